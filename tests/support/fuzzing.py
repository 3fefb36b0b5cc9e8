"""Fuzz: what anybody may send or hand over, mostly right and somewhere wrong; targets that may only refuse it in words.

A target lets nothing out but the errors that are documented; those it catches. Each is used for seconds in the suite,
and for ten minutes in `make endurance`, with its memory watched.
"""

import json
import math
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from hypothesis import strategies as st

from bridge.errors import RunError, ScenarioError, UsageError
from bridge.loop.exchange import exchange, sides
from bridge.loop.plant import PlantSide
from bridge.processes.injection import injected_by
from bridge.processes.parameters import listed, set_by, target_of
from bridge.processes.recorder.run_file import Request, RunFile
from bridge.recording.info import describe
from bridge.recording.manifest import told_by
from bridge.recording.reader import read
from bridge.recording.recover import recover
from bridge.recording.summarise import known_or_made
from bridge.replay.player import Player
from bridge.replay.timeline import Timeline
from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.wire.codec import ValveCommand, decode, encode
from bridge.wire.messages import TOPICS, field_names, struct_format
from controller.reference import table_from_csv

SHORT = ["duration=0.02"]
NUMBERS = st.one_of(
    st.floats(), st.integers(-(2**64), 2**64), st.sampled_from([0, -1, 1e308, -0.0, math.nan, math.inf, 5e-324, 2**63])
)
WORDS = st.one_of(
    st.text(max_size=30),
    st.sampled_from(["", "1 mm", "inf", "nan", "1e999 bar", "-5 %", "0x10", "1 V/%", "ø", "\0", "../..", "{", "[["]),
    st.sampled_from(["p2 > 1 bar", "safe", "2 s", "1e-9 s", "pi.py:law", "1 1/min", "stuck", "python", "table"]),
)
VALUES = st.recursive(
    st.one_of(NUMBERS, WORDS, st.booleans(), st.none()),
    lambda inner: st.one_of(st.lists(inner, max_size=4), st.dictionaries(WORDS, inner, max_size=4)),
    max_leaves=8,
)


def in_words(error: Exception, lines: int = 100) -> None:
    """A refusal is for people."""
    told = str(error).splitlines()
    assert 0 < len(told) <= lines
    assert all(len(line) < 4000 for line in told)


@st.composite
def damaged(draw: Any, sources: "st.SearchStrategy[bytes]") -> bytes:
    """Something right with some bytes changed, taken out, put in, doubled or cut off."""
    data = bytearray(draw(sources))
    for _ in range(draw(st.integers(0, 4))):
        at = draw(st.integers(0, max(0, len(data))))
        size = draw(st.integers(0, 64))
        kind = draw(st.integers(0, 5))
        if kind == 0 and at < len(data):
            data[at] ^= 1 << draw(st.integers(0, 7))
        elif kind == 1:
            del data[at : at + size]
        elif kind == 2:
            data[at:at] = draw(st.binary(max_size=64))
        elif kind == 3:
            data[at : at + 8] = draw(st.sampled_from([b"\xff" * 8, bytes(8), b"\xff" * 7 + b"\x7f", b"\0\0\0\x80" * 2]))
        elif kind == 4:
            data[at:at] = data[at : at + size]
        else:
            del data[at:]
    return bytes(data)


@cache
def messages() -> dict[str, list[bytes]]:
    """Some right messages of each topic."""
    found: dict[str, list[bytes]] = {}
    for tick in exchange(*sides(load("step", [*SHORT, "daq.channels=['flow_pump']"])), 20):
        for out in tick:
            found.setdefault(out.topic, []).append(encode(out.message))
    return {topic: some[:5] for topic, some in found.items()} | {"reset": [b"\0\1\0\0\0"]}


@st.composite
def sent(draw: Any) -> tuple[str, bytes]:
    """A topic, and what may come on it."""
    topic = draw(st.sampled_from(sorted(TOPICS)))
    right = [data for some in messages().values() for data in some] if draw(st.booleans()) else messages().get(topic)
    return topic, draw(st.one_of(st.binary(max_size=200), damaged(st.sampled_from(right or [b""]))))


