"""What a follower says, in the view: estimates in their bands, factors, deviates, and each verdict once."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bridge.recording.entries import Entry
from bridge.recording.reader import recording
from bridge.recording.verdicts import verdicts_of
from bridge.wire.codec import Estimate, Health, encode
from bridge.wire.health import PLACES
from bridge.wire.messages import ESTIMATE, HEALTH
from tests.bridge.test_view import column
from tests.bridge.test_view_live import messages
from twin.estimation.hypotheses import Verdict

SAID = [(Verdict.COMMISSIONING, -1)] * 3 + [(Verdict.HEALTHY, -1)] * 3 + [(Verdict.FAULT, PLACES.index("friction"))] * 4


def said_by_a_follower(run_id: int) -> list[Entry]:
    """Ten estimates and ten looks, 10 ms apart."""
    found = []
    for k, (verdict, first) in enumerate(SAID):
        stamp = 10_000_000 * (k + 1)
        p = (30.0 + k) * 1e5
        estimate = filled(Estimate, run_id, k, stamp) | {"p_upper": p, "p_upper_sd": 0.5e5, "unknown_friction": 1.1}
        health = filled(Health, run_id, k, stamp) | {"verdict": int(verdict), "first": first, "limit": 5.25}
        health |= {"friction_deviate": 2.0 * k, "load_deviate": math.nan}
        for topic, kind, own in ((ESTIMATE, Estimate, estimate), (HEALTH, Health, health)):
            found.append(Entry(topic, stamp, k, encode(kind(**own))))
    return found


def filled(kind: Any, run_id: int, k: int, stamp: int) -> dict[str, Any]:
    """A message of nothing but its head."""
    zeros = {name: 0 for name in kind.__dataclass_fields__ if not name.startswith("__")}
    return zeros | {"run_id": run_id, "sequence": k, "tick": 10 * (k + 1), "stamp": stamp}


@pytest.mark.parametrize("size", [3, 1000])
def test_estimates_and_verdicts_are_drawn_live_in_batches_of_any_size(tmp_path: Path, size: int):
    rr = pytest.importorskip("rerun")
    from bridge.view.live_drawing import Drawing

    head, entries = messages(0.1)
    entries = sorted([*entries, *said_by_a_follower(int(head["run_id"]))], key=lambda entry: entry.log_time)
    stream, path = rr.RecordingStream("hydrotwin"), tmp_path / "a.rrd"
    stream.save(path)
    drawing = Drawing(stream, head, bare=False)
    for begin in range(0, len(entries), size):
        drawing.add(entries[begin : begin + size])
    stream.disconnect()
    stamps, values = column(path, "/estimated_pressures/p_upper", "Scalars:scalars")
    assert stamps == [10_000_000 * (k + 1) for k in range(10)]
    assert values == pytest.approx([30.0 + k for k in range(10)])  # bar
    above = column(path, "/estimated_pressures/p_upper_above", "Scalars:scalars")[1]
    assert np.array(above) - np.array(values) == pytest.approx(1.0)  # two deviations of 0.5 bar
    assert column(path, "/unknowns/friction", "Scalars:scalars")[1] == [1.1] * 10
    assert column(path, "/health/friction", "Scalars:scalars")[1] == [2.0 * k for k in range(10)]
    assert column(path, "/health/limit_below", "Scalars:scalars")[1] == [-5.25] * 10
    told = [text for text in column(path, "/events", "TextLog:text")[1] if "health: " in text]
    assert [text.split("health: ")[1] for text in told] == [
        "commissioning",
        "healthy",
        "fault: friction of the actuator: a worn seal has less, a stiff one more",
    ]


def test_a_verdict_is_said_when_it_changes():
    whole = recording(Path("a"), said_by_a_follower(1), {})
    assert [(said.verdict, said.first) for said in verdicts_of(whole)] == list(dict.fromkeys(SAID))
    later = recording(Path("a"), [entry for entry in said_by_a_follower(1) if entry.log_time > 40_000_000], {})
    assert [said.verdict for said in verdicts_of(later, verdicts_of(whole)[1])] == [Verdict.FAULT]
