"""What a person sees while a run is going on; nothing when nobody looks."""

import sys
from typing import TYPE_CHECKING, Any

from bridge.scenario import Scenario
from bridge.wire.messages import Phase
from twin.topology import PRESSURES

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
            self.show({"tick": number, "ticks": self.scenario.ticks, "phase": Phase.RUNNING})

    def show(self, values: dict[str, Any]) -> None:
        """Draw the numbers of a status."""
        if self._live:
            self._live.update(_line(self.scenario, values))


def _line_on_screen() -> "Live":
    from rich.console import Console
    from rich.live import Live
    from rich.text import Text

    return Live(Text("starting"), console=Console(stderr=True), refresh_per_second=10, transient=True)


def _line(scenario: Scenario, values: dict[str, Any]) -> "Table":
    from rich.table import Table
    from rich.text import Text

    period = scenario.loop.daq_period
    done, total = values.get("tick", 0) * period, values.get("ticks", 1) * period
    bar = "━" * round(20 * done / total) if total else ""
    cells = [Text(scenario.name, "bold"), str(values["phase"]), f"{bar:·<20}", f"{done:.1f}/{total:g} s"]
    if "position" in values:
        cells.append(f"x {values['position'] * 1e3:.1f} mm")
        cells.append("p " + " ".join(f"{values[tap] / 1e5:.0f}" for tap in PRESSURES) + " bar")
        cells.append(f"u {values['spool']:+.2f}")
    if values.get("lateness") is not None:
        cells.append(f"late {values['lateness'] * 1e6:.0f} us")
    if values.get("round_trip", -1) > 0:
        cells.append(f"trip {values['round_trip'] * 1e6:.0f} us")
    table = Table.grid(padding=(0, 2))
    table.add_row(*cells)
    return table
