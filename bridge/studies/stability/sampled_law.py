"""A scenario's control law as the theory of the loop takes it, and the one gain of it that is free.

The free gain is `controller.gain`, all else of the controller unchanged. A function of the user's, in Python or C, runs
itself in the reduced loop; where it does not mind `controller.gain`, a factor on its answer is free instead. Of a law
given as matrices that is a factor on C and D. One that reads what the linear form of the loop does not say, such as
pressures, is asked at each sample as a function is.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from bridge.errors import ScenarioError
from bridge.loop.hearing import Hearing
from bridge.loop.law import law_of as law_in_loop
from bridge.scenario import Scenario
from bridge.scenario.controllers import OpenLoop, Pd, Pid, Python, Relay, StateSpace, WithGains
from bridge.scenario.gains import law_gains, scale_of
from controller.law import Law, Sample
from controller.laws import ControlLaw
from controller.reference import Target
from controller.stability.amplitude.linear_law import (
    LinearLaw,
    of_error,
    of_signals,
    pd_law,
    relay_law,
    with_integral,
)
from controller.stability.amplitude.run import Decide

FACTOR = "x"  # the unit of a factor on a law's answer
TRIED = 1e-3  # [m], error at which a user's law is asked whether it minds the gain
SAMPLES = 10  # of it, since a law with a memory may answer late


class FreeGain(NamedTuple):
    """The gain that the theory varies."""

    own: float  # the scenario's, in 1/m or as a factor
    unit: str  # for people: "V/%" | "x"
    per_unit: float  # 1/m per unit

    @property
    def is_factor(self) -> bool:
        """Is it a factor on the law's answer?"""
        return self.unit == FACTOR


def free_gain(scenario: Scenario) -> FreeGain:
    """The scenario's. Raises ScenarioError for a law that has none."""
    settings = scenario.controller
    if isinstance(settings, Relay | OpenLoop):
        raise ScenarioError(f"controller.kind {settings.kind!r} has no gain to advise on; set controller.kind = 'pd'")
    if scenario.rig.valve.kind == "switching":
        raise ScenarioError(
            "rig.valve.kind 'switching' knows three positions and no gain; set rig.valve.kind = 'proportional'"
        )
    if not isinstance(settings, WithGains) or (isinstance(settings, Python) and not _minds_gain(scenario)):
        return FreeGain(1.0, FACTOR, 1.0)
    scale = scale_of(scenario)
    own = scale.per_metre(settings.gain)
    if own <= 0.0:
        raise ScenarioError(f"controller.gain {settings.gain!r} closes no loop; set a gain above 0")
    return FreeGain(own, "V/%", scale.per_metre("1 V/%"))


def at_free(scenario: Scenario, gain: float, free: FreeGain) -> tuple[Scenario, float]:
    """The scenario at its free gain, and the factor on its law's answer that is left to apply."""
    if isinstance(scenario.controller, StateSpace):
        return scaled_matrices(scenario, gain), 1.0
    return (scenario, gain) if free.is_factor else (at_gain(scenario, gain), 1.0)


def at_gain(scenario: Scenario, gain: float) -> Scenario:
    """The scenario at a gain [1/m]."""
    return _with(scenario, gain=f"{gain!r} 1/m")


def scaled_matrices(scenario: Scenario, factor: float) -> Scenario:
    """The scenario with a factor on C and D of its law."""
    own: Any = scenario.controller
    rows = {name: [[factor * number for number in row] for row in getattr(own, name)] for name in ("C", "D")}
    return _with(scenario, **rows)


def _with(scenario: Scenario, **changes: Any) -> Scenario:
    return scenario.model_copy(update={"controller": scenario.controller.model_copy(update=changes)})


def law_of(scenario: Scenario) -> Callable[[float], LinearLaw | Decide]:
    """The law afresh, at a gain [1/m], or a factor where `free_gain` says so."""
    if isinstance(scenario.controller, Relay):
        relay: Any = law_gains(scenario)
        linear = relay_law(relay.derivative_time, relay.source, relay.filter_time, relay.sample_period, relay.limit)
        return lambda _: linear
    if isinstance(scenario.controller, Pd | Pid):
        return lambda gain: _linear(law_gains(at_gain(scenario, gain)))
    found = law_in_loop(scenario.controller)
    system = getattr(found.answer, "system", None)
    if system is not None:
        own: Any = law_gains(scenario)
        a, b, c, d = system
        return lambda gain: of_error(a, b, c, d, gain, own.limit, own.overlap)
    if (fixed := of_matrices(scenario)) is not None:
        return lambda factor: fixed._replace(c=factor * fixed.c, d=factor * fixed.d)
    free = free_gain(scenario)
    return lambda gain: _deciding(found, *at_free(scenario, gain, free))


def of_matrices(scenario: Scenario) -> LinearLaw | None:
    """A law given as matrices in the linear form of the loop; None for other laws, and for one that does not fit it."""
    if not isinstance(scenario.controller, StateSpace):
        return None
    own = scenario.controller.gains(scale_of(scenario))
    return of_signals(own.a, own.b, own.c, own.d, own.inputs, own.limit, own.overlap)


def is_asked(scenario: Scenario) -> bool:
    """Does the law itself run, asked at each sample, which takes longer?"""
    kind = scenario.controller.kind
    return kind in ("python", "c", "fmu") or (kind == "state-space" and of_matrices(scenario) is None)


def is_system(scenario: Scenario) -> bool:
    """Is the user's law a system of the package control, which runs compiled?"""
    return isinstance(scenario.controller, Python) and hasattr(law_in_loop(scenario.controller).answer, "system")


def scaled(law: Law, factor: float) -> Law:
    """A law whose answer is multiplied, and saturated."""

    def answer(sample: Sample, target: Target, memory: Any, gains: Any) -> tuple[float, Any]:
        spool, memory, *_ = law(sample, target, memory, gains)
        return max(-1.0, min(1.0, factor * spool)), memory

    return answer


def _linear(own: Any) -> LinearLaw:
    """A law of ours with gains: PD, or PID by its further numbers."""
    timing = own.source, own.filter_time, own.sample_period
    law = pd_law(own.proportional, own.derivative, *timing, own.limit, own.overlap, own.rest)
    if not hasattr(own, "integral"):
        return law
    back = own.sample_period / own.tracking_time if own.anti_windup == "back-calculation" else 0.0
    return with_integral(law, own.sample_period * own.integral, back, own.anti_windup == "clamping")


def _deciding(found: ControlLaw, scenario: Scenario, factor: float) -> Decide:
    """A law that is asked at each sample, with a memory of its own."""
    law, own = scaled(found.answer, factor), found.prepare(law_gains(scenario))
    memory: Any = None
    hearing = Hearing()  # what it prints here is not of a run

    def decide(sample: Sample, target: float) -> float:
        nonlocal memory
        spool, memory = hearing.call(0, law, sample, Target(target, 0.0), memory, own)
        return spool

    return decide


def _minds_gain(scenario: Scenario) -> bool:
    """Does a user's law answer otherwise with another controller.gain?"""
    settings: Any = scenario.controller
    place, own = scenario.start.position, scale_of(scenario).per_metre(settings.gain)
    period = round(scenario.loop.sample_period * 1e9)
    samples = [Sample(k * period, place, 0.0, 67e5, 25e5, 0.0) for k in range(SAMPLES)]
    found = law_in_loop(settings)
    laws = [_deciding(found, at_gain(scenario, factor * own), 1.0) for factor in (1.0, 0.5)]
    answers = [[law(sample, place + TRIED) for sample in samples] for law in laws]
    return answers[0] != answers[1]
