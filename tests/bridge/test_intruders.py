"""Intruders on a guarded network: every attempt is refused and counted, and the loop does not notice.

Each attempt is made with a real Zenoh session on loopback: connections without certificate, with a wrong user, password
or key, and without encryption; the controller's own commands again, by one who may only watch and by one who has stolen
the controller's keys; payloads that are too long.
"""

import json
import re
import signal
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from bridge.recording.entries import Entries
from bridge.recording.reader import Recording, read
from bridge.wire.link import free_endpoint
from tests.support.command import hydrotwin_here
from tests.support.processes import COARSE, ENVIRONMENT, LOOSE, ROOT, started, wait_for

CALLERS = (  # a process each; per second
    {"no certificate": 2, "wrong user": 2},
    {"wrong password": 1, "wrong key": 2},
    {"flood": 3},
)
SENDERS = {"viewer replay": 15, "replay": 10, "oversize": 15}
CROWD = (*CALLERS, SENDERS)
ROLES = "plant", "controller", "recorder"
SETTLING = 3.0  # seconds of the loop before anybody comes


class Trial(NamedTuple):
    """What became of it."""

    tried: dict[str, int]
    entered: int
    counted: dict[str, int]  # by the router
    load: float  # processors taken by the intruders
    took: float  # [s]
    recording: Recording


@pytest.fixture(scope="module")
def home(tmp_path_factory) -> Path:
    """Two folders of keys: the rig's, and somebody else's."""
    folder = tmp_path_factory.mktemp("home")
    for name in ("keys", "foreign"):
        assert hydrotwin_here("keys", name, cwd=folder).returncode == 0
    return folder


def trial(home: Path, seconds: float, changes: tuple[str, ...], intruders: bool = True, load: float = 0.0) -> Trial:
    """A loop of three processes through a guarded router, and intruders or a load that does not touch the network."""
    endpoint, path = free_endpoint().replace("tcp/", "tls/"), home / "run.mcap"
    path.unlink(missing_ok=True)
    patient = ("--set", "loop.command_timeout=5 s")
    duration = ("--set", f"duration={round(2 * seconds + 60)}", *patient, *changes, *LOOSE)
    joins = {role: ("--connect", endpoint, "--zenoh-config", f"keys/{role}.json5") for role in ROLES}
    with ExitStack() as stack:
        listening = ("router", "--listen", endpoint, "--zenoh-config", "keys/router.json5")
        router = stack.enter_context(started(*listening, cwd=home))
        loop = [
            ("plant", "step", *duration, *joins["plant"], "--await", "controller", "--await", "recorder"),
            ("controller", "step", *duration, *joins["controller"], "--patience", "30"),
            ("record", "-o", str(path), *joins["recorder"], "--patience", "30"),
        ]
        processes = [stack.enter_context(started(*command, cwd=home)) for command in loop]
        groups = CROWD if intruders else ()
        crowd = [stack.enter_context(crowd_of(home, endpoint, seconds, rates)) for rates in groups]
        crowd += [stack.enter_context(burning(seconds, load / 2)) for _ in range(2 if load else 0)]
        for process in crowd:
            assert process.stdout
            assert process.stdout.readline() == "ready\n"
        wait_for(lambda: path.exists() and path.stat().st_size > 30_000, 60.0)
        for process in crowd:  # all at once
            assert process.stdin
            process.stdin.write("go\n")
            process.stdin.flush()
        told = [json.loads(process.communicate()[0].splitlines()[-1]) for process in crowd]
        assert processes[0].poll() is None, "the loop has ended before they had done all"
        processes[0].send_signal(signal.SIGINT)
        for process in processes:
            assert process.wait(120) == 0, process.communicate()[0]
        router.send_signal(signal.SIGINT)
        said = router.communicate(timeout=20)[0]
    counted = {what: int(number) for number, what in re.findall(r"(\d+) ([a-z ]+?)(?:, |$)", said.splitlines()[-1])}
    tried = {kind: number for one in told for kind, number in one.get("tried", {}).items()}
    used = sum(one["processor"] / one["took"] for one in told)
    took = max((one["took"] for one in told), default=0.0)
    return Trial(tried, sum(one.get("entered", 0) for one in told), counted, used, took, read(path))


