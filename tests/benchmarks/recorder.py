"""Writing and reading recordings, beside the bare library."""

import time
from collections.abc import Iterator
from pathlib import Path

from mcap.writer import CompressionType, Writer

from bridge.loop.exchange import exchange, sides
from bridge.processes.options import RunOptions
from bridge.processes.recorder.order import Order
from bridge.recording.reader import read
from bridge.recording.writer import RecordingWriter
from bridge.runs.run import run_scenario
from bridge.scenario import load
from bridge.wire.codec import encode
from bridge.wire.messages import TOPICS, Mode
from tests.benchmarks.plant import Row


def rows(folder: Path) -> Iterator[Row]:
    """The same messages of 10 s through our recorder's writing path and through a bare writer."""
    scenario = load("step", ["duration=10"])
    sent = [m for tick in exchange(*sides(scenario), scenario.ticks) for m in tick]
    messages = [(m.topic, m.log_time, m.sequence, encode(m.message)) for m in sent]
    ours = _timed(lambda: _ours(folder / "ours.mcap", scenario, messages))
    bare = _timed(lambda: _bare(folder / "bare.mcap", messages))
    size = (folder / "ours.mcap").stat().st_size * 6 / 1e6
    yield _row("writing a recording, in order", len(messages), ours, bare, "bare mcap writer")
    reading = _timed(lambda: read(folder / "ours.mcap"))
    yield "reading it back", f"{len(messages) / reading:,.0f} messages/s", f"{10 / reading:.0f} x real time", ""
    yield "size of a recording", f"{size:.1f} MB a minute", "", ""
    changes = ["duration=20", "loop.sample_period=0.001", "real_time.overruns=1.0", "real_time.length=10"]
    run = RunOptions(Mode.REALTIME, folder / "run.mcap")
    lost = sum(run_scenario(load("step", changes), run).plain()["lost"].values())
    facts = read(folder / "run.mcap", ()).metadata["recorder"]
    yield "recorder beside a loop at 1 kHz", f"{100 * facts['processor_share']:.1f} % of a core", f"{lost} lost", ""


def _ours(path: Path, scenario, messages) -> None:
    writer, order = RecordingWriter(path, "rig"), Order(scenario.loop.grid())
    for message in messages:
        for entry in order.add(*message):
            writer.write(*entry)
            writer.flush_by(entry[1])
    for entry in order.rest():
        writer.write(*entry)
    writer.close()


def _bare(path: Path, messages) -> None:
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=1024 * 1024, compression=CompressionType.ZSTD)
        writer.start()
        schema = writer.register_schema("x", "", b"")
        channels = {name: writer.register_channel(name, "cdr", schema) for name in TOPICS}
        for topic, log_time, sequence, payload in messages:
            writer.add_message(channels[topic], log_time, payload, log_time, sequence)
        writer.finish()


def _timed(action) -> float:
    best = float("inf")
    for _ in range(3):
        start = time.perf_counter()
        action()
        best = min(best, time.perf_counter() - start)
    return best


def _row(words: str, count: int, ours: float, bare: float, beside: str) -> Row:
    return words, f"{count / ours:,.0f} messages/s", f"{count / bare:,.0f} {beside}", f"{bare / ours:.2f}"
