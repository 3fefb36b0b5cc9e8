"""Own figure `chatter-spectrum`: acceleration of the relief valve's housing in the rig. Source: 4.5, measured there.

The frequency that appears only when the valve works. The valve shut (tandem centre, the pump idles), at work with the
chamfered pilot, at work with the conical one; 20 cm^3 of oil before the pilot (assumed), 67 bar.
"""

import math
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from bridge.drawing.canvas import (
    Array,
    Axes,
    Columns,
    Sheet,
    label,
    remark,
    sheet,
)
from twin.circuit.build import build
from twin.circuit.equilibrium import equilibrium
from twin.circuit.housing import (
    Shaken,
    reaction,
    shake,
    spectrum,
    thrust,
)
from twin.circuit.kinds import of_kind
from twin.circuit.pilot_swing import pilot_swings
from twin.circuit.state import State
from twin.circuit.step import Circuit
from twin.relief.network import Relief
from twin.rig import values

STEP = 25e-6  # [s]
VOLUME = 20e-6  # [m^3], assumed
SECONDS, SETTLE = 0.75, 0.4  # [s]
LINES = {"pipe_1": {"length": 1.0}, "pipe_2": {"length": 2.5}}  # assumed: none of their resonances sits on the pilot's
PUSH = 1.1  # of the poppet's lift at the start
CASES = {
    "valve shut": {"relief": {}, "valve": {"kind": "switching"}},
    "chamfered pilot": {"relief": {"pilot_seat": "chamfered"}},
    "conical pilot": {"relief": {"pilot_seat": "conical"}},
}
COLOURS = dict(zip(CASES, ("0.5", "tab:blue", "tab:red"), strict=True))


class Heard(NamedTuple):
    """A run and its spectra, rms [m/s^2] in bands of 4 Hz."""

    run: Shaken
    frequency: Array  # [Hz]
    bodies: Array  # by poppet and spool
    whole: Array  # with the thrust of the inlet's pressure


def numbers(case: str, ripple: bool, volume: float = VOLUME) -> dict[str, dict[str, Any]]:
    """The rig's numbers in a case."""
    parts = {name: dict(entries) for name, entries in CASES[case].items()}
    parts["relief"] |= {"channel_volume": volume}
    parts |= LINES
    parts["pump"] = {"ripple": "teeth" if ripple else "none"}
    return values(parts)


def rig_of(case: str, ripple: bool, volume: float = VOLUME) -> Circuit:
    """The circuit of a case."""
    return build(numbers(case, ripple, volume), STEP)


def pushed(circuit: Circuit, share: float = PUSH) -> State:
    """At rest, but for the poppet, whose lift is so many times that of rest."""
    state = equilibrium(circuit, 0.1)
    relief = state.core.relief
    moved = relief.state._replace(pilot_lift=share * relief.state.pilot_lift)
    return state.with_core(relief=relief._replace(state=moved))


@cache
def heard(case: str, ripple: bool) -> Heard:
    """What the housing does; the run is the same every time."""
    circuit = rig_of(case, ripple)
    run = shake(pushed(circuit), circuit, SECONDS, SETTLE)
    rig = values()
    housing = rig["chatter"]["housing_mass"]
    bore = math.pi / 4.0 * rig["pipe_1"]["diameter"] ** 2
    bodies = reaction(run, of_kind(circuit.parts.relief, Relief), housing)
    frequency, alone = spectrum(bodies, STEP)
    return Heard(run, frequency, alone, spectrum(bodies + thrust(run, bore, housing), STEP)[1])


def theory(case: str, volume: float = VOLUME) -> tuple[float, float]:
    """Growth [1/s] and frequency [Hz] at rest by linear theory with both lines."""
    return pilot_swings(numbers(case, False, volume), rig_of(case, ripple=False, volume=volume))[0]


def draw_spectrum() -> tuple[Columns, Sheet]:
    """With the pump's ripple, and without it."""
    page, panels = sheet("Acceleration of the relief valve's housing, 8 kg, bands of 4 Hz", panels=2)
    columns: Columns = {}
    for axes, ripple in zip(panels, (True, False), strict=True):
        words = "ripple" if ripple else "no ripple"
        for case, colour in COLOURS.items():
            found = heard(case, ripple)
            if not ripple and not found.whole.any():
                continue
            axes.plot(found.frequency, np.maximum(found.whole, 1e-7), color=colour, linewidth=0.7, label=case)
            columns |= {
                "frequency [Hz]": found.frequency,
                f"{case} {words} [m/s^2]": found.whole,
                f"{case} {words} bodies alone [m/s^2]": found.bodies,
            }
        _finish(axes, "the pump's teeth, 184.5 Hz and multiples" if ripple else "a pump without ripple")
    predicted = theory("chamfered pilot")[1]
    panels[1].axvline(predicted, color="black", linestyle="--", linewidth=0.8)
    on_seat = _loudest(heard("chamfered pilot", False))
    words = f"small swings, theory: {predicted:.0f} Hz;\non its seat: {on_seat:.0f} Hz"
    panels[1].text(60.0, 1.0, words, fontsize=8)
    panels[0].legend(frameon=False, fontsize=8, loc="upper right")
    remark(
        page,
        "67 bar, 20 cm³ before the pilot (assumed); moving bodies and thrust of the inlet's pressure. "
        "Right: the conical pilot makes less than 10⁻⁵ m/s², the shut valve nothing",
    )
    return columns, page


def _loudest(found: Heard) -> float:
    beyond = found.frequency > 500.0
    return float(found.frequency[beyond][found.bodies[beyond].argmax()])


def _finish(axes: Axes, title: str) -> None:
    axes.set_title(title, fontsize=10)
    axes.set(xscale="log", yscale="log", xlim=(50.0, 1e4), ylim=(1e-5, 5.0))
    axes.set_xticks([100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0], ["100", "200", "500", "1000", "2000", "5000"])
    axes.minorticks_off()
    label(axes, "f [Hz]", "a [m/s² rms]")
