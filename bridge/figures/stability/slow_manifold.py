"""Figure 5.3: pressures fall on the critical manifold and follow the speed along it; and why that is not enough.

Source: 5.3.1, with alpha 0.01, k 0.5, gamma 0.5, s 10 of Fig. 5.4. Left the two sheets (5.17), one for each position of
the relay, and runs of the whole actuator with the relay held. Right the relay loop with pressures on the manifold,
compared with the whole loop, at a d below and one above d_H.
"""

from typing import Any

import numpy as np

from bridge.drawing.canvas import (
    Array,
    Columns,
    Sheet,
    label,
    remark,
    sheet,
)
from controller.stability.actuator.model import Actuator, Feedback, mirror
from controller.stability.actuator.relay import relay_edge
from controller.stability.actuator.slow_fast import (
    critical_manifold,
    full_rates,
    reduced_rates,
    slides,
)
from controller.stability.orbits.arc import RELAY, follow
from controller.stability.orbits.floquet import samples
from controller.stability.orbits.limit_cycle import Orbit, analogue_loop
from twin.integration import integrate

PLANT = Actuator(0.01, 0.5, 0.5)
S, GAINS = 10.0, (0.1, 0.35)  # s, and d below and above d_H
STIFF = 0.001  # alpha of the runs on the left: the fall is steeper than the picture can show at 0.01
STARTS = ((-0.30, -0.6), (-0.1, -0.1), (0.28, 0.9), (-0.2, 1.0))  # y2, y3 - y4
MOST = 200_000  # evaluations of the rates in a run, which takes some thousand
LEAST = 1e-12  # of the time: a shorter arc does not lead on
PLACES, LONGEST, SPEED = 801, 5.0, -2e-3  # of the table; time and first y2 on the right
BLUE, RED, GREY, GREEN = "#2a6fbb", "#c8413b", "#8a8f98", "#3a9150"


def sheets(y2: Array) -> tuple[Array, Array]:
    """y3 - y4 on the manifold for u = 1 and u = -1."""
    up, down = (critical_manifold(y2, u, PLANT.gamma) for u in (1.0, -1.0))
    return up[0] - up[1], down[0] - down[1]


def fall(speed: float, difference: float) -> tuple[Array, Array]:
    """y2 and y3 - y4 of the actuator held at u = 1, evenly along its way in the picture."""
    start = [0.0, speed, 0.5 + 0.5 * difference, 0.5 - 0.5 * difference]

    def rates(_t: float, y: Array) -> Array:
        return full_rates(np.asarray(y, np.float64), 1.0, PLANT.k, PLANT.gamma, STIFF)

    times = np.geomspace(1e-6, 1.5, 4000)
    y = integrate(rates, (0.0, 1.5), start, "Radau", most=MOST, t_eval=times, rtol=1e-8, atol=1e-10).y
    across, up = y[1], y[2] - y[3]
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(across) / 0.3, np.diff(up)))])
    even = np.linspace(0.0, way[-1], PLACES)
    return np.interp(even, way, across), np.interp(even, way, up)


def whole(d: float, times: Array) -> Array:
    """y2 of the whole relay loop, from a start on the manifold."""
    y3, y4 = critical_manifold(SPEED, 1.0, PLANT.gamma)
    y, loop = np.array([0.0, SPEED, y3, y4]), analogue_loop(RELAY, PLANT, Feedback(S, d))
    seen, speeds, side = [0.0], [SPEED], 1.0
    while seen[-1] < times[-1] and abs(speeds[-1]) > 1e-6:  # above d_H its switchings pile up at rest
        row, length = follow(y, times[-1] - seen[-1], loop, 1e-10, True)
        if length < LEAST * times[-1]:
            raise ArithmeticError(f"the arc from {seen[-1]:.6g} on does not end: its steps vanish, or it has no length")
        t, states = samples(Orbit(loop, y[None, :], np.array([length])), 0, 24)
        seen, speeds = [*seen, *(seen[-1] + t[1:])], [*speeds, *(side * states[1:, 1])]
        y, side = mirror(row[:4]), -side
    return np.interp(times, seen, speeds, right=0.0)


