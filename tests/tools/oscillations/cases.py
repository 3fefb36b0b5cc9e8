"""Runs that oscillate and runs that do not: what the limit-cycle metric is tried on.

Each case is a change of the scenario `step`; the reference is a step, a square wave, a sine, or a table of points. The
set covers what made an oscillation hard to tell: laws, valves, sample periods, delays, masses, sizes of step, dead
band, friction, noise, decay and growth. `random_cases` draws further ones from the same space.
"""

import random
from collections.abc import Iterator
from typing import Any, NamedTuple

from bridge.scenario import Scenario, load


class Case(NamedTuple):
    """One run."""

    name: str
    kind: str  # what it was made for; the label is measured
    changes: tuple[str, ...]

    def scenario(self) -> Scenario:
        """The scenario to run."""
        return load("step", list(self.changes))


FRICTIONLESS = "rig.seal.limit=0"


def labelled_cases() -> list[Case]:
    """The set that the metric was designed on."""
    return [*_relays(), *_gains(), *_dead_bands(), *_creep(), *_noise(), *_decaying_and_growing(), *_shapes()]


def _case(kind: str, period: float, delay: float, size: float = 60.0, length: float = 11.0, **more: Any) -> Case:
    """A step of `size` [mm] at a sample period and a delay [ms], and any further entries with `__` for a dot."""
    named = {name.replace("__", "."): value for name, value in more.items()}
    if named.get("controller.kind") == "relay":
        named = _of_relay(named)
    changes = [
        f"loop.sample_period={period} ms",
        f"loop.delay={delay} ms",
        f"loop.command_timeout={max(100.0, 3.0 * period + delay)} ms",
        f"reference.end={100.0 + size} mm",
        f"duration={1.0 + length} s",
        *(f"{name}={value}" for name, value in named.items()),
    ]
    words = " ".join(f"{name.rpartition('.')[2]}={value}" for name, value in named.items() if name[:4] != "refe")
    return Case(f"{kind} T={period:g} delay={delay:g} step={size:g} {words}", kind, tuple(changes))


def _of_relay(named: dict[str, Any]) -> dict[str, Any]:
    """A relay knows the sign only: of both gains their ratio."""
    gain, derivative = (float(str(named[f"controller.{name}"]).split()[0]) for name in ("gain", "derivative"))
    gone = ("controller.gain", "controller.derivative", "controller.compensate_overlap")
    kept = {name: value for name, value in named.items() if name not in gone}
    return kept | {"controller.derivative_time": f"{derivative / gain:.4g} s"}


def _gain(volts: float, derivative: float = 0.0) -> dict[str, Any]:
    return {"controller__gain": f"{volts} V/%", "controller__derivative": f"{derivative} V s/%"}


def _relays() -> Iterator[Case]:
    for valve in ("switching", "proportional"):
        for period, delay, derivative in (
            *((1, 1, 0.0), (1, 1, 0.2), (1, 1, 0.6), (1, 20, 0.2), (5, 0, 0.1)),
            *((10, 5, 0.0), (10, 10, 0.4), (20, 40, 0.2), (50, 0, 0.05)),
        ):
            more: dict[str, Any] = {"controller__kind": "relay", "rig__valve__kind": valve} | _gain(1.0, derivative)
            yield _case("relay", period, delay, **more)


def _gains() -> Iterator[Case]:
    """Gains about the edge of stability: half of it, near it on both sides, above it."""
    for period, delay, size, mass, edge in (
        *((1, 0, 60, 120, 3.5), (1, 4, 2, 303, 2.0), (5, 10, 20, 120, 1.8), (10, 10, 2, 120, 0.7)),
        *((10, 40, 20, 303, 0.95), (20, 20, 60, 120, 1.1), (50, 50, 2, 120, 0.74), (100, 0, 60, 120, 1.0)),
    ):
        for part in (0.5, 0.9, 1.15, 2.0):
            length = 20.0 if period >= 50 else 11.0
            more: dict[str, Any] = {"controller__compensate_overlap": "true", "rig__load__mass": mass} | _gain(
                edge * part
            )
            yield _case("pd", period, delay, size, length, **more)


def _dead_bands() -> Iterator[Case]:
    for period, delay, volts, leakage in (
        *((10, 5, 1.0, 1.04e12), (10, 5, 4.0, 1.04e11), (1, 1, 8.0, 2e11), (50, 50, 2.0, 1e11)),
        *((10, 40, 3.0, 3e11), (100, 0, 1.5, 5e10)),
    ):
        more = {"controller__compensate_overlap": "false", "rig__cylinder__leakage_resistance": leakage}
        yield _case("dead band", period, delay, 20.0, 20.0, **more, **_gain(volts))


def _creep() -> Iterator[Case]:
    """A piston that sticks and slips on its way, or sinks with the valve shut."""
    for period, volts, leakage, compensated in (
        *((10, 0.1, 1e12, "true"), (10, 0.2, 1e11, "true"), (10, 0.3, 5e10, "false"), (10, 0.05, 2e10, "false")),
        *((20, 0.1, 5e10, "true"), (1, 0.5, 5e10, "true")),
    ):
        more = {"controller__compensate_overlap": compensated, "rig__cylinder__leakage_resistance": leakage}
        yield _case("creep", period, 0.0, 20.0, 20.0, **more, **_gain(volts))


