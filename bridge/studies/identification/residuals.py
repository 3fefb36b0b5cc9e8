"""Measured less simulated, in deviations of the noise, with what the starts of the shots can explain taken out.

A start is three numbers s of a shot that only its own residual r knows, and it is so close that r is linear in them.
With Q an orthonormal basis of dr/ds, least squares over s leaves r - Q Q' r: the numbers of the rig are fitted to that
alone (variable projection, G. Golub and V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413), and its Jacobian is that of r
less the same share (L. Kaufman, BIT 15 (1975) 49). So their covariance counts the starts as unknown. Where the numbers
u move, the start that fits best moves with them, s - S^+ (r + dr/du du) with S = dr/ds: a start that stays where wrong
numbers wanted it, bars off, holds the numbers to it.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future
from typing import Any, NamedTuple

import numpy as np

from bridge.studies.identification.data import Array, Record
from bridge.studies.identification.parameters import Parameter, with_places
from bridge.studies.identification.simulation import AS_LED, Shot, Simulation, Start
from bridge.studies.identification.taming import FAR_OUT, tamed, taming

ASIDE = {"position": 2.0, "lower": 4.0, "upper": 4.0}  # how far starts are moved for a slope, in deviations of a mean
SLOPE, FINEST = 1e-3, 1e-8  # how far numbers are moved for a slope, in places: at first and at most, and at least
AWAY = 2.0  # by how much the residual is to change then, in deviations all together: phases of swings turn quickly
JUMP = 1.6 * AWAY  # a greater change is more than the step was chosen for: between two slopes the rod stuck or slid
ALIKE = 0.7  # cosine between the slopes of two numbers of which the rig may see only a product
CLOSE = 0.1  # change of the residual, in deviations all together, that no estimate shows
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
    back: Array  # -S^+: how the start follows the residual [SI]
    owed: Array  # by how much the start would still have to move [SI]


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

    share: a step is not worth it when it changes the residual by less than this part of it, or by less than CLOSE; then
    shots also start where the data lead the twin, so that none starts where wrong numbers want it.
    blind: to samples far out, which otherwise count less.
    """

    def __init__(
        self,
        task: Task,
        crew: Executor | None = None,
        share: float = 0.0,
        steps: Array | None = None,
        blind: bool = False,
    ) -> None:
        self.task = task
        self._blind = blind
        self.steps = np.full(len(task.parameters), SLOPE) if steps is None else steps  # for slopes, in places
        self._share = share
        self._last: tuple[Array, Array, float] | None = None  # places, Jacobian and residual's size there
        self.slices = slices(task)
        self.runs = 0  # of all shots once
        self._least, self._vain = math.inf, 0  # cost, and steps that brought nothing
        self._crew = crew
        self._known: tuple[bytes, list[At]] | None = None
        self._near: list[At] | None = None
        self._base = np.zeros(len(task.parameters))  # places of these
        self._along: list[Array] | None = None  # how their starts follow the places

    def at(self, u: Array) -> list[At]:
        """All shots with the numbers at places. Raises ValueError where these make no circuit.

        The starts follow the places. What they explain is taken from the first ones: it changes little.
        """
        if self._known is None or self._known[0] != u.tobytes():
            if self._near is None:
                return self._about(u)
            simulation, near, starts = self._simulation(u), self._near, self._following(u)
            found = self._map(lambda i: self._from(simulation, i, starts[i], near[i]), range(len(near)))
            self._known = u.tobytes(), found
            self.runs += 1
        return self._known[1]

    def afresh(self, u: Array) -> list[At]:
        """The same with starts that fit these places best, and what they explain there."""
        first, simulation = self._about(u), self._simulation(u)
        starts = self._following(u)
        self._near = self._map(lambda i: self._from(simulation, i, starts[i], first[i]), range(len(first)))
        self._known = u.tobytes(), self._near
        self.runs += 1
        return self._near

    def _about(self, u: Array) -> list[At]:
        """All shots from the best starts known, at first from where the data lead the twin, with slopes of these."""
        simulation, starts = self._simulation(u), self._following(u)
        self._near = self._map(lambda i: self._with_basis(simulation, i, starts[i]), range(len(starts)))
        self._known = u.tobytes(), self._near
        self._base, self._along = u.copy(), None
        self.runs += 7
        return self._near

    def _following(self, u: Array) -> list[Start]:
        """The starts that fit best at places, as the last slopes say."""
        near = self._near
        if near is None or self._share > 0.0:
            return [AS_LED for _ in self.slices]
        moves = [at.owed for at in near]
        if self._along is not None:
            moves = [move + along @ (u - self._base) for move, along in zip(moves, self._along, strict=True)]
        return [Start(*(np.array(at.start) + move).tolist()) for at, move in zip(near, moves, strict=True)]

    def _from(self, simulation: Simulation, i: int, start: Start, near: At) -> At:
        reading = self._read(simulation, i, start)[1]
        return _compared(self._raw(reading, i), near._replace(start=start, reading=reading))

    def residual(self, u: Array) -> Array:
        """Of all shots, starts taken out, then the distances from what is known before; NaN without a circuit.

        Raises SettledError.
        """
        if self._last is not None:
            place, slope, size = self._last
            if 0.0 < np.linalg.norm(slope @ (u - place)) < max(CLOSE, self._share * size):
                raise SettledError
        try:
            found = [tamed(at.residual, self._blind) for at in self.at(u)]
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
        slopes = self._map(lambda j: self._smooth(u, j, known, False), range(len(u)))
        self.runs += len(u)
        self._near, self._base = known, u.copy()
        self._along = [at.back @ np.column_stack([one[i] for one in slopes]) for i, at in enumerate(known)]
        found = self._kept([_without_starts(known, one) for one in slopes])
        found[: -len(u)] *= taming(np.concatenate([at.residual for at in known]), self._blind)[:, None]
        size = math.sqrt(sum(float((tamed(at.residual, self._blind) ** 2).sum()) for at in known))
        self._last = u.copy(), found, size
        return found

    def slopes(self, u: Array) -> Array:
        """The Jacobian by differences to both sides, where there is room: for what is said of the result."""
        known, used = self.at(u), self.steps
        columns = self._map(lambda j: self._central(u, j, known), range(len(u)))
        self.runs += 2 * len(u)
        for i, j, factor in _alike(columns):
            if used[j] != factor * used[i]:
                self.steps = used = np.where(np.arange(len(u)) == j, factor * used[i], used)
                columns[j] = self._central(u, j, known)
                self.runs += 2
        return self._kept(columns)

    def _kept(self, columns: list[Array]) -> Array:
        """Columns and what is known before; the next slopes are taken as far off as these say.

        By powers of two, so that numbers which the rig sees as one product are moved by exactly as much of it: their
        slopes are then the same, whatever the rod does on the way.
        """
        found = np.vstack([np.column_stack(columns), np.diag(1.0 / self.priors())])
        self.steps = np.exp2(np.round(np.log2(np.clip(AWAY / np.linalg.norm(found, axis=0), FINEST, SLOPE))))
        for i, j, factor in _alike(columns):  # each rounded by itself, they might lie on two sides of a half
            self.steps[j] = factor * self.steps[i]
        return found

    def last(self) -> tuple[Array, float]:
        """The places of the last Jacobian, which are those of the best residual, and its size."""
        assert self._last is not None
        return self._last[0], self._last[2]

    def _central(self, u: Array, j: int, known: list[At]) -> Array:
        return _without_starts(known, self._smooth(u, j, known, True))

    def _smooth(self, u: Array, j: int, known: list[At], both: bool) -> list[Array]:
        """Slopes of each shot, sample by sample to that side on which nothing jumps.

        A rod that is all but breaking away does so on one side: the pressures jump, by a change that is not a slope.
        Where the change is as great as expected, one side does, unless both are asked for.
        """
        ways = [beside for way in (1.0, -1.0) if (beside := self._beside(u, j, way))]
        if not ways:
            name = self.task.parameters[j].name
            raise ValueError(f"{name} cannot change: its limits are too close, or the rig allows no other value")
        one = self._slope(u, j, ways[0], known)
        jumps = self.steps[j] * np.linalg.norm(_without_starts(known, one)) > JUMP
        if len(ways) == 1 or not (both or jumps):
            return one
        other = self._slope(u, j, ways[1], known)
        return [_least(a, b) for a, b in zip(one, other, strict=True)]

    def _slope(self, u: Array, j: int, beside: tuple[Array, Simulation], known: list[At]) -> list[Array]:
        """Of each shot, from where it starts."""
        aside, simulation = beside
        found = []
        for i, at in enumerate(known):
            moved = self._raw(self._read(simulation, i, at.start)[1], i)
            found.append((moved - self._raw(at.reading, i)) / (aside[j] - u[j]))
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

    def _with_basis(self, simulation: Simulation, i: int, start: Start) -> At:
        """A shot, and what its start explains: slopes to that side on which nothing jumps."""
        shot = self.task.shots[i]
        record = self.task.records[shot.record]
        warm, reading = self._read(simulation, i, start)
        aside, raw = _aside(record, shot), self._raw(reading, i)

        def moved(name: str, by: float) -> Array:
            beside = start._replace(**{name: getattr(start, name) + by})
            return self._raw(simulation.read(record, shot, warm, beside), i) - raw

        slopes = np.column_stack([_least(moved(name, by), -moved(name, -by)) for name, by in aside.items()])
        left, single, right = np.linalg.svd(slopes, full_matrices=False)
        kept = single > NONE_LEFT * max(single[0], 1e-300)
        basis = np.ascontiguousarray(left[:, kept])
        back = -np.array(list(aside.values()))[:, None] * (right[kept].T / single[kept]) @ basis.T
        return _compared(raw, At(start, reading, raw, basis, back, np.zeros(len(aside))))

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


