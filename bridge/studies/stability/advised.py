"""What an advice holds, as values that travel: gains in two units, edges, points and suggestions."""

from enum import StrEnum
from typing import Any, NamedTuple

from bridge.studies.stability.rig_loop import RigTiming


class Stability(StrEnum):
    """A loop after all motions that were tried."""

    STABLE = "stable"
    UNSTABLE = "unstable"
    BETWEEN = "between"

    @property
    def words(self) -> str:
        """For people."""
        return WORDS[self]


WORDS = {
    Stability.STABLE: "settles after every motion",
    Stability.UNSTABLE: "swings after every motion",
    Stability.BETWEEN: "settles or swings, depending on the motion",
}


class GainInUnits(NamedTuple):
    """A gain in two units, of a derivative also times seconds; None where there is none."""

    si: float | None  # [1/m], of a derivative [s/m]
    volts: float | None  # [V/%] of the stroke, of a derivative [V s/%]


class Oscillation(NamedTuple):
    """How a loop swings at its own gains."""

    kind: str  # "none" | "fold" | "flip" | "Neimark-Sacker"
    frequency: float  # [Hz]


class PointAdvice(NamedTuple):
    """The loop about one point of rest or slow motion; None stands for no limit, of derivative gains for no gain."""

    opening: float  # of the valve, -1 .. 1
    critical_gain: GainInUnits
    kind: str  # of the oscillation that starts at the critical gain
    frequency: float  # its own [Hz]
    critical_derivative: GainInUnits  # stable below
    least_derivative: GainInUnits  # stable above
    gain_margin: float | None
    delay_margin: float | None  # [s]
    stable: bool
    swing: Oscillation
    held_below: float | None  # [m], amplitude up to which friction holds that swing; None: nothing to hold

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        gains = ("critical_gain", "critical_derivative", "least_derivative")
        inner = {name: getattr(self, name)._asdict() for name in (*gains, "swing")}
        return self._asdict() | inner


class StepAdvice(NamedTuple):
    """Where the edge of one step lies."""

    size: float  # [m], upwards positive
    swings_below: GainInUnits  # 0.0: small gains do not swing
    settles_above: GainInUnits  # from here up to the next; 0.0: from any gain on
    settles_below: GainInUnits
    swings_above: GainInUnits
    frequency: float  # [Hz], of the swing at the edge; 0.0: irregular
    frequencies: tuple[float, float]  # [Hz], least and greatest
    peak_to_peak: tuple[float, float]  # [m]
    swings_from_to: tuple[tuple[float, float], ...]  # in the unit: gains that were seen to swing, from first to last
    tried_from: float  # in the unit
    tried_up_to: float

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        names = ("swings_below", "settles_above", "settles_below", "swings_above")
        pairs = {name: getattr(self, name)._asdict() for name in names}
        return self._asdict() | pairs


class RowAdvice(NamedTuple):
    """What the loop does at one gain, after the steps asked for."""

    gain: GainInUnits
    swings_after: tuple[float, ...]  # steps [m]
    peak_to_peak: float  # [m], the largest
    frequency: float  # [Hz]; 0.0 for an irregular one

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return self._asdict() | {"gain": self.gain._asdict()}


class Suggestion(NamedTuple):
    """Gains to take."""

    gain: GainInUnits
    patient: GainInUnits  # tolerates one more sampling period of delay
    hunts_by: float | None  # [m], peak to peak at the suggested gain, at most LARGEST where it settles
    rule: str

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return self._asdict() | {"gain": self.gain._asdict(), "patient": self.patient._asdict()}


class Advice(NamedTuple):
    """What the theory says of a scenario's loop."""

    scenario: str
    held_at: float  # [m], where the reference ends: the place of the linear points
    starts_at: float  # [m], where the steps start
    timing: RigTiming
    unit: str  # of the free gain: "V/%", or "x" for a factor on the law's answer
    gain: GainInUnits  # the scenario's own
    derivative_gain: GainInUnits
    verdict: Stability
    settles_above: GainInUnits  # 0.0: from any gain on
    settles_below: GainInUnits
    swings_above: GainInUnits
    wide_above: GainInUnits  # below: no motion swings by more than WIDE
    steps: tuple[StepAdvice, ...]
    rows: tuple[RowAdvice, ...]
    points: dict[str, PointAdvice]  # linear, by the name of the point: rest, up, down; none for laws other than PD
    suggested: Suggestion
    notes: tuple[str, ...]

    @property
    def has_band(self) -> bool:
        """Does any gain settle after every step?"""
        most, least = self.settles_below.volts, self.settles_above.volts
        return most is None or (least is not None and most > least)

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        pairs = ("gain", "derivative_gain", "settles_above", "settles_below", "swings_above", "wide_above")
        return {
            "scenario": self.scenario,
            "held_at": self.held_at,
            "starts_at": self.starts_at,
            **self.timing._asdict(),
            "unit": self.unit,
            **{name: getattr(self, name)._asdict() for name in pairs},
            "verdict": self.verdict,
            "steps": [step.plain() for step in self.steps],
            "rows": [row.plain() for row in self.rows],
            "points": {name: point.plain() for name, point in self.points.items()},
            "suggested": self.suggested.plain(),
            "notes": list(self.notes),
        }


class CycleAdvice(NamedTuple):
    """How a relay's loop swings, which has no gain."""

    scenario: str
    timing: RigTiming
    verdict: Stability
    cycles: tuple[tuple[float, float, float], ...]  # step [m], peak to peak [m], frequency [Hz]
    derivative_time: float  # T_d [s], the scenario's
    critical_lead: float  # T_d [s] of (5.22), below which it swings without sampling, too
    needed_lead: float  # the same with hold and delay
    notes: tuple[str, ...]

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        keys = ("step", "peak_to_peak", "frequency")
        found = [dict(zip(keys, cycle, strict=True)) for cycle in self.cycles]
        leads = {name: getattr(self, name) for name in ("derivative_time", "critical_lead", "needed_lead")}
        whole = {"scenario": self.scenario, **self.timing._asdict(), "verdict": self.verdict, "cycles": found}
        return whole | leads | {"notes": list(self.notes)}