def crowd_of(home: Path, endpoint: str, seconds: float, rates: dict[str, int]) -> subprocess.Popen[str]:
    specs = [f"{kind}={rate}" for kind, rate in rates.items()]
    module = ("tests.support.intruders", "keys", "foreign", endpoint, str(seconds), *specs)
    return _python(home, "-m", *module)


BURN = """
import json, sys, time
seconds, share = map(float, sys.argv[1:])
print("ready", flush=True)
sys.stdin.readline()
began, used = time.monotonic(), time.process_time()
while (now := time.monotonic()) - began < seconds:
    while time.monotonic() - now < 0.02 * share:
        pass
    time.sleep(0.02 * (1.0 - share))
print(json.dumps({"processor": time.process_time() - used, "took": time.monotonic() - began}), flush=True)
"""


def burning(seconds: float, share: float) -> subprocess.Popen[str]:
    """A process that takes a share of a processor and knows no network."""
    return _python(ROOT, "-c", BURN, str(seconds), str(share))


def _python(cwd: Path, *arguments: str) -> subprocess.Popen[str]:
    command, pipe = [sys.executable, *arguments], subprocess.PIPE
    return subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True, cwd=cwd, env=ENVIRONMENT)


def assert_refused(found: Trial, attempts: int) -> None:
    """Every attempt, by who counts it. Who gives up before it has told its name has shown no certificate either."""
    tried, summary = found.tried, found.recording.metadata["summary"]
    assert sum(tried.values()) == attempts
    assert found.entered == 0
    counted = found.counted
    callers = sum(tried[kind] for group in CALLERS for kind in group)
    assert sum(number for what, number in counted.items() if what.endswith("connection refused")) == callers
    assert min(counted[f"{what} connection refused"] for what in ("certificate", "user", "password")) > 0
    assert counted["message without the right"] == tried["viewer replay"] + tried["oversize"]
    assert summary["commands"]["refused"] == {"out of order": tried["replay"]}
    assert summary["ending"].startswith("interrupted after")  # by us, when all was tried
    assert summary["safe_states"] == 0
    assert summary["lost"] == {}


def lateness(recording: Recording) -> float:
    """The 99th percentile of the ticks' lateness [s] after the start."""
    timing = recording.columns("timing")
    return float(np.percentile(timing["lateness"][timing["stamp"] > SETTLING * 1e9], 99)) * 1e-9


@pytest.mark.timed
def test_every_attempt_is_refused_and_counted(home):
    assert_refused(trial(home, 3.0, COARSE), 150)


@pytest.mark.endurance
@pytest.mark.timeout(900)
def test_ten_thousand_attempts_do_not_delay_the_loop(home):
    """1 kHz; compared with the same load by processes that do not touch the network."""
    attacked = trial(home, 200.0, ())
    assert_refused(attacked, 10_000)
    alone = trial(home, 200.0, (), intruders=False, load=attacked.load)
    ours, theirs = lateness(attacked.recording), lateness(alone.recording)
    words = f"p99 {ours * 1e3:.3f} ms, without network {theirs * 1e3:.3f} ms"
    rate = sum(attacked.tried.values()) / attacked.took
    print(f"{rate:.1f} attempts per second, load {attacked.load:.2f} processors; lateness {words}")
    assert ours <= 2.0 * theirs


def test_a_trial_would_see_somebody_who_got_in():
    """What a test of refusals must not be: one that passes whatever is counted."""
    tried: Any = {kind: 1 for group in CROWD for kind in group}
    nothing = Recording(Path(), Entries(), {"summary": {"commands": {"refused": {}}}}, True, {})
    with pytest.raises(AssertionError):
        assert_refused(Trial(tried, 1, {}, 0.0, 0.0, nothing), 8)
