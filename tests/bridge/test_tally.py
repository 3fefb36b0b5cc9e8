"""Losses are what is missing, wherever it is missing."""

from hypothesis import given
from hypothesis import strategies as st

from bridge.recording.tally import Tally


@given(st.sets(st.integers(0, 200)), st.randoms())
def test_every_missing_sequence_is_one_loss(missing, random):
    """Of 201 messages all but the missing ones come, in any order; the publisher says that there were 201."""
    tally = Tally(from_start=True)
    came = [sequence for sequence in range(201) if sequence not in missing]
    random.shuffle(came)
    for sequence in came:
        tally.add("measurement", 0, sequence)
    tally.announce({"measurement": 201})
    assert tally.losses() == ({"measurement": len(missing)} if missing else {})


def test_gaps_are_seen_without_an_announcement():
    tally = Tally(from_start=True)
    for sequence in (0, 1, 4, 5):
        tally.add("state", 0, sequence)
    assert tally.losses() == {"state": 2}


def test_a_late_joiner_does_not_miss_what_was_before():
    tally = Tally(from_start=False)
    for sequence in (100, 101, 103):
        tally.add("state", 0, sequence)
    tally.announce({"state": 105, "event": 7})
    assert tally.losses() == {"state": 2}


def test_an_intruder_does_not_hide_the_owners_losses():
    tally = Tally(from_start=True)
    for sequence in (0, 1, 2, 4, 5):
        tally.add("command", 11, sequence)
    for sequence in (7, 9):
        tally.add("command", 12, sequence)
    tally.announce({"command": 6})
    assert tally.losses() == {"command": 1}
