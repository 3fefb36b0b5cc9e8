"""From the numbers of a rig to its oil, and to what its lines hold."""

import math
from collections.abc import Mapping
from typing import Any

from twin.air import ATMOSPHERE, Air, AnyAir, NoAir, effective_bulk_modulus
from twin.iso_vg import GRADES, grade_viscosity
from twin.lines.spec import Creep, LineSpec
from twin.oil import Oil, effective_modulus, fluid_modulus, kinematic_viscosity
from twin.rig import Values, values

Entries = Mapping[str, Any]
BOTTOMLESS = -1e12  # [Pa], vapour pressure of oil that bears any tension


def oil_of(rig: Values) -> Oil:
    """The oil, without its air. Raises ValueError where its numbers contradict each other."""
    oil = rig["oil"]
    vapour = oil["vapour_pressure"] if oil["cavitation"] == "vapour" else BOTTOMLESS
    if oil["kind"] == "thesis":
        return Oil(oil["density"], kinematic_viscosity(oil["temperature"]), _measured_modulus(oil), vapour)
    if oil["kind"] == "iso-vg":
        viscosity = grade_viscosity(oil["grade"], oil["temperature"])
        return Oil(GRADES[oil["grade"]].density, viscosity, oil["bulk_modulus"], vapour)
    return Oil(oil["density"], oil["viscosity"], oil["bulk_modulus"], vapour)


def air_of(rig: Values, oil: Oil) -> AnyAir:
    """The air in it. Raises ValueError where it would expand without limit."""
    air = rig["oil"]["air"]
    if air == 0.0:
        return NoAir()
    if oil.vapour_pressure <= -ATMOSPHERE:
        raise ValueError(
            f"oil.air {air} would expand without limit: it needs a vapour pressure above {-ATMOSPHERE:g} Pa gauge; "
            "take oil.cavitation = 'vapour' and oil.vapour_pressure = '-1 bar', or oil.air = 0"
        )
    return Air(air, rig["oil"]["air_exponent"])


def _measured_modulus(oil: Entries) -> float:
    """The fluid's own modulus follows from the wave speed measured in the steel pipe, (2.8), (2.9)."""
    measured = values()["pipe_1"]
    bore, wall, young = (measured[name] for name in ("diameter", "wall", "young"))
    modulus = fluid_modulus(oil["density"] * oil["wave_speed"] ** 2, bore, wall, young)
    if not 0.0 < modulus < math.inf:
        raise ValueError(
            f"oil.wave_speed {oil['wave_speed']} m/s is more than the steel pipe allows: its wall alone makes it "
            f"{math.sqrt(wall * young / (bore * oil['density'])):.0f} m/s; take a smaller one"
        )
    return modulus


def pipe_area(pipe: Entries) -> float:
    """Of its bore [m^2]."""
    return math.pi / 4.0 * pipe["diameter"] ** 2


def pipe_volume(pipe: Entries) -> float:
    """Oil that fills it at no pressure [m^3]; without a pipe that of the manifold."""
    return pipe["manifold"] if pipe["model"] == "none" else pipe_area(pipe) * pipe["length"]


def line_spec(pipe: Entries, oil: Oil, air: AnyAir, air_pressure: float) -> LineSpec:
    """A line, its oil with air as stiff as at a pressure [Pa]. A manifold is the oil of a rigid block."""
    bore = effective_bulk_modulus(air, oil.bulk_modulus, air_pressure)
    if pipe["model"] == "none":
        length = pipe["manifold"] / pipe_area(pipe)
        return LineSpec(length, pipe["diameter"], bore, oil.density, oil.viscosity, "volume", "none")
    modulus = effective_modulus(bore, pipe["diameter"], pipe["wall"], pipe["young"])
    own = pipe["length"], pipe["diameter"], modulus, oil.density, oil.viscosity
    return LineSpec(*own, pipe["model"], pipe["friction"], _creep(pipe, modulus))


def _creep(pipe: Entries, modulus: float) -> tuple[Creep, ...]:
    """The wall's share of the compliance, B d/(delta E), times what follows of its strain."""
    wall = modulus * pipe["diameter"] / (pipe["wall"] * pipe["young"])
    elements = ((pipe["creep"], pipe["retardation"]), (pipe["creep_2"], pipe["retardation_2"]))
    return tuple(Creep(wall * late, time) for late, time in elements if late > 0.0)
