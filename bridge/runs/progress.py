"""What a person sees while a run is going on; nothing when nobody looks."""

import sys
from typing import TYPE_CHECKING, Any

from bridge.machine.narrator import on_terminal
from bridge.scenario import Scenario
from bridge.wire.events import line_of_law
from bridge.wire.messages import Phase
from bridge.wire.status import PlantStatus

if TYPE_CHECKING:
    from rich.live import Live
    from rich.table import Table

EVERY = 200  # ticks between two looks in process


class Progress:
    """A live line on a terminal. Use as a context manager."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario
        self._live = _line_on_screen() if sys.stderr.isatty() else None

    def __enter__(self) -> "Progress":
        if self._live:
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._live:
            self._live.stop()

    def tick(self, number: int) -> None:
        """In process: how far it has come."""
        if self._live and number % EVERY == 0:
            self.show(PlantStatus(number, self.scenario.ticks), Phase.RUNNING)

    def tell(self, event: Any) -> None:
        """Print a line of the law, of a `said` event."""
        on_terminal(line_of_law(event))

    def show(self, status: PlantStatus, phase: str) -> None:
        """Draw the numbers of a status."""
        if self._live:
            self._live.update(_line(self.scenario, status, phase))


def _line_on_screen() -> "Live":
    from rich.console import Console
    from rich.live import Live
    from rich.text import Text

    return Live(Text("starting"), console=Console(stderr=True), refresh_per_second=10, transient=True)


def _line(scenario: Scenario, status: PlantStatus, phase: str) -> "Table":
    from rich.table import Table
    from rich.text import Text

    period = scenario.loop.daq_period
    done, total = status.tick * period, status.ticks * period
    bar = "━" * round(20 * done / total) if total else ""
    cells = [Text(scenario.name, "bold"), phase, f"{bar:·<20}", f"{done:.1f}/{total:g} s"]
    if reading := status.reading:
        cells.append(f"x {reading.position * 1e3:.1f} mm")
        cells.append("p " + " ".join(f"{p / 1e5:.0f}" for p in reading.pressures) + " bar")
        cells.append(f"u {reading.spool:+.2f}")
    if pace := status.pace:
        cells.append(f"late {pace.lateness * 1e6:.0f} us")
        if pace.round_trip > 0.0:
            cells.append(f"trip {pace.round_trip * 1e6:.0f} us")
    table = Table.grid(padding=(0, 2))
    table.add_row(*cells)
    return table
