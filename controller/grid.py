"""When the loop samples and when a command acts: one grid for plant, controller, theory and replay.

All times are int64 nanoseconds of simulated time. The internal step divides the DAQ period; sample period and offset
are whole DAQ periods; the delay is whole internal steps and may exceed the sample period.
"""

from typing import NamedTuple

NS = 1_000_000_000


class Sampling(NamedTuple):
    """Periods and shifts [ns]. Sample i is taken at offset + i * sample and acts delay later, held until the next."""

    step: int
    daq: int
    sample: int
    offset: int
    delay: int

    @property
    def steps(self) -> int:
        """Internal steps in a DAQ period."""
        return self.daq // self.step


def to_ns(seconds: float) -> int:
    """Nanoseconds, rounded."""
    return round(seconds * NS)


def whole(name: str, seconds: float, unit_name: str, unit_ns: int, least: int = 0) -> int:
    """A time in ns that must be a whole number (>= least) of units; ValueError with the two nearest valid values."""
    ns = to_ns(seconds)
    if ns % unit_ns == 0 and ns >= least * unit_ns:
        return ns
    below = max(ns // unit_ns, least)
    above = below + 1
    raise ValueError(
        f"{name} {seconds:.9g} s is not a whole number (at least {least}) of the {unit_name}, {unit_ns / NS:.9g} s; "
        f"nearest: {below * unit_ns / NS:.9g} or {above * unit_ns / NS:.9g} s"
    )


def sampling(step: float, daq_period: float, sample_period: float, offset: float, delay: float) -> Sampling:
    """The grid of times given in seconds. Raises ValueError naming the two nearest valid values."""
    step_ns = to_ns(step)
    if step_ns < 1:
        raise ValueError(f"internal step {step} s must be at least 1e-9 s")
    daq_ns = whole("daq_period", daq_period, "internal step", step_ns, least=1)
    return Sampling(
        step=step_ns,
        daq=daq_ns,
        sample=whole("sample_period", sample_period, "DAQ period", daq_ns, least=1),
        offset=whole("offset", offset, "DAQ period", daq_ns),
        delay=whole("delay", delay, "internal step", step_ns),
    )


def is_sample(stamp: int, grid: Sampling) -> bool:
    """Does the controller sample the measurement of this stamp?"""
    return stamp >= grid.offset and (stamp - grid.offset) % grid.sample == 0


def last_due(time: int, grid: Sampling) -> int | None:
    """Stamp of the last sample whose command acts before `time`; None if there is none yet."""
    since = time - 1 - grid.delay - grid.offset
    return None if since < 0 else grid.offset + since // grid.sample * grid.sample


def number_due(time: int, grid: Sampling) -> int:
    """How many samples have a command that acts before `time`."""
    return max(0, (time - 1 - grid.delay - grid.offset) // grid.sample + 1)


def next_sample(time: int, grid: Sampling) -> int:
    """Stamp of the first sample at `time` or after it."""
    return grid.offset + max(0, -(-(time - grid.offset) // grid.sample)) * grid.sample
