"""Measured less simulated, in deviations of the noise, with what the starts of the shots can explain taken out.

A start is three numbers s of a shot that only its own residual r knows, and it is so close that r is linear in them.
With Q an orthonormal basis of dr/ds, least squares over s leaves r - Q Q' r: the numbers of the rig are fitted to that
alone (variable projection, G. Golub and V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413), and its Jacobian is that of r
less the same share (L. Kaufman, BIT 15 (1975) 49). So their covariance counts the starts as unknown.
"""

import math
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor, Future
from typing import Any, NamedTuple

import numpy as np

from bridge.studies.identification.data import Array, Record
from bridge.studies.identification.parameters import Parameter, with_places
from bridge.studies.identification.simulation import AS_LED, Shot, Simulation, Start

ASIDE = {"position": 2.0, "lower": 4.0, "upper": 4.0}  # how far starts are moved for a slope, in deviations
SLOPE, FINEST = 1e-3, 1e-8  # how far numbers are moved for a slope, in places: at first and at most, and at least
AWAY = 2.0  # by how much the residual is to change then, in deviations all together: phases of swings turn quickly
CLOSE = 0.1  # change of the residual, in deviations all together, that no estimate shows
FAR_OUT = 5.0  # deviations from which on a residual counts less
VAIN = 3  # steps that bring nothing until it ends
NONE_LEFT = 1e-9  # singular values below this share of the greatest say nothing
USUAL = {"position": 1e-5, "lower": 1e4, "upper": 1e4}  # [m], [Pa]: where none is measured


class Task(NamedTuple):
    """What a fit compares: records, shots on them, and the rig."""

    values: Mapping[str, Mapping[str, Any]]
    step: float
    records: Sequence[Record]
    parameters: Sequence[Parameter]
    shots: Sequence[Shot]


class At(NamedTuple):
    """A shot with certain numbers."""

    start: Start  # that fits best
    reading: Array  # simulated, (signals, samples)
    residual: Array  # flat, in deviations; zero where nothing is compared
    basis: Array  # Q


class Slice(NamedTuple):
    """What of its record a shot is compared with."""

    value: Array
    weight: Array  # 1/deviation, zero where nothing is compared


def slices(task: Task) -> list[Slice]:
    """Measured values of each shot."""
    return [_slice(task.records[shot.record], shot) for shot in task.shots]


def _slice(record: Record, shot: Shot) -> Slice:
    part = slice(shot.begin + 1, shot.end + 1)
    value = np.array([signal.value[part] for signal in record.signals])
    counted = np.array([signal.counted[part] for signal in record.signals])
    deviation = np.array([[signal.deviation] for signal in record.signals])
    return Slice(np.where(counted, value, 0.0), np.where(counted, 1.0 / deviation, 0.0))


class SettledError(Exception):
    """A step that changes nothing worth a simulation."""


