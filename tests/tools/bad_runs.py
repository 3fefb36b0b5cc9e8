"""Runs that are not good, each in process, in lockstep and in real time: exit code and the first line of what is said.

`python -m tests.tools.bad_runs [NAME...]` prints the table; a traceback, an exit code other than the one stated, or an
output without the word that helps is marked. In real time a busy machine may be named, too: lateness is allowed for.
"""

import socket
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import chain
from pathlib import Path
from typing import NamedTuple

from tests.support.processes import LOOSE, hydrotwin

MODES = ("inprocess", "lockstep", "realtime")
LAW = "def law(sample, target, memory, gains):\n    {}\n"
BY_LAW = ("--set", "controller.kind=python", "--set", "controller.law=./mine.py:law")
LONGEST = 300.0  # [s], of a command on a machine that others use, too
OWN = 'extends = "step"\nduration = "0.3 s"\nexpect = [{}]\n'
TIGHT = ("rig.relief.kind=none", "rig.pump.efficiency_pressure=1e15")
Done = subprocess.CompletedProcess[str]


class BadRun(NamedTuple):
    """One mistake, and what must come of it."""

    words: tuple[str, ...]  # of the command
    code: int
    says: str  # part of the line that is read first
    files: tuple[tuple[str, str], ...] = ()


def by_law(body: str, code: int, says: str, head: str = "") -> BadRun:
    """A run by a law of the user's."""
    return BadRun(("run", "step", *BY_LAW), code, says, (("mine.py", head + LAW.format(body)),))


def changed(verb: str, *changes: str, code: int = 2, says: str = "") -> BadRun:
    """The scenario `step` with changes."""
    return BadRun((verb, "step", *(word for change in changes for word in ("--set", change))), code, says)


def checked(band: str, code: int, says: str) -> BadRun:
    """A check of a scenario with these bands."""
    return BadRun(("check", "own.toml"), code, says, (("own.toml", OWN.format(band)),))


BAD_RUNS = {
    "every command refused: a law answers 3.0": by_law("return 3.0, memory", 1, "out of range"),
    "a law answers NaN": by_law("return float('nan'), memory", 1, "not finite"),
    "a law raises": by_law("return 1 / 0, memory", 1, "mine.py, line 2: ZeroDivisionError"),
    "a law that is checked raises": by_law("return 1 / 0, memory", 1, "mine.py, line 2: ZeroDivisionError")._replace(
        words=("check", "step", *BY_LAW)
    ),
    "a law ends Python when imported": by_law("return 0.0, memory", 2, "SystemExit", "import sys\nsys.exit(0)\n"),
    "a law ends Python when called": by_law("raise SystemExit(0)", 1, "SystemExit"),
    "no band": checked("", 1, "states no band"),
    "a band without unit: overshoot <= 5": checked('"overshoot <= 5"', 2, "500 %"),
    "a band beyond the run": checked('"rms error from 3 s to end <= 5 mm"', 2, "3 s"),
    "a unit forgotten: loop.delay=10": changed("check", "loop.delay=10", code=1, says="loop.delay is 10 s"),
    "a unit forgotten: reference.end=160": changed("run", "reference.end=160", "reference.at=0.1 s", says="stroke"),
    "a reference beyond the stroke": changed(
        "run", "reference.end=300 mm", "reference.at=0.1 s", code=0, says="stroke"
    ),
    "no circuit: a pump that leaks nothing, checked": changed("check", *TIGHT, code=2, says="outlet"),
    "no relief valve, a tight pump": changed("run", *TIGHT, says="outlet"),
}


def first_line(done: Done, says: str = "") -> str:
    """The line that gives the reason, or the first one."""
    lines = [" ".join(line.split()) for line in (done.stderr + "\n" + done.stdout).splitlines() if line.strip()]
    judged = [line for line in lines if (says and says in line) or (not says and "FAILED" in line)]
    return next(iter([*judged, *lines]), "")