def decodes(arrived: tuple[str, bytes]) -> None:
    """Whatever comes on a topic is a message, or a ValueError of one line."""
    topic, data = arrived
    try:
        decode(data, topic)
    except ValueError as error:
        in_words(error, 1)


@cache
def plant() -> PlantSide:
    """A plant that goes on from example to example."""
    side = PlantSide(load("step", ["duration=1000"]), 7)
    side.start()
    return side


COMMAND = field_names(TOPICS["command"].type)
COMMANDS = st.one_of(
    st.binary(max_size=80),
    damaged(st.builds(lambda: messages()["command"][0])),
    st.tuples(
        st.sampled_from([7, 8]), *[st.integers(0, 2**64 - 1)] * 2, *[st.integers(-(2**63), 2**63 - 1)] * 2, st.floats()
    ).map(lambda values: encode(ValveCommand(**dict(zip(COMMAND, values, strict=True))))),
)


def commands(data: bytes) -> None:
    """Whatever comes as a command is taken or refused with a reason; the plant's numbers stay finite."""
    side = plant()
    before = side.inlet.accepted + sum(side.inlet.refused.values())
    side.receive(data)
    assert side.inlet.accepted + sum(side.inlet.refused.values()) == before + 1
    side.tick(lean=True)
    assert math.isfinite(side.measurement.position)


FLAT = sorted(name for name, topic in TOPICS.items() if struct_format(topic.type))


@st.composite
def structures(draw: Any) -> tuple[str, tuple[Any, ...]]:
    """A flat message, as a C program fills its struct: any numbers of the right sizes."""
    topic = draw(st.sampled_from([name for name in FLAT if name != "channels"]))
    codes = (struct_format(TOPICS[topic].type) or "")[3:]
    by_code = {"Q": st.integers(0, 2**64 - 1), "q": st.integers(-(2**63), 2**63 - 1), "d": st.floats()}
    return topic, tuple(draw(by_code[code]) for code in codes)


def packs(filled: tuple[str, tuple[Any, ...]]) -> None:
    """The struct that we tell C programs of is the message, bit by bit."""
    import struct

    topic, values = filled
    layout = struct_format(TOPICS[topic].type) or ""
    data = b"\0\1\0\0" + struct.pack(layout.replace("4x", ""), *values)
    message = decode(data, topic)
    assert encode(message) == data


SCENARIOS = st.sampled_from(["step", "pid", "press", "motor", "crane", "load-change", "impingement", "relay"])


@cache
def text_of(name: str) -> bytes:
    """A built-in scenario."""
    from importlib import resources

    return (resources.files("bridge.scenario") / "built_in" / f"{name}.toml").read_bytes()


SECTIONS = (
    *("loop", "daq", "controller", "reference", "rig", "timeline", "fault", "alarm", "safety", "start"),
    *("real_time", "expect", "duration"),
)
KEYS = (
    *("kind", "at", "set", "target", "when", "gain", "step", "delay", "value", "times", "every", "csv", "channels"),
    *("file", "law", "to", "lasts", "name"),
)


@st.composite
def scenario_files(draw: Any) -> tuple[str, bytes]:
    """A scenario with wrong bytes, or a section of it with any values."""
    name = draw(SCENARIOS)
    if draw(st.booleans()):
        return "x.toml", draw(damaged(st.just(text_of(name))))
    section = draw(st.sampled_from(SECTIONS))
    inner = st.dictionaries(st.one_of(st.sampled_from(KEYS), WORDS), VALUES, max_size=4)
    data = {"extends": name, section: draw(st.one_of(inner, VALUES, st.lists(inner, max_size=2)))}
    return "x.json", json.dumps(data).encode()


def scenarios(file: tuple[str, bytes]) -> None:
    """Whatever a file holds is a scenario, or lines for people."""
    name, content = file
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        path.write_bytes(content)
        try:
            load(str(path))
        except ScenarioError as error:
            in_words(error)


