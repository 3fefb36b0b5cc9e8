"""An ensemble of twins that follows a rig: advanced with its commands, corrected by what the card reads.

A pure function of the commands, the scans and a seed: the same numbers in every mode, on one kind of processor.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.circuit.block import compiled
from twin.circuit.state import ENDS_AT, load, place_of, slots_of
from twin.circuit.step import Circuit
from twin.estimation.admissible import admit
from twin.estimation.consistency import GATE, Verdict, Watch, stated
from twin.estimation.draws import Draws, exact
from twin.estimation.members import Members
from twin.estimation.quantities import ESTIMATED, Standing, Use
from twin.estimation.settings import Settings
from twin.estimation.start import begin, freedoms
from twin.estimation.transform import BLOCK, apply, combine, fade
from twin.estimation.unknowns import Unknowns, priors
from twin.kernel import entry, kernel
from twin.load_slot import push_of
from twin.sensors import Card
from twin.topology import CHAMBERS, CHANNELS, END_OF

Array = NDArray[np.float64]
WHERE = {  # what wanders of a flat state
    "position": place_of("piston.position"),
    "velocity": place_of("piston.velocity"),
    **{name: ENDS_AT + END_OF[name] for name in CHAMBERS},
}
CENTRED = {name: WHERE[name] for name in ("position", "velocity")}  # pressures follow from those in the lines
RESTLESS = 9.0  # mean square of innovations above which the filter does not know any more
LOST_AFTER, FOUND_AFTER = 0.2, 0.3  # [s]
BLIND = 0.1  # [s] without a reading after which it does not know
FORGETTING = 0.02  # [s], of the mean square that tells


class Innovation(NamedTuple):
    """Of one channel at a scan, and over the last second."""

    away: float  # reading less prediction, SI
    deviation: float  # that it should have
    use: Use
    verdict: Verdict


class Estimate(NamedTuple):
    """What is known after a correction; all by name, SI."""

    stamp: float  # [s]
    standing: Standing
    values: dict[str, float]  # of ESTIMATED
    deviations: dict[str, float]
    unknowns: dict[str, float]  # factors, and offsets in SI
    unknown_deviations: dict[str, float]
    innovations: dict[str, Innovation]


class Filter:
    """One estimate of one rig."""

    def __init__(self, circuit: Circuit, card: Card, settings: Settings, seed: int) -> None:
        self.circuit, self.settings, self.seed = circuit, settings, seed
        self.priors = priors(circuit.parts, settings.unknowns)
        self.names = tuple(self.priors)
        _refuse_few(settings, len(self.names))
        n, self._lines = settings.members, compiled(circuit)
        self._beforehand, self._drift = np.array([*self.priors.values()]).reshape(-1, 2).T.copy()
        self._noise = np.array([*settings.noises().values()])
        self._noisy = np.array([WHERE[name] for name in settings.noises()])
        self._card, self.sensors = card, Sensors(card, settings, circuit.parts.step)
        self._watched = [name not in settings.without for name in CHANNELS]
        self.unknowns = Unknowns(circuit.parts, self.names, n)
        self.z = np.zeros((n, len(self.names)))
        self._room = np.zeros((n + 1, BLOCK)), np.zeros(n), np.zeros((n, n)), np.zeros((n, n))
        self._draws = Draws(seed, len(self.names) + len(self._noise), n)
        self.members: Members | None = None
        self._corrections = 0
        self.forget()

    def start(self, readings: Mapping[str, float], spool: float, tick: int) -> bool:
        """Begin at a scan, at a tick of the internal step; False where it does not say enough."""
        if math.isnan(readings["position"]):
            return False
        n, count = self.settings.members, len(self.names)
        drawn = Draws(self.seed, count + len(freedoms()), n).at(self._corrections)
        entry(exact, drawn[:0].copy(), drawn)(drawn[:0].copy(), drawn)
        self.z[:] = (drawn[:count] * np.array([[p.deviation] for p in self.priors.values()])).T
        self._corrections += 1
        known = {name: math.nan if name in self.settings.without else readings[name] for name in CHANNELS}
        states = begin(self.circuit, known, self.sensors.deviations(), spool, tick, drawn[count:])
        if self.members is None:
            self.members = Members(self.circuit, self.unknowns, states)
            self._compile()
        else:
            self.members.states[:] = states
        self.unknowns.write(self.z)
        self._admit(*self._admitted)
        self.members.run(0.0, 0)
        self.forget()
        self.standing = Standing.SETTLING
        return True

    def advance(self, reference: float, steps: int) -> None:
        """Move on under a spool reference."""
        if self.members is not None and steps:
            self.members.run(reference, steps)
            self._since += steps * self.circuit.parts.step

    def look(self, readings: Mapping[str, float]) -> None:
        """Take a scan at the instant reached; it counts at the next correction."""
        assert self.members is not None
        predicted = self.sensors.predicted(self.members.taps, self.unknowns.offsets)
        found, variance = [readings[name] for name in CHANNELS], self.sensors.variance.tolist()
        mean = predicted.mean(axis=0)
        spread = ((predicted - mean) ** 2).sum(axis=0) / (len(predicted) - 1)
        deviation = np.sqrt(spread + self.sensors.variance).tolist()
        away = [x - m for x, m in zip(found, mean.tolist(), strict=True)]
        far = [watched and abs(e) > GATE * s for e, s, watched in zip(away, deviation, self._watched, strict=True)]
        alone = self.standing == Standing.FOLLOWING and sum(far) < 2  # else the model may be wrong
        for j, (name, watch) in enumerate(self.watches.items()):
            more = watch.look(found[j], away[j] / deviation[j], alone) if self._watched[j] else math.nan
            self._last[name] = away[j], deviation[j]
            variance[j] += more * deviation[j] ** 2
            if math.isnan(more):
                found[j] = variance[j] = math.nan
        self._scans.append((predicted.T.copy(), np.array(found), np.array(variance)))

    def correct(self) -> None:
        """Use the scans since the last correction."""
        assert self.members is not None
        self._age += self._since
        if self._age < self.settings.settling:
            self._scans, self._since = [], 0.0
            return
        if not self._settled and self._scans:
            self._recentre()
        self._blind += self._since
        if self._scans:
            self._transform()
        self._wander()
        self.unknowns.write(self.z)
        self._admit(*self._admitted)
        self.members.run(0.0, 0)
        self._judge()
        self._scans, self._since = [], 0.0

    def estimate(self, stamp: float) -> Estimate:
        """What is known now."""
        assert self.members is not None
        self._loads(*self._loaded)
        found = np.column_stack([self.members.seen, self._load])
        values, unknowns = found.mean(axis=0), self.unknowns.values(self.z)
        names = [*ESTIMATED]
        return Estimate(
            stamp,
            self.standing,
            dict(zip(names, values.tolist(), strict=True)),
            dict(zip(names, self._stated(found.std(axis=0, ddof=1)).tolist(), strict=True)),
            dict(zip(self.names, unknowns.mean(axis=0).tolist(), strict=True)),
            dict(zip(self.names, unknowns.std(axis=0, ddof=1).tolist(), strict=True)),
            {name: Innovation(*self._last[name], watch.use, watch.verdict()) for name, watch in self.watches.items()},
        )

    def begin_futures(self) -> Array:
        """Give the members deviations as they are stated, not as corrections need them; the states as they were."""
        assert self.members is not None
        kept, square = self.members.states.copy(), self._independent_square()
        unread = np.full(kept.shape[1], np.inf)
        self.unknowns.write(_spread(self.z, self._beforehand, square))
        self.members.states[:] = _spread(kept, unread, square)
        self._admit(*self._admitted)
        self.members.run(0.0, 0)
        return kept

    def end_futures(self, kept: Array) -> None:
        """Go on from the states that `begin_futures` found."""
        assert self.members is not None
        self.unknowns.write(self.z)
        self.members.states[:] = kept
        self.members.run(0.0, 0)

    def _stated(self, spread: Array) -> Array:
        """Deviations by the spread of the members, and by how large the innovations are beside theirs."""
        if self._prior is None:
            self._prior = spread
        return stated(spread, self._prior, self._independent_square())

    def _independent_square(self) -> float:
        """Mean square of the independent innovations of the channels that are used; 1 where it is not known."""
        squares = [watch.verdict().square for watch in self.watches.values() if watch.use is Use.USED]
        known = [square for square in squares if not math.isnan(square)]
        return sum(known) / len(known) if known else 1.0

    def forget(self) -> None:
        """Wait for a scan to begin with."""
        ends = zip(self._card.low.tolist(), self.sensors.top.tolist(), strict=True)
        self.watches = {name: Watch(self._card.noise, end) for name, end in zip(CHANNELS, ends, strict=True)}
        self._last = dict.fromkeys(CHANNELS, (math.nan, math.nan))
        self._scans: list[tuple[Array, Array, Array]] = []
        self._age, self._since, self._square, self._calm, self._blind = 0.0, 0.0, 1.0, 0.0, 0.0
        self._settled = False
        self._prior: Array | None = None  # spread of what is estimated before any reading counts
        self.standing = Standing.WAITING

    def _compile(self) -> None:
        """The kernels for arrays of this size, before anybody waits for them."""
        members = self.members
        assert members is not None
        self._load = np.zeros(len(members.states))
        self._admitted: Any = self.unknowns.records, self._lines.whole, self._lines.numbers, members.states
        self._loaded: Any = self.unknowns.records, members.states, self._load
        self._admit, self._loads = entry(admit, *self._admitted), entry(load_forces, *self._loaded)
        room, weight, turn, change = self._room
        y, d = np.zeros((1, len(weight))), np.zeros(1)
        self._combine = entry(combine, y, d, d, weight, turn, change, d, self.z)
        self._apply, self._exact = entry(apply, members.states, change, 1.0, room), entry(exact, change, change)
        self._fade = entry(fade, self.z, self._beforehand, 1.0)

    def _transform(self) -> None:
        stretch = math.exp(self.settings.inflation * self._since)
        members, (room, weight, turn, change) = self.members, self._room
        assert members is not None
        y = np.vstack([scan[0] for scan in self._scans])
        d, r = (np.concatenate([scan[i] for scan in self._scans]) for i in (1, 2))
        mean = y.mean(axis=1, keepdims=True)
        y = np.ascontiguousarray(mean + stretch * (y - mean))
        missed = np.zeros(len(d))
        self._fade(self.z, self._beforehand, stretch**-2)
        self._combine(y, d, r, weight, turn, change, missed, self.z)
        self._apply(members.states, change, stretch, room)
        by_channel = missed.reshape(len(self._scans), -1)
        for j, watch in enumerate(self.watches.values()):
            watch.note(by_channel[:, j])
        used = missed[~np.isnan(missed)]
        if len(used):
            self._blind = 0.0
            kept = math.exp(-self._since / FORGETTING)
            self._square = kept * self._square + (1.0 - kept) * float((used * used).mean())

    def _recentre(self) -> None:
        """Put the members' mean where the newest scan says, once what it did not say at the beginning has died."""
        assert self.members is not None
        predicted, found, _ = self._scans[-1]
        for j, channel in enumerate(CHANNELS.values()):
            away = found[j] - predicted[j].mean()
            if channel.reads in CENTRED and not math.isnan(away):
                self.members.states[:, CENTRED[channel.reads]] += away
                for scan in self._scans:
                    scan[0][j] += away
        self._settled = True

    def _wander(self) -> None:
        """Let the unknowns drift: what they may have done since grows their deviations, and nothing else."""
        assert self.members is not None
        count, states = len(self.names), self.members.states
        drawn = self._draws.at(self._corrections)
        self._exact(np.ascontiguousarray(self.z.T), drawn)
        root = math.sqrt(self._since)
        self.z += (drawn[:count] * (self._drift * root)[:, None]).T
        more = min(max(1.0, self._square), self.settings.activity)
        states[:, self._noisy] += (drawn[count:] * (self._noise * (root * more))[:, None]).T
        self._corrections += 1

    def _judge(self) -> None:
        """Is it lost, or found again?"""
        left_out = sum(
            here and watch.left_out for here, watch in zip(self._watched, self.watches.values(), strict=True)
        )
        wrong = self._square > RESTLESS or self._blind > BLIND or 2 * left_out > len(CHANNELS)
        self._calm = min(0.0, self._calm) - self._since if wrong else max(0.0, self._calm) + self._since
        if self._calm < -LOST_AFTER or self._blind > BLIND:
            self.standing = Standing.LOST
        elif self._calm > FOUND_AFTER:
            self.standing = Standing.FOLLOWING


