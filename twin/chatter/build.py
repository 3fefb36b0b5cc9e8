"""From the numbers of a rig to its pilot with a volume before it, and to its seats."""

from twin.chatter.physical import Pilot
from twin.oil import Oil, kinematic_viscosity
from twin.relief.poppet import spring_drag
from twin.rig import Values
from twin.seats.chamfered import ChamferedSeat
from twin.seats.conical import ConicalSeat


def chamfered_of(rig: Values) -> ChamferedSeat:
    """The pilot's short seat."""
    valve, own = rig["relief"], rig["chatter"]
    return ChamferedSeat(
        valve["seat_diameter"], valve["cone_angle"], own["discharge"], valve["loss_factor"], valve["loss_exponent"],
        rig["oil"]["density"],
    )  # fmt: skip


def conical_of(rig: Values) -> ConicalSeat:
    """The long seat that the pilot could have, for the same cone and inlet."""
    valve, oil = rig["relief"], rig["oil"]
    viscosity = oil["density"] * kinematic_viscosity(oil["temperature"])
    return ConicalSeat(0.5 * valve["seat_diameter"], rig["relief"]["seat_length"], valve["cone_angle"], viscosity)


def _oil(rig: Values) -> Oil:
    oil = rig["oil"]
    return Oil(
        oil["density"], kinematic_viscosity(oil["temperature"]), rig["chatter"]["modulus"], oil["vapour_pressure"]
    )


def pilot_of(rig: Values) -> Pilot:
    """The pilot of chapter 4: poppet and spring of the relief valve, before the volume of `chatter`."""
    valve, own = rig["relief"], rig["chatter"]
    return Pilot(
        mass=valve["pilot_mass"],
        stiffness=valve["pilot_stiffness"],
        drag=spring_drag(valve["pilot_spring_diameter"], valve["pilot_spring_turns"], _oil(rig)),
        chamfered=chamfered_of(rig),
        conical=conical_of(rig),
        modulus=own["modulus"],
        volume=own["volume"],
        reference_lift=own["reference_lift"],
        restitution=own["restitution"],
    )
