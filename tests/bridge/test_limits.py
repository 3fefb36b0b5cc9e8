"""Limits on what arrives: each is reached, what is too much is counted, and the loop does not notice."""

import threading
from typing import Any

import pytest
import zenoh

from bridge.machine.refusals import kind_of
from bridge.recording.reader import read
from bridge.wire import limits
from bridge.wire.bus import Bus
from bridge.wire.codec import decode
from bridge.wire.intake import Desk, Door, Turned, Waiting
from bridge.wire.limits import IN_A_ROW, MESSAGE, TOKENS, WAITING_QUERIES, Excess, command_rate
from bridge.wire.link import Link, free_endpoint, open_session
from bridge.wire.status import TURNED, counts, numbers_of
from tests.support.processes import COARSE, LOOSE, ROOT, started, wait_for

BLOCK = zenoh.CongestionControl.BLOCK


class Clock:
    """Time that stands still until it is moved [ns]."""

    def __init__(self) -> None:
        self.now = 0

    def __call__(self) -> int:
        return self.now


@pytest.mark.parametrize("rate", [10.0, 1000.0, 20_000.0])
def test_a_door_lets_in_its_rate_and_what_an_overrun_has_held_up(rate):
    """In T seconds of a flood: rate (T + IN_A_ROW), and one."""
    clock, turned, seconds = Clock(), Turned(), 3
    door = Door("command", turned, rate, now=clock)
    admitted = 0
    for instant in range(seconds * 100 + 1):  # at each of them more than the rate allows
        clock.now = instant * 10_000_000
        admitted += sum(door.admits(10) for _ in range(round(rate / 20) + 2))
    first = min(rate * IN_A_ROW, round(rate / 20) + 2)
    assert first < admitted <= rate * (seconds + IN_A_ROW) + 1
    assert turned.counts() == {"command too often": (seconds * 100 + 1) * (round(rate / 20) + 2) - admitted}


def test_at_its_rate_everything_comes_in_however_it_is_bunched():
    """A second's worth at once, then nothing for a second, and so on."""
    clock, turned = Clock(), Turned()
    door = Door("measurement", turned, 1000.0, now=clock)
    for second in range(5):
        clock.now = second * 1_000_000_000
        assert all(door.admits(10) for _ in range(1000))
    assert turned.counts() == {}


def test_a_message_that_is_too_long_is_counted_and_not_charged():
    turned = Turned()
    door = Door("status", turned, 1.0, now=Clock())
    assert not any(door.admits(MESSAGE + 1) for _ in range(7))
    assert door.admits(MESSAGE)
    assert turned.counts() == {"status too long": 7}


def test_a_queue_that_is_full_drops_and_counts():
    turned = Turned()
    waiting = Waiting("command", turned, 3)
    for number in range(5):
        waiting.put(number)
    assert [waiting.get_nowait() for _ in range(3)] == [0, 1, 2]
    assert turned.counts() == {"command too many waiting": 2}


def test_a_plant_takes_ten_times_the_commands_of_its_scenario():
    assert command_rate(0.001, 1.0) == 10_000.0
    assert command_rate(0.01, 20.0) == 20_000.0
    assert command_rate(0.1, 1.0) == 1000.0


class Query:
    """What Zenoh hands over."""

    def __init__(self, payload: bytes = b"") -> None:
        self.payload: Any = zenoh.ZBytes(payload)
        self.answers: list[bytes] = []

    def reply(self, key: str, answer: bytes) -> None:
        self.answers.append(answer)

    def reply_err(self, answer: bytes) -> None:
        self.answers.append(b"error: " + answer)


def test_few_queries_wait_and_the_others_are_told_so():
    turned, go = Turned(), threading.Event()
    desk = Desk("scenario", turned, "rig/scenario", lambda payload: b"late" if go.wait(10) else b"")
    queries = [Query() for _ in range(WAITING_QUERIES + 10)]
    desk.take(queries[0])
    wait_for(lambda: desk._waiting.empty(), 5.0)  # the first is being answered
    for query in queries[1:]:
        desk.take(query)
    go.set()
    wait_for(lambda: sum(query.answers == [b"late"] for query in queries) == WAITING_QUERIES + 1, 5.0)
    assert sum(query.answers == [b"error: refused: too many wait"] for query in queries) == 9
    assert turned.counts() == {"scenario too many waiting": 9}
    desk.close()


