"""What a valve's designer is told: physical references, seats at equal flow, the static curve's shapes, the verbs."""

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from bridge.cli.verbs import app
from bridge.errors import UsageError
from bridge.studies.sweep.engine import HERE
from bridge.studies.valve.chart import rows as chart_rows
from bridge.studies.valve.chatter import truly_damped
from tests.support.relief_valve import (
    BAR,
    LITRE_PER_MINUTE,
    SHEET,
    SHEET_OIL,
    valve,
)
from twin.chatter.basin import chart
from twin.chatter.build import pilot_of
from twin.chatter.equilibrium import growth, onset
from twin.chatter.physical import Pilot, compare, displacement, equal_flow, lift, narrowing, reference, system
from twin.chatter.system import CHAMFERED, CONICAL
from twin.relief.sensitivity import (
    curve,
    identifiable,
    knee,
    sensitivities,
    set_and_override,
)
from twin.rig import values
from twin.seats.chamfered import ChamferedSeat, discharge_flow
from twin.seats.conical import ConicalSeat, flow

SINE = math.radians(21.0)
PILOT = Pilot(
    10.6e-3, 811e3, 1.5 * 0.03512 * 13e-3 * math.pi * 10.0, ChamferedSeat(5.6e-3, SINE, 0.8, 0.369, 2.3, 878.0),
    ConicalSeat(2.8e-3, 3.21e-3, SINE, 0.03512), 1.55e9, 2.356e-4, 0.23e-3, 0.8,
)  # fmt: skip
SPRING, SHEAR, FILM = ("spring",), ("spring", "shear"), ("spring", "shear", "film")


def test_the_references_are_those_of_chapter_4_recomputed():
    """Printed: 75.73 bar, 9.14 and 3.95 l/min, beta 0.0152 and 0.00657; sigma 6.244e-4, which is 22 times too small."""
    a, b = reference(CHAMFERED, PILOT), reference(CONICAL, PILOT)
    assert a.omega == pytest.approx(8746.97, abs=0.01)
    assert a.pressure / BAR == pytest.approx(75.7326, abs=1e-4)
    assert a.flow / LITRE_PER_MINUTE == pytest.approx(9.1421, abs=1e-4)
    assert (a.beta, b.beta) == pytest.approx((0.015132, 0.006538), abs=1e-6)
    assert b.flow / LITRE_PER_MINUTE == pytest.approx(3.9499, abs=1e-4)
    assert narrowing(PILOT) == pytest.approx(0.013741, abs=1e-6)
    assert displacement(PILOT) == pytest.approx(0.00492, abs=1e-5)
    assert system(CHAMFERED, 1e-5, 0.0, PILOT).damping == pytest.approx(2.3191e-4, rel=1e-3)
    cubic = (a.omega * PILOT.volume / (PILOT.modulus * b.flow / (b.pressure * PILOT.reference_lift**3))) ** (1.0 / 3.0)
    assert cubic == pytest.approx(1.2300e-3, rel=1e-4)  # where beta would be 1; printed 0.232 mm


@pytest.mark.parametrize("law", [CHAMFERED, CONICAL])
def test_the_steady_lift_passes_the_flow_by_the_seats_own_law(law):
    """sigma y1 and the conical seat's next order are what the scaled laws leave out: 1 % at these lifts."""
    for litres in (0.02, 0.2, 0.6):
        q = litres * LITRE_PER_MINUTE
        x, p = lift(law, q, 0.23e-3, PILOT), compare(law, q, 0.23e-3, PILOT).pressure
        through = discharge_flow(x, p, PILOT.chamfered) if law == CHAMFERED else flow(x, p, 0.0, PILOT.conical)
        assert through == pytest.approx(q, rel=0.01)


def test_equal_flow_by_what_counts_as_damping():
    """[l/min] beyond which the conical seat is worse; ten times better only below 0.0043 (0.076 precompressed)."""
    for e, flows in ((0.0, (1.08296, 17.7157, 349.832)), (0.23e-3, (2.40078, 23.0689, 401.078))):
        found = [equal_flow(e, PILOT, parts) / LITRE_PER_MINUTE for parts in (SPRING, SHEAR, FILM)]
        assert found == pytest.approx(flows, rel=1e-5)
    for e, litres in ((0.0, 0.0043115), (0.23e-3, 0.0762075)):
        a, b = (compare(law, litres * LITRE_PER_MINUTE, e, PILOT).critical for law in (CHAMFERED, CONICAL))
        assert a / b == pytest.approx(10.0, rel=1e-5)


