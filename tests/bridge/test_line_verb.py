"""`hydrotwin line`: what it writes and says, and one line for every mistake."""

import csv
import inspect
import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from bridge.cli.line import line as verb
from bridge.cli.verbs import app
from bridge.errors import UsageError
from bridge.studies.line.case import LineOptions
from bridge.studies.line.study import facts as what_it_says
from bridge.studies.line.study import study


def line(folder: Path, *options: str):
    return CliRunner().invoke(app, ["line", "-o", str(folder), *options])


def asked(*options: str) -> dict[str, str]:
    """Facts without a picture: the verb's own defaults, changed."""
    chosen = {name: value.default for name, value in inspect.signature(verb).parameters.items()}
    chosen |= {
        name.removeprefix("--").replace("-", "_"): value
        for name, value in zip(options[::2], options[1::2], strict=True)
    }
    chosen["cells"], chosen["cavitation"] = int(chosen["cells"]), chosen["cavitation"] == "yes"
    return dict(what_it_says(study(LineOptions(**{name: chosen[name] for name in LineOptions._fields}))))


def facts(folder: Path, *options: str) -> dict[str, str]:
    result = line(folder, "--json", *options)
    assert result.exit_code == 0, result.exception
    return json.loads(result.stdout)["facts"]


def test_defaults_are_the_rigs_second_line(tmp_path: Path):
    """1137 m/s in steel from oil and wall, 40 mm^2/s, 2.5 m; characteristics within 0.5 % of the exact line."""
    found = facts(tmp_path)
    assert found["wave speed"] == "1137 m/s"
    assert found["travel time L/a"] == "2.199 ms"
    assert found["viscosity"] == "40.00 mm^2/s"
    assert float(found["rms error against the exact line"].split()[0]) < 0.5
    assert (tmp_path / "line.png").stat().st_size > 10_000
    with (tmp_path / "line.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 1001  # 20 travel times of 50 cells
    assert float(rows[-1]["time [s]"]) == pytest.approx(20 * 2.5 / 1137.0, rel=1e-3)
    assert float(rows[500]["pressure left [Pa]"]) == pytest.approx(
        float(rows[500]["exact pressure left [Pa]"]), abs=0.01 * 9.98e5
    )


@pytest.mark.parametrize(
    "options",
    [
        ("--scheme", "fem/esdirk4", "--cells", "20"), ("--scheme", "ends"), ("--scheme", "nodes"),
        ("--scheme", "exact"), ("--left", "open", "--friction", "kagawa"),
        ("--left", "closed", "--right", "push", "--rise", "5 bar"),
        ("--left", "reservoir", "--right", "shut", "--friction", "steady", "--temperature", "60 degC"),
        ("--scheme", "cds5/esdirk3", "--tolerance", "0.001 bar"),
    ],
)  # fmt: skip
def test_schemes_and_ends_meet_the_exact_line(options: tuple[str, ...]):
    found = asked(*options, "--span", "20 ms")
    assert float(found["rms error against the exact line"].split()[0]) < 3.0


def test_joukowsky():
    """rho a v of a frictionless line: the inlet swings by as much, 878 * 1000 * 2 = 17.56 bar."""
    options = ("--friction", "none", "--speed", "1000 m/s", "--velocity", "2 m/s", "--left", "reservoir")
    found = asked(*options, "--right", "shut", "--pressure", "30 bar")
    assert found["Joukowsky pressure"] == "17.560 bar"
    assert found["pressure right"] == "12.440 .. 47.560 bar"


def test_cavitation_keeps_the_vapour_pressure():
    options = ("--left", "reservoir", "--right", "shut", "--velocity", "3", "--pressure", "5 bar")
    for scheme in ("nodes", "ends"):
        found = asked(*options, "--cavitation", "yes", "--scheme", scheme)
        assert found["pressure right"].startswith("-1.000 ")
        assert "rms error against the exact line" not in found


BRANCH = ("--friction", "none", "--speed", "1000 m/s", "--length", "2 m", "--cells", "40")


def test_a_branch_as_wide_as_the_pipe_passes_two_thirds_of_a_wave():
    """A push p meets two equal lines: 2/3 p goes on, (2.101), until an echo comes back: 4 ms after the push at 1 m."""
    found = asked(*BRANCH, "--left", "push", "--right", "closed", "--closure", "0 s", "--span", "1.9 ms",
                  "--branch", "1 m", "--branch-diameter", "11 mm")  # fmt: skip
    assert found["pressure junction"] == "20.000 .. 26.667 bar"
    assert found["Courant numbers: left, right, branch"] == "1.000, 1.000, 1.000"


def test_a_branch_begins_at_rest_and_stays_so():
    """Nothing happens: steady flow past a branch, open to a reservoir at the junction's pressure or closed."""
    for end in ("closed", "reservoir"):
        found = asked("--left", "reservoir", "--right", "reservoir", "--branch", "0.7 m", "--branch-end", end)
        assert {found[f"pressure {name}"] for name in ("left", "right", "junction", "branch end")} == {
            "20.000 .. 20.000 bar"
        }


def test_a_branch_is_in_table_and_picture(tmp_path: Path):
    found = facts(tmp_path, "--left", "open", "--branch", "1.2 m", "--branch-diameter", "16 mm", "--closure", "5 ms")
    assert "pressure branch end" in found
    with (tmp_path / "line.csv").open() as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    low, high = (f([row["pressure branch end [Pa]"] for row in rows]) / 1e5 for f in (min, max))
    assert found["pressure branch end"] == f"{low:.3f} .. {high:.3f} bar"
    assert max(row["flow into branch [m^3/s]"] for row in rows) > 1e-5


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--branch", "1 m", "--scheme", "ends"), "scheme ends has no junctions; with --branch take moc"),
        (("--branch", "1 m", "--branch-at", "3 m"), "--branch-at 3 m is not inside the pipe of 2.5 m"),
        (("--branch", "1 m", "--branch-end", "open"), "branch end 'open' is unknown (valid: closed, reservoir)"),
        (("--branch", "1 um"), "take a longer one, or a shorter --span"),
        (("--branch", "1e6 m"), "take a shorter --branch"),
        (("--branch", "-1 m"), "--branch '-1 m': must be above 0"),
        (("--left", "closed", "--right", "closed"), "one end must hold pressure"),
        (("--left", "shut", "--right", "hatch"), "end 'hatch' is unknown (valid: closed"),
        (("--scheme", "moo"), "scheme 'moo' unknown; known: moc"),
        (("--friction", "moody"), "friction 'moody' unknown; known: none"),
        (("--length", "-1 m"), "--length '-1 m': must be above 0"),
        (("--length", "3 kg"), "unit 'kg' does not fit"),
        (("--diameter", "nan"), "--diameter: cannot read 'nan'"),
        (("--friction", "convolution", "--scheme", "fem/bdf2"), "take scheme moc"),
        (("--courant", "1.5"), "Courant number 1.5 is outside 0 < C <= 1"),
        (("--cavitation",), "take ends or nodes"),
        (("--temperature", "90 degC"), "holds from -20 to 80 deg C"),
        (("--oil", "milk"), "oil 'milk' unknown"),
        (("--scheme", "fem/bdf2", "--tolerance", "10 Pa"), "no embedded error"),
        (("--scheme", "cds5/bdf2", "--cells", "4"), "take 8 or more"),
        (("--cells", "0"), "--cells 0 is outside 1 .. 2000"),
        (("--poles", "0", "--friction", "zielke"), "--poles 0 is outside"),
        (("--span", "1e9 s"), "take a shorter one or fewer cells"),
        (("--span", "1 us"), "is shorter than a step"),
        (("--scheme", "ends", "--step", "10 ms"), "take a smaller step"),
        (("--scheme", "nodes", "--friction", "trikha"), "take one of none, steady, quasi-steady, fit"),
        (("--scheme", "exact", "--friction", "brunone"), "has no exact answer"),
    ],
)
def test_mistakes_get_one_line(tmp_path: Path, options: tuple[str, ...], message: str):
    """`main` prints a UsageError as one line and exits with 2."""
    result = line(tmp_path, *options)
    assert isinstance(result.exception, UsageError)
    assert message in str(result.exception)
    assert "\n" not in str(result.exception)
    assert not (tmp_path / "line.csv").exists()
