"""The recorded commands through the twin, from starts that the data give: what the sensors would have read.

A shot is a stretch of a record that is simulated without looking at the data. Where it begins, the state must be
known. Position and pressures of the chambers are measured; the rest (spool, relief valve, waves in the lines) follows
within some tenths of a second from the commands. So the twin runs for a while before a shot, led to the measured
position and pressures; what the noise leaves in these three is estimated with the numbers (`residuals`).
"""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import UsageError
from bridge.studies.identification.data import TAPS, Array, Record
from twin.actuator import areas, chamber_volumes, moduli, stored_oil
from twin.circuit.block import compiled
from twin.circuit.build import build
from twin.circuit.course import Stretches, Watched, course_of, width
from twin.circuit.equilibrium import holding_pressures, relieved_at, state_at, supply_at_rest
from twin.circuit.state import ENDS_AT, Flows, Pressures, flatten, place_of
from twin.circuit.step import LOWER, UPPER, Circuit, Piston
from twin.cylinder import Chambers
from twin.directional_valve import Spool
from twin.kernel import interpreted
from twin.topology import OBSERVED

WARM_UP, WARM_SHARE = 0.3, 0.6  # [s]; share of a short shot
FITTED_OVER = 11  # samples of the straight line that is the first guess of position and velocity
LINE = 3  # of these that are known, at least
POSITION_GAIN, PRESSURE_GAIN = 0.1, 0.1  # shares of a deviation that are taken back at each sample
TICK = place_of("tick")
X, LOWER_OIL, UPPER_OIL = place_of("piston.position"), place_of("chambers.lower"), place_of("chambers.upper")
LEADING = {"position": ("position",), "lower": ("p2", "p_lower"), "upper": ("p3", "p_upper")}  # quantities that do
NO_STRETCH = np.zeros(0, np.int64)


class Shot(NamedTuple):
    """A stretch of a record, by its samples."""

    record: int
    warm: int  # where the twin begins to run, led by the data
    begin: int  # from here on without
    end: int


class Start(NamedTuple):
    """What is estimated of the state in which a shot begins: deviations from that of the run before it."""

    position: float  # [m]
    lower: float  # pressure of the lower chamber [Pa]
    upper: float  # [Pa]


AS_LED = Start(0.0, 0.0, 0.0)


def shots_of(records: Sequence[Record], length: float) -> list[Shot]:
    """Records cut into shots of a length [s] at most, all equally long; inf: one for each record.

    A shot whose run before it would begin in a hole of the position begins later; one that is all hole is left out.
    Raises UsageError for a record without any.
    """
    found = []
    for number, record in enumerate(records):
        warm = max(1, round(min(WARM_UP, WARM_SHARE * length) / record.period))
        left = record.samples - 1 - warm
        count = 1 if length == np.inf else max(1, round(left * record.period / length))
        cuts = np.linspace(warm, record.samples - 1, count + 1).round().astype(int).tolist()
        known = _line_known(record)
        shots = [_off_holes(Shot(number, begin - warm, begin, end), known) for begin, end in pairwise(cuts)]
        own = [shot for shot in shots if shot is not None]
        if not own:
            raise UsageError(
                f"{record.name}: no stretch begins where the position is known; a fit needs {LINE} samples of it among "
                f"{FITTED_OVER}, and {(warm + FITTED_OVER) * record.period:g} s of data behind them"
            )
        found += own
    return found


