"""A sampled drive between SI units and the numbers of the dimensionless model, both ways.

Source: chapter 5, (5.7) and (5.8), (5.27), Table 5.1. The units are length L, time 1/omega with omega^2 = A B/(L m),
and pressure p_s - p_r above p_r; one chamber holds V0 = A L. Then

    alpha = (p_s - p_r)/B,   gamma = Q_max/(V0 omega),   k = K/(m omega),
    tau = omega T,   s = P L,   d = D L omega,

with u = P (x_ref - x) - D v of a controller that samples with a period T. A relay knows the sign of u alone, so only
d/s = T_d omega. Mass, area, length, modulus and relief pressure are the units of the way back.
"""

import math
from typing import NamedTuple

from controller.stability.actuator.model import Drive, dimensionless, omega


class SampledGains(NamedTuple):
    """A sampled controller in SI units."""

    period: float  # T [s]
    delay: float  # [s]
    gain: float  # P [1/m]
    derivative: float  # D [s/m]


class Numbers(NamedTuple):
    """A sampled drive without dimensions."""

    alpha: float
    gamma: float
    k: float
    tau: float
    delay: float  # over the sampling period
    s: float
    d: float


def to_numbers(drive: Drive, loop: SampledGains) -> Numbers:
    """The numbers of a drive and its controller. Raises ValueError for a value that none has."""
    _refuse(loop.period, "period", above=True)
    for name in ("delay", "gain", "derivative"):
        _refuse(getattr(loop, name), name, above=False)
    unit, own = omega(drive), dimensionless(drive)
    s, d = loop.gain * drive.length, loop.derivative * drive.length * unit
    return Numbers(*own, tau=loop.period * unit, delay=loop.delay / loop.period, s=s, d=d)


def to_si(numbers: Numbers, units: Drive) -> tuple[Drive, SampledGains]:
    """The drive with the mass, area, length, modulus and relief pressure of `units`, and its controller.

    Raises ValueError for a value that no drive has.
    """
    for name, value in numbers._asdict().items():
        _refuse(value, name, above=name in ("alpha", "gamma", "tau"))
    unit, period = omega(units), numbers.tau / omega(units)
    drive = units._replace(
        supply=units.relief + numbers.alpha * units.modulus,
        flow=numbers.gamma * units.area * units.length * unit,
        friction=numbers.k * units.mass * unit,
    )
    derivative = numbers.d / (units.length * unit)
    return drive, SampledGains(period, numbers.delay * period, numbers.s / units.length, derivative)


def _refuse(value: float, name: str, above: bool) -> None:
    if not (value > 0.0 if above else value >= 0.0) or value == math.inf:
        raise ValueError(f"{name} {value:g} must be finite and {'above' if above else 'at least'} 0")
