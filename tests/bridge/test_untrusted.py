"""Files that somebody made to harm: each is refused in one line, in time, and within bounded memory."""

import json
import os
import pickle
import resource
import struct
import tracemalloc
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import lz4.frame
import numpy as np
import pytest
import zstandard
from mcap.opcode import Opcode
from mcap.writer import CompressionType, Writer

from bridge.errors import RunError, ScenarioError, UsageError
from bridge.recording.layout import MAGIC, RECORD
from bridge.recording.reader import read
from bridge.recording.recover import recover
from bridge.runs.campaign.file import read_campaign
from bridge.scenario import load
from bridge.scenario.untrusted import DEEPEST, LONGEST, LONGEST_TABLE, MOST_FILES
from bridge.wire.messages import TOPICS, definition
from controller.reference import table_from_csv
from tests.support.command import hydrotwin_here
from tests.support.processes import ROOT

STEP = 'extends = "step"\n'
MEGABYTES = 1000  # that any of them may take; their bombs are larger
pytestmark = pytest.mark.timeout(60)


@pytest.fixture(autouse=True)
def bounded():
    """Nothing here may fill the memory."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    yield
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < MEGABYTES * 1000


def refusal(path: Path) -> str:
    """What is said of a scenario: one line, and a short one."""
    with pytest.raises(ScenarioError) as refused:
        load(str(path))
    (line,) = str(refused.value).splitlines()
    assert len(line) < 600
    return line


HOSTILE = {
    "lists in lists": (STEP + "x = " + "[" * 100_000, "tables within one another more than 20 deep"),
    "a long dotted name": (STEP + "[" + ".".join("a" * 100_000) + "]\n", "more than 20 deep"),
    "a dotted name in quotes": (STEP + ".".join(['","'] * 100_000) + " = 1\n", "more than 20 deep"),
    "a dotted name behind a text": (STEP + 'x = "\\\\"\n' + ".".join("a" * 50_000) + " = 1\n", "more than 20 deep"),
    "a dotted name behind a long text": (STEP + 'x = """\\""""\n' + ".".join("a" * 50_000) + " = 1", "20 deep"),
    "tables in tables": (STEP + "x = " + "{a=" * 30 + "1" + "}" * 30, "more than 20 deep"),
    "a huge file": (STEP + f"title = '{'x' * LONGEST}'", f"is longer than {LONGEST} bytes"),
    "a number in spaces": (STEP + f'duration = "1{" " * 50_000}x"', "50002 characters: write a number"),
    "a long number": (STEP + f"duration = {'9' * 5000}", "cannot be read"),
    "many times": (
        STEP + '[[timeline]]\nset = "rig.load.force"\nat = 1\nto = 1\nevery = 0.01\ntimes = 10000\n' * 11,
        "timeline: its entries happen 110000 times in all; at most 100000",
    ),
    "a name that leaves the folder": (STEP + 'name = "../../evil"', "would leave the folder of recordings"),
    "a name with a null": (STEP + 'name = "a\\u0000b"', "control character"),
    "a rig's name that means all": (STEP + 'rig_name = "**"', "rig_name"),
    "a device": ('extends = "/dev/zero"', "no such scenario or file"),
    "another file's text": ('extends = "../../../../../../../../etc/passwd"', "cannot be read"),
}


@pytest.mark.parametrize("what", HOSTILE)
def test_a_hostile_scenario_is_refused_in_one_line(tmp_path, what):
    text, words = HOSTILE[what]
    (tmp_path / "hostile.toml").write_text(text)
    assert words in refusal(tmp_path / "hostile.toml")


@pytest.mark.parametrize("text", ["[" * 100_000, '{"a":' * 1000 + "1" + "}" * 1000])
def test_a_hostile_json_is_refused_in_one_line(tmp_path, text):
    (tmp_path / "hostile.json").write_text(text)
    assert f"more than {DEEPEST} deep" in refusal(tmp_path / "hostile.json")


def test_mistakes_without_number_are_not_all_told(tmp_path):
    """Nor compared with every valid key."""
    (tmp_path / "hostile.toml").write_text(STEP + "".join(f"{'k' * 100}{k} = 1\n" for k in range(5000)))
    with pytest.raises(ScenarioError) as refused:
        load(str(tmp_path / "hostile.toml"))
    *told, last = str(refused.value).splitlines()
    assert len(told) == 20
    assert last.endswith("and 4980 mistakes more")


def test_files_that_extend_others_twice_each_end_soon(tmp_path):
    """Without a limit these 30 would be 2^30."""
    for k in range(30):
        (tmp_path / f"b{k}.toml").write_text(f'extends = ["b{k + 1}.toml", "b{k + 1}.toml"]\n')
    (tmp_path / "b30.toml").write_text(STEP)
    assert f"more than {MOST_FILES} files extend one another" in refusal(tmp_path / "b0.toml")


def test_a_link_to_oneself_is_an_error_of_the_system(tmp_path):
    (tmp_path / "loop.toml").symlink_to(tmp_path / "loop.toml")
    assert "no such scenario or file" in refusal(tmp_path / "loop.toml")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0," + "1" * 200_000, "line 1: field larger than field limit"),
        ("0,0\n1," + "x" * 1000, "line 2: position_m is 'xxxx"),
        ("0,0\n1,\0\n", "line 2: position_m is '\\x00'"),
        ("0,0\n" + "1," * 1000, "line 2: 1001 columns in '1,1,"),
        ('0,0\n"' + "1\n" * 100_000, "line 100001: 1 columns in '11"),
        ("0,0\n1,1e999\n", "line 2: position_m is '1e999'; expected a finite number"),
    ],
)
def test_a_hostile_table_is_refused_in_one_short_line(text, words):
    with pytest.raises(ValueError, match=r"^line \d+: ") as refused:
        table_from_csv(text)
    assert words in str(refused.value)
    assert len(str(refused.value)) < 200


def test_a_table_that_does_not_end_is_refused_unread(tmp_path):
    with (tmp_path / "long.csv").open("wb") as file:
        file.truncate(50 * LONGEST_TABLE)  # a sparse file: no line ends in it
    (tmp_path / "long.toml").write_text(STEP + '[reference]\nkind = "table"\ncsv = "long.csv"\n')
    assert f"is longer than {LONGEST_TABLE} bytes" in refusal(tmp_path / "long.toml")


def test_a_hostile_campaign_is_refused_in_one_line(tmp_path):
    for text in ("x = " + "[" * 100_000, ".".join("a" * 100_000) + " = 1", "x = '" + "x" * LONGEST + "'"):
        (tmp_path / "campaign.toml").write_text(text)
        with pytest.raises(UsageError) as refused:
            read_campaign(tmp_path / "campaign.toml")
        assert len(str(refused.value).splitlines()) == 1


class Evil:
    """Runs code where somebody unpickles it."""

    def __reduce__(self) -> tuple[Callable[[str], int], tuple[str]]:
        return os.system, ("touch executed",)


def npz(path: Path, name: str, content: bytes) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr(f"{name}.npy", content)


def array(shape: tuple[int, ...]) -> bytes:
    """The head of a file of numpy that says so, and no numbers."""
    head = str({"descr": "<f8", "fortran_order": False, "shape": shape}).encode().ljust(117) + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head


def matrices(tmp_path: Path, name: str) -> str:
    (tmp_path / "law.toml").write_text(STEP + f'[controller]\nkind = "state-space"\nfile = "{name}"\n')
    return refusal(tmp_path / "law.toml")


def test_an_archive_of_arrays_neither_runs_code_nor_fills_the_memory(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    npz(tmp_path / "code.npz", "D", pickle.dumps(Evil()))
    assert "has no dt" in matrices(tmp_path, "code.npz")  # bytes that are not an array stay bytes
    np.savez(tmp_path / "object.npz", D=np.array([Evil()], dtype=object))
    assert "is not an archive of plain arrays" in matrices(tmp_path, "object.npz")
    assert not (tmp_path / "executed").exists()
    npz(tmp_path / "bomb.npz", "D", array((20_000_000,)) + bytes(160_000_000))
    assert "unpacks to 160000128 bytes" in matrices(tmp_path, "bomb.npz")
    npz(tmp_path / "lie.npz", "D", array((1 << 40,)))
    assert "is not an archive of plain arrays" in matrices(tmp_path, "lie.npz")
    (tmp_path / "long.npz").write_bytes(bytes(LONGEST + 1))
    assert f"is longer than {LONGEST} bytes" in matrices(tmp_path, "long.npz")


def test_a_matlab_file_does_not_fill_the_memory(tmp_path):
    from scipy.io import savemat

    savemat(tmp_path / "bomb.mat", {"D": np.zeros((3000, 3000))}, do_compression=True)
    assert (tmp_path / "bomb.mat").stat().st_size < LONGEST
    assert "unpacks to 72000000 bytes; the matrices of a law have at most 16000000" in matrices(tmp_path, "bomb.mat")
    (tmp_path / "junk.mat").write_bytes(
        b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + b"\x0f\0\0\0\xff\xff\xff\x7f"
    )
    assert "is not a MATLAB file that can be read" in matrices(tmp_path, "junk.mat")


def chunk(packed: bytes, kind: bytes, size: int, checksum: int = 0) -> bytes:
    """A chunk of MCAP."""
    body = struct.pack("<QQQI", 0, 1, size, checksum) + struct.pack("<I", len(kind)) + kind
    body += struct.pack("<Q", len(packed)) + packed
    return RECORD.pack(Opcode.CHUNK, len(body)) + body


def mcap(path: Path, *records: bytes) -> Path:
    path.write_bytes(MAGIC + b"".join(records) + MAGIC)
    return path


ZEROS = 1 << 28  # bytes that a bomb unpacks to


def zstd_bomb(size: int, stated: bool) -> bytes:
    """Some kilobytes."""
    packer = zstandard.ZstdCompressor(level=1)
    if stated:
        return packer.compress(bytes(size))
    stream, block = packer.compressobj(), bytes(1 << 20)
    return b"".join([*(stream.compress(block) for _ in range(size >> 20)), stream.flush()])


def lz4_bomb(size: int) -> bytes:
    packer, block = lz4.frame.LZ4FrameCompressor(), bytes(1 << 20)
    return b"".join([packer.begin(), *(packer.compress(block) for _ in range(size >> 20)), packer.flush()])


@pytest.mark.parametrize(
    ("kind", "packed", "size"),
    [
        (b"zstd", zstd_bomb(ZEROS >> 3, True), ZEROS >> 3),  # as it says, and many of them below
        (b"zstd", zstd_bomb(ZEROS, False), 1000),  # more than the chunk says
        (b"zstd", zstd_bomb(ZEROS, False), 1 << 62),
        (b"lz4", lz4_bomb(ZEROS >> 1), 1000),
        (b"lz4", lz4_bomb(ZEROS >> 1), 1 << 62),
    ],
    ids=["zstd", "zstd more", "zstd huge", "lz4 more", "lz4 huge"],
)
def test_a_recording_does_not_fill_the_memory(tmp_path, kind, packed, size):
    """Eight chunks of a few kilobytes that unpack to some hundred megabytes each."""
    path = mcap(tmp_path / "bomb.mcap", *[chunk(packed, kind, size, zlib.crc32(bytes(min(size, 1 << 20))))] * 8)
    tracemalloc.start()
    try:
        for use in (lambda: read(path), lambda: recover([path], tmp_path / "out.mcap")):
            with pytest.raises((UsageError, RunError), match=r"^.*bomb.mcap: (nothing|\d+ bytes that unpack).*$"):
                use()
        assert tracemalloc.get_traced_memory()[1] < 300e6
    finally:
        tracemalloc.stop()


def test_a_small_file_of_many_chunks_is_refused_with_its_size(tmp_path):
    block = RECORD.pack(0x80, 8 << 20) + bytes(8 << 20)  # one record of a kind that anybody may have
    packed = zstandard.compress(block)
    path = mcap(tmp_path / "bomb.mcap", *[chunk(packed, b"zstd", len(block), zlib.crc32(block))] * 40)
    with pytest.raises(UsageError, match=r"bomb.mcap: \d+ bytes that unpack to more than \d+: not a recording"):
        read(path)


def rewritten(path: Path, topic: str = "", data: bytes = b"", **scenario: Any) -> Path:
    """A golden recording in which two messages of a topic are something else, or values of the scenario."""
    source, left = read(ROOT / "recordings" / "step.mcap"), 2
    source.metadata["run"]["scenario"] |= scenario
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.ZSTD)
        writer.start(profile="ros2", library="somebody")
        channels = {}
        for name, known in TOPICS.items():
            schema = writer.register_schema(known.type, "ros2msg", definition(known.type).encode())
            channels[name] = writer.register_channel(f"rig/{name}", "cdr", schema)
        for entry in source.entries:
            ours = entry.topic == topic and left > 0
            left -= ours
            writer.add_message(channels[entry.topic], entry.log_time, data if ours else entry.data, 0, entry.sequence)
        for name, facts in source.metadata.items():
            plain = {key: value if isinstance(value, str) else json.dumps(value) for key, value in facts.items()}
            writer.add_metadata(name, plain)
        writer.finish()
    return path


@pytest.mark.parametrize("topic", ["event", "measurement", "state", "lines", "joint"])
@pytest.mark.parametrize("data", [b"", b"\0\1\0\0" + b"\xff" * 300], ids=["empty", "endless lists"])
def test_a_message_that_is_not_what_its_channel_says_is_left_out_and_counted(tmp_path, topic, data):
    path = rewritten(tmp_path / "evil.mcap", topic, data)
    found = read(path)
    assert found.damage.unreadable == 2
    done = hydrotwin_here("info", str(path), cwd=tmp_path)
    assert done.returncode == 0
    (line,) = done.stderr.splitlines()
    assert line.endswith("damaged: 2 messages are not what their channel says, and are left out")


def test_a_title_is_text_on_every_page(tmp_path):
    """Neither a browser nor a terminal does what it says."""
    title = "<script>alert(1)</script><img src=x onerror=alert(1)>"
    rewritten(tmp_path / "r.mcap", title=title)
    assert hydrotwin_here("report", "r.mcap", "-o", "r.html", cwd=tmp_path).returncode == 0
    page = (tmp_path / "r.html").read_text()
    assert "&lt;script&gt;alert(1)" in page
    assert "<script>alert(1)" not in page
    assert "<img src=x" not in page


def test_a_recording_s_channels_are_not_names_of_files(tmp_path):
    """An export writes into its folder, whatever a channel is called."""
    path = tmp_path / "evil.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros2", library="somebody")
        kind = TOPICS["measurement"].type
        schema = writer.register_schema(kind, "ros2msg", definition(kind).encode())
        number = writer.register_channel("rig/../../../evil/measurement", "cdr", schema)
        for entry in read(ROOT / "recordings" / "step.mcap").of("measurement"):
            writer.add_message(number, entry.log_time, entry.data, entry.log_time, entry.sequence)
        writer.finish()
    (tmp_path / "deep" / "er").mkdir(parents=True)
    before = set(tmp_path.rglob("*"))
    hydrotwin_here("export", str(path), "--csv", "-o", "out", cwd=tmp_path / "deep" / "er")
    made = set(tmp_path.rglob("*")) - before
    assert made
    assert all(p.is_relative_to(tmp_path / "deep" / "er" / "out") for p in made)


def test_looking_at_a_recording_runs_no_law_of_it(tmp_path):
    """It names a law in a file beside it; whoever looks does not load that. Only a run of the law does."""
    (tmp_path / "evil.py").write_text(
        "open('executed', 'w')\n\ndef law(sample, target, memory, gains):\n    return 0.0, None\n"
    )
    rewritten(tmp_path / "r.mcap", controller={"kind": "python", "law": "evil.py:law"})
    for verb, *options in (["info"], ["digest"], ["report", "-o", "r.html"], ["export", "--csv", "-o", "out"]):
        done = hydrotwin_here(verb, "r.mcap", *options, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert not (tmp_path / "executed").exists(), verb
    hydrotwin_here("replay", "r.mcap", "--into", "controller", "--alone", cwd=tmp_path)
    assert (tmp_path / "executed").exists()


def test_a_test_would_see_a_bomb():
    """The packed zeros are what they are said to be."""
    assert len(zstd_bomb(1 << 20, True)) < 1000
    assert lz4.frame.decompress(lz4_bomb(1 << 20)) == bytes(1 << 20)
    assert zstandard.ZstdDecompressor().stream_reader(zstd_bomb(1 << 20, False)).read() == bytes(1 << 20)
