"""The controller's gains in SI, from a scenario."""

from bridge.scenario.model import Scenario
from bridge.scenario.units import split
from controller.law import Gains, per_metre


def gains(scenario: Scenario) -> Gains:
    """The gains in SI: V per % of stroke are turned into spool per metre."""
    settings, rig = scenario.controller, scenario.rig
    stroke, full_scale = rig.cylinder.stroke, rig.valve.full_scale
    return Gains(
        proportional=_per_metre(settings.gain, "V/%", stroke, full_scale),
        derivative=_per_metre(settings.derivative, "V s/%", stroke, full_scale),
        source=settings.velocity,
        filter_time=settings.filter_time,
        sample_period=scenario.loop.sample_period,
        limit=settings.limit,
        overlap=rig.valve.overlap if settings.compensate_overlap else 0.0,
    )


def _per_metre(text: str, volt_unit: str, stroke: float, full_scale: float) -> float:
    number, unit = split(text)
    return per_metre(number, stroke, full_scale) if unit == volt_unit else number
