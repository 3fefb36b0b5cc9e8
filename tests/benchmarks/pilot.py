"""Growth of the pilot's small swings between the lines at rest: the twin at four steps, compared with linear theory."""

from collections.abc import Iterator
from pathlib import Path

from tests.support.pilot_growth import LONGER, RIG, Changes, circuit_at, flow_of, grown, nearest, theory, with_oil
from tests.support.plant import bench

Row = tuple[str, str, str, str]
SPEEDS = (5.2, 6.0, 8.0, 10.0, 15.0, 20.5)  # of the pump [Hz]
STEPS = (100e-6, 50e-6, 25e-6, 12.5e-6)  # [s]
KINDS: dict[str, Changes] = {
    "the rig": RIG,
    "0.75 cm^3 before the pilot": with_oil(0.75e-6),
    "10 cm^3": with_oil(10e-6),
    "pipe_1 of 1.5 m": LONGER,
    "assumed-rig": bench(),
}


def rows(folder: Path) -> Iterator[Row]:
    """A row per flow and step: growth, what theory says, and the difference."""
    for kind, rig in KINDS.items():
        for speed in SPEEDS if rig is RIG else SPEEDS[1::2]:
            swings = theory(speed, rig)
            for step in STEPS:
                circuit = circuit_at(speed, step, rig)
                found = grown(circuit, seconds=0.05 if rig is LONGER else 0.1)[0]  # before it reaches its seat
                exact = nearest(found, swings)
                name = f"{kind}, {flow_of(circuit) * 6e4:.2f} l/min, {step * 1e6:g} us, {found.frequency:.0f} Hz"
                words = f"{exact.growth:.2f} 1/s at {exact.frequency:.0f} Hz by theory"
                yield name, f"{found.growth:.2f} 1/s", words, f"{found.growth - exact.growth:+.2f} 1/s"
