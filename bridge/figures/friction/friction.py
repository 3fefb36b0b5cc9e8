"""Figures 2.4 to 2.6: seal friction of the twin, from the pressures at constant speed.

Source: 2.3. Only runs at constant speed, read within the transducers' range, tell the friction. The others are
drawn in grey as what they are, and the table's verdict tells them apart.
"""

import numpy as np

from bridge.drawing.canvas import (
    Array,
    Axes,
    Columns,
    Sheet,
    label,
    shades,
    sheet,
)
from bridge.figures.friction.constant_speed import (
    LEAST_PRESSURE,
    LINES,
    LOADS,
    OUT_OF_RANGE,
    RESTING,
    SPREAD,
    UNSTEADY,
    Readings,
    bench,
    readings,
)
from bridge.figures.friction.power_law import (
    PowerLaw,
    factor,
    fit_power_law,
    law_force,
    limited,
    on_slope,
)
from twin.circuit.kinds import of_kind
from twin.seal import Seal

MARKS = dict(zip(LINES, "so", strict=True))  # by line: hoses, valve on the cylinder
SHORT, LONG = min(LINES), max(LINES)
LEFT_OUT = {
    UNSTEADY: ("x", f"speed not constant: σ(v) > {SPREAD:.0%}"),
    RESTING: ("+", "at rest"),
    OUT_OF_RANGE: ("v", f"$p_u$ < {1e-5 * LEAST_PRESSURE:.1f} bar, out of range"),
}
VERDICT = "verdict [0 steady; 1 unsteady; 2 at rest; 3 out of range]"
SPEEDS = (0.02, 0.04, 0.06)  # [m/s], of the law's lines in 2.5


def rig_seal() -> Seal:
    """The rig's seal: the same in every run."""
    return of_kind(bench(LONG, LOADS[0]).parts.seal, Seal)


def speed_columns(test: Readings) -> Columns:
    """Figure 2.4."""
    return _runs(test) | {"friction force [N]": test.force, VERDICT: test.verdict}


def pressure_columns(test: Readings) -> Columns:
    """Figure 2.5."""
    return _runs(test) | {
        "lower pressure [Pa]": test.p_lower,
        "upper pressure [Pa]": test.p_upper,
        "pressure difference [Pa]": test.sealing,
        "friction force [N]": test.force,
        VERDICT: test.verdict,
    }


def factor_columns(test: Readings) -> Columns:
    """Figure 2.6, with the fitted constants and the thesis's."""
    seal = rig_seal()
    law, (z, g), used = fit_power_law(test, seal), factor(test, seal), on_slope(test, seal)
    return _runs(test) | {
        "z [-]": z,
        "g [-]": g,
        "g fitted [-]": limited(z, law, seal.limit),
        "in the fit [0 no; 1 yes]": used.astype(float),
        VERDICT: test.verdict,
        "alpha fitted [-]": np.full(len(z), law.alpha),
        "beta fitted [-]": np.full(len(z), law.beta),
        "alpha source [-]": np.full(len(z), seal.alpha),
        "beta source [-]": np.full(len(z), seal.beta),
        "g limit [-]": np.full(len(z), seal.limit),
    }


def _runs(test: Readings) -> Columns:
    return {
        "line length [m]": test.line,
        "load [kg]": test.mass,
        "spool reference [-]": test.reference,
        "speed [m/s]": test.speed,
        "speed deviation [m/s]": test.spread,
    }


def draw_over_speed() -> tuple[Columns, Sheet]:
    """Figure 2.4; the lines are the law at the mean pressure difference of each load and direction."""
    test, seal = readings(), rig_seal()
    page, (axes,) = sheet("2.4  Seal friction over the speed of the piston")
    _scatter(axes, test, 1e3 * test.speed, test.force)
    for load, colour in zip(LOADS, shades(LOADS), strict=True):
        for sign in (-1.0, 1.0):
            chosen = on_slope(test, seal) & (test.mass == load) & (sign * test.speed > 0.0)
            if chosen.any():
                speed = sign * np.geomspace(1e-4, 0.07, 200)
                force = law_force(speed, test.sealing[chosen].mean(), seal)
                axes.plot(1e3 * speed, force, color=colour, linewidth=0.8, zorder=1)
    axes.plot([], [], color="black", linewidth=0.8, label="law (2.13), mean $|p_l − p_u|$")
    label(axes, "speed v [mm/s], upwards positive", "friction force $F_f$ [N]")
    _legend(page, axes)
    return speed_columns(test), page


