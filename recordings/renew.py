"""Make the golden recordings and the README's picture anew: `make recordings`."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from bridge.inprocess import record_in_process
from bridge.picture import draw
from bridge.scenario import Scenario, load

HERE = Path(__file__).parent


class Golden(NamedTuple):
    """How a golden recording is made."""

    scenario: str
    changes: list[str]

    def load(self) -> Scenario:
        """Its scenario."""
        return load(self.scenario, self.changes)


GOLDEN = {
    "step": Golden("step", ["duration=2.5", 'loop.daq_period="5 ms"', "daq.noise=0.0"]),
}


def main() -> None:
    """Write every golden recording, and the picture."""
    for name, golden in GOLDEN.items():
        print(record_in_process(golden.load(), HERE / f"{name}.mcap").path.name)
    scenario = load("step", ["duration=4"])
    with TemporaryDirectory() as folder:
        recording = record_in_process(scenario, Path(folder) / "step.mcap")
        print(draw(recording, scenario, HERE.parent / "docs" / "step.png").name)


if __name__ == "__main__":
    main()