def _line_known(record: Record) -> NDArray[np.bool_]:
    """Samples about which the position is known well enough for a straight line."""
    signal = record.signal("position")
    if signal is None:
        return np.ones(record.samples, bool)
    sums = np.concatenate([[0], np.cumsum(np.isfinite(signal.value))])
    begin = np.maximum(0, np.arange(record.samples) - FITTED_OVER // 2)
    return sums[np.minimum(begin + FITTED_OVER, record.samples)] - sums[begin] >= LINE


def _off_holes(shot: Shot, known: NDArray[np.bool_]) -> Shot | None:
    """The shot, begun as much later as the run before it must be; None where that leaves none."""
    if known[shot.warm]:
        return shot
    later = np.flatnonzero(known[shot.warm : shot.end])
    by = int(later[0]) if len(later) else len(known)
    moved = shot._replace(warm=shot.warm + by, begin=shot.begin + by)
    return moved if moved.begin + FITTED_OVER <= shot.end else None


class Simulation:
    """A rig with certain numbers, on which shots are run; threads may share it."""

    def __init__(self, values: Mapping[str, Mapping[str, Any]], step: float) -> None:
        """Raises ValueError where the numbers make no circuit."""
        self.circuit: Circuit = build(values, step)
        self._plant = compiled(self.circuit)
        self._supply = supply_at_rest(self.circuit)
        self._step = step

    def warm(self, record: Record, shot: Shot) -> Array:
        """The flat state in which a shot begins, as the run before it leaves it."""
        state = flatten(self._at(record, shot.warm))
        state[TICK] = round(shot.warm * record.period / self._step)  # the pump's teeth are where they were
        watched = self._watched(record, True)
        stretches = record.between(shot.warm, shot.begin)
        self._run(state, stretches, watched, self._measured(record, shot.warm, shot.begin, watched))
        return state

    def read(self, record: Record, shot: Shot, warm: Array, start: Start = AS_LED) -> Array:
        """What the sensors would have read in a shot, shape (signals, samples)."""
        state = warm.copy()
        self._shift(state, start)
        watched = self._watched(record, False)
        out = self._run(state, record.between(shot.begin, shot.end), watched, np.zeros((1, 1)))
        return np.array([_reading(out, j, record) for j in range(len(record.signals))])

    def _run(self, state: Array, stretches: Stretches, watched: Watched, measured: Array) -> Array:
        out = np.zeros((int((stretches.row >= 0).sum()), width(watched)))
        course_of(self._plant, stretches, watched)(state, measured, out)
        return out

    def _watched(self, record: Record, led: bool) -> Watched:
        further = [list(OBSERVED).index(s.quantity) for s in record.signals if s.quantity not in TAPS]
        leads = list(self._leads(record)) if led else []
        at, by, gain = zip(*leads, strict=True) if leads else ((), (), ())
        return Watched(np.array(further, np.int64), np.array(at, np.int64), np.array(by, np.int64), np.array(gain))

    def _leads(self, record: Record) -> Any:
        """What leads which number of the state: the piston takes the oil of its chambers with it."""
        cylinder = self.circuit.parts.cylinder
        middle = 0.5 * getattr(cylinder, "stroke", 0.0)
        area, volume = interpreted(areas)(cylinder, middle), interpreted(chamber_volumes)(middle, cylinder)
        stiff = interpreted(moduli)(cylinder)
        places = {name: _column(record, quantities) for name, quantities in LEADING.items()}
        if (by := places["position"]) is not None:
            yield X, by, POSITION_GAIN
            yield LOWER_OIL, by, POSITION_GAIN * area.lower
            yield UPPER_OIL, by, -POSITION_GAIN * area.upper
        if (by := places["lower"]) is not None:
            yield LOWER_OIL, by, PRESSURE_GAIN * volume.lower / stiff.lower
        if (by := places["upper"]) is not None:
            yield UPPER_OIL, by, PRESSURE_GAIN * volume.upper / stiff.upper

    def _measured(self, record: Record, begin: int, end: int, watched: Watched) -> Array:
        """Values that lead, where those they are compared with stand."""
        found = np.full((end - begin, width(watched)), np.nan)
        for quantities in LEADING.values():
            column, signal = _column(record, quantities), _signal(record, quantities)
            if column is not None and signal is not None:
                found[:, column] = np.where(signal.counted, signal.value, np.nan)[begin + 1 : end + 1]
        return found

    def _at(self, record: Record, sample: int) -> Any:
        """A first guess of the state at a sample."""
        parts = self.circuit.parts
        position, velocity = _line(record, sample)
        position = min(max(position, 0.0), parts.cylinder.stroke)
        lower, upper = (_mean(record, LEADING[name], sample) for name in ("lower", "upper"))
        held = holding_pressures(parts.cylinder, parts.load, position, 0.0 if upper is None else upper)
        lower, upper = held.lower if lower is None else lower, held.upper if upper is None else upper
        tee, relieved = self._tee(record, sample)
        area = interpreted(areas)(parts.cylinder, position)
        at = Pressures(max(self._supply.pump - self._supply.tee, 0.0) + tee, tee, tee, lower, lower, upper, upper, 0, 0)
        through = Flows(relieved, 0.0, area.lower * velocity, -area.upper * velocity, 0.0, 0.0)
        reference = float(record.stretches.reference[record.first[min(sample + 1, record.samples - 1)]])
        return state_at(at, through, Piston(position, velocity), Spool(reference, 0.0), self.circuit)

    def _tee(self, record: Record, sample: int) -> tuple[float, float]:
        """Pressure at the tee, and what the relief valve takes there."""
        measured = _mean(record, ("p1", "p_p", "p_pump"), sample)
        if measured is None or measured >= self._supply.tee:
            return self._supply.tee, self._supply.relieved
        return measured, relieved_at(measured, self.circuit)[0]

    def _shift(self, state: Array, start: Start) -> None:
        """Move piston and pressures; the oil of the chambers changes by as much as they then hold more."""
        if start == AS_LED:
            return
        before = self._oil(state)
        state[X] += start.position
        state[ENDS_AT + LOWER] += start.lower
        state[ENDS_AT + UPPER] += start.upper
        after = self._oil(state)
        state[LOWER_OIL] += after.lower - before.lower
        state[UPPER_OIL] += after.upper - before.upper

    def _oil(self, state: Array) -> Any:
        """What the chambers hold at the pressures of their ports."""
        p = Chambers(float(state[ENDS_AT + LOWER]), float(state[ENDS_AT + UPPER]))
        return interpreted(stored_oil)(p, float(state[X]), self.circuit.parts.cylinder)


def _reading(out: Array, number: int, record: Record) -> Array:
    """What a sensor reads, of all that was kept."""
    signal = record.signals[number]
    column = _place(record, number)
    if signal.quantity not in TAPS:
        return out[:, column]
    return out[:, column] + signal.lead * (out[:, column - len(TAPS)] - out[:, column])


def _place(record: Record, number: int) -> int:
    """Column of a signal at the sample itself."""
    quantity = record.signals[number].quantity
    if quantity in TAPS:
        return len(TAPS) + TAPS.index(quantity)
    return 2 * len(TAPS) + sum(s.quantity not in TAPS for s in record.signals[:number])


def _signal(record: Record, quantities: tuple[str, ...]) -> Any:
    return next((s for q in quantities if (s := record.signal(q)) is not None), None)


def _column(record: Record, quantities: tuple[str, ...]) -> int | None:
    signal = _signal(record, quantities)
    return None if signal is None else _place(record, record.signals.index(signal))


def _mean(record: Record, quantities: tuple[str, ...], sample: int) -> float | None:
    """Mean of a signal about a sample; None where it was not measured."""
    signal = _signal(record, quantities)
    if signal is None:
        return None
    about = signal.value[max(0, sample - FITTED_OVER // 2) : sample + FITTED_OVER // 2 + 1]
    return float(np.nanmean(about)) if np.isfinite(about).any() else None


def _line(record: Record, sample: int) -> tuple[float, float]:
    """Position and velocity at a sample, by a straight line through its neighbours."""
    signal = record.signal("position")
    assert signal is not None  # without a position no record is taken
    begin = max(0, sample - FITTED_OVER // 2)
    about = signal.value[begin : begin + FITTED_OVER]
    sound = np.isfinite(about)
    time = record.period * (np.arange(len(about)) + begin - sample)
    slope, place = np.polyfit(time[sound], about[sound], 1)
    return float(place), float(slope)
