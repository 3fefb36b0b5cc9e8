"""Compile what the suite's tests share: `python -m tests.support.warm PART`.

Done once before the workers start, a part in each of two processes; all of them then find it in the cache. A kernel
that only one file of tests calls is left to that file.
"""

import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

import numpy as np

DRIVES = ("ehla", "press", "crane", "test-cylinder", "motor")  # built-in, each with kinds of its own


def plant() -> None:
    """The circuit as every built-in scenario of the thesis's rig has it."""
    from bridge.scenario import names

    _run([name for name in names() if name not in DRIVES])


def drives() -> None:
    """The circuits of the other built-in drives."""
    _run(DRIVES)


def _run(names: Iterable[str]) -> None:
    from bridge.runs.in_process import record_in_process
    from bridge.scenario import load

    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            record_in_process(load(name, ["duration=0.01"]), Path(folder) / f"{name}.mcap")


def theory() -> None:
    """Orbits, sampled loops and their linear theory, the relief valve's chatter."""
    from controller.stability.actuator.model import Actuator
    from controller.stability.actuator.oscillation import PLAIN, oscillations
    from controller.stability.orbits.birth import relay_birth
    from twin.chatter.basin import basin
    from twin.chatter.system import CHAMFERED, CONICAL, System

    oscillations(PLAIN._replace(s=0.1, tau=1.0))
    relay_birth(Actuator(0.01, 0.5, 0.5), 10.0, 0.005)
    for law in (CHAMFERED, CONICAL):
        basin(System(law, 1.0, 1.0, 1.0, 0.2, 0.8), np.array([1.1]), np.zeros(1), 32)


def amplitude() -> None:
    """The reduced drive, of the rig as it is and as it was before its calibration, compiled and asked."""
    from bridge.scenario import load
    from bridge.studies.stability.amplitude import loop_of

    for name in ("step", "assumed-rig"):
        loop_of(load(name))


PARTS = {"plant": plant, "drives": drives, "theory": theory, "amplitude": amplitude}

if __name__ == "__main__":
    PARTS[sys.argv[1]]()
