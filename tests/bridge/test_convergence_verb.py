"""`hydrotwin convergence`: how far results depend on the step."""

import json
import math

import numpy as np
import pytest

from bridge.runs.convergence import (
    COMPARED,
    Row,
    _row,
    convergence,
)
from bridge.scenario import Scenario, load
from tests.support.command import hydrotwin_here

LUMPED = [f"rig.pipe_{i}.model=lumped" for i in range(1, 7)]
HALF_OPEN = ["controller.kind=open-loop", "reference={kind='constant', value=0.5}"]
SMOOTH = [
    *("rig.pump.ripple=none", "rig.seal.limit=0", "rig.relief.kind=none", "rig.oil.cavitation=none"),
    "rig.minor_losses.kind=none",  # they go by q |q|, whose curvature jumps with the sign
    "rig.amplifier.kind=none",  # as in tests/twin/test_convergence.py, whose compiled step is taken
    *("rig.pump.speed='300 rpm'", "rig.valve.overlap=0", "loop.step='100 us'", "loop.daq_period='10 ms'"),
    *("loop.sample_period='10 ms'", "loop.viewer_period='20 ms'", "loop.command_timeout='1 s'", "duration='0.4 s'"),
]


def smooth() -> Scenario:
    """No stick, no relief valve, no cavity, no dead band: the spool opens by half and stays there."""
    return load("step", [*LUMPED, *SMOOTH, *HALF_OPEN])


@pytest.mark.parametrize("order", [1, 2, 4])
def test_the_order_of_a_known_error_is_found(order: int):
    """f + c h^n: dt against dt/4 differ by c h^n (1 - 4^-n)."""
    shape = np.sin(np.arange(100.0))
    runs = [shape + 1e-3 * shape * (1.0 / n) ** order for n in (1, 2, 4)]
    row = _row("position", *runs)
    assert row.order == pytest.approx(order, abs=1e-6)
    assert row.greatest == pytest.approx(1e-3 * (1.0 - 4.0**-order) * np.abs(shape).max())
    assert row.rms == pytest.approx(1e-3 * (1.0 - 4.0**-order) * math.sqrt(np.mean(shape**2)))


def test_what_does_not_differ_has_no_order():
    still = np.full(10, 0.1)
    assert math.isnan(_row("position", still, still, still).order)
    assert Row("p1", 0.0, 0.0, math.nan).words() == ("p1", "0 bar", "0 bar", "-")
    assert Row("position", 1e-6, 2e-6, 2.0).words() == ("position", "0.001 mm", "0.002 mm", "2.00")


def test_a_smooth_run_is_of_second_order_and_its_errors_fall():
    """Every signal that moves: order 2 within 0.1; at half the step a quarter of the error, within a tenth.

    The spool is exact at any step, so it has no order; the relief valve is not there.
    """
    coarse = {row.signal: row for row in convergence(smooth())}
    half = smooth().model_copy(update={"loop": smooth().loop.model_copy(update={"step": 50e-6})})
    fine = {row.signal: row for row in convergence(half)}
    moving = [name for name, row in coarse.items() if math.isfinite(row.order)]
    assert set(moving) >= {"position", "velocity", "p1", "p_lower", "p_upper", "p_t", "flow_1", "flow_6", "flow_pump"}
    assert "spool" not in moving
    for name in moving:
        assert coarse[name].order == pytest.approx(2.0, abs=0.1)
        assert fine[name].rms == pytest.approx(0.25 * coarse[name].rms, rel=0.1)
        assert 0.0 < coarse[name].rms <= coarse[name].greatest


def test_no_signal_is_compared_that_only_counts_or_jumps():
    assert not [name for name in COMPARED if name.startswith(("oil", "mass", "friction"))]
    assert len(COMPARED) == len(set(COMPARED)) > 25


def changes() -> list[str]:
    return [word for change in [*LUMPED, *SMOOTH, *HALF_OPEN] for word in ("--set", change)]


def test_the_verb_prints_a_row_for_each_signal(tmp_path):
    done = hydrotwin_here("convergence", "step", *changes(), cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "step at 100, 50 and 25 us" in done.stdout
    row = next(line for line in done.stdout.splitlines() if line.startswith("position"))
    assert float(row.split()[-1]) == pytest.approx(2.0, abs=0.1)


def test_the_verb_prints_json_without_nan(tmp_path):
    text = hydrotwin_here("convergence", "step", *changes(), "--json", cwd=tmp_path).stdout
    rows = {row["signal"]: row for row in json.loads(text)}
    assert "NaN" not in text
    assert rows["spool"]["order"] is None
    assert rows["position"]["order"] == pytest.approx(2.0, abs=0.1)
