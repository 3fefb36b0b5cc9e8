"""Make the golden recordings and the pictures of the guides anew: `make recordings`."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from matplotlib import rc_context

from bridge.figures.circuit.rig import draw_circuit
from bridge.figures.transients.transients import draw_load_change
from bridge.runs.in_process import record_in_process
from bridge.runs.picture import draw
from bridge.scenario import Scenario, load

HERE = Path(__file__).parents[2] / "recordings"


class Golden(NamedTuple):
    """How a golden recording is made."""

    scenario: str
    changes: list[str]

    def load(self) -> Scenario:
        """Its scenario."""
        return load(self.scenario, self.changes)


SHORT = ["duration=2.5", 'loop.daq_period="5 ms"', "daq.noise=0.0"]
GOLDEN = {
    "step": Golden("step", SHORT),
    "assumed-rig": Golden("assumed-rig", SHORT),
}


def main() -> None:
    """Write every golden recording, and the pictures."""
    for name, golden in GOLDEN.items():
        print(record_in_process(golden.load(), HERE / f"{name}.mcap").path.name)
    for path in pictures(HERE.parent / "docs"):
        print(path.name)


def pictures(folder: Path) -> list[Path]:
    """Write the pictures of the guides into a folder."""
    scenario = load("step", ["duration=4"])
    with TemporaryDirectory() as scratch:
        recording = record_in_process(scenario, Path(scratch) / "step.mcap")
        made = [draw(recording, scenario, folder / "step.png")]
    for sheet, path in (
        (draw_load_change()[1], folder / "load-change.png"),
        (draw_circuit()[1], folder / "circuit.svg"),
    ):
        made.append(path)
        with rc_context({"svg.hashsalt": path.stem}):
            sheet.savefig(path, dpi=110, metadata={"Date": None} if path.suffix == ".svg" else None)
    return made


if __name__ == "__main__":
    main()