def test_with_its_film_the_conical_seat_is_calm_where_the_pilot_works_without_it_not():
    """Up to 1 l/min; the chamfered sings everywhere. By eigenvalues, not by K/K_crit."""
    for litres in (0.01, 0.1, 1.0):
        q = litres * LITRE_PER_MINUTE
        assert (
            growth(truly_damped(CONICAL, q, 0.23e-3, PILOT)) < 0.0 < growth(truly_damped(CHAMFERED, q, 0.23e-3, PILOT))
        )
    shear_only = compare(CONICAL, LITRE_PER_MINUTE, 0.23e-3, PILOT)
    assert shear_only.safety(*SHEAR) < 1.0 < shear_only.safety(*FILM)


def test_volume_and_length_of_the_seat_count():
    """Twice the volume halves beta and so K_crit; a longer seat squeezes more oil."""
    q = 0.1 * LITRE_PER_MINUTE
    one, two = (onset(system(CHAMFERED, q, 0.0, PILOT._replace(volume=v * PILOT.volume))).damping for v in (1.0, 2.0))
    assert one / two == pytest.approx(2.0, rel=1e-4)
    longer = PILOT._replace(conical=PILOT.conical._replace(length=2.0 * PILOT.conical.length))
    assert compare(CONICAL, q, 0.0, longer).damping.film > 3.0 * compare(CONICAL, q, 0.0, PILOT).damping.film


def test_the_knee_and_the_openings_are_those_of_the_table():
    v = valve(pilot_precompression=0.2e-3)
    bend = knee(v)
    assert bend.cracking / BAR == pytest.approx(65.854, abs=5e-4)
    assert bend.pressure / BAR == pytest.approx(71.972, abs=5e-4)
    assert bend.flow / LITRE_PER_MINUTE == pytest.approx(0.22507, abs=5e-6)
    found = curve(np.array([0.5, 1.0, 25.0]) * bend.flow, v)
    assert found.spool_lift[0] == 0.0 < found.spool_lift[2]
    assert found.pilot_flow[0] == pytest.approx(0.5 * bend.flow, rel=1e-9)
    assert found.pilot_flow[2] < 1.2 * bend.flow  # the main stage takes the rest


def test_sensitivities_are_those_of_the_balances():
    """Cracking is s x0/A: 1, 1 and -2 in logarithms. At the knee the spool's spring counts by s x0 alone."""
    sizes = {**SHEET, "pilot_precompression": 0.2e-3}
    names, low = sensitivities([1e-6 * LITRE_PER_MINUTE], sizes, SHEET_OIL)
    relative = dict(zip(names, low[0] / (65.854 * BAR), strict=True))
    assert relative["pilot_stiffness"] == pytest.approx(1.0, abs=2e-3)
    assert relative["pilot_precompression"] == pytest.approx(1.0, abs=2e-3)
    assert relative["seat_diameter"] == pytest.approx(-2.0, abs=5e-3)
    names, bend = sensitivities([0.2250698 * LITRE_PER_MINUTE * 1.0001], sizes, SHEET_OIL)
    at_knee = dict(zip(names, bend[0], strict=True))
    assert at_knee["spool_stiffness"] == pytest.approx(at_knee["spool_precompression"], rel=0.02)
    assert "spool_mass" not in names
    _, shaped = set_and_override(LITRE_PER_MINUTE, 100.0 * LITRE_PER_MINUTE, sizes, SHEET_OIL)
    assert shaped[1][names.index("pilot_stiffness")] < 0.03 * shaped[0][names.index("pilot_stiffness")]


def test_the_curve_cannot_tell_orifice_2_but_tells_the_pilot():
    sizes = {**SHEET, "pilot_precompression": 0.2e-3}
    names, found = sensitivities(np.geomspace(0.01, 200.0, 15) * LITRE_PER_MINUTE, sizes, SHEET_OIL)
    told = identifiable(names, found, 3e3)
    assert np.linalg.norm(found @ told.directions.T, axis=0)[:6] / 3e3 == pytest.approx(told.singular[:6], rel=1e-6)
    assert told.directions @ told.directions.T == pytest.approx(np.eye(len(told.singular)), abs=1e-9)
    assert told.known == 5 < len(names)
    best = dict(zip(names, np.abs(told.directions[0]), strict=True))
    assert best["seat_diameter"] > 0.7 > 0.05 > best["nozzle_diameter"]
    share = sum(told.directions[i][names.index("nozzle_diameter")] ** 2 for i in range(told.known))
    assert share < 0.05  # of it lies in what is told


