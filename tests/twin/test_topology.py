"""The tables of the circuit against each other and against the names that the equations use."""

from tests.support.plant import circuit
from twin.circuit import ends, rates
from twin.circuit.block import HELD, observed
from twin.circuit.equilibrium import equilibrium
from twin.circuit.state import CORE, Flows, Pressures, flatten
from twin.rig import RIG
from twin.topology import CHANNELS, END_OF, ENDS, FLOWS, OBSERVED, PIPES, PLACES, RELIEF_LINE, TANK

NAMED = {  # pipe: the names that `step` has for its two ends
    "pipe_1": (ends.PUMP, ends.TEE_1),
    "pipe_2": (ends.TEE_2, ends.P),
    "pipe_3": (ends.A, ends.LOWER),
    "pipe_4": (ends.B, ends.UPPER),
    "pipe_5": (ends.T, ends.BACK_5),
    "pipe_6": (ends.BACK_6, ends.TANK),
}


def test_the_equations_name_the_ends_in_the_order_of_the_pipes():
    assert [end for ends in NAMED.values() for end in ends] == list(range(len(ENDS)))
    assert list(NAMED) == list(PIPES)
    places = {"pump": ends.PUMP, "tee": ends.TEE_1, "p": ends.P, "a": ends.A, "lower": ends.LOWER}
    places |= {"upper": ends.UPPER, "b": ends.B, "t": ends.T, "return": ends.BACK_5}
    assert places == END_OF


def test_vectors_of_places_and_pipes_have_their_order():
    named = {"pump": rates.PUMP, "tee": rates.TEE, "p": rates.P, "a": rates.A, "lower": rates.LOWER}
    named |= {"upper": rates.UPPER, "b": rates.B, "t": rates.T, "return": rates.BACK}
    assert named == {place: i for i, place in enumerate(PLACES)}
    assert [field.replace("back", "return") for field in Pressures._fields] == list(PLACES)
    assert len(Flows._fields) == len(FLOWS) == len(PIPES)


def test_every_pipe_is_of_the_rig_and_joins_known_places():
    assert [name for name in RIG if name.startswith("pipe_")] == [*PIPES, RELIEF_LINE]
    assert {place for pipe in PIPES.values() for place in pipe} == {*PLACES, TANK}


def test_quantities_that_a_state_holds_are_found_under_their_names():
    c = circuit()
    state = equilibrium(c, 0.1)
    flat, seen = flatten(state), observed(state, c)
    assert {name: flat[at] for name, at in HELD.items()} == {name: seen[name] for name in HELD}
    assert seen["position"] == state.piston.position
    assert [seen[place.pressure] for place in PLACES.values()] == [state.ends.pressure[end] for end in END_OF.values()]
    assert [seen["relief_pilot"], seen["relief_spool"]] == [*state.core.relief.state][::2]
    assert [seen[f"oil_{name}"] for name in state.ledger._fields] == [*state.ledger]
    assert len(CORE) == len(set(CORE))


def test_every_channel_reads_something_that_is_observed():
    assert {channel.reads for channel in CHANNELS.values()} <= set(OBSERVED)
    assert not set(CHANNELS) & {"run_id", "sequence", "tick", "stamp"}
