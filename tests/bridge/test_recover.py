"""Recovery of damaged recordings: cut at every byte, with wrong bits, of every kind of file."""

import random
from pathlib import Path

import pytest

from bridge.errors import RunError, UsageError
from bridge.recording.reader import read
from bridge.recording.recover import Recovered, recover
from tests.support.damage import KINDS, Message, Small, read_by_mcap, small_file

ZSTD = b"\x28\xb5\x2f\xfd"


@pytest.fixture(scope="module", params=KINDS)
def small(request, tmp_path_factory) -> Small:
    return small_file(tmp_path_factory.mktemp("small") / "small.mcap", request.param)


@pytest.fixture
def recovery(tmp_path):
    """Recover bytes: what was said, and the messages that mcap's own reader finds; None when it was refused.

    Both readers are asked once for outputs that follow each other and are the same.
    """
    known: dict[bytes, list[Message]] = {}

    def recovered(data: bytes) -> tuple[Recovered, list[Message]] | None:
        damaged, output = tmp_path / "damaged.mcap", tmp_path / "out.mcap"
        damaged.write_bytes(data)
        output.unlink(missing_ok=True)
        try:
            done = recover([damaged], output)
        except (RunError, UsageError):
            assert [path.name for path in tmp_path.iterdir()] == ["damaged.mcap"]
            return None
        assert {path.name for path in tmp_path.iterdir()} == {"damaged.mcap", "out.mcap"}
        written = output.read_bytes()
        if written not in known:
            known.clear()
            known[written] = read_by_mcap(output)
            ours = read(output)  # wrong bits in a name may make a channel one of ours, which it does not fit
            assert len(known[written]) == sum(ours.counts.values()) + ours.damage.unreadable
        assert done.messages == len(known[written])
        return done, known[written]

    return recovered


def test_whatever_byte_a_file_ends_at_every_whole_chunk_before_it_is_kept(small, recovery):
    """Also what of the last chunk can be unpacked; what is kept is the beginning of what was written."""
    every = 1 if ZSTD in small.data else 7  # bytes: ours are zstd
    for end in range(0, len(small.data), every):
        least = sum(place <= end for place in small.ends)
        got = recovery(small.data[:end])
        if got is None:
            assert end < small.fact, f"refused at byte {end}"
            continue
        found = got[1]
        assert len(found) >= least, f"cut at byte {end}"
        assert found == small.messages[: len(found)], f"cut at byte {end}"


def test_a_wrong_bit_costs_no_more_than_the_chunk_that_it_is_in(small, recovery):
    flips = random.Random(2)
    for _ in range(250):
        place, bit = flips.randrange(len(small.data)), flips.randrange(8)
        data = bytearray(small.data)
        data[place] ^= 1 << bit
        got = recovery(bytes(data))
        assert got is not None
        found = set(got[1])
        lost = {end for message, end in zip(small.messages, small.ends, strict=True) if message not in found}
        assert len(lost) <= 1, f"byte {place}, bit {bit}: {len(lost)} chunks are lost"
        assert all(place < end for end in lost)


def test_wrong_bits_in_a_file_that_is_cut_off_as_well(small, recovery):
    flips = random.Random(3)
    for _ in range(150):
        data = bytearray(small.data[: flips.randrange(len(small.data))])
        for place in flips.choices(range(len(data)), k=min(len(data), 3)):
            data[place] ^= 1 << flips.randrange(8)
        recovery(bytes(data))


def test_an_overwritten_block_costs_what_was_in_it(small, recovery):
    """As a power cut leaves it: a block of zeros, or of somebody else's bytes."""
    for seed in range(60):
        noise = random.Random(seed)
        begin, size = noise.randrange(8, len(small.data)), noise.randrange(1, 300)
        block = bytes(size) if seed % 2 else noise.randbytes(size)
        got = recovery(small.data[:begin] + block + small.data[begin + size :])
        assert got is not None
        kept = set(got[1])
        for number, (message, end) in enumerate(zip(small.messages, small.ends, strict=True)):
            first = next((e for e in reversed(small.ends[:number]) if e < end), small.fact)
            untouched = end <= begin or begin + size <= first
            assert message in kept or not untouched, f"seed {seed}: message {number}"


