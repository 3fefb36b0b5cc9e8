"""The plant between its messages: commands act when they should, bad ones leave no trace."""

import math
import struct
from collections.abc import Callable

import numpy as np
import pytest

from bridge.loop.plant import PlantSide
from bridge.scenario import load
from bridge.scenario.circuit import circuit_of
from bridge.wire.codec import ValveCommand, encode
from controller.grid import NS
from twin.circuit.block import block_of, buffers, compiled
from twin.circuit.equilibrium import equilibrium
from twin.circuit.state import flatten, flows, oil_in, pressures, unflatten
from twin.rig import RIG
from twin.topology import OBSERVED

MS, RUN, OWNER = 1_000_000, 5, 21
CAVITIES = {name for name in OBSERVED if name.startswith("cavity_")}
QUIET = ["daq.noise=0", "daq.quantise=false", "daq.quantise_output=false", "daq.skew=0", "loop.delay=0"]


def plant(*changes: str) -> PlantSide:
    side = PlantSide(load("step", [*QUIET, *changes]), RUN)
    side.start()
    return side


def command(sequence: int, stamp: int, apply_at: int, spool: float, source: int = OWNER):
    return ValveCommand(RUN, source, sequence, stamp, apply_at, spool)


def payloads(side: PlantSide, ticks: int, meddle: Callable[[PlantSide, int], None] = lambda side, tick: None):
    """Measurements and true states of a run under a fixed schedule of good commands."""
    out = []
    for tick in range(ticks):
        meddle(side, tick)
        stamp = side.now
        assert side.take(command(tick, stamp, stamp, 0.4 * math.sin(tick / 20)))
        out += [encode(m.message) for m in side.tick() if m.topic in ("measurement", "state")]
    return out


def test_a_command_acts_at_its_own_instant_inside_a_block():
    """The same as advancing the kernels by hand: 7 steps before, 13 after."""
    side = plant()
    assert side.take(command(0, 0, 350_000, 0.8))
    side.tick()
    scenario = side.scenario
    circuit = circuit_of(scenario)
    state, (taps, seen) = flatten(equilibrium(circuit, scenario.start.position)), buffers()
    block_of(compiled(circuit))(state, 0.0, 7, taps, seen)
    block_of(compiled(circuit))(state, 0.8, 13, taps, seen)
    assert np.array_equal(state, side._state)
    assert np.array_equal(taps, side._acquisition.taps)


def test_the_true_state_is_what_was_observed_at_the_end_of_the_block():
    """Under each name what the parts of the plant's state hold, after 50 ms in which no two pressures stay alike."""
    side = plant()
    assert side.take(command(0, 0, 0, 0.8))
    for _ in range(49):
        side.tick()
    message = next(m.message for m in side.tick() if m.topic == "state")
    state = unflatten(side._state)
    p, relief = pressures(state), state.core.relief.state
    assert len({round(value) for value in p}) == 9
    expected = {
        "position": state.piston.position,
        "velocity": state.piston.velocity,
        "spool": state.spool.position,
        **{f"p_{name}": getattr(p, name) for name in ("pump", "p", "a", "lower", "upper", "b", "t")},
        "p1": p.tee,
        "p_return": p.back,
        **{f"flow_{i}": flow for i, flow in enumerate(flows(state), 1)},
        "flow_relief": state.core.relief.flow,
        "relief_pilot": relief.pilot_lift,
        "relief_spool": relief.spool_lift,
        "mass": RIG["load"]["mass"].value,
        "oil_stored": pytest.approx(oil_in(state) + lines_hold(side), rel=1e-12),
        "oil_pumped": state.ledger.pumped,
        "oil_relieved": state.ledger.relieved,
        "oil_returned": state.ledger.returned,
    }
    assert {name: getattr(message, name) for name in expected} == expected
    assert {name for name in OBSERVED if name not in expected} == {"flow_pump", "friction", *CAVITIES}
    assert (message.stamp, message.reference) == (50 * MS, 0.8)


def lines_hold(side: PlantSide) -> float:
    """Oil that fills the lines [m^3]."""
    return circuit_of(side.scenario).parts.line_volume


