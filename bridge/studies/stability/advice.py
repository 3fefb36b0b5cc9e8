"""What the theory says of a scenario's loop: which gains settle after which steps, how it swings, and gains to take.

The answer depends on the size of the motion (`amplitude`). The linear theory about the points of `rig_plant`, without
friction and card, is given beside it: it is that of the smallest motions, with margins. Gains are also given in V per %
of the stroke, as a scenario writes them.
"""

import math
from collections.abc import Sequence

from bridge.errors import ScenarioError
from bridge.scenario import Scenario
from bridge.scenario.controllers import Pd
from bridge.scenario.gains import gains
from bridge.studies.stability.advised import (
    Advice,
    CycleAdvice,
    GainInUnits,
    Oscillation,
    PointAdvice,
    RowAdvice,
    Stability,
    StepAdvice,
    Suggestion,
)
from bridge.studies.stability.amplitude import (
    ASKED,
    SwingRange,
    both_ways,
    cycles,
    is_one_sided,
    room_for,
    swing_range,
    wide_gain_later,
)
from bridge.studies.stability.notes import notes_on, timing_notes
from bridge.studies.stability.relay_lead import critical_lead, needed_lead, relay_of
from bridge.studies.stability.rig_loop import RigTiming, held_amplitude, margins_of, named, timing_of
from bridge.studies.stability.rig_plant import RigPlant, plants
from bridge.studies.stability.sampled_law import FreeGain, free_gain
from bridge.studies.stability.search import OUT_OF_TIME, Search
from bridge.studies.stability.twin_loop import runs_alone, uncovered
from bridge.studies.stability.twin_range import search_of, twin_range, twin_wide_later
from controller.law import volts_per_percent
from controller.reference import evaluate
from controller.stability import Margins
from controller.stability.amplitude.band import LEAST
from controller.stability.amplitude.gain_scan import Scanned
from controller.stability.amplitude.swing import WIDE
from controller.stability.margins import GAIN_MARGIN

RULE = (
    f"1/{GAIN_MARGIN:g} of the gain below which none swings by more than {WIDE * 1e3:g} mm; the patient one also with "
    "one more period of delay"
)
LONGEST = 40  # sampling periods of delay that the linear theory takes: the work grows with the cube


def refuse_linear(scenario: Scenario) -> None:
    """Raises ScenarioError for a law that the linear theory does not know."""
    if not isinstance(scenario.controller, Pd):
        kind = scenario.controller.kind
        raise ScenarioError(f"controller.kind {kind!r}: the linear theory is that of 'pd'; set controller.kind = 'pd'")
    _refuse_switching(scenario)


def _refuse_switching(scenario: Scenario) -> None:
    kind = scenario.rig.valve.kind
    if kind == "switching":
        raise ScenarioError("rig.valve.kind 'switching' has no gain; set rig.valve.kind = 'proportional'")


def at_reference_end(scenario: Scenario) -> Scenario:
    """The scenario with its start moved to where its reference ends."""
    end = evaluate(scenario.reference.reference(), scenario.duration).position
    place = min(max(end, 0.0), scenario.rig.cylinder.stroke)
    return scenario.model_copy(update={"start": scenario.start.model_copy(update={"position": place})})


def plants_of(scenario: Scenario) -> dict[str, RigPlant]:
    """The plants about where the reference ends. Raises ScenarioError where the linear theory has no answer."""
    _refuse_switching(scenario)
    try:
        return plants(at_reference_end(scenario))
    except ValueError as error:
        raise ScenarioError(f"{scenario.name}: no linear model: {error}") from None


def advise(scenario: Scenario, sizes: Sequence[float] = ASKED) -> Advice | CycleAdvice:
    """What the theory says after steps of these sizes [m]. Raises ScenarioError where it has no answer."""
    if scenario.controller.kind == "relay":
        return _advise_relay(scenario, sizes)
    free = free_gain(scenario)
    search = search_of(scenario, room_for(scenario, sizes))
    alone = runs_alone(scenario)
    found = twin_range(search, free.own, is_one_sided(scenario)) if alone else swing_range(scenario, search)
    own, suggested = gains_of(scenario), _suggestion(scenario, sizes, found, free, search)
    points, left_out = _linear(scenario)
    return Advice(
        scenario=scenario.name,
        held_at=at_reference_end(scenario).start.position,
        starts_at=scenario.start.position,
        timing=timing_of(scenario),
        unit=free.unit,
        gain=_free(free.own, free),
        derivative_gain=_gain(own, scenario),
        verdict=verdict(free.own, found),
        settles_above=_free(found.least, free),
        settles_below=_free(found.low, free),
        swings_above=_free(found.high, free),
        wide_above=_free(found.wide, free),
        steps=tuple(_step(step, free) for step in found.steps),
        rows=tuple(RowAdvice(_free(r.gain, free), r.swinging, r.peak_to_peak, r.frequency) for r in found.rows),
        points=points,
        suggested=suggested,
        notes=(*notes_on(scenario, free), *_runs_of_the_twin(scenario, search), *left_out),
    )


