"""Table 2.2 as a figure: loss coefficient of the pilot's chamfered seat by CFD, by the fitted law, and by Idelchik's.

Source: (2.25) to (2.27), Table 2.2. Idelchik does not state the cone's angle, so the laws are of two geometries; they
are drawn side by side, each solid where it holds.
"""

import numpy as np

from bridge.drawing.canvas import Columns, Sheet, label, remark, sheet
from twin.chatter.build import chamfered_of
from twin.rig import values
from twin.seats.chamfered import ChamferedSeat, idelchik_coefficient, loss_coefficient

CFD = {0.2e-3: 841.7, 0.3e-3: 316.1, 0.4e-3: 137.8, 0.5e-3: 111.4}  # lift [m] -> zeta, Table 2.2
FITTED, IDELCHIK = (0.01, 0.1), (0.125, 0.4)  # x/d in which the laws hold, (2.26), (2.27)


def refit(seat: ChamferedSeat) -> tuple[float, float]:
    """Factor and exponent of (2.26) by least squares on the logarithms of the four printed points."""
    x, zeta = np.log(np.array(list(CFD)) / seat.diameter), np.log(np.array(list(CFD.values())))
    slope, intercept = np.polyfit(x, zeta, 1)
    return float(np.exp(intercept)), -float(slope)


def _columns(seat: ChamferedSeat) -> Columns:
    """Both laws over the lift, with Table 2.2's lifts among them."""
    printed = np.array(list(CFD)) / seat.diameter
    shares = np.unique(np.concatenate([np.geomspace(FITTED[0], IDELCHIK[1], 60), printed, FITTED, IDELCHIK]))
    lifts = shares * seat.diameter
    cfd = np.array([next((z for x, z in CFD.items() if abs(x - lift) < 1e-9), 0.0) for lift in lifts])
    return {
        "lift [m]": lifts,
        "lift over diameter [-]": shares,
        "zeta by CFD; 0 where none [-]": cfd,
        "zeta fitted (2.26) [-]": np.array([loss_coefficient(float(x), seat) for x in lifts]),
        "zeta Idelchik (2.27) [-]": np.array([idelchik_coefficient(float(x), seat) for x in lifts]),
    }


def draw_loss() -> tuple[Columns, Sheet]:
    """The loss coefficient over the lift, and what the fit misses of each printed point."""
    seat = chamfered_of(values())
    table = _columns(seat)
    shares = table["lift over diameter [-]"]
    page, (left, right) = sheet("Table 2.2  Loss coefficient of the pilot's seat", panels=2)
    for key, (low, high), colour, name in (
        ("zeta fitted (2.26) [-]", FITTED, "tab:blue", "fitted to CFD, (2.26)"),
        ("zeta Idelchik (2.27) [-]", IDELCHIK, "tab:red", "Idelchik, (2.27)"),
    ):
        holds = (shares >= low - 1e-9) & (shares <= high + 1e-9)
        left.plot(shares, table[key], ":", color=colour, linewidth=1.0)
        left.plot(shares[holds], table[key][holds], color=colour, label=name)
    left.plot(np.array(list(CFD)) / seat.diameter, list(CFD.values()), "o", color="black", label="CFD, Table 2.2")
    left.plot([], [], ":", color="black", label="beyond its range")
    left.set(xscale="log", yscale="log")
    left.set_xticks([0.01, 0.02, 0.05, 0.1, 0.2, 0.4], ["0.01", "0.02", "0.05", "0.1", "0.2", "0.4"])
    left.legend(frameon=False)
    label(left, "$x_{pl}/d_{in}$ [-]", "ζ [-]")
    _draw_misses(right, seat)
    factor, exponent = refit(seat)
    ratio = loss_coefficient(FITTED[1] * seat.diameter, seat) / idelchik_coefficient(FITTED[1] * seat.diameter, seat)
    remark(
        page,
        f"The four points alone give {factor:.4f} $(x/d)^{{-{exponent:.3f}}}$. At x/d = {FITTED[1]} (2.26) is "
        f"{ratio:.1f} times (2.27). In the rig the pilot opens by x/d of about 0.002: both are extrapolated there.",
    )
    return table, page


def _draw_misses(axes, seat: ChamferedSeat) -> None:
    """(2.26) over CFD, in percent, a bar per printed lift."""
    names = [f"{x * 1e3:.1f} mm" for x in CFD]
    misses = [100.0 * (loss_coefficient(x, seat) / zeta - 1.0) for x, zeta in CFD.items()]
    bars = axes.bar(names, misses, color="tab:blue", width=0.6)
    axes.bar_label(bars, [f"{miss:+.1f} %" for miss in misses], fontsize=9, padding=2)
    axes.axhline(0.0, color="0.4", linewidth=0.8)
    axes.margins(y=0.15)
    label(axes, "lift [mm]", "(2.26) over CFD [%]")
