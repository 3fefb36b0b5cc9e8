"""Why the twin and its linear theory disagree: each cause can be taken away, or be the only one that is left.

With all of them away the twin is a spool without overlap between a constant supply and a frictionless cylinder of
equal areas on lumped lines, read by a card that rounds nothing: what the theory describes, but for the square root in
the valve's flow and the limits of the spool.
"""

import math
from collections.abc import Collection, Mapping
from typing import Any

from bridge.errors import nearest
from bridge.scenario import Scenario, changed
from bridge.studies.stability.rig_plant import at_rest
from twin.rig import rig_number

AMPLE = 40.0  # times the pump's flow: a supply that gives way by 1 bar at 16 l/min
BORE, ROD = (rig_number("cylinder", name) for name in ("bore", "rod"))
PRESSURE = rig_number("relief", "setting")
SPEED = rig_number("pump", "speed")
PIPES = [f"pipe_{number}" for number in range(1, 7)]

# cause -> what takes it away
AWAY: dict[str, Mapping[str, Any]] = {
    "overlap": {"rig.valve.overlap": 0.0},
    "friction": {"rig.seal.limit": 0.0},
    "areas": {  # both as large as the mean of the true ones
        "rig.cylinder.rod": 1e-6,
        "rig.cylinder.bore": math.sqrt(BORE**2 - 0.5 * ROD**2),
        "rig.cylinder.dead_lower": rig_number("cylinder", "dead_upper"),
    },
    "supply": {  # a pump whose leak alone sets the pressure
        "rig.pump.speed": AMPLE * SPEED,
        "rig.pump.efficiency": 0.0,
        "rig.pump.efficiency_speed": AMPLE * SPEED,
        "rig.pump.efficiency_pressure": PRESSURE,
        "rig.pump.ripple": "none",
    },
    "relief": {"rig.relief.kind": "none"},
    "leak": {"rig.cylinder.leakage_resistance": math.inf},
    "waves": {f"rig.{pipe}.model": "lumped" for pipe in PIPES},
    "card": {"daq.noise": 0.0, "daq.quantise": False, "daq.skew": 0.0, "daq.quantise_output": False},
}
CAUSES = tuple(AWAY)
DEAD_BAND = "dead band"  # the overlap, and nobody jumps it
# with the ample supply away, but no relief valve: its flow is limited, its pressure at rest is the same
LIMITED = {"rig.pump.efficiency": 0.0, "rig.pump.efficiency_pressure": PRESSURE}
# with an ample supply a relief valve needs a surplus to pass, and a source that would go higher
RELIEVED = {
    "rig.pump.speed": 4.0 * SPEED,
    "rig.pump.efficiency": 0.5,
    "rig.pump.efficiency_speed": 4.0 * SPEED,
    "rig.pump.efficiency_pressure": 2.0 * PRESSURE,
    "rig.pump.ripple": "none",
}


def with_causes(scenario: Scenario, present: Collection[str]) -> Scenario:
    """The scenario with these causes and no others; started at the pressures it holds its load with.

    Raises ValueError for a cause that is none of CAUSES.
    """
    for cause in present:
        if cause not in (*AWAY, DEAD_BAND):
            raise ValueError(f"cause {cause!r} is unknown{nearest(cause, (*CAUSES, DEAD_BAND))}")
    taken: dict[str, Any] = {"controller.compensate_overlap": DEAD_BAND not in present}
    for cause in CAUSES:
        taken |= {} if cause in present else AWAY[cause]
    if "relief" not in present and "supply" in present:
        taken |= LIMITED
    if "relief" in present and "supply" not in present:
        taken |= RELIEVED
    found = changed(scenario.model_dump(mode="json"), [f"{k}={_toml(v)}" for k, v in taken.items()], scenario.name)
    return at_rest(found)


def _toml(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else f'"{value}"' if isinstance(value, str) else repr(value)
