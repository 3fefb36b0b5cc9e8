"""What a scenario expects, in words: "overshoot <= 5 %", "limit cycle: none", "peak p_lower <= 80 bar".

And of a part of the run: "mean p1 from impact + 300 ms to impact + 600 ms >= 66 bar", "rms error from 3 s to end <= 5
mm". A limit states its unit.
"""

import math
import re
from collections.abc import Collection
from typing import NamedTuple, TypeGuard

from bridge.errors import nearest
from bridge.scenario.units import in_si, quantity, shown, split
from controller.bands import END, START, STATISTICS, WHOLE, Band, Metrics, Moment, WindowBand
from twin.topology import BALANCE_UNITS, OBSERVED


class Shown(NamedTuple):
    """How a metric is written for people."""

    words: str
    unit: str  # SI
    factor: float  # from SI to what is shown
    shown_unit: str


METRICS = {
    "rise_time": Shown("rise time (10-90 %)", "s", *shown("s")),
    "overshoot": Shown("overshoot", "", *shown("", "%")),
    "settling_time": Shown("settling time (2 %)", "s", *shown("s")),
    "steady_error": Shown("steady error", "m", *shown("m")),
    "rms_error": Shown("rms error", "m", *shown("m")),
    "max_error": Shown("largest error", "m", *shown("m")),
    "limit_cycle_amplitude": Shown("limit cycle amplitude", "m", *shown("m")),
    "limit_cycle_frequency": Shown("limit cycle frequency", "Hz", *shown("Hz")),
    "limit_cycle_begin": Shown("worst constant stretch, from", "s", *shown("s", "s")),
    "limit_cycle_end": Shown("worst constant stretch, to", "s", *shown("s", "s")),
    "phase_lag": Shown("phase lag", "rad", *shown("rad")),
    "time_lag": Shown("time lag", "s", *shown("s")),
    "amplitude_ratio": Shown("amplitude ratio", "", 1.0, ""),
    "peak_p1": Shown("peak p1", "Pa", *shown("Pa")),
    "peak_p_lower": Shown("peak p_lower", "Pa", *shown("Pa")),
    "peak_p_upper": Shown("peak p_upper", "Pa", *shown("Pa")),
    "min_p_lower": Shown("least p_lower", "Pa", *shown("Pa")),
    "min_p_upper": Shown("least p_upper", "Pa", *shown("Pa")),
    "valve_travel": Shown("valve travel", "", 1.0, "travels"),
}
assert set(METRICS) == set(Metrics._fields)
_PRINTED = {
    re.sub(r"[\s-]+", "_", shown_as.words): name for name, shown_as in METRICS.items()
}  # a band may say so, too
SIGNALS = OBSERVED | BALANCE_UNITS
BANDED = SIGNALS | {"error": "m", "reference": "m"}  # what a statistic can be asked of
_NO_STRETCH = "no constant stretch of at least 1 s follows a motion of the reference"
_NO_SINE = "the reference is not a sine of at least two periods"
UNDEFINED = {  # why a metric of a run can have no value
    "rise_time": "the reference makes no step, or the piston does not reach 90 % of it",
    "overshoot": "the reference makes no step",
    "settling_time": "the reference makes no step, or the piston does not stay within 2 % of it",
    **dict.fromkeys(("rms_error", "max_error"), "the law follows no reference"),
    "steady_error": "no constant stretch follows a motion of the reference",
    **dict.fromkeys(
        ("limit_cycle_amplitude", "limit_cycle_frequency", "limit_cycle_begin", "limit_cycle_end"), _NO_STRETCH
    ),
    **dict.fromkeys(("phase_lag", "amplitude_ratio"), _NO_SINE),
    "time_lag": "the reference does not move other than by steps",
}
TRACKING = ("phase_lag", "time_lag", "amplitude_ratio")  # metrics of a reference that moves
MOMENTS = (START, END, "contact", "impact")
_BAND = re.compile(r"\s*(.+?)\s*(<=|>=)\s*(.+?)\s*")
_WINDOW = re.compile(r"(.+?)\s+from\s+(.+?)\s+to\s+(.+)")
_MOMENT = re.compile(r"([a-z]+)(?:\s*([+-])\s*(.+))?")
_OWN = re.compile(r"(?:signals|channels)\.\w+")
_CYCLE = re.compile(r"\s*limit cycle\s*:\s*(\w+)\s*")
SMALLEST_CYCLE = 1e-9  # [m]; what the metrics call no limit cycle is exactly zero


def value_with_unit(metric: str, value: float | None) -> str:
    """A metric as people read it."""
    metric_shown = METRICS[metric]
    if value is None or value != value:
        return "-"
    return f"{value * metric_shown.factor:.4g} {metric_shown.shown_unit}".rstrip()


def metric_words(metrics: Metrics | None) -> list[tuple[str, str]]:
    """The metrics of a run as people read them: those that it has, and what its limit cycle was looked for in."""
    if metrics is None:
        return []
    defined = {name: value for name, value in metrics._asdict().items() if name not in TRACKING or value == value}
    return [(METRICS[name].words, value_with_unit(name, value)) for name, value in defined.items()]


def cycle_words(metrics: Metrics) -> str:
    """Frequency and stretch of a limit cycle, or which stretch was the last without one."""
    found = metrics.limit_cycle_amplitude > 0.0
    known = metrics.limit_cycle_begin == metrics.limit_cycle_begin  # older recordings do not say
    stretch = f"from {metrics.limit_cycle_begin:.4g} s to {metrics.limit_cycle_end:.4g} s" if known else ""
    words = f"at {value_with_unit('limit_cycle_frequency', metrics.limit_cycle_frequency)}" if found else "none"
    return ", ".join(filter(None, (words, stretch if found or not known else f"the last stretch {stretch}")))