def run_in(bad: BadRun, mode: str) -> Done:
    """The run in a folder of its own."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in bad.files:
            Path(folder, name).write_text(text)
        kept = ("--record", "a.mcap") if bad.words[0] == "run" else ("-o", "out")
        short = () if bad.files and bad.files[0][0] == "own.toml" else ("--set", "duration=0.3 s")
        loose = LOOSE if mode == "realtime" else ()
        return hydrotwin(*bad.words, *short, "--mode", mode, *kept, *loose, cwd=Path(folder), timeout=LONGEST)


def wrong(bad: BadRun, done: Done) -> list[str]:
    """What is not as it must be."""
    text = done.stdout + done.stderr
    faults = ["a traceback"] if "Traceback" in text else []
    if done.returncode != bad.code:
        faults.append(f"exit code {done.returncode}, not {bad.code}")
    return faults if bad.says in text else [*faults, f"does not say {bad.says!r}"]


def two_checks(mode: str) -> tuple[Done, Done]:
    """Two scenarios of one name checked at once into one folder: the one that misses its band, and the good one."""
    with tempfile.TemporaryDirectory() as folder:
        for name, band in (("bad", ">= 210 mm"), ("good", "<= 170 mm")):
            Path(folder, name).mkdir()
            Path(folder, name, "own.toml").write_text(OWN.format(f'"greatest position {band}"'))
        loose = LOOSE if mode == "realtime" else ()

        def check(name: str) -> Done:
            words = ("check", f"{name}/own.toml", "--mode", mode, "-o", "out", *loose)
            return hydrotwin(*words, cwd=Path(folder), timeout=LONGEST)

        with ThreadPoolExecutor(2) as pool:
            bad, good = pool.map(check, ("bad", "good"))
        return bad, good


def address_taken(mode: str) -> tuple[Done, str]:
    """A run whose address somebody else has, where an earlier recording lies; the run, and the earlier scenario."""
    with tempfile.TemporaryDirectory() as folder, socket.create_server(("127.0.0.1", 0)) as server:
        earlier = ("run", "sine", "--mode", "inprocess", "--duration", "0.2 s", "--record", "a.mcap", "--json", "-")
        hydrotwin(*earlier, cwd=Path(folder))
        taken = f"tcp/127.0.0.1:{server.getsockname()[1]}"
        words = ("run", "step", "--mode", mode, "--duration", "0.2 s", "--listen", taken, "--record", "a.mcap")
        return hydrotwin(*words, "--json", "-", cwd=Path(folder), timeout=LONGEST), '"sine"'


def rows(names: Sequence[str]) -> Iterator[tuple[str, str, Done, list[str]]]:
    """Name and mode of each run, how it ended, and what is not as it must be."""
    for name in names or BAD_RUNS:
        for mode in MODES:
            done = run_in(BAD_RUNS[name], mode)
            yield name, mode, done, wrong(BAD_RUNS[name], done)


def pairs() -> Iterator[tuple[str, str, Done, list[str]]]:
    """The same of what takes more than one command."""
    for mode in MODES:
        bad, good = two_checks(mode)
        faults = (
            [] if (bad.returncode, good.returncode) == (1, 0) else [f"exit codes {bad.returncode}, {good.returncode}"]
        )
        yield "two checks at once, one bad", mode, bad, faults
    for mode in MODES[1:]:
        done, earlier = address_taken(mode)
        faults = ["exit code 0"] if done.returncode == 0 else []
        yield "the address is taken", mode, done, [*faults, "earlier run shown"] if earlier in done.stdout else faults


def main(names: Sequence[str]) -> int:
    """Print the table; 1 where something is not as it must be."""
    print("| run | mode | exit code | says |\n|---|---|---|---|")
    failed = 0
    for name, mode, done, faults in rows(names) if names else chain(rows(()), pairs()):
        mark = "".join(f" **{fault}**" for fault in faults)
        says = BAD_RUNS[name].says if name in BAD_RUNS else ""
        print(
            f"| {name} | {mode} | {done.returncode} | {first_line(done, says)[:150]}{mark} |",
            flush=True,
        )
        failed += bool(faults)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
