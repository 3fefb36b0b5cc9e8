"""What the pilot's equations ask of its seat. Which seat is fitted is known when they are compiled.

A seat is a file with its numbers as a NamedTuple and a variant of each of these functions: `chamfered_seat`,
`long_seat`. Lifts [m] from the seat, the outlet at zero pressure.
"""

from typing import Any

from twin.kernel import by_type


@by_type
def seat_flow(seat: Any, lift: float) -> tuple[float, float]:
    """R [m^3/(s sqrt(Pa))] of Q = R sqrt(p2), and the area [m^2] on which p2 acts, both at a lift > 0."""
    raise TypeError(f"{seat} is not a seat")


@by_type
def opening_slope(seat: Any, lift: float, conductance: float, area: float) -> tuple[float, float]:
    """Slopes over the lift of what `seat_flow` gives at a lift > 0; 0.0 for a seat whose substeps are the finest."""
    raise TypeError(f"{seat} is not a seat")


@by_type
def laminar_conductance(seat: Any, lift: float) -> float:
    """G [m^3/(s Pa)] of a flow Q = G p2 at a lift; 0.0 for a seat that is shut or whose flow is R sqrt(p2)."""
    raise TypeError(f"{seat} is not a seat")


@by_type
def is_laminar(seat: Any) -> bool:
    """Is the flow G p2, and not R sqrt(p2)?"""
    raise TypeError(f"{seat} is not a seat")


@by_type
def seat_damping(seat: Any, lift: float, spring: float) -> float:
    """K [N s/m] of the oil in the gap added to that of the oil on the spring."""
    raise TypeError(f"{seat} is not a seat")


@by_type
def pressure_stiffness(seat: Any, stiff_12: float, y: float, lift: float, conductance: float, area: float) -> float:
    """How p2 resists the poppet's lift, A dp2/dx [N/m]; stiff_12 [Pa s/m^3] of orifices 1 and 2, p2 = y|y|."""
    raise TypeError(f"{seat} is not a seat")
