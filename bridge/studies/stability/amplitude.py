"""A scenario's loop as the theory that depends on amplitude takes it, and what that says: which gains settle.

Every run starts where the scenario starts and follows one step of the reference, whatever the scenario's own reference
is. The reduced drive says where to look; whether a gain near the edge swings, the twin itself says (`search`). The work
is bounded: so many motions and gains, each run of at most some hundred thousand steps, and the search has a time. Runs
go to two threads, and an interruption is answered between two of them.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from bridge.errors import ScenarioError
from bridge.scenario import Scenario
from bridge.scenario.circuit import circuit_of
from bridge.scenario.controllers import Pd
from bridge.studies.stability.sampled_law import free_gain, is_asked, law_of
from bridge.studies.stability.search import Search, threaded
from bridge.studies.stability.twin_loop import TwinLoop, twin_loop, uncovered
from controller.stability.amplitude.band import LEAST, Band, Outlook, band_about
from controller.stability.amplitude.edges import (
    ROUGH,
    SCAN,
    SEEDS,
    Edge,
    Interval,
    Loop,
    Scan,
    lasting,
    nearer,
    smallest_swinging,
    spanned,
)
from controller.stability.amplitude.edges import swing as reduced_swing
from controller.stability.amplitude.gain_scan import Scanned
from controller.stability.amplitude.reduce import at_rest, reduced
from controller.stability.amplitude.run import MOST_PERIODS, Card, Course
from controller.stability.amplitude.swing import LARGEST, WIDE, Swing

ASKED = (2e-3, 20e-3, 60e-3)  # [m], steps in both directions, unless others are asked for
FURTHER = (5e-3, 120e-3)  # [m], that also count among all motions
FEW = SEEDS[:2]  # noises with the further ones
ROUGHLY = 1.15  # beyond the edges of a single noise
AT = 1.0  # [s], of the step
ROWS = 9  # of the picture
TWIN_SCAN = ROUGH._replace(ratio=1.6, tolerance=1.06, back=0.6)  # where each run is one of the twin


class PictureRow(NamedTuple):
    """What a gain does after the steps asked for."""

    gain: float
    swinging: tuple[float, ...]  # the steps [m] after which it swings
    peak_to_peak: float  # [m], the largest
    frequency: float  # [Hz], of the largest


class SwingRange(NamedTuple):
    """Which gains settle, in the unit of the free gain times its factor (1/m for a PD)."""

    least: float  # from here up to `low` no motion that was tried swings; 0.0: there is no lower edge
    low: float
    high: float  # above: every one does; inf: never all
    wide: float  # below: none swings by more than WIDE; inf: none at any gain
    steps: tuple[Scanned, ...]  # asked for, down and up
    rows: tuple[PictureRow, ...]


def any_loop(scenario: Scenario) -> Loop | TwinLoop:
    """The reduced loop, or runs of the twin where the reduced drive leaves something out. Raises ScenarioError."""
    return twin_loop(scenario) if uncovered(scenario) else loop_of(scenario)


def swing(loop: Loop | TwinLoop, gain: float, size: float, seed: int = SEEDS[0]) -> Swing:
    """The last third after a step of a size [m] at a gain, with one noise of the card."""
    return loop.swing(gain, size, seed) if isinstance(loop, TwinLoop) else reduced_swing(loop, gain, size, seed)


def edge(
    loop: Loop | TwinLoop, size: float, seed: int, first: float, scan: Scan = SCAN, largest: float = LARGEST
) -> Edge:
    """The smallest gain that swings with one noise, searched from a gain `first`; largest: as in `swing_range`."""
    scan = TWIN_SCAN if isinstance(loop, TwinLoop) else scan
    return smallest_swinging(lambda gain: swing(loop, gain, size, seed), first, scan, largest)


def loop_of(scenario: Scenario) -> Loop:
    """The reduced loop. Raises ScenarioError where there is none, or where the drive has more than it covers."""
    if left_out := uncovered(scenario):
        raise ScenarioError(f"{left_out[0]}: the reduced drive leaves it out; `hydrotwin advise` runs the twin instead")
    circuit = circuit_of(scenario)
    timing, daq = scenario.loop, scenario.daq
    period, delay = timing.sample_period, timing.delay
    if delay > MOST_PERIODS * period:
        raise ScenarioError(
            f"loop.delay {delay:g} s is more than {MOST_PERIODS} sampling periods of {period:g} s; lower it"
        )
    try:
        drive = reduced(circuit)
    except ValueError as error:
        raise ScenarioError(str(error)) from None
    at = period * math.ceil(round(AT / period, 9))
    steps = 2.0**daq.bits if daq.quantise else math.inf
    card = Card(daq.position_range / steps, 2.0 * daq.velocity_range / steps, daq.noise, _output_step(scenario))
    try:
        when = Course(period, delay, at, lasting(period, delay))
    except ValueError as error:
        raise ScenarioError(f"loop.sample_period {period:g} s: {error}; a unit may be missing, as in '10 ms'") from None
    return Loop(
        drive, at_rest(drive, circuit, scenario.start.position, scenario.start.p_upper), law_of(scenario), when, card
    )


def _output_step(scenario: Scenario) -> float:
    """What the card rounds a command to."""
    daq: Any = scenario.daq
    return 2.0 / 2.0**daq.output_bits if getattr(daq, "quantise_output", False) else 0.0


def both_ways(scenario: Scenario, sizes: Iterable[float]) -> list[float]:
    """Steps up and down of these sizes [m], as far as the stroke has room for them."""
    start, stroke = scenario.start.position, scenario.rig.cylinder.stroke
    signed = [sign * abs(size) for size in sizes for sign in (1.0, -1.0)]
    return [size for size in signed if 0.0 < start + size < stroke]


def room_for(scenario: Scenario, sizes: Sequence[float]) -> list[float]:
    """As `both_ways`. Raises ScenarioError where none fits."""
    if asked := both_ways(scenario, sizes):
        return asked
    raise ScenarioError(
        f"no step of {', '.join(f'{abs(s) * 1e3:g}' for s in sizes)} mm fits into the stroke from "
        f"{scenario.start.position * 1e3:g} mm; ask for smaller ones, or set start.position"
    )


def swing_range(scenario: Scenario, search: Search) -> SwingRange:
    """Which gains settle after the steps of a search. Raises ScenarioError where the reduced loop does not exist."""
    loop, own, asked = loop_of(scenario), free_gain(scenario).own, search.sizes
    steps = scans_of(scenario, loop, search)
    further = [size for size in both_ways(scenario, (*ASKED, *FURTHER)) if size not in asked]
    bands = bands_of(loop, further, own, is_one_sided(scenario))
    jobs = [(size, band.inside, seed) for size, band in bands.items() if band for seed in FEW]
    found = list(zip(jobs, threaded(lambda job: edge(loop, job[0], job[2], job[1], ROUGH), jobs), strict=True))
    others = [spanned(size, [e for job, e in found if job[0] == size]) for size, band in bands.items() if band]
    least = max([step.beneath[1] for step in steps] + [b.bottom for b in bands.values() if b and b.swings_below])
    low = min(i.low for i in (*steps, *others))
    high = max(*(step.swings_from for step in steps), *(i.high for i in others))
    firsts = {step.size: step.low if 0.0 < step.low < math.inf else own for step in steps}
    wide = min(wide_gain(loop, firsts), search.lowest_beyond(WIDE, firsts))
    shown = min(least, low) or low
    rows = picture(loop, search, shown, max((g for g in (high, wide) if math.isfinite(g)), default=math.inf), own)
    quiet = [row.gain * ROUGHLY for row in rows if row.gain > low and len(row.swinging) < len(asked)]
    return SwingRange(least, low, max([high, *quiet]), wide, tuple(steps), tuple(rows))


def is_one_sided(scenario: Scenario) -> bool:
    """Can a gain only be too high? A law with a memory, or of the user's, may swing at small gains, too."""
    return isinstance(scenario.controller, Pd)


