"""Explicit first stage, singly diagonally implicit Runge-Kutta pairs of orders 3, 4, 5.

The implicit parts of ARK3(2)4L[2]SA, ARK4(3)6L[2]SA and ARK5(4)8L[2]SA, Kennedy and Carpenter 2003: L-stable, stiffly
accurate, stage order 2. The tests hold all order conditions of both members.
"""

from fractions import Fraction
from typing import NamedTuple

import numpy as np

from twin.lines.lab.pipe import Array

F = Fraction


class Tableau(NamedTuple):
    """Butcher's tableau of a pair; the last row of `a` is `b`."""

    order: int
    a: Array  # (s, s), lower triangle, 0 first on its diagonal, gamma below
    b: Array  # (s,)
    embedded: Array  # (s,), of order - 1
    c: Array  # (s,)

    @property
    def gamma(self) -> float:
        """The diagonal."""
        return float(self.a[1, 1])


def _tableau(order: int, gamma: F, lower: list[list[F]], b: list[F], embedded: list[F], c: list[F]) -> Tableau:
    stages = len(b)
    a = np.zeros((stages, stages))
    for i, row in enumerate([*lower, b[:-1]], start=1):
        a[i, : len(row)] = [float(value) for value in row]
        a[i, i] = float(gamma)
    return Tableau(order, a, *(np.array([float(value) for value in row]) for row in (b, embedded, c)))


_G3 = F(1767732205903, 4055673282236)
ESDIRK3 = _tableau(
    3, _G3,
    [[_G3], [F(2746238789719, 10658868560708), F(-640167445237, 6845629431997)]],
    [F(1471266399579, 7840856788654), F(-4482444167858, 7529755066697), F(11266239266428, 11593286722821), _G3],
    [F(2756255671327, 12835298489170), F(-10771552573575, 22201958757719), F(9247589265047, 10645013368117),
     F(2193209047091, 5459859503100)],
    [F(0), 2 * _G3, F(3, 5), F(1)],
)  # fmt: skip
ESDIRK4 = _tableau(
    4, F(1, 4),
    [[F(1, 4)], [F(8611, 62500), F(-1743, 31250)], [F(5012029, 34652500), F(-654441, 2922500), F(174375, 388108)],
     [F(15267082809, 155376265600), F(-71443401, 120774400), F(730878875, 902184768), F(2285395, 8070912)]],
    [F(82889, 524892), F(0), F(15625, 83664), F(69875, 102672), F(-2260, 8211), F(1, 4)],
    [F(4586570599, 29645900160), F(0), F(178811875, 945068544), F(814220225, 1159782912), F(-3700637, 11593932),
     F(61727, 225920)],
    [F(0), F(1, 2), F(83, 250), F(31, 50), F(17, 20), F(1)],
)  # fmt: skip
ESDIRK5 = _tableau(
    5, F(41, 200),
    [[F(41, 200)], [F(41, 400), F(-567603406766, 11931857230679)],
     [F(683785636431, 9252920307686), F(0), F(-110385047103, 1367015193373)],
     [F(3016520224154, 10081342136671), F(0), F(30586259806659, 12414158314087), F(-22760509404356, 11113319521817)],
     [F(218866479029, 1489978393911), F(0), F(638256894668, 5436446318841), F(-1179710474555, 5321154724896),
      F(-60928119172, 8023461067671)],
     [F(1020004230633, 5715676835656), F(0), F(25762820946817, 25263940353407), F(-2161375909145, 9755907335909),
      F(-211217309593, 5846859502534), F(-4269925059573, 7827059040749)]],
    [F(-872700587467, 9133579230613), F(0), F(0), F(22348218063261, 9555858737531), F(-1143369518992, 8141816002931),
     F(-39379526789629, 19018526304540), F(32727382324388, 42900044865799), F(41, 200)],
    [F(-975461918565, 9796059967033), F(0), F(0), F(78070527104295, 32432590147079), F(-548382580838, 3424219808633),
     F(-33438840321285, 15594753105479), F(3629800801594, 4656183773603), F(4035322873751, 18575991585200)],
    [F(0), F(41, 100), F(2935347310677, 11292855782101), F(1426016391358, 7196633302097), F(92, 100), F(24, 100),
     F(3, 5), F(1)],
)  # fmt: skip
PAIRS = {"esdirk3": ESDIRK3, "esdirk4": ESDIRK4, "esdirk5": ESDIRK5}
