"""The panel: who may do what, what a page gets, and a whole session with a run that it starts itself."""

import asyncio
import json
import re
import signal
import socket
import subprocess
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bridge.panel.clients import packed
from bridge.panel.doors import Doors, Guest, doors_for, is_own
from bridge.panel.own_run import Wish
from bridge.panel.picture import picture_of
from bridge.panel.rig import may_operate
from bridge.panel.series import Series, dtype_of, thinned
from bridge.panel.server import application
from bridge.panel.station import Place, Station
from bridge.recording.entries import Entry
from bridge.recording.reader import read
from bridge.scenario import load
from bridge.wire.access import MEMBERS, Role
from bridge.wire.link import Link, free_endpoint
from tests.support.command import hydrotwin_here
from tests.support.processes import COARSE, children, started

websockets = pytest.importorskip("websockets.sync.client")
uvicorn = pytest.importorskip("uvicorn")
pytest.importorskip("starlette")
PATIENT = ("--set", "loop.command_timeout=10 s")  # on a busy machine a controller may wait long for a processor
ADDRESS = re.compile(r"panel at (http://\S+)")


class Page:
    """What a page does, without a browser."""

    def __init__(self, socket: Any) -> None:
        self.socket = socket
        self.told: list[dict[str, Any]] = []

    def hear(self, wanted: Callable[[dict[str, Any]], Any], patience: float = 60.0) -> dict[str, Any]:
        """The next message that is wanted."""
        deadline = time.monotonic() + patience
        while time.monotonic() < deadline:
            self.told.append(json.loads(self.socket.recv(patience)))
            if wanted(self.told[-1]):
                return self.told[-1]
        raise AssertionError(f"not within {patience} s; the last: {str(self.told[-1])[:500]}")

    def ask(self, what: str, **more: Any) -> dict[str, Any]:
        """The answer to an order."""
        self.socket.send(json.dumps({"id": len(self.told), "do": what, **more}))
        return self.hear(lambda told: told["type"] == "answer")

    def event(self, kind: str) -> dict[str, Any]:
        """The next event of a kind."""
        told = self.hear(lambda told: any(event["kind"] == kind for event in told.get("events", [])))
        return next(event for event in told["events"] if event["kind"] == kind)


@contextmanager
def opened(address: str, **headers: str) -> Iterator[Page]:
    """A page of an address."""
    place = address.replace("http", "ws") + "socket"
    with websockets.connect(place, max_size=None, additional_headers=headers) as socket:
        yield Page(socket)


def address_of(panel: "subprocess.Popen[str]") -> Iterator[str]:
    """The addresses that a panel prints."""
    assert panel.stdout is not None
    for line in panel.stdout:
        if found := ADDRESS.search(line):
            yield found[1]
        elif "Ctrl-C" in line:
            return


def test_a_session_with_a_run_of_its_own(tmp_path: Path):
    """Start, change a gain, see what is refused, record, inject a fault, reset, stop: the plant obeys each time."""
    options = ("--scenario", "step", *COARSE, *PATIENT, "--port", "0", "--no-open")
    with started("panel", *options, cwd=tmp_path) as panel:
        (address,) = address_of(panel)
        with opened(address) as page:
            operate(page, panel.pid, tmp_path)
        panel.send_signal(signal.SIGINT)
        panel.wait(10.0)


def operate(page: Page, panel: int, folder: Path) -> None:
    """The session."""
    facts = page.hear(lambda told: told["type"] == "run")
    assert facts["name"] == "step"
    assert_parts(facts["svg"], "moving", "travelled", "chambers")
    numbers = page.hear(lambda told: told["type"] == "numbers")["numbers"]
    gain = next(number for number in numbers if number["name"] == "controller.gain")
    assert gain["unit"] == "V/%"
    assert gain["value"] == pytest.approx(1.0, rel=1e-5)  # as the scenario has it

    recording = page.ask("record")["done"]["recording"]
    page.hear(lambda told: told["type"] == "state" and "recorder" in told["roles"])
    assert page.ask("set", changes={"controller.gain": "1.4 V/%"})["done"]["units"] == {"controller.gain": "1/m"}
    again = page.hear(lambda told: told["type"] == "numbers")["numbers"]
    assert next(n for n in again if n["name"] == "controller.gain")["value"] == pytest.approx(1.4, rel=1e-5)
    refused = page.ask("set", changes={"rig.load.mass": "-3 kg"})["refused"]
    assert "must be at least" in refused

    fault = {"target": "sensor.p2", "kind": "bias", "size": "5 bar"}
    assert page.ask("fault", fault=fault)["done"]["injected"] == "sensor.p2 bias"
    assert page.ask("fault", fault={"end": "sensor.p2 bias"})["done"]["ended"] == "sensor.p2 bias"
    assert "done" in page.ask("reset")
    moved = page.hear(lambda told: told["type"] == "frame" and "state" in told["curves"])["curves"]["state"]["v"]
    assert 0.0 < moved["state.position"][-1] < 270.0  # [mm], the stroke
    assert "a run is going on" in page.ask("start", scenario="sine")["refused"]
    assert "cannot be started from a page" in page.ask("start", scenario="/etc/passwd")["refused"]

    assert "done" in page.ask("stop")
    assert not page.hear(lambda told: told["type"] == "state" and not told["live"])["busy"]
    assert not [c for c in children(panel).values() if "bridge plant" in c or "bridge controller" in c]
    texts = [event.text for event in read(folder / recording).messages("event")]
    assert any(text.startswith("controller.gain = ") for text in texts)
    assert any("injected" in text for text in texts)