def draw_over_pressure() -> tuple[Columns, Sheet]:
    """Figure 2.5; the lines are the law at some speeds."""
    test, seal = readings(), rig_seal()
    page, (axes,) = sheet("2.5  Seal friction over the pressure difference")
    _scatter(axes, test, 1e-5 * test.sealing, test.force)
    sealing = np.linspace(5e5, 45e5, 100)
    for speed, style in zip((1e-9, *SPEEDS), ("-", "--", "-.", ":"), strict=True):
        name = f"law (2.13) at ±{1e3 * speed:.0f} mm/s" if speed in SPEEDS else f"limit, g = {seal.limit}"
        for sign in (-1.0, 1.0):
            force = law_force(np.full(100, sign * speed), sealing, seal)
            axes.plot(1e-5 * sealing, force, style, color="black", linewidth=0.8, zorder=1, label=name)
            name = None
    axes.set_ylim(-1200.0, 1200.0)
    label(axes, "pressure difference $|p_l − p_u|$ [bar]", "friction force $F_f$ [N]")
    _legend(page, axes)
    return pressure_columns(test), page


def draw_factor() -> tuple[Columns, Sheet]:
    """Figure 2.6: over z as the thesis has it, and on logarithmic axes, where the law is straight."""
    test, seal = readings(), rig_seal()
    z, g = factor(test, seal)
    page, (plain, logs) = sheet("2.6  Friction factor over the dimensionless speed", panels=2)
    _scatter(plain, test, 1e7 * z, g)
    grid = np.geomspace(2e-10, 1.5e-7, 300)
    _laws(plain, np.concatenate([-grid[::-1], [np.nan], grid]), fit_power_law(test, seal), seal)
    label(plain, "$z · 10^7$ [-]", "g [-]")
    _scatter(logs, test, 1e7 * np.abs(z), np.abs(g))
    _laws(logs, grid, fit_power_law(test, seal), seal)
    logs.set(xscale="log", yscale="log", xlim=(1e-3, 2.0), ylim=(0.01, 0.4))
    logs.set_yticks([0.01, 0.02, 0.05, 0.1, 0.25], ["0.01", "0.02", "0.05", "0.1", "0.25"])
    logs.minorticks_off()
    label(logs, "$|z| · 10^7$ [-]", "|g| [-]")
    _legend(page, logs)
    return factor_columns(test), page


def _laws(axes: Axes, z: Array, law: PowerLaw, seal: Seal) -> None:
    own = PowerLaw(seal.alpha, seal.beta)
    for each, style, colour, name in ((own, "-", "0.2", "source"), (law, "--", "tab:green", "fitted")):
        text = f"{name}: g = {1e6 * each.alpha:.3f}·10⁻⁶ $|z|^{{{each.beta:.4f}}}$, ≤ {seal.limit}"
        axes.plot(1e7 * z, limited(z, each, seal.limit), style, color=colour, linewidth=1.2, zorder=1, label=text)


def _scatter(axes: Axes, test: Readings, across: Array, up: Array) -> None:
    for verdict, (mark, name) in LEFT_OUT.items():
        chosen = test.verdict == verdict
        text = f"{name} ({chosen.sum()})"
        axes.plot(across[chosen], up[chosen], mark, color="0.72", markersize=4, zorder=1, label=text)
    for load, colour in zip(LOADS, shades(LOADS), strict=True):
        for line, mark in MARKS.items():
            chosen = test.steady & (test.mass == load) & (test.line == line)
            axes.plot(across[chosen], up[chosen], mark, color=colour, markersize=5, zorder=3)
        axes.plot([], [], MARKS[SHORT], color=colour, label=f"{load:.0f} kg")
    axes.plot([], [], MARKS[SHORT], color="white", markeredgecolor="black", label=f"lines of {SHORT} m steel")
    axes.plot([], [], MARKS[LONG], color="white", markeredgecolor="black", label=f"lines of {LONG} m hose (rig)")


def _legend(page: Sheet, axes: Axes) -> None:
    handles, names = axes.get_legend_handles_labels()
    page.legend(handles, names, loc="outside right center", frameon=False, fontsize=8)