def _alike(columns: list[Array]) -> Iterator[tuple[int, int, float]]:
    """Numbers i < j whose slopes all but say the same, and the power of two between their steps."""
    for j in range(1, len(columns)):
        for i in range(j):
            a, b = np.linalg.norm(columns[i]), np.linalg.norm(columns[j])
            if abs(columns[i] @ columns[j]) > ALIKE * a * b:
                yield i, j, float(np.exp2(np.round(np.log2(a / b))))
                break


def _without_starts(known: list[At], slopes: list[Array]) -> Array:
    """A column of the Jacobian: slopes of all shots less what their starts explain."""
    return np.concatenate([one - at.basis @ (at.basis.T @ one) for at, one in zip(known, slopes, strict=True)])


def _compared(raw: Array, at: At) -> At:
    """A shot with its residual less what the start explains; what is far out does not move the start."""
    residual = raw - at.basis @ (at.basis.T @ raw)
    return at._replace(residual=residual, owed=at.back @ np.where(np.abs(residual) <= FAR_OUT, raw, 0.0))


def _least(one: Array, other: Array) -> Array:
    """Of two, the one closer to zero, number by number."""
    return np.where(np.abs(one) < np.abs(other), one, other)


def _aside(record: Record, shot: Shot) -> dict[str, float]:
    """How far each number of a start is moved for a slope [SI]: the residual is to change as much as for `AWAY`.

    Further, and the rod would stick where it slid: what a start explains would be wrong for the whole shot.
    """
    found, samples = {}, shot.end - shot.begin
    for name, quantities in {"position": ("position",), "lower": ("p2", "p_lower"), "upper": ("p3", "p_upper")}.items():
        signal = next((s for q in quantities if (s := record.signal(q)) is not None), None)
        found[name] = ASIDE[name] / math.sqrt(samples) * (USUAL[name] if signal is None else signal.deviation)
    return found
