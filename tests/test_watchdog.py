"""A test that hangs is a named failure with its stack, wherever it hangs, alone and under xdist."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
CONFTEST = "from tests.support import watchdog\nfrom tests.support.watchdog import *\n\nwatchdog.GRACE = 0.5\n"
SOUND = "def test_sound():\n    assert True\n"
LOCKED = """
import ctypes

def test_hang():
    mutex, library = ctypes.create_string_buffer(64), ctypes.{library}(None)
    library.pthread_mutex_lock(mutex)
    library.pthread_mutex_lock(mutex)
"""
LOCK_HELD = "compiled, with the interpreter's lock"
HANGS = {
    "in Python": "import time\n\ndef test_hang():\n    time.sleep(50)\n",
    LOCK_HELD: LOCKED.format(library="PyDLL"),
    "compiled, without the lock": LOCKED.format(library="CDLL"),
}


def suite(folder: Path, hang: str, *options: str) -> str:
    """What pytest prints about a sound test and one that hangs, with a limit of seconds; it must fail."""
    (folder / "conftest.py").write_text(CONFTEST)
    (folder / "test_it.py").write_text(SOUND + HANGS[hang])
    command = [sys.executable, "-m", "pytest", "-v", "-p", "no:cacheprovider", f"--rootdir={folder}", "-c", os.devnull]
    done = subprocess.run(
        [*command, "--timeout=2", *options, str(folder)],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=100,
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT), "COLUMNS": "200"},
    )
    assert done.returncode != 0
    return done.stdout


OTHERS = (pytest.mark.endurance, pytest.mark.timeout(120))  # the hardest of the three is enough with workers
UNDER_XDIST = [name if name == LOCK_HELD else pytest.param(name, marks=OTHERS) for name in HANGS]


@pytest.mark.parametrize("hang", UNDER_XDIST)
def test_under_xdist_a_hang_is_a_failure_of_that_name_with_its_line_and_the_others_run(hang, tmp_path):
    text = suite(tmp_path, hang, "-n", "1")
    assert "1 failed, 1 passed" in text
    assert re.search("^FAILED test_it.py::test_hang", text, re.MULTILINE)
    assert re.search("test_it.py.*line .* in test_hang|^>.*time.sleep", text, re.MULTILINE)


def test_alone_a_hang_in_compiled_code_ends_with_its_stack(tmp_path):
    text = suite(tmp_path, "compiled, with the interpreter's lock")
    assert "Timeout (0:00:02.500000)!" in text
    assert re.search("test_it.py.*line .* in test_hang", text)