def signal_with_unit(si: str, value: float) -> str:
    """A statistic of a signal, whose unit is given, as people read it."""
    factor, unit = shown(si)
    return "-" if value != value else f"{value * factor:.4g} {unit}".rstrip()


def parse_band(text: str) -> Band | WindowBand:
    """The band that a text states. Raises ValueError naming the nearest valid metric, signal, moment or unit."""
    if cycle := _CYCLE.fullmatch(text):
        return _cycle_band(text, cycle[1])
    match = _BAND.fullmatch(text)
    if match is None:
        raise ValueError(
            f"expect {text!r}: write 'metric <= value unit', 'metric >= value unit' or 'limit cycle: none'"
        )
    try:
        named = parse_measure(match[1])
        if is_own(named):
            number, written = split(match[3])
            unit, factor = in_si(written)
            return named._replace(relation=match[2], limit=number * factor, unit=unit)
        return named._replace(relation=match[2], limit=limit_of(match[3], *units_of(named)))
    except ValueError as error:
        raise ValueError(f"expect {text!r}: {error}") from None


def parse_measure(text: str) -> Band | WindowBand:
    """What a band can name, as one without a limit: "overshoot", "mean p1 from 3 s to end". Raises ValueError."""
    words, begin, end = _parts(text.strip())
    metric = re.sub(r"[\s-]+", "_", words)
    metric = _PRINTED.get(metric, metric)
    statistic, _, signal = words.partition(" ")
    if metric in METRICS:
        return Band(metric, ">=", -math.inf, *_window(begin, end))
    if statistic not in STATISTICS or not signal:
        known = [name.replace("_", " ") for name in METRICS]
        raise ValueError(f"no metric {words!r}{nearest(words, known)}")
    if (signal := signal.strip()) not in BANDED and not _OWN.fullmatch(signal):
        raise ValueError(f"no signal {signal!r}{nearest(signal, BANDED)}")
    return WindowBand(statistic, signal, *_window(begin, end), ">=", -math.inf)


def is_own(band: Band | WindowBand) -> TypeGuard[WindowBand]:
    """Is it about what only some runs have, "signals.integral" of a law or "channels.force"?"""
    return isinstance(band, WindowBand) and _OWN.fullmatch(band.signal) is not None


def refuse_unread(band: Band | WindowBand, channels: Collection[str]) -> None:
    """Raises ValueError for a band about a further channel of the card that a scenario has not chosen."""
    if not is_own(band):
        return
    topic, _, name = band.signal.partition(".")
    if topic == "channels" and name not in channels:
        raise ValueError(f"expect: {band.signal!r} is not read; put {name!r} into daq.channels")


def units_of(band: Band | WindowBand) -> tuple[str, str]:
    """The unit in SI of what a band names, and the one that people read."""
    if isinstance(band, Band):
        return METRICS[band.metric].unit, METRICS[band.metric].shown_unit
    if is_own(band):
        return band.unit, shown(band.unit)[1]
    return BANDED[band.signal], shown(BANDED[band.signal])[1]


def _parts(text: str) -> tuple[str, str | None, str | None]:
    """What is meant, and the words for begin and end of its window if it has one."""
    match = _WINDOW.fullmatch(text)
    return (match[1], match[2], match[3]) if match else (text, None, None)


def limit_of(text: str, unit: str, shown_unit: str) -> float:
    """The limit of a band in SI; only 0 and infinity say the same in every unit."""
    value = quantity(text, unit)
    number, written = split(text)
    if shown_unit in ("", "travels") or written or number == 0.0 or math.isinf(number):
        return value
    raise ValueError(
        f"{text} has no unit, and would be {value * shown(unit, shown_unit)[0]:g} {shown_unit}: "
        f"write '{text} {shown_unit}' or another unit"
    )


def _window(begin: str | None, end: str | None) -> tuple[Moment, Moment]:
    if begin is None or end is None:
        return WHOLE
    window = _moment(begin), _moment(end)
    if window[0].name == window[1].name and window[0].offset > window[1].offset:
        raise ValueError(f"the window ends before it begins: write 'from {end} to {begin}'")
    return window


def outside(band: Band | WindowBand, duration: float) -> str | None:
    """What is wrong with a band's window in a run of a duration [s]; None for nothing, or what only the run tells."""
    known = {START: 0.0, END: duration}
    for moment in (band.begin, band.end):
        at = known.get(moment.name, 0.0) + moment.offset
        if moment.name in known and not -1e-9 <= at <= duration + 1e-9:
            return f"its window reaches to {at:g} s, outside of the run, which lasts from 0 s to {duration:g} s"
    return None


def _moment(text: str) -> Moment:
    """A time of the run, "3 s", or one counted from a moment, "impact + 300 ms"."""
    match = _MOMENT.fullmatch(text)
    if match is None:
        return Moment(START, limit_of(text, "s", "s"))
    if match[1] not in MOMENTS:
        raise ValueError(f"no moment {match[1]!r}{nearest(match[1], MOMENTS, 'or a time')}")
    offset = limit_of(match[3], "s", "s") if match[3] else 0.0
    return Moment(match[1], -offset if match[2] == "-" else offset)


def _cycle_band(text: str, word: str) -> Band:
    if word == "none":
        return Band("limit_cycle_amplitude", "<=", 0.0)
    if word == "present":
        return Band("limit_cycle_amplitude", ">=", SMALLEST_CYCLE)
    raise ValueError(f"expect {text!r}: a limit cycle is 'none' or 'present'")