def _runs_of_the_twin(scenario: Scenario, search: Search) -> list[str]:
    ended = [OUT_OF_TIME] if search.cut_short else []
    if not runs_alone(scenario):
        return ended
    beyond = ", ".join(uncovered(scenario))
    why = f"leaves out {beyond}" if beyond else "takes as long where the law is asked so often"
    return [f"by runs of the twin alone, one noise each: the reduced drive {why}", *ended]


def _suggestion(
    scenario: Scenario, sizes: Sequence[float], found: SwingRange, free: FreeGain, search: Search
) -> Suggestion:
    """Half of the gain from which a motion swings widely; none where none does or all do."""
    gain = above_lower_edge(found.wide / GAIN_MARGIN, found)
    if runs_alone(scenario):
        later = twin_wide_later(scenario, search, gain)
    else:
        firsts = dict.fromkeys(both_ways(scenario, sizes), max(found.least, found.low) or LEAST * free.own)
        later = min(gain, above_lower_edge(wide_gain_later(scenario, firsts), found))
    unknown = not math.isfinite(gain) or search.late()
    hunts = None if unknown else max(swing.peak_to_peak for swing in search.at(gain))
    return Suggestion(_free(gain, free), _free(later, free), hunts, RULE)


def above_lower_edge(gain: float, found: SwingRange) -> float:
    """A gain, or the middle of what leads to no wide swing if that gain is too small."""
    return gain if gain >= found.least or math.isinf(found.wide) else math.sqrt(found.least * found.wide)


def gains_of(scenario: Scenario) -> float:
    """The derivative gain [s/m] of a controller that has one."""
    return gains(scenario).derivative if isinstance(scenario.controller, Pd) else 0.0


def verdict(own: float, found: SwingRange) -> Stability:
    """Of a gain among those that settle."""
    if found.least <= own <= found.low:
        return Stability.STABLE
    below = min(step.beneath[0] for step in found.steps)
    return Stability.UNSTABLE if own >= found.high or own < below else Stability.BETWEEN


def _advise_relay(scenario: Scenario, sizes: Sequence[float]) -> CycleAdvice:
    found = cycles(scenario, sizes)
    swinging = [swing.counts for _, swing in found]
    stability = Stability.UNSTABLE if all(swinging) else Stability.BETWEEN if any(swinging) else Stability.STABLE
    rows = tuple((size, swing.peak_to_peak, swing.frequency) for size, swing in found)
    timing, own = timing_of(scenario), relay_of(scenario).derivative_time
    leads = own, critical_lead(scenario), needed_lead(scenario, timing.period, timing.delay)
    return CycleAdvice(scenario.name, timing, stability, rows, *leads, tuple(timing_notes(scenario)))


def _linear(scenario: Scenario) -> tuple[dict[str, PointAdvice], list[str]]:
    """The linear theory, or why there is none."""
    timing = timing_of(scenario)
    if timing.delay > LONGEST * timing.period:
        return {}, [f"no linear theory: loop.delay {timing.delay:g} s is more than {LONGEST} sampling periods"]
    try:
        refuse_linear(scenario)
        found, own = plants_of(scenario), gains(scenario)
        of = {name: margins_of(p.plant(), timing, own.proportional, own.derivative) for name, p in found.items()}
    except (ValueError, ScenarioError) as error:
        return {}, [f"no linear theory: {error}"]
    held = {n: held_amplitude(p, timing, own.proportional, own.derivative) for n, p in found.items()}
    return {n: _point(p.opening, timing, of[n], scenario, held[n]) for n, p in found.items()}, []


def _step(found: Scanned, free: FreeGain) -> StepAdvice:
    least, low = tuple(_free(gain, free) for gain in found.beneath), (_free(found.low, free), _free(found.high, free))
    seen = found.frequency, found.frequencies, found.peaks
    islands = tuple((first / free.per_unit, last / free.per_unit) for first, last in found.islands)
    tried = found.tried[0] / free.per_unit, found.tried[1] / free.per_unit
    return StepAdvice(found.size, least[0], least[1], *low, *seen, islands, *tried)


def _free(gain: float, free: FreeGain) -> GainInUnits:
    """A free gain; of a factor there is no other unit."""
    return GainInUnits(None if free.is_factor else _finite(gain), _finite(gain / free.per_unit))


def _point(opening: float, timing: RigTiming, found: Margins, scenario: Scenario, held: float | None) -> PointAdvice:
    critical, swing = named(found.critical, timing), named(found.dominant, timing)
    return PointAdvice(
        opening=opening,
        critical_gain=_gain(critical.gain, scenario),
        kind=critical.kind,
        frequency=critical.frequency,
        critical_derivative=_gain(found.derivative[1], scenario),
        least_derivative=_gain(found.derivative[0], scenario),
        gain_margin=_finite(found.gain_margin),
        delay_margin=_finite(found.delay_margin * timing.period),
        stable=found.stable,
        swing=Oscillation(swing.kind, swing.frequency),
        held_below=held,
    )


def _gain(si: float, scenario: Scenario) -> GainInUnits:
    rig = scenario.rig
    return GainInUnits(_finite(si), _finite(volts_per_percent(si, rig.cylinder.stroke, rig.valve.full_scale)))


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