def test_a_sound_file_stays_what_it_is(small, recovery):
    done, found = recovery(small.data)
    assert done.whole
    assert not done.notes
    assert found == small.messages


def test_a_chunk_that_is_left_out_is_counted_and_its_time_is_named(recovery, tmp_path):
    small = small_file(tmp_path / "damaged.mcap", chunks=5, each=4)
    data = bytearray(small.data)
    place = small.data.index(ZSTD, small.ends[3]) + 20
    data[place] ^= 1
    done, found = recovery(bytes(data))
    assert done.damaged == 1
    assert len(found) == 16
    assert done.notes == ("damaged: 1 of 5 chunks is left out: t = 4e-06 s to 7e-06 s",)


def test_a_part_of_the_last_chunk_is_unpacked(recovery, tmp_path):
    """A chunk of many blocks, cut in its middle: about half of its messages are there."""
    small = small_file(tmp_path / "damaged.mcap", chunks=1, each=4000, size=500)
    _, found = recovery(small.data[: len(small.data) // 2])
    assert 1500 < len(found) < 2100
    assert found == small.messages[: len(found)]


def test_a_missing_input_leaves_the_output_as_it_was(tmp_path):
    output = tmp_path / "keep.mcap"
    small_file(output)
    before = output.read_bytes()
    for files in ([tmp_path / "missing.mcap"], [tmp_path], [output]):
        with pytest.raises(UsageError):
            recover(files, output)
        assert output.read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["keep.mcap"]


def test_one_part_that_is_not_a_recording_is_named_before_anything_is_written(tmp_path):
    small_file(tmp_path / "a.mcap")
    (tmp_path / "b.mcap").write_text("not a recording, but longer than a magic number")
    with pytest.raises(UsageError, match=r"b\.mcap: not an MCAP file"):
        recover([tmp_path / "a.mcap", tmp_path / "b.mcap"], tmp_path / "out.mcap")
    assert not (tmp_path / "out.mcap").exists()


def test_the_output_may_lie_in_a_folder_that_is_not_there_yet(tmp_path):
    small = small_file(tmp_path / "a.mcap")
    recover([tmp_path / "a.mcap"], tmp_path / "new" / "folder" / "out.mcap")
    assert read_by_mcap(tmp_path / "new" / "folder" / "out.mcap") == small.messages


def test_an_input_under_another_name_is_not_overwritten(tmp_path):
    small_file(tmp_path / "a.mcap")
    (tmp_path / "b.mcap").hardlink_to(tmp_path / "a.mcap")
    with pytest.raises(UsageError, match="would overwrite"):
        recover([tmp_path / "a.mcap"], tmp_path / "b.mcap")


def test_parts_with_damage_are_joined(tmp_path, recovery):
    small = small_file(tmp_path / "a.mcap")
    (tmp_path / "b.mcap").write_bytes(small.data[: small.ends[-5]])
    done = recover([tmp_path / "a.mcap", tmp_path / "b.mcap"], tmp_path / "out.mcap")
    assert read_by_mcap(done.path) == small.messages + small.messages[:-4]
    assert not done.whole


def test_attachments_and_facts_are_kept(tmp_path):
    from mcap.reader import make_reader
    from mcap.writer import Writer

    with (tmp_path / "a.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        writer.add_attachment(1, 2, "notes.txt", "text/plain", b"words")
        writer.add_metadata("user", {"operator": "Ada"})
        writer.finish()
    recover([tmp_path / "a.mcap"], tmp_path / "b.mcap")
    with Path(tmp_path / "b.mcap").open("rb") as file:
        reader = make_reader(file)
        assert [a.data for a in reader.iter_attachments()] == [b"words"]
        assert [(m.name, m.metadata) for m in reader.iter_metadata()] == [("user", {"operator": "Ada"})]