@cache
def recording() -> bytes:
    """A short right one."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "r.mcap"
        record_in_process(load("step", SHORT), path)
        return path.read_bytes()


RECORDINGS = damaged(st.builds(recording))


def recordings(content: bytes) -> None:
    """Whatever a file holds can be read and recovered, or is refused in a line; what is recovered is sound."""
    with tempfile.TemporaryDirectory() as folder:
        path, out = Path(folder) / "x.mcap", Path(folder) / "out.mcap"
        path.write_bytes(content)
        try:
            found = read(path)
            describe(found)
            known_or_made(found, found.scenario())
        except UsageError as error:
            in_words(error)
        try:
            recover([path], out)
        except (UsageError, RunError):
            return
        assert not read(out).damage.chunks


@st.composite
def manifests(draw: Any) -> bytes:
    """What may come as the answer of a plant."""
    right = {
        "run_id": "7",
        "mode": "realtime",
        "speed": 1.0,
        "tick": 0,
        "scenario": load("step").model_dump(mode="json"),
    }
    wrong = draw(st.dictionaries(st.sampled_from([*right, "x"]), VALUES, max_size=2))
    return draw(damaged(st.just(json.dumps(right | wrong).encode())))


def introductions(answer: bytes) -> None:
    """Whoever answers as the plant is one, or not, in words."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            file = RunFile(Path(folder) / "x.mcap", told_by(answer, "rig"), Request())
            file.close({})
        except (RunError, ScenarioError) as error:
            in_words(error)


CELLS = st.one_of(NUMBERS.map(str), WORDS)
TABLES = st.one_of(
    damaged(st.just(b"time_s,position_m\n0,0.1\n1,0.12\n2.5,0.1\n")).map(lambda data: data.decode("utf-8", "replace")),
    st.lists(st.tuples(CELLS, st.sampled_from(',;\t\n"'), CELLS).map("".join), max_size=8).map("\n".join),
)


def tables(text: str) -> None:
    """Whatever a table says is a reference, or a line for people."""
    try:
        table = table_from_csv(text)
    except ValueError as error:
        in_words(error, 1)
    else:
        assert all(map(math.isfinite, (*table.times, *table.values)))


NAMES = st.sampled_from(["controller.gain", "rig.load.force", "rig.pump.speed", "reference", "sensor.p2.offset", "x"])
QUERIES = st.one_of(
    st.binary(max_size=100),
    VALUES.map(lambda value: json.dumps(value).encode()),
    st.fixed_dictionaries({"set": st.dictionaries(NAMES, VALUES, max_size=3)}, optional={"over": VALUES}).map(
        lambda value: json.dumps(value).encode()
    ),
    st.fixed_dictionaries(
        {"target": st.sampled_from(["sensor.p2", "link.command", "valve", "rig.pump", "x"]), "kind": WORDS},
        optional={"at": VALUES, "lasts": VALUES, "when": WORDS, "value": VALUES, "name": WORDS},
    ).map(lambda value: json.dumps(value).encode()),
)


def queries(payload: bytes) -> None:
    """Whatever is asked of a plant gets an answer in JSON, or a line for people."""
    side = plant()
    for asked in (set_by, injected_by):
        try:
            json.dumps(asked(payload, side.scenario)(side))
        except (ScenarioError, UsageError) as error:
            in_words(error)
    assert json.loads(listed(side, payload))
    try:
        assert math.isfinite(target_of(payload))
    except ValueError as error:
        in_words(error)
    side.tick(lean=True)


@cache
def player() -> Player:
    """A replay that is never played."""
    return Player(Timeline(list(range(0, 10**9, 10**6)), 0), lambda indices: None)


REMOTE = st.tuples(
    st.sampled_from(["seek", "speed", "faster", "skip", "pause", "resume", "toggle", "step", "status", "x"]), WORDS
)


def remote(asked: tuple[str, str]) -> None:
    """Whatever is asked of a replay is done, or answered with an error."""
    one = player()
    answer = one.ask(*asked)
    one._heed(one._orders.get())
    assert isinstance(answer.result(1.0), dict)


TARGETS: dict[str, tuple[Any, Callable[[Any], None]]] = {
    "decoding": (sent(), decodes),
    "commands": (COMMANDS, commands),
    "structs": (structures(), packs),
    "scenarios": (scenario_files(), scenarios),
    "recordings": (RECORDINGS, recordings),
    "introductions": (manifests(), introductions),
    "tables": (TABLES, tables),
    "queries": (QUERIES, queries),
    "remote": (REMOTE, remote),
}
