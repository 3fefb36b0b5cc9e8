"""The priority of the loop's processes, as the kernel says it."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from bridge.machine import priority
from bridge.machine.priority import ORDINARY, Priority, stand_back, take
from bridge.recording.reader import read
from tests.support.processes import COARSE, ENVIRONMENT, LOOSE, UNDRAWN, hydrotwin

GRANTED = (
    subprocess.run([sys.executable, "-c", "import os; os.sched_setscheduler(0, 1, os.sched_param(30))"]).returncode == 0
)
needs_fifo = pytest.mark.skipif(not GRANTED, reason="SCHED_FIFO is refused here: root or `ulimit -r 30` has it")
needs_two = pytest.mark.skipif(len(os.sched_getaffinity(0)) < 2, reason="auto wants two processors")


def in_a_process(code: str) -> str:
    """Standard output and error of Python code in a process of its own: priorities are not to be kept here."""
    head = (
        "import os, sys, threading, time\nfrom bridge.machine import priority\nfrom bridge.machine.priority import *\n"
    )
    head += "def now(thread): return os.sched_getscheduler(thread) & ~os.SCHED_RESET_ON_FORK\n"
    low = "priority.FIFO_PRIORITY = 1\n"  # so that a loop beside this test has the processor first
    command = [sys.executable, "-c", head + low + code]
    done = subprocess.run(command, capture_output=True, text=True, timeout=30, env=ENVIRONMENT)
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


@needs_fifo
def test_every_thread_that_is_there_gets_it_and_what_they_start_is_ordinary():
    found = in_a_process(
        "def policy(): found.append(now(threading.get_native_id()))\n"
        "def early(): go.wait(); policy()\n"
        "found, go = [], threading.Event()\n"
        "threads = [threading.Thread(target=early)]; threads[0].start()\n"
        "take(Priority.FIFO, True); threads.append(threading.Thread(target=policy)); threads[1].start(); go.set()\n"
        "[thread.join() for thread in threads]; policy()\n"
        "print(sorted(found) == [os.SCHED_OTHER, os.SCHED_FIFO, os.SCHED_FIFO])"
    )
    assert "True" in found


@needs_fifo
def test_who_computes_without_a_pause_gives_it_back_and_says_so():
    found = in_a_process(
        "priority.GREEDY = 200_000; take(Priority.FIFO, True); end = time.monotonic() + 10\n"
        "while now(0) == os.SCHED_FIFO and time.monotonic() < end: pass\n"
        "print(now(0) == os.SCHED_OTHER)"
    )
    assert "True" in found
    assert "SCHED_FIFO is given back" in found


@needs_fifo
def test_a_program_that_it_starts_may_compute_as_long_as_it_likes():
    found = in_a_process(
        "import subprocess; priority.GREEDY = 200_000; take(Priority.FIFO, True)\n"
        "busy = 'import time\\nwhile time.process_time() < 0.6: pass'\n"
        "print('ended with', subprocess.run([sys.executable, '-c', busy]).returncode)"
    )
    assert "ended with 0" in found


@needs_fifo
def test_it_is_given_back_before_a_limit_of_the_system_kills():
    found = in_a_process(
        "import resource; resource.setrlimit(resource.RLIMIT_RTTIME, (300_000, 300_000))\n"
        "take(Priority.FIFO, True); end = time.process_time() + 0.5\n"
        "while time.process_time() < end: pass\n"
        "print(now(0) == os.SCHED_OTHER)"
    )
    assert "True" in found


@needs_fifo
def test_who_pauses_keeps_it():
    found = in_a_process(
        "priority.GREEDY = 200_000; take(Priority.FIFO, True); end = time.process_time() + 0.6\n"
        "while time.process_time() < end:\n"
        "    until = time.process_time() + 0.05\n"
        "    while time.process_time() < until: pass\n"
        "    time.sleep(0.001)\n"
        "print(now(0) == os.SCHED_FIFO)"
    )
    assert "True" in found
    assert "given back" not in found


@pytest.mark.parametrize(("asked", "is_paced"), [(Priority.ORDINARY, True), (Priority.AUTO, False)])
def test_ordinary_is_left_as_it_was(asked: Priority, is_paced: bool):
    before = os.sched_getscheduler(0)
    assert take(asked, is_paced) == ORDINARY
    assert os.sched_getscheduler(0) == before


@pytest.mark.parametrize("asked", [Priority.AUTO, Priority.FIFO])
def test_what_is_refused_is_told_to_whoever_has_asked_for_it(
    asked: Priority, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    def refused(*_: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "sched_setscheduler", refused)
    monkeypatch.setattr(priority, "_processors", lambda: 2)
    assert take(asked, is_paced=True) == ORDINARY
    assert ("SCHED_FIFO refused" in capsys.readouterr().err) == (asked == Priority.FIFO)


def test_one_processor_is_left_to_others(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(priority, "_processors", lambda: 1)
    assert take(Priority.AUTO, is_paced=True) == ORDINARY


@needs_fifo
@needs_two
def test_a_recorder_comes_behind_the_loop_and_before_all_else():
    """And not by SCHED_FIFO, of which the kernel gives all together 95 % of a processor."""
    found = in_a_process(
        "def nices(): return {os.getpriority(os.PRIO_PROCESS, int(t)) for t in os.listdir('/proc/self/task')}\n"
        "threading.Thread(target=time.sleep, args=(0.5,)).start()\n"
        "take_behind(Priority.AUTO, True); print(nices(), now(0) == os.SCHED_OTHER)\n"
        "ease(); print(nices())"
    )
    assert found.split() == [f"{{{priority.EAGER}}}", "True", "{0}"]


@pytest.mark.parametrize("is_granted", [True, False])
def test_who_only_listens_is_nicer_only_where_the_loop_has_no_right_of_way(
    is_granted: bool, monkeypatch: pytest.MonkeyPatch
):
    asked: list[int] = []

    def schedule(*_: object) -> None:
        if not is_granted:
            raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "sched_setscheduler", schedule)
    monkeypatch.setattr(os, "nice", asked.append)
    stand_back()
    assert asked == ([] if is_granted else [priority.YIELDING])


@needs_fifo
@needs_two
@pytest.mark.timed
def test_a_run_says_what_was_granted_and_so_does_its_recording(tmp_path: Path):
    file = tmp_path / "a.mcap"
    words = ("run", "step", "--duration", "0.2 s", "--record", str(file), *COARSE, *LOOSE, *UNDRAWN)
    found = [json.loads(hydrotwin(*words, *how).stdout)["priority"] for how in ((), ("--priority", "ordinary"))]
    assert found[0].startswith("SCHED_FIFO 30")
    assert read(file).metadata["run"]["host"]["priority"] == found[1] == ORDINARY