def test_a_chart_is_the_same_by_rows(tmp_path: Path):
    s = system(CONICAL, reference(CONICAL, PILOT).flow, 0.0, PILOT)
    flows, dampings = np.array([0.1, 0.4]), np.linspace(0.001, 0.02, 5)
    by_rows, whole = chart_rows(s, flows, dampings, tmp_path / "part", HERE), chart(s, flows, dampings, shut=False)
    for one, other in zip(by_rows, whole, strict=True):
        assert one.tolist() == other.tolist()


def asked(tmp_path: Path, *words: str) -> dict:
    result = CliRunner().invoke(app, ["valve", *words, "--json", "-o", str(tmp_path)], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return json.loads(result.output)


def test_the_verbs_answer_with_numbers_a_picture_and_a_table(tmp_path: Path):
    static = asked(tmp_path, "static", "--set", "rig.relief.setting=150bar")
    assert static["knee"]["pressure"] == pytest.approx(149.3 * BAR, rel=2e-3)
    seat = asked(tmp_path, "seat", "conical", "--lift", "0.1mm", "--drop", "10bar")
    assert seat["film_damping"] == pytest.approx(67.85, rel=1e-3)
    assert seat["warnings"] == []
    moving = asked(tmp_path, "seat", "conical", "--lift", "0.1mm", "--drop", "10bar", "--speed", "0.5 m/s")
    assert moving["cylinder_force"] < seat["cylinder_force"] < seat["cylinder_force_middle"]
    assert moving["shear_force"] == pytest.approx(moving["shear_force_by_pressure"] + moving["shear_force_by_speed"])
    assert moving["channel_force_by_speed"] == pytest.approx(moving["shear_force_by_speed"], rel=0.04)
    assert asked(tmp_path, "seat", "chamfered", "--lift", "10um", "--drop", "10bar")["warnings"]
    sings = asked(tmp_path, "chatter", "chamfered", "--flow", "0.3l/min", "--precompression", "0.23mm")
    assert sings["sings"]
    assert sings["impact"]["frequency"] == pytest.approx(1596.0, rel=2e-3)
    assert not asked(tmp_path, "chatter", "conical", "--flow", "0.3l/min")["sings"]
    asked_for = ("chart", "conical", "--cells", "3", "--workers", "1")
    assert CliRunner().invoke(app, ["valve", *asked_for, "-o", str(tmp_path)], catch_exceptions=False).exit_code == 0
    for name in ("static", "seat-conical", "seat-chamfered", "chatter-chamfered", "chatter-conical", "chart-conical"):
        assert (tmp_path / f"valve-{name}.png").stat().st_size > 20_000
        with (tmp_path / f"valve-{name}.csv").open(newline="") as file:
            header, *rows = csv.reader(file)
        assert all(column.endswith("]") for column in header)
        assert np.isfinite(np.array(rows, float)).all()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("seat", "round"), "no seat 'round' \\(valid: chamfered, conical\\)"),
        (("seat", "conical", "--lift", "9 mm"), "leaves no gap"),
        (("seat", "chamfered", "--lift", "0.2 mm", "--speed", "1 m/s"), "only the conical seat has a viscous force"),
        (("chatter", "conical", "--flow", "3 bar"), "--flow '3 bar'"),
        (("chatter", "conical", "--flow", "0"), "take a flow above 0"),
        (("chart", "conical", "--flows", "0.5:0.1"), "it must rise"),
        (("static", "--set", "rig.relief.kind=none"), "take two-stage"),
        (("static", "--set", "rig.relief.setting=2bar"), "take a higher setting"),
    ],
)
def test_a_mistake_is_one_line(tmp_path: Path, words: tuple[str, ...], said: str):
    with pytest.raises(UsageError, match=said):
        CliRunner().invoke(app, ["valve", *words, "-o", str(tmp_path)], catch_exceptions=False)
    assert not list(tmp_path.iterdir())


def test_the_rigs_own_pilot_is_that_of_chapter_4():
    own = pilot_of(values())
    assert own.drag == pytest.approx(0.0215, abs=1e-4)
    assert own[:2] == PILOT[:2]
    assert own.conical.viscosity == pytest.approx(0.03512, rel=2e-4)
