"""The last word on a test that hangs where no Python runs: its stack on standard error, and the end of its process.

pytest-timeout fails a late test by a signal, whose handler waits for the interpreter. Compiled code that keeps the
interpreter's lock, or that never returns, does not let it run. faulthandler's own thread needs neither: GRACE seconds
after the limit it writes every stack and ends the process; under xdist the test is then reported by its name.
"""

import faulthandler
import os
import sys
from typing import Any

import pytest

GRACE = 10.0  # [s] for pytest-timeout to fail the test in the usual way
STDERR = pytest.StashKey[int]()


def pytest_configure(config: pytest.Config) -> None:
    """Keep standard error as it is while nothing is captured."""
    config.stash[STDERR] = os.dup(sys.__stderr__.fileno() if sys.__stderr__ else 2)


def pytest_unconfigure(config: pytest.Config) -> None:
    os.close(config.stash[STDERR])


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """A long trial states its own limit."""
    long = [item for item in items if item.get_closest_marker("endurance")]
    bare = [item.nodeid for item in long if not item.get_closest_marker("timeout")]
    if bare:
        raise pytest.UsageError(f"marked endurance without a mark timeout(seconds): {', '.join(bare)}")


@pytest.hookimpl(tryfirst=True)
def pytest_timeout_set_timer(item: pytest.Item, settings: Any) -> None:
    faulthandler.dump_traceback_later(settings.timeout + GRACE, exit=True, file=item.config.stash[STDERR])


@pytest.hookimpl(tryfirst=True)
def pytest_timeout_cancel_timer(item: pytest.Item) -> None:
    faulthandler.cancel_dump_traceback_later()