@contextmanager
def served(station: Station, doors: Doors, host: str) -> Iterator[str]:
    """A server in a thread of ours; the address of its page on this machine."""
    with socket.create_server(("127.0.0.1", 0)) as listening:
        config = uvicorn.Config(application(station, doors, host), log_level="critical", timeout_graceful_shutdown=1)
        server = uvicorn.Server(config)
        thread = threading.Thread(target=lambda: asyncio.run(server.serve([listening])))
        thread.start()
        try:
            yield f"http://127.0.0.1:{listening.getsockname()[1]}/"
        finally:
            server.should_exit = True
            thread.join(10.0)


def test_over_a_network_a_token_says_who_may_operate(tmp_path: Path):
    """Without one nothing is shown; a watcher's orders are refused, and other pages' sockets."""
    station = Station(Place("nobody", Link(None, free_endpoint(), None, 0.1), Wish("step")), tmp_path, {})
    doors = doors_for("0.0.0.0", watch_only=False)
    tokens = [doors.tokens[who] for who in (Guest.OPERATOR, Guest.WATCHER)]
    with served(station, doors, "0.0.0.0") as here:
        with pytest.raises(urllib.error.HTTPError, match="403"):
            urllib.request.urlopen(here)
        opener = urllib.request.build_opener(urllib.request.HTTPCookieProcessor())
        with opener.open(f"{here}?token={tokens[1]}") as answer:
            assert b"<main>" in answer.read()
            assert "default-src 'self'" in answer.headers["Content-Security-Policy"]
        with opened(here, Cookie=f"hydrotwin={tokens[1]}") as watcher:
            assert watcher.hear(lambda told: told["type"] == "hello")["guest"] == "watcher"
            assert "may only watch" in watcher.ask("reset")["refused"]
        with opened(here, Cookie=f"hydrotwin={tokens[0]}") as operator:
            assert operator.ask("reset")["refused"] == "no plant is running"
        for headers in ({}, {"Cookie": f"hydrotwin={tokens[0]}", "Origin": "http://elsewhere.example"}):
            with pytest.raises(Exception, match="403"), opened(here, **headers):
                pass


def test_on_this_machine_pages_by_other_names_are_refused(tmp_path: Path):
    """A name of somebody else that leads to 127.0.0.1 opens no door: DNS rebinding."""
    station = Station(Place("nobody", Link(None, free_endpoint(), None, 0.1), Wish("step")), tmp_path, {})
    with served(station, doors_for("127.0.0.1", watch_only=False), "127.0.0.1") as here:
        asked = urllib.request.Request(here, headers={"Host": "elsewhere.example"})
        with pytest.raises(urllib.error.HTTPError, match="400"):
            urllib.request.urlopen(asked)
        with urllib.request.urlopen(f"{here}main.js") as answer:
            assert "javascript" in answer.headers["Content-Type"]


def test_on_this_machine_only_its_own_page_may_operate():
    assert doors_for("127.0.0.1", watch_only=False).guest(None) is Guest.OPERATOR
    assert doors_for("::1", watch_only=True).guest(None) is Guest.WATCHER
    assert doors_for("192.0.2.1", watch_only=False).guest(None) is None
    assert list(doors_for("192.0.2.1", watch_only=True).tokens) == [Guest.WATCHER]
    assert is_own("http://localhost:8742", "localhost:8742")
    assert not is_own("http://localhost:8743", "localhost:8742")


def test_the_rights_of_a_network_hold_for_the_panel():
    """Of the roles of `hydrotwin keys` the operator alone may order; on a network without names everybody."""
    assert [role for role in MEMBERS if may_operate(role)] == [Role.OPERATOR]
    assert may_operate(None)
    assert not may_operate("somebody")


def test_thinned_curves_keep_their_peaks_and_their_order():
    """1 kHz in 3 stretches: the one scan at 90 bar is there, before the one at 10 bar."""
    kind = dtype_of("state")
    rows = np.zeros(50, kind)
    rows["stamp"], rows["p1"] = np.arange(50) * 1_000_000, 60e5
    rows["p1"][20], rows["p1"][25] = 90e5, 10e5
    rows["p_lower"] = np.nan
    series = Series(kind, keeps=30)
    taken = series.add([Entry("state", 0, k, b"\0\1\0\0" + row.tobytes()) for k, row in enumerate(rows)])
    points = thinned(taken, ["p1", "p_lower"], 3)
    assert len(points.time) == 6
    assert points.values[2:4, 0] == pytest.approx([90e5, 10e5])
    assert np.isnan(points.values[:, 1]).all()
    assert len(series.between(0.01, 0.02)) == 11
    assert series.add([Entry("state", 0, 0, b"short")]).size == 0


def test_what_is_not_known_goes_out_as_json():
    assert packed("x", {"a": [1.0, float("nan")]}) == '{"type":"x","a":[1.0,null]}'


def test_the_picture_of_a_motor_turns():
    assert_parts(picture_of(load("motor")).svg, "turning")


def assert_parts(svg: str, *moves: str) -> None:
    """All that the page colours and moves is there, under one id each, and nothing of another address."""
    ids = re.findall(r'id="([^"]+)"', svg)
    assert len(ids) == len(set(ids))
    assert {f"drive-{part}.1" for part in (*(f"pipe{line}" for line in range(1, 7)), "spool", *moves)} <= set(ids)
    assert not re.search(r"https?://", svg)


@pytest.mark.parametrize(
    ("words", "said"),
    [(("--host", "192.0.2.1"), "choose another one with --port"), (("--set", "seed=2"), "rig 'rig' runs already")],
)
def test_a_panel_that_cannot_be_is_one_sentence(words: tuple[str, ...], said: str, tmp_path: Path):
    done = hydrotwin_here("panel", "rig", "--port", "8742", *words, cwd=tmp_path)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert said in done.stderr