def test_a_query_that_fails_does_not_end_the_answers():
    turned = Turned()
    desk = Desk("scenario", turned, "rig/scenario", lambda payload: bytes([100 // len(payload)]))
    bad, good, long = Query(), Query(b"12"), Query(b"x" * (limits.QUERY + 1))
    for query in (bad, long, good):
        desk.take(query)
    wait_for(lambda: good.answers, 5.0)
    assert good.answers == [b"2"]
    assert bad.answers == [b"error: failed: ZeroDivisionError: integer division or modulo by zero"]
    assert long.answers == [b"error: refused: too long, or too many in a second"]
    assert turned.counts() == {"scenario unreadable": 1, "scenario too long": 1}
    desk.close()


def test_signs_of_life_of_a_crowd_are_not_all_remembered():
    endpoint = free_endpoint()
    with (
        Bus(Link(endpoint, None, None, 5.0), "rig", "plant", blocking=False) as bus,
        open_session(Link(None, endpoint, None, 5.0)) as crowd,
    ):
        bus.watch()
        tokens = [crowd.liveliness().declare_token(f"rig/alive/recorder/{pid}") for pid in range(TOKENS + 5)]
        assert wait_for(lambda: bus.turned.counts(), 10.0)
        wait_for(lambda: bus.turned.counts()["sign of life too many waiting"] == 5, 5.0)
        assert len(bus.present["recorder"]) == TOKENS
        for token in tokens:
            token.undeclare()
        wait_for(lambda: not bus.present["recorder"], 5.0)


def test_a_plant_and_its_recorder_count_what_they_turn_away(tmp_path):
    """Long commands, and resets in a row; the summary of the recording names them, and the run is complete."""
    endpoint, path = free_endpoint(), tmp_path / "run.mcap"
    plant = ("plant", "step", "--listen", endpoint, *COARSE, *LOOSE, "--set", "duration=4", "--await", "recorder")
    record = ("record", "--connect", endpoint, "--output", str(path))
    with started(*plant) as running, started(*record) as recorder, open_session(Link(None, endpoint, None, 20.0)) as s:
        statuses: list[Any] = []
        heard = s.declare_subscriber("rig/status", lambda sample: statuses.append(sample.payload.to_bytes()))
        wait_for(lambda: statuses, 30.0)
        for _ in range(50):
            s.put("rig/command", b"x" * (MESSAGE + 1), congestion_control=BLOCK)
            s.put("rig/reset", b"", congestion_control=BLOCK)
        for process in (running, recorder):
            assert process.wait(60) == 0, process.communicate()[0]
        heard.undeclare()
    last = [numbers_of(message) for raw in statuses if (message := decode(raw, "status")).role == "plant"][-1]
    turned = counts(TURNED, last)
    assert turned["command too long"] == 50
    assert 1 <= turned["reset too often"] <= 40
    summary = read(path).metadata["summary"]
    assert summary["turned_away"]["plant: command too long"] == 50
    assert summary["turned_away"]["recorder: command too long"] == 50
    assert summary["ending"] == "complete after 400 ticks"


@pytest.mark.parametrize(
    ("line", "kind"),
    [
        (b"WARN acc-0 zenoh_link_tls::unicast: invalid peer certificate: BadSignature.", ("certificate", True)),
        (b"DEBUG zenoh_transport::unicast::establishment::accept: UsrPwd. Invalid password. at", ("password", True)),
        (b"DEBUG zenoh_transport::unicast::establishment::accept: UsrPwd. Invalid user. at", ("user", True)),
        (b"DEBUG zenoh_transport::unicast::establishment::accept: Max transports", ("peer", True)),
        (b"DEBUG zenoh_transport::unicast::establishment::accept: New transport link accepted from", ("", False)),
        (b"TRACE zenoh::net::routing::interceptor: Msg intercepted!", ("message", True)),
        (b"TRACE zenoh::net::routing::interceptor: New", ("", False)),
        (b"hydrotwin: routing on tls/127.0.0.1:7447", None),
    ],
)
def test_a_line_of_zenoh_s_log_says_what_was_refused(line, kind):
    found = kind_of(line)
    assert (found and (found[0], isinstance(found[1], Excess))) == kind


def test_every_limit_stands_in_the_documents():
    """docs/security.md lists them with their values."""
    text = (ROOT / "docs" / "security.md").read_text().replace(" ", "")
    for value in (limits.FRAME, limits.MESSAGE, limits.TOKENS, limits.WAITING_COMMANDS, limits.WAITING_RECORDS):
        assert f"|{value}" in text, value
    for value in (*limits.RATES.values(), limits.FASTEST, limits.QUERY_RATE, limits.WAITING_QUERIES, *limits.PEERS[:2]):
        assert f"|{round(value)}" in text, value
