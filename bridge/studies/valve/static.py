"""The static curve of a rig's relief valve: settings, knee, openings, what shapes it and what it can tell."""

from typing import Any, NamedTuple

import numpy as np

from bridge.drawing.canvas import (
    Columns,
    Sheet,
    label,
    sheet,
)
from twin.circuit.build import relief_sizes
from twin.circuit.oil import oil_of
from twin.relief.sensitivity import (
    Curve,
    Identified,
    Knee,
    curve,
    identifiable,
    knee,
    sensitivities,
    set_and_override,
)
from twin.relief.steady import precompression_for
from twin.relief.valve import Relief, relief
from twin.rig import Values

BAR, LITRE_PER_MINUTE = 1e5, 1e-3 / 60.0
LEAST, MOST = 1.0 * LITRE_PER_MINUTE, 100.0 * LITRE_PER_MINUTE  # where the setting is read, and the override
FULL_SCALE, STEPS = 250.0 * BAR, 4096.0  # transducer and card, 2.2.2: noise half a step


class Static(NamedTuple):
    """What is found."""

    valve: Relief
    precompression: float  # [m]
    curve: Curve
    knee: Knee
    names: list[str]  # parameters
    shaped: Any  # (2, n), set pressure and override [Pa per ln]
    told: Identified


def static(rig: Values) -> Static:
    """The valve set as the rig says. Raises ValueError where there is none, or none that holds the setting."""
    if rig["relief"]["kind"] == "none":
        raise ValueError("relief.kind is none: the rig has no relief valve; take two-stage")
    part = rig["relief"]
    x0 = precompression_for(part["setting"], part["setting_flow"], valve_of(rig, 0.0))
    valve, sizes, oil = valve_of(rig, x0), relief_sizes(rig["relief"], x0), oil_of(rig)
    flows = np.concatenate([np.geomspace(0.01, 1.0, 20), np.geomspace(1.2, 200.0, 40)]) * LITRE_PER_MINUTE
    names, shaped = set_and_override(LEAST, MOST, sizes, oil)
    sparse = flows[::4]
    told = identifiable(*sensitivities(sparse, sizes, oil), 0.5 * FULL_SCALE / STEPS)
    return Static(valve, x0, curve(flows, valve), knee(valve), names, shaped, told)


def plain(found: Static) -> dict[str, Any]:
    """For JSON, SI."""
    told = found.told
    return {
        "precompression": found.precompression,
        "knee": found.knee._asdict(),
        "curve": {name: values.tolist() for name, values in found.curve._asdict().items()},
        "sensitivity": {
            name: {"set_pressure": float(a), "override": float(b)}
            for name, a, b in zip(found.names, *found.shaped, strict=True)
        },
        "identifiable": {
            "singular_values": told.singular.tolist(),
            "count": told.known,
            "directions": [dict(zip(told.names, row, strict=True)) for row in told.directions.tolist()],
        },
    }


def rows(found: Static) -> list[tuple[str, str, str, str]]:
    """Parameter; bar for 1 % of it at the setting and in the override; its spread if all others were known."""
    order = np.argsort(-np.abs(found.shaped[0]))
    spread = dict(zip(found.told.names, found.told.alone, strict=True))
    return [
        (
            found.names[i],
            f"{1e-2 * found.shaped[0][i] / BAR:+.4f}",
            f"{1e-2 * found.shaped[1][i] / BAR:+.4f}",
            f"{100.0 * spread[found.names[i]]:.3g} %",
        )
        for i in order
    ]


def combinations(told: Identified) -> list[tuple[str, str]]:
    """How well each combination is known, and its greatest parts."""
    found = []
    for value, row in zip(told.singular[: told.known], told.directions, strict=False):
        parts = [f"{row[i]:+.2f} {told.names[i]}" for i in np.argsort(-np.abs(row))[:4]]
        found.append((f"{100.0 / value:.2g} %", "  ".join(parts)))
    return found


def draw(found: Static) -> tuple[Columns, Sheet]:
    """Pressure and openings over the flow."""
    c = found.curve
    page, (left, right) = sheet("Static curve of the relief valve", panels=2)
    left.plot(c.flow / LITRE_PER_MINUTE, c.pressure / BAR, color="tab:blue")
    left.plot(found.knee.flow / LITRE_PER_MINUTE, found.knee.pressure / BAR, "o", color="tab:red", label="main opens")
    left.axhline(found.knee.cracking / BAR, color="0.6", linestyle=":", label="pilot cracks")
    left.set_xscale("log")
    left.legend(frameon=False)
    label(left, "Q [l/min]", "p [bar]")
    right.plot(c.flow / LITRE_PER_MINUTE, c.pilot_lift * 1e6, color="tab:blue", label="pilot")
    right.plot(c.flow / LITRE_PER_MINUTE, c.spool_lift * 1e6, "--", color="tab:blue", label="main spool")
    right.set(xscale="log", yscale="log", ylim=(0.1, None))
    right.legend(frameon=False)
    label(right, "Q [l/min]", "opening [µm]")
    return {
        "flow [m^3/s]": c.flow, "pressure [Pa]": c.pressure, "pilot lift [m]": c.pilot_lift,
        "spool lift [m]": c.spool_lift, "pilot flow [m^3/s]": c.pilot_flow,
    }, page  # fmt: skip


def valve_of(rig: Values, precompression: float) -> Relief:
    """The relief valve with a pilot spring precompressed by so much [m]."""
    return relief(relief_sizes(rig["relief"], precompression), oil_of(rig))
