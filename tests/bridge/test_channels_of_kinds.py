"""Further channels of what is fitted: each reads the number that its kind keeps, from where the plant has it."""

import numpy as np
import pytest

from bridge.scenario import load
from bridge.scenario.circuit import circuit_of
from twin import accumulator, compliant, counterbalance, lugre, pilot_check, variable_pump
from twin.accessory import LINE
from twin.circuit.block import compiled
from twin.circuit.sensing import DERIVED, Sensing, as_load
from twin.circuit.state import MEMORY_AT, place_of, unflatten
from twin.kept import FOLLOWS, KEPT, kept, sensors
from twin.rig import rig_words
from twin.topology import CHANNELS, OBSERVED

WORDS = {"gas_pressure": "gas"}  # where a sensor has another word than the number that it shows
MEMORIES = {
    "variable": variable_pump.MEMORY,
    "bladder": accumulator.MEMORY,
    "counterbalance": counterbalance.MEMORY,
    "pilot-check": pilot_check.MEMORY,
    "lugre": lugre.MEMORY,
    "compliant": compliant.MEMORY,
}


def test_what_a_kind_keeps_is_read_from_its_slot():
    kinds = ("supply.kind=variable", "accumulator.kind=bladder", "accessory_a.kind=counterbalance")
    kinds = (*kinds, "accessory_b.kind=throttle", "relief.kind=none", "friction.kind=lugre", "load.kind=compliant")
    own = [f"rig.{change}" for change in kinds]
    rig, state = load("step", own).rig_values(), np.arange(float(MEMORY_AT))
    names, seen, taps = kept(rig), np.zeros(len(OBSERVED)), np.zeros((2, len(CHANNELS)))
    found = Sensing(names, compiled(circuit_of(load("step"))), rig).read(state, seen, taps)
    slots = unflatten(state).slots._asdict()
    far = state[place_of("piston.position")] + slots["load"][compliant.STRETCH]
    expected = [far if entry.number == FOLLOWS else slots[slot][entry.number] for slot, entry in names.values()]
    assert found.tolist() == expected
    assert len(names) == 11


@pytest.mark.parametrize("kind", rig_words("load", "kind"))
def test_the_force_cell_knows_the_load_of_any_kind(kind: str):
    """Off the record that changes while the plant runs, with all that is nested in it."""
    circuit = circuit_of(load("step", [f"rig.load.kind={kind}"]))
    record = compiled(circuit).parts[0]["load"]
    assert as_load(record.dtype, record.item()) == circuit.parts.load


@pytest.mark.parametrize("section", KEPT)
def test_a_sensor_shows_the_number_that_its_kind_names(section: str):
    for kind, words in KEPT[section].items():
        assert kind in rig_words(section, "kind")
        for word, entry in words.items():
            if entry.number == FOLLOWS:
                assert f"{section}_{word}" in {*OBSERVED, *DERIVED}
            elif (section.startswith("accessory"), word) == (True, "pressure"):
                assert entry.number == LINE
            else:
                assert MEMORIES[kind][entry.number] == WORDS.get(word, word)


def test_sensors_have_ranges_and_words():
    daq = load("step").daq
    for name, sensor in sensors(load("step").rig_values()).items():
        low, high = sensor.ends(daq)
        assert low <= 0.0 < high
        assert sensor.note
        assert name in OBSERVED or name in ("force", "acceleration")
    assert not set(sensors(load("step").rig_values())) & (set(CHANNELS) - {"p1"})
