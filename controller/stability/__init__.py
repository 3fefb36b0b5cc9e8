"""When a loop oscillates, and how: theory of the analogue, the relay and the sampled loop. Source: chapter 5.

`Timing`: when a controller samples and acts. `monodromy`, `critical_gain`: the sampled dimensionless actuator with any
delay and the derivatives of `controller.law`. `plant_of` (a control.StateSpace, as of
`twin.circuit.linear.linearise`), `sampled_loop`, `closed`: the same for any linear plant; the actuator is
`linear_actuator`; `movable` takes out rests that no loop can move. `multipliers`, `stable_count`, `is_stable`,
`dominant`, `loop_onset` (gain, kind and frequency), `gain_margin`, `derivative_range`, `delay_margin` judge a loop,
`margins` in all of these ways; `suggested_gain` keeps a distance at several points. `curves`: closed forms. `chart`:
counts of stable multipliers on grids, compiled. `relay_cycle`: the swing of a sampled relay. `analogue`, `relay`,
`slow_fast`: the loop without sampling. `birth`, `limit_cycle`, `continuation`, `floquet`: its periodic orbits, from
their birth through folds, and what they do to their neighbours; their arcs are compiled in `arc`.
"""

from controller.stability.crossing import Onset, is_stable, multipliers, stable_count
from controller.stability.margins import (
    Margins,
    delay_margin,
    derivative_range,
    dominant,
    gain_margin,
    loop_onset,
    margins,
    suggested_gain,
)
from controller.stability.movable import movable
from controller.stability.plant import Plant, linear_actuator, plant_of
from controller.stability.sampled import SampledLoop, closed, critical_gain, monodromy, sampled_loop
from controller.stability.timing import Timing

__all__ = [
    "Margins",
    "Onset",
    "Plant",
    "SampledLoop",
    "Timing",
    "closed",
    "critical_gain",
    "delay_margin",
    "derivative_range",
    "dominant",
    "gain_margin",
    "is_stable",
    "linear_actuator",
    "loop_onset",
    "margins",
    "monodromy",
    "movable",
    "multipliers",
    "plant_of",
    "sampled_loop",
    "stable_count",
    "suggested_gain",
]
