"""Numbers set over the bus while a loop runs: listed, changed, watched, recorded, and handed in again by a replay."""

import json
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bridge.recording.reader import read
from bridge.replay.through import Through, replay_through
from bridge.wire.link import Link, free_endpoint, open_session
from tests.support.command import hydrotwin_here
from tests.support.processes import ROOT, UNDRAWN, started, wait_for

RANGES = {
    "rig.load.force": (-500.0, 500.0),
    "rig.pump.speed": (15.0, 22.0),
    "sensor.p2.offset": (-1e5, 1e5),
    "controller.gain": (0.1, 1.0),
    "controller.derivative": (0.0, 0.003),
    "reference": (0.05, 0.2),
}
JOYSTICK = (ROOT / "docs/timeline.md").read_text(encoding="utf-8").partition("```python\n")[2].partition("```")[0]
SET = "rig/parameters/set"


def asked(session: Any, key: str, payload: str) -> dict[str, Any] | None:
    """The answer to a query; None without one."""
    for reply in session.get(key, payload=payload, timeout=5.0):
        if reply.ok is not None:
            return json.loads(reply.ok.payload.to_bytes())
    return None


def replayed(path: Path) -> None:
    """Both ways, with residual 0."""
    for into in ("plant", "controller"):
        verdict = replay_through(path, Through(into, path.with_name(f"{into}.mcap"), alone=True))
        assert verdict.events_differ is None
        assert {difference.greatest for difference in verdict.differences} == {0.0}


def test_numbers_of_a_run_are_set_and_come_out_again(tmp_path: Path):
    """By the verbs, and a hand on the reference by another program; the pages of the docs say the same."""
    endpoint, path = free_endpoint(), tmp_path / "run.mcap"
    live = ("reference.kind=live", "reference.value=100 mm", "reference.rate=0.5 m/s", "expect=[]")
    changes = [f"--set={change}" for change in (*live, "duration=60", "loop.sample_period=2 ms")]
    connect = ("--connect", endpoint)
    run = ("run", "step", "--mode", "lockstep", "--listen", endpoint, "--record", str(path), *changes, *UNDRAWN)
    with started(*run) as process:
        listed = wait_for(lambda: hydrotwin_here("get", "rig", "--json", *connect, cwd=tmp_path).stdout, 60)
        assert len(json.loads(listed)["parameters"]) > 80
        done = hydrotwin_here("set", "rig", "controller.gain=0.5", "rig.load.force=100 N", *connect, cwd=tmp_path)
        assert "controller.gain = 18.5" in done.stdout, done
        assert hydrotwin_here("set", "rig", "rig.load.force=-50 N", "--over=0.1 s", *connect, cwd=tmp_path).stdout
        for change, said in (
            ("rig.load.mass=1 g", "swings too fast"),
            ("rig.load.mas=1", "did you mean 'rig.load.mass'"),
        ):
            done = hydrotwin_here("set", "rig", change, *connect, cwd=tmp_path)
            assert (done.returncode, said in done.stderr) == (2, True), done
        with open_session(Link(None, endpoint, None, 5.0)) as session:
            session.put("rig/target", b"\xff nonsense")
        exec(JOYSTICK.replace("tcp/127.0.0.1:7447", endpoint), {})
        process.send_signal(2)
        process.wait(60)
    recording = read(path)
    told = [event.text for event in recording.messages("event") if event.kind == "changed"]
    assert sum(text.startswith("reference = 0.1") for text in told) > 20
    assert "rig.load.force = -50.0 over 100000000 ns" in told
    replayed(path)


@pytest.mark.endurance
@pytest.mark.timeout(600)
def test_a_thousand_live_changes_in_lockstep_come_out_again(tmp_path: Path):
    """At random times of a run of 20 s by three processes, each change by a query of its own."""
    endpoint, path, answers = free_endpoint(), tmp_path / "run.mcap", []
    ended = threading.Event()

    def tune() -> None:
        rng = np.random.default_rng(1)
        with open_session(Link(None, endpoint, None, 60.0)) as session:
            while len(answers) < 1000 and not ended.is_set():
                name = str(rng.choice([*RANGES]))
                wanted = {"set": {name: float(rng.uniform(*RANGES[name]))}, "over": float(rng.choice([0.0, 0.02]))}
                answer = asked(session, SET, json.dumps(wanted))
                if answer is not None and "set" in answer:
                    answers.append(answer)
                ended.wait(float(rng.exponential(0.005)))

    run = ("run", "square", "--mode", "lockstep", "--duration", "60", "--listen", endpoint, "--record", str(path))
    with started(*run, *UNDRAWN) as process:
        hand = threading.Thread(target=tune)
        hand.start()
        process.wait(300)
        ended.set()
        hand.join()
    told = [event for event in read(path).messages("event") if event.kind == "changed"]
    print(f"{len(answers)} changes taken, {len(told)} recorded")
    assert len(told) == len(answers) == 1000
    replayed(path)
