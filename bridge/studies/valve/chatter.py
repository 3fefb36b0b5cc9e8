"""Chatter of a relief valve at a flow: critical damping, frequency, kind of loss of stability, impacts."""

import math
from typing import Any

import numpy as np

from bridge.drawing.canvas import (
    Columns,
    Sheet,
    label,
    sheet,
)
from bridge.errors import nearest
from twin.chatter.build import pilot_of
from twin.chatter.equilibrium import gains
from twin.chatter.impact import impact_orbit, orbit_error
from twin.chatter.lyapunov import first_coefficient
from twin.chatter.physical import Pilot, compare, reference, system
from twin.chatter.system import SEATS, SeatLaw, System
from twin.rig import Values
from twin.seats import validity

BAR, LITRE_PER_MINUTE, MM = 1e5, 1e-3 / 60.0, 1e-3
PARTS = ("spring", "shear", "film")


def law_of(seat: str) -> SeatLaw:
    """The law of a seat's name. Raises ValueError for another."""
    if seat not in SEATS:
        raise ValueError(f"no seat {seat!r}{nearest(seat, SEATS)}")
    return SEATS[seat]


def truly_damped(law: SeatLaw, flow: float, precompression: float, pilot: Pilot) -> System:
    """The system with all the damping that the seat has at this flow."""
    own = compare(law, flow, precompression, pilot)
    s = system(law, flow, precompression, pilot)
    return s._replace(damping=sum(own.damping) / (pilot.mass * reference(law, pilot).omega))


def facts(seat: str, flow: float, precompression: float, rig: Values) -> dict[str, Any]:
    """Numbers in SI and verdicts; flow [m^3/s], precompression [m]. Raises ValueError for what cannot be."""
    law, pilot = law_of(seat), pilot_of(rig)
    if not (flow > 0.0 and precompression >= 0.0):
        raise ValueError(
            f"flow {flow} m^3/s, precompression {precompression} m: take a flow above 0 "
            "and a precompression of at least 0"
        )
    own = compare(law, flow, precompression, pilot)
    s = truly_damped(law, flow, precompression, pilot)
    r, l1 = reference(law, pilot), first_coefficient(s)
    sings = sum(own.damping) < own.critical
    found = {
        "lift": own.lift, "pressure": own.pressure, "frequency": own.frequency, "critical_damping": own.critical,
        "damping": own.damping._asdict(), "sings": sings, "z": gains(s)[1], "beta": s.beta, "q": s.flow,
        "e": s.precompression, "k": s.damping, "first_lyapunov_coefficient": l1, "loss": "soft" if l1 < 0.0 else "hard",
        "warnings": _warnings(seat, own.lift, own.pressure, rig),
    }  # fmt: skip
    return found | ({"impact": _impact(s, r.omega, r.lift)} if sings else {})


def _warnings(seat: str, lift: float, pressure: float, rig: Values) -> list[str]:
    pilot = pilot_of(rig)
    if seat == "chamfered":
        return []  # (4.2) has a constant discharge coefficient: no fitted range
    return list(validity.of_conical(lift, pressure, rig["oil"]["density"], pilot.conical).warnings)


def _impact(s: System, omega: float, lift: float) -> dict[str, float] | None:
    """The period-one orbit in SI, with the error that two tolerances show; None: there is none."""
    try:
        o, error = impact_orbit(s), orbit_error(s)
    except ValueError:
        return None
    return {
        "frequency": o.frequency * omega / (2.0 * math.pi),
        "highest_lift": o.lift * lift,
        "impact_speed": o.impact * lift * omega,
        "multiplier": o.multiplier,
        "relative_error": max(error[:4]),
    }


def rows(found: dict[str, Any]) -> list[tuple[str, str]]:
    """The facts for people."""
    damping = found["damping"]
    shares = ", ".join(f"{part} {damping[part]:.4g}" for part in PARTS if damping[part])
    table = [
        ("steady lift", f"{found['lift'] / MM:.4g} mm"),
        ("steady pressure", f"{found['pressure'] / BAR:.4g} bar"),
        ("critical damping", f"{found['critical_damping']:.4g} N s/m"),
        ("its own damping", f"{sum(damping.values()):.4g} N s/m ({shares})"),
        ("verdict", "it sings" if found["sings"] else "it is calm"),
        ("frequency of the swing that begins", f"{found['frequency']:.5g} Hz"),
        (
            "loss of stability",
            f"{found['loss']} (l1 = {found['first_lyapunov_coefficient']:.3g}, z = {found['z']:.4g})",
        ),
    ]
    orbit = found.get("impact")
    if orbit:
        table += [
            ("swing after long", f"{orbit['frequency']:.5g} Hz, up to {orbit['highest_lift'] / MM:.4g} mm"),
            ("speed into the seat", f"{orbit['impact_speed']:.4g} m/s" if orbit["impact_speed"] else "it stays clear"),
            ("error of the swing", f"{orbit['relative_error']:.1e}, relative, from two tolerances"),
        ]
    return table


def draw(seat: str, flow: float, precompression: float, rig: Values) -> tuple[Columns, Sheet]:
    """Critical damping and own damping over the flow, and over the volume before the seat, the asked point marked."""
    law, pilot = law_of(seat), pilot_of(rig)
    shares = np.geomspace(0.02, 20.0, 61)
    page, panels = sheet(f"{seat} seat, precompression {precompression / MM:.3g} mm", panels=2)
    columns: Columns = {"share [-]": shares}
    for axes, name in zip(panels, ("flow", "volume"), strict=True):
        points = [
            compare(law, flow * c, precompression, pilot)
            if name == "flow"
            else compare(law, flow, precompression, pilot._replace(volume=pilot.volume * c))
            for c in shares
        ]
        x = shares * (flow / LITRE_PER_MINUTE if name == "flow" else pilot.volume * 1e6)
        critical = np.array([p.critical for p in points])
        axes.plot(x, critical, color="tab:red", label="needed: $K_{crit}$")
        columns[f"K_crit over {name} [N s/m]"] = critical
        so_far = np.zeros(len(points))
        for part, style in zip(PARTS, (":", "--", "-"), strict=True):
            own = np.array([getattr(p.damping, part) for p in points])
            so_far = so_far + own
            if own.any():
                axes.plot(x, so_far, style, color="tab:blue", label=part if part == "spring" else f"and {part}")
            columns[f"K with {part} over {name} [N s/m]"] = so_far
        axes.axvline(flow / LITRE_PER_MINUTE if name == "flow" else pilot.volume * 1e6, color="0.6", linewidth=0.8)
        axes.set(xscale="log", yscale="log")
        label(axes, "Q [l/min]" if name == "flow" else "V [cm³]", "K [N s/m]")
    panels[0].legend(frameon=False, fontsize=8)
    return columns, page
