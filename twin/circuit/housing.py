"""How the relief valve shakes its housing: 4.5 of the thesis, whose accelerometer sat on it.

Springs, seats and stops, flow forces and damping all act between the two moving bodies and the housing with its oil.
So what they do to the housing is minus what they do to the bodies: `M a = -(m u' + m_s v')`, impacts included, poppet
and spool along one axis (assumed). Beside it the thrust of the inlet's pressure on the bore, `p A` (assumed).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import welch

from twin.circuit.block import HELD, block_of, buffers, compiled
from twin.circuit.state import State, flatten, place_of
from twin.circuit.step import Circuit
from twin.relief.network import Relief

Array = NDArray[np.float64]
SHAKEN = (  # places in a flat state
    HELD["relief_pilot"],
    place_of("relief.state.pilot_velocity"),
    place_of("relief.state.spool_velocity"),
    HELD["p1"],
    HELD["flow_relief"],
)
RESOLUTION, BAND = 4.0, 10e3  # [Hz], the thesis's analyser


class Shaken(NamedTuple):
    """What is sampled at every step, an entry each."""

    step: float  # [s]
    pilot_lift: Array  # [m]
    pilot_speed: Array  # [m/s]
    spool_speed: Array  # [m/s]
    pressure: Array  # p1 [Pa]
    flow: Array  # over the valve [m^3/s]


def shake(state: State, circuit: Circuit, seconds: float, settle: float = 0.0) -> Shaken:
    """The rig with its directional valve at rest, from a state; the first `settle` seconds are not kept."""
    run, flat, into, step = block_of(compiled(circuit)), flatten(state), buffers(), circuit.parts.step
    run(flat, 0.0, round(settle / step), *into)
    rows = np.empty((round(seconds / step), len(SHAKEN)))
    for row in rows:
        run(flat, 0.0, 1, *into)
        row[:] = flat[list(SHAKEN)]
    return Shaken(step, *rows.T)


def reaction(found: Shaken, valve: Relief, housing: float) -> Array:
    """a [m/s^2] of a housing of a mass [kg] by the moving bodies: the mean over each step, so no impact is missed."""
    momentum = valve.pilot.mass * found.pilot_speed + valve.main.mass * found.spool_speed
    return -np.diff(momentum) / (found.step * housing)


def thrust(found: Shaken, bore: float, housing: float) -> Array:
    """a [m/s^2] by the inlet's pressure on its bore [m^2], less its mean."""
    pressure = found.pressure[1:]
    return (pressure - pressure.mean()) * bore / housing


def spectrum(acceleration: Array, step: float) -> tuple[Array, Array]:
    """Frequencies [Hz] up to BAND in steps of RESOLUTION and the rms [m/s^2] in each: Welch, Hann, half overlapped.

    Raises ValueError for a run too short or a step too long for them.
    """
    length = round(1.0 / (RESOLUTION * step))
    if len(acceleration) < length or step > 0.5 / BAND:
        raise ValueError(
            f"{len(acceleration)} steps of {step} s: a resolution of {RESOLUTION} Hz needs {length} of them, "
            f"a band of {BAND} Hz steps of at most {0.5 / BAND} s"
        )
    frequency, power = welch(acceleration, 1.0 / step, window="hann", nperseg=length, scaling="spectrum")
    within = frequency <= BAND
    return frequency[within], np.sqrt(power[within])
