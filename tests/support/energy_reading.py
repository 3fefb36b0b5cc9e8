"""What one piece of a run says of its energy: entries by the instants, for `tests/support/energy_book.py`."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.circuit.ends import LOWER, PUMP, TANK, TEE_1, TEE_2, UPPER, A, B
from twin.circuit.state import ENDS_AT, MEMORY_AT, place_of
from twin.lines.bank import Bank, steady_drop
from twin.orifice import resistance
from twin.topology import END_COUNT, LINES

Array = NDArray[np.float64]
OWN_ENDS = 2 * LINES


class Piece(NamedTuple):
    """Instants between two changes of the rig: the first as the change has left it, the last before the next."""

    parts: Any  # the circuit's numbers then, as the kernels have them
    lines: Bank
    rows: Array  # flat states


class Reading:
    """One piece, its quantities by the instants."""

    def __init__(self, piece: Piece, earlier: "Reading | None") -> None:
        self.parts, rows, e = piece.parts, piece.rows, ENDS_AT
        self.rows, self.earlier = rows, earlier
        last = rows[0] if earlier is None else earlier.rows[-2]
        self.lines, self.step = piece.lines, piece.parts["step"]
        self.p, self.q, self.cavity = (rows[:, e + k * END_COUNT : e + (k + 1) * END_COUNT] for k in range(3))
        self.x, self.v, self.spool = (
            rows[:, place_of(n)] for n in ("piston.position", "piston.velocity", "spool.position")
        )
        self.relieved = rows[:, place_of("relief.flow")]
        self.held = rows[:, [place_of("chambers.lower"), place_of("chambers.upper")]]
        places = MEMORY_AT + self.lines.lumped_place
        self.inner = rows[:, places + 2]  # half a step after each instant
        self.inner_before = np.vstack([last[places + 2], self.inner[:-1]])
        self.q_before = np.vstack([last[e + END_COUNT : e + 2 * END_COUNT], self.q[:-1]])
        self.own = self.p[:, :OWN_ENDS] - self._elbow_drops()  # pressures at the lines' own ends
        self.from_chambers = self.q[:, [LOWER, UPPER]]

    # --- what is stored

    def stored(self) -> Array:
        """All that is stored [J] at each instant."""
        load, vapour = self.parts["load"], self.parts["oil"]["vapour_pressure"]
        motion = 0.5 * load["mass"] * self.v**2 + load["mass"] * load["gravity"] * self.x
        return motion + self._lines() + self._chambers() - vapour * self.cavity[:, :OWN_ENDS].sum(axis=1)

    def _lines(self) -> Array:
        """Of a lumped line; its flow is known half a step before and after: their product is what the scheme keeps."""
        n = self.lines
        at = n.lumped_lines
        own = self.own.reshape(-1, LINES, 2)[:, at]
        compressed = 0.25 * n.capacity[at] * (own**2).sum(axis=2)
        return (compressed + 0.5 * n.inertance[at] * self.inner * self.inner_before).sum(axis=1)

    def entered(self) -> Array:
        """What the waves bring that enter at both ends of each line, a^2/(4 Z0), a = p + Z0 q [W]."""
        z = np.repeat(self.lines.z0, 2)[:OWN_ENDS]
        return ((self.own + z * self.q[:, :OWN_ENDS]) ** 2 / (4.0 * z)).reshape(-1, LINES, 2).sum(axis=2)

    def _chambers(self) -> Array:
        volumes, b = self._volumes(), self._moduli()
        vapour = self.parts["oil"]["vapour_pressure"]
        thinnest = 1.0 + vapour / b
        full = np.minimum(volumes, self.held / thinnest)  # what of it is oil
        return (b * (self.held * np.log(self.held / full) - self.held + full) - vapour * (volumes - full)).sum(axis=1)

    def _volumes(self) -> Array:
        c = self.parts["cylinder"]
        lower = c["dead_lower"] + c["area_lower"] * self.x
        return np.stack([lower, c["dead_upper"] + c["area_upper"] * (c["stroke"] - self.x)], axis=1)

    def _moduli(self) -> Array:
        c = self.parts["cylinder"]
        if "bulk_modulus" in (c.dtype.names or ()):
            return np.array([c["bulk_modulus"], c["bulk_modulus"]])
        return np.array([c["modulus_lower"], c["modulus_upper"]])

    def _worth(self) -> Array:
        """mu of the chambers' oil [Pa]."""
        return self._moduli() * np.log1p(self.p[:, [LOWER, UPPER]] / self._moduli())

    # --- what comes in

    def brought(self) -> dict[str, Array]:
        """For each step [J]."""
        return {
            "pump": self.step * mean(self.p[:, PUMP]) * self._component(PUMP),
            "force": self.parts["load"]["force"] * np.diff(self.x),
        }

    def _component(self, *ends: int) -> Array:
        """What a component delivers at a place [m^3/s], the mean of a step: what the lines take, less their cavity."""
        flow = self.q[:, list(ends)].sum(axis=1)
        opened = self.cavity[:, ends[0]]
        return mean(flow) - np.diff(opened) / self.step

    def _through(self, end: int) -> Array:
        """The same at each instant, of a place with one line: what has passed the part before it [m^3/s]."""
        opened = self.cavity[:, end]
        return self.q[:, end] - np.diff(opened, prepend=opened[0]) / self.step

    # --- what is lost

    def lost(self) -> dict[str, Array]:
        """For each step [J]."""
        h, p = self.step, self.p
        return {
            "tank": -h * mean(p[:, TANK]) * mean(self.q[:, TANK]),
            "relief valve": h * mean(p[:, TEE_1]) * mean(self.relieved),
            "filter": self._filter(),
            "lands": self._lands(),
            "elbows": self._elbows(),
            "lines": self._friction(),
            "density": h * (mean(p[:, [LOWER, UPPER]] - self._worth()) * mean(-self.from_chambers)).sum(axis=1),
            "leak": self._leak(),
            "holes": self._holes(),
            "seal": self._seal(),
        }

    def _filter(self) -> Array:
        return self.step * mean(self._since("_filter_drop")) * mean(self._through(TEE_2))

    def _filter_drop(self) -> Array:
        f = self.parts["fitting"]
        return (f["linear"] + f["quadratic"] * abs(self.q_before[:, TEE_2])) * self._through(TEE_2)

    def _since(self, drop: str) -> Array:
        """A drop [Pa] at each instant; at the first it is still that of the numbers before the change."""
        column = getattr(self, drop)()
        if self.earlier is not None:
            column[0] = getattr(self.earlier, drop)()[-1]
        return column

    def _elbows(self) -> Array:
        return self.step * (mean(self._elbow_drops()) * mean(self.q[:, :OWN_ENDS])).sum(axis=1)

    def _elbow_drops(self) -> Array:
        per_line = np.array([self.parts["losses"][f"line_{i + 1}"] for i in range(LINES)])
        return np.repeat(per_line, 2) * abs(self.q_before[:, :OWN_ENDS]) * self.q[:, :OWN_ENDS]

    def _friction(self) -> Array:
        """Of the inner flow between two instants."""
        flow = self.inner[:-1]
        lines = self.lines.lumped_lines
        drops = [[steady_drop(self.lines, i, q) * q for q in column] for i, column in zip(lines, flow.T, strict=True)]
        return self.step * np.sum(drops, axis=0) if drops else np.zeros(len(self.x) - 1)

    def _lands(self) -> Array:
        drops, flows = self._since("_land_drops"), self._land_flows()
        return self.step * (mean(drops) * mean(flows)).sum(axis=1)

    def _land_drops(self) -> Array:
        """Of the lands that A and B have open."""
        valve, q = self.parts["valve"], self._land_flows()
        a, b = np.array([_land(x, valve["orifice"], self.parts["oil"]) for x in self._land_area()]).T[:, :, None]
        return (a * abs(q) + b) * q

    def _land_flows(self) -> Array:
        through = np.stack([self._through(A), self._through(B)], axis=1)
        return np.where(self._land_area()[:, None] > 0.0, through, 0.0)

    def _land_area(self) -> Array:
        valve = self.parts["valve"]
        return valve["area"] * np.maximum(0.0, abs(self.spool) - valve["overlap"]) / (1.0 - valve["overlap"])

    def _leak(self) -> Array:
        p, worth = self.p, self._worth()
        flow = self.parts["cylinder"]["leakage"] * (p[:, LOWER] - p[:, UPPER])
        return self.step * mean(flow) * mean(worth[:, 0] - worth[:, 1])

    def _holes(self) -> Array:
        c, lost = self.parts["cylinder"], np.zeros(len(self.x) - 1)
        if "a_lower" not in (c.dtype.names or ()):
            return lost
        for side, end, name in ((0, LOWER, "lower"), (1, UPPER, "upper")):
            a, b, p = c[f"a_{name}"], c[f"b_{name}"], np.maximum(0.0, self.p[:, end])
            flow = 2.0 * p / (b + np.sqrt(b * b + 4.0 * a * p))
            lost += self.step * mean(flow) * mean(self._worth()[:, side])
        return lost

    def _seal(self) -> Array:
        s, moved = self.parts["seal"], np.diff(self.x)
        speed = abs(moved) / self.step
        load = s["width"] * mean(abs(self.p[:, LOWER] - self.p[:, UPPER]))
        z = np.maximum(s["viscosity"] * speed, 1e-300) / np.maximum(load, 1e-300)
        share = np.minimum(s["limit"], s["alpha"] * z ** s["beta"])
        return share * load * s["perimeter"] * np.where(moved < 0.0, s["downward"], 1.0) * abs(moved)


def mean(column: Array) -> Array:
    return 0.5 * (column[1:] + column[:-1])


def _land(area: float, orifice: Any, oil: Any) -> tuple[float, float]:
    return resistance(area, orifice, oil) if area > 0.0 else (0.0, 0.0)