def bands_of(loop: Loop | TwinLoop, sizes: Iterable[float], own: float, one_sided: bool) -> dict[float, Band | None]:
    """The band of gains that settles about the own one, or next to it, for each step [m], with one noise."""
    steps = list(sizes)
    found = threaded(lambda size: band_about(lambda g: not swing(loop, g, size).counts, own, one_sided), steps)
    return dict(zip(steps, found, strict=True))


def scans_of(scenario: Scenario, loop: Loop, search: Search) -> list[Scanned]:
    """Runs of the twin about the edges of the reduced loop, and what its edges with some noises say."""
    own, one_sided = free_gain(scenario).own, is_one_sided(scenario)
    bands = bands_of(loop, search.sizes, own, one_sided)
    first = {size: band.inside if band else LEAST * own for size, band in bands.items()}
    rough = threaded(lambda size: edge(loop, size, SEEDS[0], first[size], ROUGH), search.sizes)
    starts = dict(zip(search.sizes, rough, strict=True))
    edged = [(size, nearer(e, first[size])) for size, e in starts.items() if math.isfinite(e.swings)]
    jobs = [(size, begin, seed) for size, begin in edged for seed in _noises(scenario)]
    found = list(zip(jobs, threaded(lambda job: edge(loop, job[0], job[2], job[1]), jobs), strict=True))
    expected = {size: spanned(size, [e for job, e in found if job[0] == size] or [e]) for size, e in starts.items()}
    near = {size: e.swings if math.isfinite(e.swings) else own for size, e in starts.items()}
    return search.scans({size: outlook(near[size], bands[size], one_sided, expected[size]) for size in search.sizes})


