"""What `hydrotwin advise` prints: gains in the unit of the law, lengths in mm."""

from math import isfinite, log10
from typing import TYPE_CHECKING

from bridge.cli.tables import print_table

if TYPE_CHECKING:
    from bridge.scenario import Scenario
    from bridge.studies.stability.advised import Advice, CycleAdvice, GainInUnits, PointAdvice, RowAdvice, StepAdvice
    from bridge.studies.stability.verified import Verified, VerifiedCycle

WIDEST = 24  # columns, of a bar of the picture
NARROWEST = 0.1  # [mm], where a bar begins
STEP_HEADS = ("settles from", "up to", "upper edge below", "starts with", "at", "seen to swing at")
MOST_ISLANDS = 3  # ranges of gains in a row of the table


def print_advice(found: "Advice") -> None:
    """The answer, what each step does, the smallest motions, and gains to take."""
    timing, unit = found.timing, found.unit
    derivative = f"D {found.derivative_gain.volts:.4g} V s/% ({timing.derivative}), "
    print(
        f"{found.scenario}: gain {_in(found.gain, unit)}, {'' if timing.derivative == 'none' else derivative}"
        f"sampled every {timing.period * 1e3:g} ms, delay {timing.delay * 1e3:g} ms"
    )
    print("\n".join(_answer(found)) + "\n")
    print_table(
        (f"after a step of, from {found.starts_at * 1e3:g} mm", *STEP_HEADS),
        [_step_row(step, unit) for step in found.steps],
    )
    print()
    print_table(
        ("gain", "peak to peak, up to", "", "at", "swings after"), [_picture_row(row, found) for row in found.rows]
    )
    if found.points:
        print(f"\nSmallest motions, by linear theory about {found.held_at * 1e3:g} mm, and what friction holds:")
        heads = (
            "about",
            "opening",
            "critical P",
            "gain margin",
            "delay margin",
            "stable D",
            "starts as",
            "at these gains",
        )
        print_table(heads, [_row(name, point) for name, point in found.points.items()])
    suggested = found.suggested
    print(f"\nsuggested gain: {_in(suggested.gain, unit)}, patient {_in(suggested.patient, unit)} ({suggested.rule})")
    if suggested.hunts_by is not None:
        print(f"At {_in(suggested.gain, unit)} it hunts by up to {suggested.hunts_by * 1e3:.2g} mm peak to peak.")
    for note in found.notes:
        print(note)


def _answer(found: "Advice") -> list[str]:
    """The gains that count, and what the own one does."""
    from controller.stability.amplitude.swing import WIDE

    unit, wide = found.unit, found.wide_above
    above = _in(found.swings_above, unit) if found.swings_above.volts is not None else "no gain"
    widely = "at any gain tried" if wide.volts is None else f"below {_in(wide, unit)}" if wide.volts else "at none"
    own = [row.peak_to_peak for row in found.rows if row.gain.volts == found.gain.volts]
    by = f", by up to {own[0] * 1e3:.2g} mm peak to peak" if own and own[0] > 0.0 else ""
    settles = f"Every motion settles {_band(found)}" if found.has_band else "No gain tried settles after every motion"
    return [
        f"{settles}, every one swings above {above}; none swings by more than {WIDE * 1e3:g} mm {widely}.",
        f"This loop {found.verdict.words}{by}.{_nearest(found)}",
    ]


def _nearest(found: "Advice") -> str:
    """The way to the band, where the own gain is outside."""
    own, most, least = (gain.volts or 0.0 for gain in (found.gain, found.settles_below, found.settles_above))
    if found.verdict == "stable" or not found.has_band:
        return ""
    return f" The nearest gain that settles after every motion is {most if own > most else least:.3g} {found.unit}."


def _band(found: "Advice") -> str:
    """Where every motion settles."""
    most, least, unit = found.settles_below, found.settles_above, found.unit
    if not least.volts:
        return "at any gain tried" if most.volts is None else f"below {_in(most, unit)}"
    return f"above {_in(least, unit)}" if most.volts is None else f"from {least.volts:.3g} to {_in(most, unit)}"


def _in(gain: "GainInUnits", unit: str) -> str:
    return "none" if gain.volts is None else f"{gain.volts:.3g} {unit}"


def _step_row(step: "StepAdvice", unit: str) -> tuple[str, ...]:
    small, large = (peak * 1e3 for peak in step.peak_to_peak)
    return (
        f"{step.size * 1e3:+g} mm",
        _in(step.settles_above, unit) if step.settles_above.volts else "any",
        _in(step.settles_below, unit),
        _in(step.swings_above, unit),
        _span(small, large, "mm"),
        _span(*step.frequencies, "Hz"),
        _islands(step),
    )


