"""For pytest: the fixture `rig`, which runs scenarios; the last run of a test that fails is kept when asked for."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from bridge.scenario import Scenario
    from hydrotwin.runs import Changes, Law, Run
    from hydrotwin.signal import Signal

UNSAFE = r"[^\w.,=\[\]-]+"  # in the name of a file
FAILED = pytest.StashKey[bool]()


class Rig:
    """Runs scenarios for a test and remembers the last run."""

    def __init__(self) -> None:
        self.last: Run | None = None

    def run(
        self, scenario: "Scenario | str | Path" = "step", law: "Law | None" = None, changes: "Changes" = ()
    ) -> "Run":
        """As `hydrotwin.run`."""
        from hydrotwin.runs import run

        self.last = run(scenario, law, changes)
        return self.last

    def signal(self, name: str) -> "Signal":
        """Of the last run; the scenario "step" is run where there was none."""
        return (self.last or self.run()).signal(name)


def pytest_addoption(parser: pytest.Parser) -> None:
    """The options of this plugin."""
    parser.getgroup("hydrotwin").addoption(
        "--rig-recordings", metavar="FOLDER", help="keep the last run of each test that fails, as an MCAP file"
    )


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Any:
    """Remember whether a test has failed."""
    report = yield
    item.stash[FAILED] = item.stash.get(FAILED, False) or report.failed
    return report


@pytest.fixture
def rig(request: pytest.FixtureRequest) -> Iterator[Rig]:
    """A rig to run a law on: `rig.run("step", law)`, then `rig.signal("p2").stays(below="80 bar", after="1 s")`."""
    found = Rig()
    yield found
    folder = request.config.getoption("--rig-recordings")
    if folder and found.last is not None and request.node.stash.get(FAILED, False):
        from bridge.recording.names import own_name

        with own_name(Path(folder) / f"{re.sub(UNSAFE, '_', request.node.name)}.mcap") as path:
            found.last.save(path)
