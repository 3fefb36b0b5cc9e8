"""Growth of the pilot's small swings in the rig at rest, by linear theory and by the twin at any step."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.circuit.build import build
from twin.circuit.equilibrium import equilibrium, supply_at_rest
from twin.circuit.housing import shake
from twin.circuit.pilot_swing import pilot_swings
from twin.circuit.step import Circuit
from twin.rig import values

COLUMNS, LEAST = 400, 1e-11  # of the sliding window; share of the largest singular value squared that is kept
SPACING = 100e-6  # [s], of the samples
BAND = (1000.0, 3000.0)  # [Hz]

Changes = Mapping[str, Mapping[str, float | str]]
RIG: Changes = {}
LONGER: Changes = {"pipe_1": {"length": 1.5}}  # a mode of line 1 sits on the pilot's frequency


def with_oil(volume: float) -> Changes:
    """The rig with compressible oil before its pilot [m^3]."""
    return {"relief": {"channel_volume": volume}}


class Swing(NamedTuple):
    """An oscillation."""

    growth: float  # [1/s]
    frequency: float  # [Hz]


def changes(speed: float, rig: Changes) -> dict[str, dict[str, float | str]]:
    """The changed rig without ripple at a pump speed [Hz]."""
    pump = dict(rig.get("pump", {})) | {"ripple": "none", "speed": speed}
    return {part: dict(entries) for part, entries in rig.items()} | {"pump": pump}


def circuit_at(speed: float, step: float, rig: Changes) -> Circuit:
    return build(values(changes(speed, rig)), step)


def flow_of(circuit: Circuit) -> float:
    """Over the valve at rest [m^3/s]."""
    return supply_at_rest(circuit).relieved


def theory(speed: float, rig: Changes) -> list[Swing]:
    """The fastest growing first."""
    found = pilot_swings(values(changes(speed, rig)), circuit_at(speed, 50e-6, rig))
    return [Swing(*swing) for swing in found]


def nearest(swing: Swing, swings: list[Swing]) -> Swing:
    """That of the nearest frequency."""
    return min(swings, key=lambda other: abs(other.frequency - swing.frequency))


def pushed_lift(
    circuit: Circuit, seconds: float = 0.1, settle: float = 0.01, push: float = 1e-8
) -> NDArray[np.float64]:
    """Lift of the poppet [m] from `settle` on, at rest but for a push by a share of its lift."""
    state = equilibrium(circuit, 0.1)
    relief = state.core.relief
    moved = relief.state._replace(pilot_lift=relief.state.pilot_lift * (1.0 + push))
    pushed = state.with_core(relief=relief._replace(state=moved))
    return shake(pushed, circuit, seconds, settle).pilot_lift


def grown(circuit: Circuit, seconds: float = 0.1) -> list[Swing]:
    """The oscillations of the pushed poppet, the fastest growing first."""
    every = max(1, round(SPACING / circuit.parts.step))
    return modes(pushed_lift(circuit, seconds)[::every], every * circuit.parts.step)


def modes(signal: NDArray[np.float64], spacing: float) -> list[Swing]:
    """The oscillations in a sum of damped ones, the fastest growing first: poles of its shift (ESPRIT)."""
    x = (signal - signal.mean()) / np.abs(signal - signal.mean()).max()
    window = np.lib.stride_tricks.sliding_window_view(x, min(len(x) // 3, COLUMNS))
    size, vectors = np.linalg.eigh(window.T @ window)
    kept = vectors[:, size > LEAST * size.max()]
    poles = np.linalg.eigvals(np.linalg.lstsq(kept[:-1], kept[1:], rcond=None)[0])
    rates = np.log(poles.astype(complex)) / spacing
    time = spacing * np.arange(len(x))
    shares = np.abs(np.linalg.lstsq(np.exp(np.outer(time, rates)), x.astype(complex), rcond=None)[0])
    seen = shares * np.exp(np.maximum(rates.real, 0.0) * time[-1]) > 1e-2
    low, high = (2.0 * math.pi * f for f in BAND)
    found = rates[seen & (rates.imag > low) & (rates.imag < high)]
    return sorted((Swing(float(r.real), float(r.imag) / (2.0 * math.pi)) for r in found), reverse=True)