def _islands(step: "StepAdvice") -> str:
    """Gains that were seen to swing: the first ranges, and the last."""
    words = [f"{low:.3g}" if low == high else f"{low:.3g} to {high:.3g}" for low, high in step.swings_from_to]
    if words and step.swings_from_to[-1][1] == step.tried_up_to:
        words[-1] = f"{step.swings_from_to[-1][0]:.3g} on"
    if words and step.settles_above.volts and step.swings_from_to[0][0] == step.tried_from:
        words[0] = f"up to {step.swings_from_to[0][1]:.3g}"
    left_out = len(words) - MOST_ISLANDS
    return ", ".join(words if left_out <= 0 else [*words[: MOST_ISLANDS - 1], f"{left_out} more", words[-1]])


def _span(low: float, high: float, unit: str) -> str:
    if high == 0.0:
        return "irregular" if unit == "Hz" else "-"
    return f"{low:.2g} {unit}" if high < 1.1 * low else f"{low:.2g} to {high:.2g} {unit}"


def _picture_row(row: "RowAdvice", found: "Advice") -> tuple[str, ...]:
    peak = row.peak_to_peak * 1e3
    mark = " *" if row.gain.volts == found.gain.volts else ""
    width = round(WIDEST * min(1.0, max(0.0, log10(max(peak, NARROWEST) / NARROWEST) / 4.0)))
    after = ", ".join(f"{size * 1e3:+g}" for size in row.swings_after)
    swings = "all" if len(row.swings_after) == len(found.steps) else f"{after} mm" if after else "none"
    if not row.swings_after:
        return f"{row.gain.volts:.3g}{mark}", "settles", "", "", swings
    often = f"{row.frequency:.2g} Hz" if row.frequency else "irregular"
    return f"{row.gain.volts:.3g}{mark}", "#" * width, f"{peak:.2g} mm", often, swings


def print_cycles(found: "CycleAdvice", runs: "list[VerifiedCycle]") -> None:
    """A relay's cycle after each step, beside the twin's where it ran."""
    timing = found.timing
    print(
        f"{found.scenario}: relay, sampled every {timing.period * 1e3:g} ms, delay {timing.delay * 1e3:g} ms; "
        f"it {found.verdict.words}."
    )
    print(
        f"Derivative time {found.derivative_time * 1e3:.3g} ms; (5.22) asks for {found.critical_lead * 1e3:.3g} ms, "
        f"with hold and delay {found.needed_lead * 1e3:.3g} ms.\n"
    )
    rows = [(f"{size * 1e3:+g} mm", *_cycle(peak, often)) for size, peak, often in found.cycles]
    if not runs:
        print_table(("after a step of", "peak to peak", "at"), rows)
    else:
        twin = [
            (*_cycle(run.found.peak_to_peak, run.found.frequency), "agrees" if run.agrees else "DISAGREES")
            for run in runs
        ]
        heads = ("after a step of", "peak to peak", "at", "twin", "at", "")
        print_table(heads, [(*row, *more) for row, more in zip(rows, twin, strict=True)])
    for note in found.notes:
        print(note)


def _cycle(peak: float, often: float) -> tuple[str, str]:
    return f"{peak * 1e3:.3g} mm", f"{often:.3g} Hz" if often else "irregular"


def print_verified(scenario: "Scenario", found: "Advice") -> None:
    """Runs of the twin, as they come."""
    from bridge.studies.stability.verified import verified

    runs = list(verified(scenario, found.steps))
    print()
    print_table(
        ("after a step of", "interval", "edge found", "swings by", "at", ""),
        [_verified_row(run, found.unit) for run in runs],
    )
    print(f"{sum(run.agrees for run in runs)} of {len(runs)} edges lie in their intervals.")


def _verified_row(run: "Verified", unit: str) -> tuple[str, ...]:
    edge, above = run.found, f"{run.high:.3g}" if isfinite(run.high) else "any"
    theory, agrees = f"{run.low:.3g} to {above} {unit}", "agrees" if run.agrees else "DISAGREES"
    if not isfinite(edge.swings):
        return f"{run.size * 1e3:+g} mm", theory, f"settles up to {edge.settles:.3g} {unit}", "-", "-", agrees
    often = f"{edge.frequency:.2g} Hz" if edge.frequency else "irregular"
    peak = f"{edge.peak_to_peak * 1e3:.2g} mm"
    return f"{run.size * 1e3:+g} mm", theory, f"{edge.swings:.3g} {unit}", peak, often, agrees


def _row(name: str, point: "PointAdvice") -> tuple[str, ...]:
    swing, margin, late = point.swing, point.gain_margin, point.delay_margin
    low, high = point.least_derivative.volts, point.critical_derivative.volts
    width = "none" if low is None else f"{low:.3g} to {'any' if high is None else f'{high:.3g}'} V s/%"
    now = "dies away" if point.stable else f"{swing.kind}, {swing.frequency:.3g} Hz"
    return (
        name,
        f"{point.opening * 1e2:.2g} %",
        _in(point.critical_gain, "V/%"),
        "-" if margin is None else f"{margin:.3g}",
        "long" if late is None else f"{late * 1e3:.3g} ms",
        width,
        f"{point.kind}, {point.frequency:.3g} Hz",
        now,
        "-" if point.held_below is None else f"below {point.held_below * 1e3:.2g} mm",
    )
