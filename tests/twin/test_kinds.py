"""A part of a circuit as one kind: it is given where it is fitted, and refused with what to take where it is not."""

import re

import pytest

from tests.support.plant import circuit
from twin.circuit.build import build
from twin.circuit.kinds import CHOSEN_BY, of_kind
from twin.rig import rig_number, rig_words, values
from twin.seal import Seal


@pytest.mark.parametrize("kind", CHOSEN_BY, ids=lambda kind: kind.__name__)
def test_what_a_refusal_says_to_take_fits_that_kind(kind: type):
    place, word = re.findall(r"(\w+)\.kind = '([\w-]+)'", CHOSEN_BY[kind])[0]
    assert word in rig_words(place, "kind")
    parts = build(values({place: {"kind": word}}), 50e-6).parts
    (fitted,) = (part for part in parts if type(part) is kind)
    assert of_kind(fitted, kind) is fitted


def test_another_kind_is_refused_with_the_way_out():
    bare = circuit(friction={"kind": "none"}).parts.seal
    with pytest.raises(ValueError, match=r"a Seal is needed, and a NoFriction is fitted: take friction\.kind = 'seal'"):
        of_kind(bare, Seal)


def test_a_number_is_not_a_word_of_the_rig():
    assert rig_number("cylinder", "bore") == values()["cylinder"]["bore"]
    assert rig_words("friction", "kind")[0] == "seal"
    with pytest.raises(TypeError, match=r"friction\.kind is not a number: 'seal'"):
        rig_number("friction", "kind")
    with pytest.raises(TypeError, match=r"cylinder\.bore is not a choice of words: 0\.05"):
        rig_words("cylinder", "bore")
