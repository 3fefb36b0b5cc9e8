"""Verbs about the stability of the sampled loop: advise, map."""

from typing import Any

from bridge.cli.app import AS_JSON, CHANGES, SCENARIO, print_json


def advise(scenario: SCENARIO = "step", changes: CHANGES = None, as_json: AS_JSON = False) -> None:
    """Say which gains a scenario's loop bears: critical gains, margins, how it would swing, gains to take.

    By linear theory about the rig's own points of rest and slow motion; what it leaves out is in docs/stability.md.
    """
    from bridge.scenario import load
    from bridge.stability.advice import advise as advice

    found = advice(load(scenario, changes))
    if as_json:
        print_json(found)
    else:
        _print(found)


def _print(found: dict[str, Any]) -> None:
    from bridge.cli.report import print_table
    from bridge.stability.advice import WORDS

    own, derivative = found["gain"]["volts"], found["derivative_gain"]["volts"]
    print(
        f"{found['scenario']}: P {own:.4g} V/%, D {derivative:.4g} V s/% ({found['derivative']}), sampled every "
        f"{found['period'] * 1e3:g} ms, delay {found['delay'] * 1e3:g} ms, held at {found['held_at'] * 1e3:g} mm"
    )
    print(f"By linear theory the loop is {WORDS[found['verdict']]}.\n")
    heads = ("about", "opening", "critical P", "gain margin", "delay margin", "stable D", "starts as", "at these gains")
    print_table(heads, [_row(name, point) for name, point in found["points"].items()])
    suggested = found["suggested"]
    gain, patient = (_volts(suggested[name], "V/%") for name in ("gain", "patient"))
    print(f"\nsuggested P: {gain}, patient {patient} ({suggested['rule']})")


def _row(name: str, point: dict[str, Any]) -> tuple[str, ...]:
    swing, margin, late = point["swing"], point["gain_margin"], point["delay_margin"]
    low, high = point["least_derivative"]["volts"], point["critical_derivative"]["volts"]
    width = "none" if low is None else f"{low:.3g} to {'any' if high is None else f'{high:.3g}'} V s/%"
    now = "dies away" if point["stable"] else f"{swing['kind']}, {swing['frequency']:.3g} Hz"
    return (
        name,
        f"{point['opening'] * 1e2:.2g} %",
        _volts(point["critical_gain"], "V/%"),
        "-" if margin is None else f"{margin:.3g}",
        "long" if late is None else f"{late * 1e3:.3g} ms",
        width,
        f"{point['kind']}, {point['frequency']:.3g} Hz",
        now,
    )


def _volts(gain: dict[str, float | None], unit: str) -> str:
    return "none" if gain["volts"] is None else f"{gain['volts']:.4g} {unit}"
