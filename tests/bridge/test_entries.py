"""The messages of a recording in little memory behave like a list of them."""

import random
import sys

import pytest

from bridge.recording.entries import Entries, Entry


@pytest.fixture(scope="module")
def messages() -> list[Entry]:
    """Of several topics, of any length, in no order."""
    rng = random.Random(3)
    return [
        Entry(
            rng.choice(["state", "event", "camera"]), rng.randrange(-9, 10**15), rng.randrange(2**63), rng.randbytes(n)
        )
        for n in (rng.randrange(40) for _ in range(500))
    ]


def test_they_are_a_sequence_like_the_list(messages: list[Entry]):
    kept = Entries(messages)
    assert list(kept) == messages
    assert kept == messages
    assert len(kept) == len(messages)
    assert (kept[0], kept[-1], kept[7:90:3]) == (messages[0], messages[-1], messages[7:90:3])
    assert kept != messages[1:]
    with pytest.raises(IndexError):
        kept[len(messages)]


@pytest.mark.parametrize("topic", ["state", "event", "camera", "nobody's"])
def test_each_topic_has_its_own(messages: list[Entry], topic: str):
    kept, own = Entries(messages), [entry for entry in messages if entry.topic == topic]
    assert list(kept.of(topic)) == own
    assert list(kept.lane(topic)) == [entry.data for entry in own]
    assert bytes(kept.lane(topic).data) == b"".join(entry.data for entry in own)


def test_a_message_costs_little_beside_its_own_bytes():
    """Five numbers of 8 bytes or less: an hour at 1 kHz of what a summary needs is 1 GB and not 4."""
    kept = Entries()
    for k in range(10_000):
        kept.add("state", k, k, b"x" * 100)
    lane = kept.lane("state")
    arrays = [value for part in (kept, lane) for value in vars(part).values() if hasattr(value, "__len__")]
    assert sum(map(sys.getsizeof, arrays)) < 10_000 * (100 + 5 * 8) * 1.2


def test_there_may_be_as_many_topics_as_a_file_can_have_channels():
    kept = Entries(Entry(f"topic {k}", 0, 0, b"") for k in range(2**16 + 1))
    assert kept[-1].topic == f"topic {2**16}"