class Residuals:
    """Residual and Jacobian of a task, by the places of its parameters.

    share: a step is not worth it when it changes the residual by less than this part of it, or by less than CLOSE.
    """

    def __init__(
        self, task: Task, crew: Executor | None = None, share: float = 0.0, steps: Array | None = None
    ) -> None:
        self.task = task
        self.steps = np.full(len(task.parameters), SLOPE) if steps is None else steps  # for slopes, in places
        self._share = share
        self._last: tuple[Array, Array, float] | None = None  # places, Jacobian and residual's size there
        self.slices = slices(task)
        self.runs = 0  # of all shots once
        self._least, self._vain = math.inf, 0  # cost, and steps that brought nothing
        self._crew = crew
        self._known: tuple[bytes, list[At]] | None = None
        self._near: list[At] | None = None

    def at(self, u: Array) -> list[At]:
        """All shots with the numbers at places. Raises ValueError where these make no circuit.

        The starts, and what they explain, are those of the first places, whose slopes change little with the numbers.
        """
        if self._known is None or self._known[0] != u.tobytes():
            if self._near is None:
                self._near = self.afresh(u)
                return self._near
            simulation, near = self._simulation(u), self._near
            self._known = u.tobytes(), self._map(lambda i: self._as_near(simulation, i, near[i]), range(len(near)))
            self.runs += 1
        return self._known[1]

    def afresh(self, u: Array) -> list[At]:
        """The same with starts that fit these places best."""
        simulation = self._simulation(u)
        self._near = self._map(lambda i: self._fitted(simulation, i), range(len(self.slices)))
        self._known = u.tobytes(), self._near
        self.runs += 5
        return self._near

    def _as_near(self, simulation: Simulation, i: int, near: At) -> At:
        reading = self._read(simulation, i, near.start)[1]
        raw = self._raw(reading, i)
        return At(near.start, reading, raw - near.basis @ (near.basis.T @ raw), near.basis)

    def residual(self, u: Array) -> Array:
        """Of all shots, starts taken out, then the distances from what is known before; NaN without a circuit.

        Raises SettledError.
        """
        if self._last is not None:
            place, slope, size = self._last
            if 0.0 < np.linalg.norm(slope @ (u - place)) < max(CLOSE, self._share * size):
                raise SettledError
        try:
            found = [tamed(at.residual) for at in self.at(u)]
        except ValueError:
            return np.full(sum(s.value.size for s in self.slices) + len(u), np.nan)
        residual = np.concatenate([*found, u / self.priors()])
        self._refuse_vain(0.5 * float(residual @ residual))
        return residual

    def _refuse_vain(self, cost: float) -> None:
        """Raises SettledError after steps that bring nothing and cost little: what is left is rough."""
        if cost < self._least - CLOSE or cost > self._least + 1.0:
            self._vain = 0
        else:
            self._vain += 1
        self._least = min(self._least, cost)
        if self._vain >= VAIN:
            raise SettledError

    def jacobian(self, u: Array) -> Array:
        """Of the residual, by differences to one side."""
        known = self.at(u)
        columns = self._map(lambda j: self._slope(u, j, self._either(u, j), known), range(len(u)))
        self.runs += len(u)
        found = self._kept(columns)
        found[: -len(u)] *= taming(np.concatenate([at.residual for at in known]))[:, None]
        size = math.sqrt(sum(float((tamed(at.residual) ** 2).sum()) for at in known))
        self._last = u.copy(), found, size
        return found

    def slopes(self, u: Array) -> Array:
        """The Jacobian by differences to both sides, where there is room: for what is said of the result."""
        known = self.at(u)
        columns = self._map(lambda j: self._central(u, j, known), range(len(u)))
        self.runs += 2 * len(u)
        return self._kept(columns)

    def _kept(self, columns: list[Array]) -> Array:
        """Columns and what is known before; the next slopes are taken as far off as these say.

        By powers of two, so that numbers which the rig sees as one product are moved by exactly as much of it: their
        slopes are then the same, whatever the rod does on the way.
        """
        found = np.vstack([np.column_stack(columns), np.diag(1.0 / self.priors())])
        away = np.clip(AWAY / np.linalg.norm(found, axis=0), FINEST, SLOPE)
        self.steps = np.exp2(np.round(np.log2(away)))
        return found

    def last(self) -> tuple[Array, float]:
        """The places of the last Jacobian, which are those of the best residual, and its size."""
        assert self._last is not None
        return self._last[0], self._last[2]

    def _central(self, u: Array, j: int, known: list[At]) -> Array:
        found = [self._slope(u, j, beside, known) for way in (1.0, -1.0) if (beside := self._beside(u, j, way))]
        return np.mean(found, axis=0) if found else self._slope(u, j, self._either(u, j), known)

    def _slope(self, u: Array, j: int, beside: tuple[Array, Simulation], known: list[At]) -> Array:
        aside, simulation = beside
        found = []
        for i, at in enumerate(known):
            moved = self._raw(self._read(simulation, i, at.start)[1], i)
            slope = (moved - self._raw(at.reading, i)) / (aside[j] - u[j])
            found.append(slope - at.basis @ (at.basis.T @ slope))
        return np.concatenate(found)

    def _either(self, u: Array, j: int) -> tuple[Array, Simulation]:
        found = self._beside(u, j, 1.0) or self._beside(u, j, -1.0)
        if found is None:
            name = self.task.parameters[j].name
            raise ValueError(f"{name} cannot change: its limits are too close, or the rig allows no other value")
        return found

    def _beside(self, u: Array, j: int, way: float) -> tuple[Array, Simulation] | None:
        """Places with one a little higher or lower, and their simulation; None where there is none."""
        aside = u.copy()
        aside[j] += way * self.steps[j]
        low, high = self.task.parameters[j].bounds
        if not low <= aside[j] <= high:
            return None
        try:
            return aside, self._simulation(aside)
        except ValueError:
            return None

    def _simulation(self, u: Array) -> Simulation:
        return Simulation(with_places(self.task.values, self.task.parameters, u), self.task.step)

    def _read(self, simulation: Simulation, i: int, start: Start) -> tuple[Array, Array]:
        shot = self.task.shots[i]
        record = self.task.records[shot.record]
        warm = simulation.warm(record, shot)
        return warm, simulation.read(record, shot, warm, start)

    def _fitted(self, simulation: Simulation, i: int) -> At:
        """A shot from the start that fits best."""
        shot = self.task.shots[i]
        record = self.task.records[shot.record]
        warm, reading = self._read(simulation, i, AS_LED)
        aside = _aside(record)
        raw = self._raw(reading, i)
        moved = [simulation.read(record, shot, warm, AS_LED._replace(**{name: by})) for name, by in aside.items()]
        slopes = np.column_stack([(self._raw(one, i) - raw) for one in moved])
        left, single, right = np.linalg.svd(slopes, full_matrices=False)
        kept = single > NONE_LEFT * max(single[0], 1e-300)
        shares = -(right[kept].T / single[kept]) @ (left[:, kept].T @ raw)
        start = Start(**{name: by * share for (name, by), share in zip(aside.items(), shares.tolist(), strict=True)})
        reading, basis = simulation.read(record, shot, warm, start), np.ascontiguousarray(left[:, kept])
        raw = self._raw(reading, i)
        return At(start, reading, raw - basis @ (basis.T @ raw), basis)

    def _raw(self, reading: Array, i: int) -> Array:
        part = self.slices[i]
        return ((reading - part.value) * part.weight).ravel()

    def priors(self) -> Array:
        """Deviations of what is known before."""
        return np.array([one.prior for one in self.task.parameters])

    def _map(self, function: Any, items: Any) -> list[Any]:
        """Over the threads of the crew: a simulation does not hold the interpreter."""
        if self._crew is None:
            return [function(item) for item in items]
        asked: list[Future[Any]] = [self._crew.submit(function, item) for item in items]
        return [future.result() for future in asked]


def tamed(residual: Array) -> Array:
    """The residual r as one whose square grows only with abs(r) far out: pseudo-Huber, 2 c^2 (sqrt(1 + (r/c)^2) - 1).

    A rod that sticks where the other slides is off by hundreds of deviations for a moment and says little of the
    numbers; noise is left as it is.
    """
    return np.sign(residual) * FAR_OUT * np.sqrt(2.0 * (np.hypot(1.0, residual / FAR_OUT) - 1.0))


def taming(residual: Array) -> Array:
    """Slope of `tamed`."""
    far = np.hypot(1.0, residual / FAR_OUT)
    small = np.abs(residual) < 1e-3
    own = np.where(small, 1.0, np.abs(tamed(residual)))
    return np.where(small, 1.0, np.abs(residual) / (far * own))


def _aside(record: Record) -> dict[str, float]:
    """How far each number of a start is moved for a slope [SI]."""
    found = {}
    for name, quantities in {"position": ("position",), "lower": ("p2", "p_lower"), "upper": ("p3", "p_upper")}.items():
        signal = next((s for q in quantities if (s := record.signal(q)) is not None), None)
        found[name] = ASIDE[name] * (USUAL[name] if signal is None else signal.deviation)
    return found