class Sensors:
    """The card as a model of measurement."""

    def __init__(self, card: Card, settings: Settings, step: float) -> None:
        lsb = (card.high - card.low) / 2.0**card.bits
        self.low, self.top = card.low, card.high - lsb if card.quantise else card.high
        own = card.noise**2 + (1.0 / 12.0 if card.quantise else 0.0)
        error = np.array([*settings.model_errors().values()])
        self.variance = own * lsb**2 + error**2
        waiting = np.cumsum(card.fitted[::-1])[::-1] - 1
        self._earlier = waiting * card.skew / step
        self._card, self._lsb = card, lsb

    def deviations(self) -> dict[str, float]:
        """Of a reading, by channel."""
        return dict(zip(CHANNELS, np.sqrt(self.variance).tolist(), strict=True))

    def predicted(self, taps: Array, offsets: Array) -> Array:
        """What the card would read of each member, without noise: members x channels."""
        values = taps[:, 1] + self._earlier * (taps[:, 0] - taps[:, 1]) + offsets
        return self._clipped(values)

    def read(self, taps: Array, offsets: Array, noise: Array) -> Array:
        """What the card reads of each member, with unit noise of each: members x channels."""
        values = taps[:, 1] + self._earlier * (taps[:, 0] - taps[:, 1]) + offsets
        values = values + noise * self._card.noise * self._lsb
        if self._card.quantise:
            values = self.low + self._lsb * np.floor((values - self.low) / self._lsb + 0.5)
        return np.where(self._card.fitted, self._clipped(values), math.nan)

    def _clipped(self, values: Array) -> Array:
        return np.minimum(np.maximum(values, self.low), self.top) if self._card.clip else values


@kernel
def load_forces(parts, states, out) -> None:
    """Force of the load on the piston [N], its weight included, of each member."""
    for m in range(len(states)):
        s, slots = load(states[m]), slots_of(states[m])
        out[m] = push_of(parts[m].load, 0.0, s.piston.position, s.piston.velocity, s.weight, slots.load, 0.0).force


def _spread(rows: Array, prior: Array, square: float) -> Array:
    """A row for each member, with the stated deviation of each number."""
    mean, spread = rows.mean(axis=0), rows.std(axis=0, ddof=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = np.where(spread > 0.0, stated(spread, prior, square) / spread, 1.0)
    return rows + (factor - 1.0) * (rows - mean)  # what all have in common stays to the bit


def fewest(settings: Settings, unknowns: int) -> int:
    """Members, so that unknowns, their drifts and the noises of the state are independent of one another."""
    return 2 * unknowns + sum(noise > 0.0 for noise in settings.noises().values()) + 1


def _refuse_few(settings: Settings, unknowns: int) -> None:
    if settings.members < (least := fewest(settings, unknowns)):
        raise ValueError(f"{settings.members} members for {unknowns} unknowns: at least {least}, or fewer unknowns")