def reduced(d: float, times: Array) -> Array:
    """y2 of the relay loop on the manifold: it switches while it must, and slides, y2' = -(s/d) y2, once it can."""
    values = np.empty((PLACES, 2))
    time, y, side, filled = 0.0, np.array([0.0, SPEED]), 1.0, 0

    def switch(_t: float, y: Array) -> float:
        return S * y[0] + d * y[1]

    switch.terminal = True  # pyright: ignore[reportFunctionMemberAccess]
    while filled < PLACES:
        switch.direction = side  # pyright: ignore[reportFunctionMemberAccess]

        def rates(_t: float, y: Array, u: float = side) -> Array:
            return np.array(reduced_rates(float(y[1]), u, PLANT.k, PLANT.gamma, PLANT.alpha), float)

        span = (time, float(times[-1]))
        piece = integrate(rates, span, y, "RK45", most=MOST, events=switch, dense_output=True, rtol=1e-9, atol=1e-14)
        if piece.t[-1] - time < LEAST * times[-1]:
            raise ArithmeticError(f"the relay switches again within {LEAST:g} of the time, at {time:.6g}")
        upto = int(np.searchsorted(times, piece.t[-1], side="right"))
        if upto > filled:
            values[filled:upto] = piece.sol(times[filled:upto]).T
        filled, time, y, side = upto, piece.t[-1], piece.y[:, -1], -side
        if slides(y[1], S, d, PLANT.k, PLANT.gamma, PLANT.alpha):
            values[filled:, 1] = y[1] * np.exp(-S / d * (times[filled:] - time))
            break
    return values[:, 1]


def manifold() -> Columns:
    """The numbers of the figure."""
    speeds, times = np.linspace(-0.4, 0.4, PLACES), np.linspace(0.0, LONGEST, PLACES)
    up, down = sheets(speeds)
    columns: Columns = {"y2 [-]": speeds, "y3 - y4 at u 1 [-]": up, "y3 - y4 at u -1 [-]": down}
    for i, start in enumerate(STARTS):
        columns[f"run {i + 1} y2 [-]"], columns[f"run {i + 1} y3 - y4 [-]"] = fall(*start)
    columns["time [-]"] = times
    for d in GAINS:
        columns[f"y2 on the manifold d {d:g} [-]"] = reduced(d, times)
        columns[f"y2 of the whole loop d {d:g} [-]"] = whole(d, times)
    return columns


def draw_manifold() -> tuple[Columns, Sheet]:
    """Figure 5.3."""
    columns = manifold()
    page, (left, right) = sheet("Pressures fall on the critical manifold, and what that leaves out", 2)
    _draw_sheets(left, columns)
    times = columns["time [-]"]
    for d, colour in zip(GAINS, (RED, GREEN), strict=True):
        right.plot(
            times, 1e3 * columns[f"y2 of the whole loop d {d:g} [-]"], color=colour, label=f"whole loop, d {d:g}"
        )
        on = 1e3 * columns[f"y2 on the manifold d {d:g} [-]"]
        right.plot(times, on, "--", color=colour, linewidth=1.1, label=f"on the manifold, d {d:g}")
    label(right, "time", "velocity y2 / 1e-3")
    right.set(xlim=(0.0, LONGEST), ylim=(-2.1, 2.7))
    right.legend(fontsize=8, frameon=False, loc="upper right", ncols=2)
    edge = float(relay_edge(S, PLANT.k, PLANT.gamma, PLANT.alpha))
    remark(
        page,
        f"Left: relay held at u = 1, alpha {STIFF:g}. Right: relay loop, s {S:g}, alpha {PLANT.alpha:g}. "
        f"On the manifold it comes to rest at every d > 0; the whole loop oscillates below d_H = {edge:.4f}.",
    )
    return columns, page


def _draw_sheets(axes: Any, columns: Columns) -> None:
    y2 = columns["y2 [-]"]
    axes.plot(y2, columns["y3 - y4 at u 1 [-]"], color=BLUE, linewidth=2.2, label="manifold, h < 0, u = 1")
    axes.plot(y2, columns["y3 - y4 at u -1 [-]"], color=RED, linewidth=2.2, label="manifold, h > 0, u = -1")
    for i in range(len(STARTS)):
        across, up = columns[f"run {i + 1} y2 [-]"], columns[f"run {i + 1} y3 - y4 [-]"]
        axes.plot(across, up, color="0.25", linewidth=1.0, label="runs of the actuator at u = 1" if i == 0 else None)
        axes.plot(across[0], up[0], "o", color="0.25", markersize=4)
        for share in (0.25, 0.85):
            j = int(share * PLACES)
            ahead = {"arrowstyle": "->", "color": "0.25"}
            axes.annotate("", (across[j + 3], up[j + 3]), (across[j], up[j]), arrowprops=ahead)
    axes.set(xlim=(-0.4, 0.4), ylim=(-1.7, 2.5))
    label(axes, "velocity y2", "pressure difference y3 - y4")
    axes.legend(fontsize=8, frameon=False, loc="upper right")
