"""A load lowered through a counterbalance valve: its small swings by linear theory and in the twin."""

import math
from itertools import pairwise
from typing import Any

import numpy as np

from tests.support.pilot_growth import Swing
from tests.support.plant import FRICTIONLESS, SMOOTH, TIGHT, bench, watched
from twin.circuit.build import build
from twin.circuit.equilibrium import relieved_at, state_at
from twin.circuit.lowering import Lowering, lowering
from twin.circuit.lowering_swing import swings
from twin.circuit.state import Flows, Pressures, State
from twin.circuit.step import Circuit, Piston, Spool
from twin.rig import values

VALVE = {"kind": "counterbalance", "setting": 66e5, "stiffness": 40e3, "damping": 1500.0, "flow": 1e-3}
CUSHION = {"kind": "spear"}  # far away; so the step is that of tests/twin/test_necked_circuit.py
FREE = {"cushion": CUSHION, "seal": FRICTIONLESS, "pump": SMOOTH, "cylinder": TIGHT, "load": {"mass": 600.0}}
PUSH, SETTLE, SECONDS, STEP, EVERY = 1e-4, 0.03, 0.2, 50e-6, 10  # [m/s], [s], [s], [s], [steps]
POSITION, SPOOL = 0.15, -0.3


def drive(ratio: float, line_a: float, line_b: float) -> dict[str, dict[str, Any]]:
    """A rig with a pilot ratio and lengths [m] of the held line and of the pilot's."""
    parts: dict[str, dict[str, Any]] = FREE | {
        "accessory_a": VALVE | {"pilot_ratio": ratio},
        "pipe_3": {"length": line_a},
        "pipe_4": {"length": line_b},
    }
    return values({part: {**bench().get(part, {}), **parts.get(part, {})} for part in {**bench(), **parts}})


def theory(rig: dict[str, dict[str, Any]]) -> Swing:
    """The fastest growing oscillation, where the piston is halfway through what `grown` looks at."""
    circuit = build(rig, STEP)
    half_way = POSITION - lowering(circuit, POSITION, SPOOL).speed * (SETTLE + 0.5 * SECONDS)
    return Swing(*swings(lowering(circuit, half_way, SPOOL), rig, circuit)[0])


def state_of(at: Lowering, circuit: Circuit, push: float) -> State:
    """The twin in a steady lowering of the lower chamber, with a push [m/s]."""
    p = Pressures(at.tee, at.tee, at.p_p, at.p_a, at.p_held, at.p_driven, at.p_b, at.p_t, 0.5 * at.p_t)
    q = Flows(relieved_at(at.tee, circuit)[0] + at.q_driven, at.q_driven, -at.q_held, at.q_driven, at.q_held, at.q_held)
    return state_at(p, q, Piston(at.position, push - at.speed), Spool(at.spool, 0.0), circuit)


def grown(rig: dict[str, dict[str, Any]]) -> Swing:
    """The oscillation of the held chamber's pressure in the twin: what a push changes, from one end to the other."""
    circuit = build(rig, STEP)
    at = lowering(circuit, POSITION, SPOOL)
    runs = [
        watched(state_of(at, circuit, push), SPOOL, circuit, SETTLE + SECONDS, EVERY)[0]["p_lower"]
        for push in (0.0, PUSH)
    ]
    changed = (runs[1] - runs[0])[round(SETTLE / STEP / EVERY) :]
    turns = np.flatnonzero(np.diff(np.sign(changed)))
    tops = [np.abs(changed[begin:end]).max() for begin, end in pairwise(turns)]
    half = float(turns[-1] - turns[0]) * STEP * EVERY / (len(turns) - 1)
    return Swing(math.log(tops[-1] / tops[0]) / (half * (len(tops) - 1)), 0.5 / half)