BAD: dict[str, Callable[[int], bytes]] = {
    "not finite": lambda now: encode(command(10**6, now, now, math.nan)),
    "out of range": lambda now: encode(command(10**6, now, now, 1e300)),
    "undecodable": lambda now: b"\x00\x01\x00\x00 noise",
    "out of order": lambda now: encode(command(0, now, now, 0.9)),
    "far future": lambda now: encode(command(10**6, now, now + 11 * NS, 0.9)),
    "second controller": lambda now: encode(command(10**6, now, now, 0.9, source=99)),
    "foreign run": lambda now: encode(ValveCommand(RUN + 1, OWNER, 10**6, now, now, 0.9)),
    "off the grid": lambda now: encode(command(10**6, now, now + 1, 0.9)),
}


@pytest.mark.parametrize("reason", BAD)
def test_bad_commands_are_counted_recorded_and_change_nothing(reason):
    """Every measurement and every true state, bit for bit."""

    def meddle(side: PlantSide, tick: int) -> None:
        if tick >= 3 and tick % 5 == 0:
            assert side.receive(BAD[reason](side.now)) is None

    side = plant()
    disturbed = payloads(side, 60, meddle)
    assert disturbed == payloads(plant(), 60)
    assert side.inlet.refused == {reason: 11}


def test_a_message_of_another_type_is_refused():
    side = plant()
    good = encode(command(0, 0, 0, 0.5))
    assert side.receive(good, "std_msgs/msg/String") is None
    assert side.inlet.refused == {"undecodable": 1}
    assert side.receive(good, "hydrotwin_msgs/msg/ValveCommand") is not None


def test_refusals_are_recorded_one_by_one_until_there_are_too_many():
    side = plant()
    for _ in range(300):
        side.receive(b"noise")
    events = [m.message for m in side.tick() if m.topic == "event"]
    assert len(events) == 100
    assert "only counted" in events[-1].text
    assert side.inlet.refused == {"undecodable": 300}


def test_a_late_command_acts_from_the_last_integrated_instant_and_says_so():
    late, prompt = plant(), plant()
    for side in (late, prompt):
        for _ in range(10):
            side.tick()
    assert late.take(command(0, 5 * MS, 6 * MS, 0.7))
    assert prompt.take(command(0, 10 * MS, 10 * MS, 0.7))
    messages = late.tick()
    prompt.tick()
    assert np.array_equal(late._state, prompt._state)
    event = next(m.message for m in messages if m.topic == "event")
    assert (event.kind, event.apply_at, event.applied_at) == ("late", 6 * MS, 10 * MS)
    assert late.inlet.late == 1
    assert late.inlet.worst_lateness == 4 * MS


def test_a_command_that_never_came_is_told_by_the_next_one():
    """Not one that came and was refused, nor what an intruder leaves out."""
    side = plant()
    told = []
    for tick in range(20):
        stamp = side.now
        if tick in (8, 9):
            side.take(command(tick, stamp, stamp, math.nan))
        elif tick not in (0, 1, 5, 14, 15):
            side.take(command(tick, stamp, stamp, 0.1))
            side.take(command(3 * tick, stamp, stamp, 0.1, source=99))
        told += [m.message for m in side.tick() if m.topic == "event" and m.message.kind == "missed"]
    assert [event.text.removesuffix(" were not taken") for event in told] == [
        "commands 0 to 1", "commands 5 to 5", "commands 14 to 15",
    ]  # fmt: skip
    assert [event.command for event in told] == [2, 6, 16]


def test_silence_centres_the_valve_within_the_timeout_and_a_tick():
    side = plant("loop.command_timeout=0.05")
    assert side.take(command(0, 0, 0, 1.0))
    events, reference = [], []
    for _ in range(100):
        for message in side.tick():
            events += [message.message] if message.topic == "event" else []
            reference += [message.message.reference] if message.topic == "state" else []
    safe = [event for event in events if event.kind == "safe"]
    assert len(safe) == 1
    assert safe[0].applied_at == 60 * MS  # a sample period after the last command plus the timeout
    assert reference[:60] == [1.0] * 60
    assert reference[60:] == [0.0] * 40


