"""One row of the table of channels is a channel from the card to the recording."""

import pytest

from bridge.drawing.colours import DARK, LIGHT
from bridge.recording.shown import GROUPS
from bridge.report.charts import CHARTS
from bridge.scenario.fields import Measured
from bridge.scenario.model import Daq
from bridge.scenario.units import UNITS
from bridge.view.curves import CURVES
from bridge.wire.codec import Measurement
from bridge.wire.messages import TOPICS, field_names
from controller.law import Sample
from twin.sensors import card_of
from twin.topology import CHANNELS, PRESSURES


@pytest.mark.parametrize("name", CHANNELS)
def test_a_channel_has_a_range_in_the_scenario_in_its_own_unit(name):
    channel = CHANNELS[name]
    stated = Daq.model_fields[channel.span].metadata
    assert [entry.unit for entry in stated if isinstance(entry, Measured)] == [channel.unit]
    assert not channel.switch or isinstance(getattr(Daq(), channel.switch), bool)


def test_channels_are_the_readings_of_a_measurement_in_order():
    head = ["run_id", "sequence", "tick", "stamp"]
    assert field_names(TOPICS["measurement"].type) == [*head, *CHANNELS]
    assert Measurement(**dict.fromkeys((*head, *CHANNELS), 0)).stamp == 0
    assert {f"pressure/{tap}" for tap in PRESSURES} == {topic for topic in TOPICS if topic.startswith("pressure/")}
    assert set(Sample._fields) <= {"stamp_ns", *CHANNELS, "channels"}


def test_a_card_has_the_ranges_of_the_scenario():
    card = card_of(Daq(position_range=0.2, pressure_range=100e5, velocity_range=2.0, tachometer=False))
    assert card.low.tolist() == [0.0, -2.0, 0.0, 0.0, 0.0]
    assert card.high.tolist() == [0.2, 2.0, 100e5, 100e5, 100e5]
    assert card.fitted.tolist() == [True, False, True, True, True]


@pytest.mark.parametrize("name", [name for name in CHANNELS if name != "velocity"])
def test_what_a_channel_reads_is_drawn_in_report_and_view_in_one_unit_and_with_one_label(name):
    field = CHANNELS[name].reads
    charts = {curve.field: (chart.group, curve) for chart in CHARTS for curve in chart.group.curves}
    group, drawn = charts[field]
    seen = [curve for curve in CURVES if (curve.topic, curve.field) == ("state", field)]
    assert all(curve.scale == group.scale for curve in seen)
    assert drawn.label in [curve.label for curve in seen]
    assert group.unit in group.axis
    assert group.scale == pytest.approx(1.0 / UNITS[CHANNELS[name].unit][group.unit].factor, rel=1e-15)


def test_every_colour_of_a_curve_is_in_both_palettes():
    assert {curve.colour for group in GROUPS.values() for curve in group.curves} <= set(LIGHT)
    assert set(LIGHT) == set(DARK)
