"""Growth of the pilot's small swings between the lines at rest: the twin at four steps, compared with linear theory."""

from collections.abc import Iterator
from pathlib import Path

from tests.support.pilot_growth import Changes, circuit_at, flow_of, grown, nearest, theory, with_pilot

Row = tuple[str, str, str, str]
SPEEDS = (6.5, 7.0, 8.0, 10.0, 15.0, 20.5)  # of the pump [Hz]
STEPS = (100e-6, 50e-6, 25e-6, 12.5e-6)  # [s]
KINDS: dict[str, Changes] = {
    "rigid": with_pilot(),
    "0.75 cm^3": with_pilot(0.75e-6),
    "10 cm^3": with_pilot(10e-6),
    "the rig": {},
}


def rows(folder: Path) -> Iterator[Row]:
    """A row per flow and step: growth, what theory says, and the difference."""
    for kind, rig in KINDS.items():
        for speed in SPEEDS if kind == "rigid" else SPEEDS[2::2]:
            swings = theory(speed, rig)
            for step in STEPS:
                circuit = circuit_at(speed, step, rig)
                found = grown(circuit, seconds=0.1 if rig else 0.05)[0]  # before the rig's own reaches its seat
                exact = nearest(found, swings)
                name = f"{kind}, {flow_of(circuit) * 6e4:.2f} l/min, {step * 1e6:g} us, {found.frequency:.0f} Hz"
                words = f"{exact.growth:.2f} 1/s at {exact.frequency:.0f} Hz by theory"
                yield name, f"{found.growth:.2f} 1/s", words, f"{found.growth - exact.growth:+.2f} 1/s"
