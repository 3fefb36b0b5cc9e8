"""Oils by grade: their viscosity index by ASTM D2270, Walther's straight line, a maker's chart."""

import math

import pytest

from twin.iso_vg import GRADES, grade_viscosity

D2270 = (  # from nu at 100 deg C: L = a Y^2 + b Y + c of index 0, H = d Y^2 + e Y + f of index 100
    (3.8, (3.38095, -15.4952, 33.196, 0.78571, 1.7929, -0.183)),
    (4.4, (2.5, -7.2143, 13.812, 0.82143, 1.5679, 0.119)),
    (5.0, (0.101, 16.635, -45.469, 0.04985, 9.1613, -18.557)),
    (6.4, (3.35714, -23.5643, 78.466, 0.22619, 7.7369, -16.656)),
    (7.0, (0.01191, 21.475, -72.87, 0.79762, -0.7321, 14.61)),
    (7.7, (0.41858, 16.1558, -56.04, 0.05794, 10.5156, -28.24)),
    (9.0, (0.88779, 7.5527, -16.6, 0.26665, 6.7015, -10.81)),
)


@pytest.mark.parametrize("grade", GRADES)
def test_a_grade_is_named_by_40_degrees_and_has_the_index_100(grade: str):
    """VI = 100 (L - U)/(L - H) by the formulas of ASTM D2270; a digit of nu at 100 deg C is 0.3 of it."""
    at_40, y = (1e6 * grade_viscosity(grade, t) for t in (40.0, 100.0))
    assert at_40 == pytest.approx(float(grade), rel=1e-12)
    a, b, c, d, e, f = next(row for low, row in reversed(D2270) if y >= low)
    least, most = a * y**2 + b * y + c, d * y**2 + e * y + f
    assert 100.0 * (least - at_40) / (least - most) == pytest.approx(100.0, abs=0.3)


@pytest.mark.parametrize("grade", GRADES)
def test_viscosity_is_a_straight_line_on_walthers_chart(grade: str):
    """log10 log10(nu + 0.7) over log10 T, from -20 to 80 deg C."""
    points = [(math.log10(t + 273.15), 1e6 * grade_viscosity(grade, t)) for t in (-20.0, 5.0, 30.0, 55.0, 80.0)]
    line = [(x, math.log10(math.log10(nu + 0.7))) for x, nu in points]
    slopes = [(y - line[0][1]) / (x - line[0][0]) for x, y in line[1:]]
    assert slopes == pytest.approx([slopes[0]] * 4, rel=1e-9)
    assert [nu for _, nu in points] == sorted((nu for _, nu in points), reverse=True)


@pytest.mark.parametrize(("grade", "celsius", "read"), [("46", 30.0, 80.0), ("46", 75.0, 12.0), ("68", 75.0, 18.0)])
def test_viscosities_are_those_of_a_makers_chart(grade: str, celsius: float, read: float):
    """Read off a chart of hydraulic oils, mm^2/s; 15 %: its lines are wide, its oils not all of index 100."""
    assert 1e6 * grade_viscosity(grade, celsius) == pytest.approx(read, rel=0.15)