def test_a_backlog_from_before_the_safe_state_does_not_act():
    """A controller that was stopped sends what it had computed: too old, whether the plant latches or resumes."""
    side = plant("loop.command_timeout=0.02", "loop.after_timeout=resume")
    assert side.take(command(0, 0, 0, 1.0))
    for _ in range(50):
        side.tick()
    for k in range(1, 4):
        assert not side.take(command(k, k * 10 * MS // 2, k * 10 * MS // 2, 0.9))
    assert side.inlet.refused == {"stale": 3}
    side.tick()
    assert side.inlet.value == 0.0
    assert side.inlet.safe_states == 1


def test_answers_from_within_a_cut_do_not_wake_the_plant_and_the_first_that_is_young_enough_does():
    """The link is cut for 100 ms; then the controller answers what was waiting, an answer a tick, until it is in time.

    Silence since a sample makes the plant safe 30 ms after it: so the answer to 80 ms, which comes at 107 ms, is the
    first that is taken; it left its safe state for that to 40 ms, and was safe again at once.
    """
    side = plant("loop.command_timeout=0.02", "loop.after_timeout=resume")
    assert side.take(command(0, 0, 0, 1.0))
    events = [m.message for _ in range(100) for m in side.tick() if m.topic == "event"]
    taken = []
    for k in range(1, 20):
        taken.append(side.now >= k * 10 * MS and side.take(command(k, k * 10 * MS, k * 10 * MS, 0.1)))
        for _ in range(1 if k < 10 else 10):
            events += [m.message for m in side.tick() if m.topic == "event"]
    assert taken[:10] == [False] * 7 + [True] * 3
    assert side.inlet.refused == {"stale": 7}
    told = [(event.kind, event.command) for event in events if event.kind in ("safe", "resumed")]
    assert told == [("safe", 0), ("resumed", 8)]


@pytest.mark.parametrize(("policy", "taken"), [("latch", False), ("resume", True)])
def test_after_the_timeout_the_plant_latches_or_resumes_as_configured(policy, taken):
    side = plant("loop.command_timeout=0.02", f"loop.after_timeout={policy}")
    assert side.take(command(0, 0, 0, 1.0))
    for _ in range(50):
        side.tick()
    assert side.take(command(1, 50 * MS, 50 * MS, 0.3)) is taken
    side.reset()
    assert side.take(command(2, 50 * MS, 50 * MS, 0.3)) is True
    side.tick()
    assert side.inlet.value == 0.3


def test_before_the_first_command_the_silence_counts_and_latches_nothing():
    """Due at the offset, 20 ms, and given 10 ms more; a first command that comes late is heard all the same."""
    side = plant("loop.command_timeout=0.01", "loop.offset=0.02")
    events = [m.message for _ in range(40) for m in side.tick() if m.topic == "event"]
    assert [(event.kind, event.applied_at) for event in events] == [("safe", 30 * MS)]
    assert side.take(command(0, 30 * MS, 30 * MS, 0.3))
    side.tick()
    assert (side.inlet.safe, side.inlet.value, side.inlet.late) == (False, 0.3, 1)


def test_after_a_reset_the_silence_counts_from_the_next_sample():
    side = plant("loop.command_timeout=0.02")
    assert side.take(command(0, 0, 0, 1.0))
    for _ in range(45):
        side.tick()
    side.reset()
    events = [m.message for _ in range(40) for m in side.tick() if m.topic == "event"]
    assert [(event.kind, event.applied_at) for event in events] == [("reset", 0), ("safe", 70 * MS)]


def test_lockstep_knows_which_sample_it_waits_for():
    side = plant("loop.sample_period=0.01", "loop.offset=0.002", "loop.delay=0.0125")
    waits = []
    for _ in range(40):
        waits.append(side.awaited())
        if waits[-1] is not None:
            sequence = waits[-1] // (10 * MS)
            assert side.take(command(sequence, waits[-1], waits[-1] + 12_500_000, 0.0))
        side.tick()
    assert [(k, w) for k, w in enumerate(waits) if w is not None] == [(14, 2 * MS), (24, 12 * MS), (34, 22 * MS)]


def test_measurements_are_what_the_struct_says():
    payload = encode(plant().tick()[0].message)
    run, sequence, tick, stamp, position, *_ = struct.unpack("<4xQQQqddddd", payload)
    assert (run, sequence, tick, stamp) == (RUN, 1, 1, MS)
    assert position == pytest.approx(0.1, abs=1e-6)