def _noises(scenario: Scenario) -> Sequence[int]:
    """With which the reduced loop is searched: fewer where runs of the twin say more in the time that this takes.

    So with a second edge to look for, and under a law that is asked at each sample, where a run takes a third of the
    twin's: there the rough edge alone says where to look.
    """
    if is_one_sided(scenario):
        return SEEDS
    return () if is_asked(scenario) else FEW


def outlook(near: float, band: Band | None, one_sided: bool, expected: Interval | None) -> Outlook:
    """Where the scan begins that has an edge near a gain above a band."""
    if one_sided:
        return Outlook(near, expected=expected)
    if band and band.swings_below:
        return Outlook(near, band.inside, band.swings_below, expected)
    return Outlook(near, below=LEAST * near, expected=expected)


def cycles(scenario: Scenario, sizes: Sequence[float] = ASKED) -> list[tuple[float, Swing]]:
    """What a law without a gain does after steps [m] of these sizes, both ways."""
    loop = any_loop(scenario)
    steps = both_ways(scenario, sizes)
    return list(zip(steps, threaded(lambda size: swing(loop, 1.0, size), steps), strict=True))


def wide_gain(loop: Loop | TwinLoop, firsts: Mapping[float, float]) -> float:
    """Below which gain none of some steps [m] leaves a swing of more than WIDE; each searched from a gain upwards.

    inf where none does, as where a first gain is: no gain swings at all.
    """
    if any(math.isinf(first) for first in firsts.values()):
        return math.inf
    found = threaded(lambda size: edge(loop, size, SEEDS[0], firsts[size], ROUGH, WIDE), firsts)
    return min(e.swings for e in found) / ROUGHLY


def wide_gain_later(scenario: Scenario, firsts: Mapping[float, float]) -> float:
    """The same with one more sampling period of delay."""
    times = {"delay": scenario.loop.delay + scenario.loop.sample_period}
    loop = any_loop(scenario.model_copy(update={"loop": scenario.loop.model_copy(update=times)}))
    return wide_gain(loop, firsts)


def range_over(scenario: Scenario, period: float, own: float, size: float) -> tuple[float, float]:
    """Below which gain a step of a size [m] settles, and swings by at most WIDE, with another sampling period [s]."""
    times = {"sample_period": period, "command_timeout": max(scenario.loop.command_timeout, 2.0 * period)}
    changed = scenario.model_copy(update={"loop": scenario.loop.model_copy(update=times)})
    loop = any_loop(changed)
    bands = bands_of(loop, both_ways(scenario, (size,)), own, is_one_sided(scenario))
    firsts = {size: band.inside if band else LEAST * own for size, band in bands.items()}
    found = threaded(lambda size: edge(loop, size, SEEDS[0], firsts[size], ROUGH), firsts)
    return min(e.swings for e in found) / ROUGHLY, wide_gain(loop, firsts)


def picture(loop: Loop, search: Search, low: float, high: float, own: float) -> list[PictureRow]:
    """Amplitude and frequency over the gain: of the twin at the own gain and where it ran, else of the reduced loop."""
    if not math.isfinite(low):
        return []
    if not search.late():
        search.at(own)
    least, top = low or own * LEAST, high if math.isfinite(high) else 4.0 * low
    gains = sorted({*np.geomspace(0.8 * least, 1.25 * top, ROWS).tolist(), own})
    jobs = [(gain, size) for gain in gains for size in search.sizes]
    swings = threaded(lambda job: search.nearest(*job) or swing(loop, *job), jobs)
    return [
        picture_row(gain, search.sizes, [s for (g, _), s in zip(jobs, swings, strict=True) if g == gain])
        for gain in gains
    ]


def own_row(scenario: Scenario, own: float) -> tuple[PictureRow, int]:
    """What the own gain does after the steps of ASKED that have room, with one noise, and how many these are."""
    loop, sizes = loop_of(scenario), both_ways(scenario, ASKED)
    if not sizes:
        raise ScenarioError(f"no step fits into the stroke from {scenario.start.position * 1e3:g} mm")
    return picture_row(own, sizes, threaded(lambda size: swing(loop, own, size), sizes)), len(sizes)


def picture_row(gain: float, sizes: Sequence[float], swings: Sequence[Swing]) -> PictureRow:
    """What a gain does, of a swing for each step [m]."""
    largest = max(swings, key=lambda s: s.peak_to_peak)
    swinging = tuple(size for size, s in zip(sizes, swings, strict=True) if s.counts)
    return PictureRow(gain, swinging, largest.peak_to_peak, largest.frequency)