def _noise() -> Iterator[Case]:
    for period, bits, noise, volts in ((1, 12, 4.0, 0.3), (10, 10, 2.0, 0.3), (10, 8, 1.0, 0.3), (10, 12, 20.0, 0.5)):
        more = {"daq__noise": noise, "daq__bits": bits, "controller__compensate_overlap": "true"}
        yield _case("noise", period, 0.0, 2.0, **more, **_gain(volts))


def _decaying_and_growing() -> Iterator[Case]:
    """Without friction the swing dies or grows as the linear theory says, slowly about the edge."""
    exact = {"rig__seal__limit": 0, "controller__compensate_overlap": "true", "daq__noise": 0, "daq__quantise": "false"}
    for volts in (0.25, 0.3, 0.34, 0.38, 0.42, 0.46, 0.6):
        yield _case("frictionless", 10, 10, 20, 11.0, **exact, **_gain(volts))
    for volts in (1.0, 1.5, 2.0, 2.5, 3.0):
        yield _case("frictionless", 10, 0, 20, 11.0, **exact, **_gain(volts))
    for period, delay, volts, length in (
        *((10, 40, 1.0, 3.0), (10, 40, 1.05, 4.0), (10, 40, 1.1, 5.0), (20, 20, 1.0, 11.0), (20, 20, 0.7, 14.0)),
        *((10, 60, 0.9, 5.0), (10, 60, 1.1, 11.0), (50, 0, 2.4, 11.0)),
    ):
        slack = exact | {"controller__compensate_overlap": "true" if delay == 40 else "false", "rig__load__mass": 303}
        yield _case("frictionless", period, delay, 60, length, **slack, **_gain(volts))


def _square(period: float, amplitude: float) -> str:
    return f'{{kind="square", mean="130 mm", amplitude="{amplitude} mm", period="{period} s", at="1 s"}}'


def _sine(frequency: float, amplitude: float) -> str:
    return f'{{kind="sine", mean="130 mm", amplitude="{amplitude} mm", frequency="{frequency} Hz", at="1 s"}}'


def _table(*points: tuple[float, float]) -> str:
    return '{kind="table", csv="' + "\\n".join(f"{t},{x}" for t, x in points) + '"}'


def _shaped(kind: str, reference: str, period: float, delay: float, volts: float, *more: str) -> Case:
    base = _case(kind, period, delay, controller__compensate_overlap="true", **_gain(volts))
    kept = [change for change in base.changes if not change.startswith("reference")]
    name = f"{kind} T={period:g} delay={delay:g} gain={volts:g} {' '.join(more)}"
    return Case(name, kind, (*kept, f"reference={reference}", "start.position=130 mm", *more))


def _shapes() -> Iterator[Case]:
    """Other references: several stretches, one after a motion, and none."""
    for volts in (0.7, 1.5, 3.0):
        yield _shaped("square", _square(6.0, 30.0), 10, 5, volts, "duration=19 s")
    for volts in (0.3, 2.0):
        yield _shaped("square frictionless", _square(4.0, 40.0), 10, 0, volts, FRICTIONLESS, "duration=17 s")
    for volts, frequency in ((0.5, 0.25), (2.0, 0.5), (4.0, 1.0), (1.0, 2.0)):
        yield _shaped("sine", _sine(frequency, 20.0), 10, 5, volts)
    hold = _table((0, 0.13), (1, 0.13), (3, 0.17), (12, 0.17))
    for volts, delay in ((0.8, 5), (3.0, 20)):
        yield _shaped("ramp and hold", hold, 10, delay, volts)


def random_cases(number: int, seed: int) -> list[Case]:
    """Further runs, drawn from the same space."""
    draw = random.Random(seed)
    return [_drawn(draw, i) for i in range(number)]


def _drawn(draw: random.Random, i: int) -> Case:
    period = draw.choice((1, 2, 5, 10, 20, 50, 100))
    delay = period * draw.choice((0, 0.5, 1, 2, 4))
    law = draw.choice(("pd", "pd", "pd", "relay"))
    scale = 4.0 / (1.0 + 0.06 * (period + delay))  # [V/%], of the order of the edge
    more = {
        "seed": i + 1,
        "controller__kind": law,
        "controller__compensate_overlap": draw.choice(("true", "true", "false")),
        "rig__valve__kind": draw.choice(("proportional", "switching")) if law == "relay" else "proportional",
        "rig__load__mass": draw.choice((120, 210, 303)),
        "rig__seal__limit": draw.choice((0.25, 0.25, 0.25, 0.1, 0)),
        "rig__cylinder__leakage_resistance": f"{10.0 ** draw.uniform(10.5, 13.0):.3g}",
        "daq__noise": draw.choice((0, 0.5, 0.5, 3.0)),
    }
    volts, derivative = scale * 10.0 ** draw.uniform(-0.8, 0.5), draw.choice((0.0, 0.0, 0.02, 0.1, 0.3))
    size = draw.choice((2.0, 5.0, 20.0, 60.0, -20.0))
    length = draw.choice((11.0, 20.0)) if period < 50 else 20.0
    case = _case("random", period, delay, size, length, **more, **_gain(round(volts, 3), derivative))
    return case._replace(name=f"{i:03d} {case.name}")
