"""What a person writes about one pipe, as a case of the laboratory of lines."""

from typing import NamedTuple

from bridge.errors import UsageError, nearest
from bridge.scenario.units import option
from twin.lines.lab.pipe import PRESSURE, VELOCITY, Case, End, Pipe, closed, elastic, ramp, reservoir
from twin.oil import fluid_modulus, kinematic_viscosity
from twin.rig import values

ENDS = ("closed", "reservoir", "shut", "open", "push")
OIL = "rig"  # the only oil known by name; others by density, viscosity, bulk modulus


class LineOptions(NamedTuple):
    """What was asked for; texts with units."""

    length: str
    diameter: str
    oil: str  # OIL
    temperature: str
    viscosity: str | None  # instead of the temperature
    density: str | None
    speed: str | None  # of waves, instead of wall and Young's modulus
    wall: str
    young: str
    left: str  # of ENDS
    right: str
    velocity: str  # that is shut or opened
    pressure: str  # of reservoirs
    rise: str  # of a push
    closure: str  # time of shutting, opening, pushing
    span: str | None
    scheme: str
    friction: str
    cells: int
    step: str | None
    courant: float
    tolerance: str | None
    poles: int
    cavitation: bool
    branch: str | None  # length; none without
    branch_diameter: str | None  # else that of the pipe
    branch_at: str | None  # from the left end; else in the middle
    branch_end: str  # closed or reservoir


def case_of(request: LineOptions) -> Case:
    """The case. ValueError: a value out of its range, or ends that do not go together."""
    pipe = _pipe(request)
    velocity, pressure = amount(request, "velocity", "m/s", signed=True), amount(request, "pressure", "Pa")
    for kind in (request.left, request.right):
        if kind not in ENDS:
            raise UsageError(f"end {kind!r} is unknown{nearest(kind, ENDS)}")
    kinds = {request.left, request.right}
    if not kinds & {"reservoir", "push"}:
        raise ValueError("one end must hold pressure (reservoir or push), else the start is not known")
    start = velocity if "shut" in kinds else 0.0
    if start and "closed" in kinds:
        raise ValueError("a closed end and one that is shut from a velocity contradict each other; take open")
    left, right = (_end(request, kind, velocity, pressure) for kind in (request.left, request.right))
    if start and VELOCITY not in (left.holds, right.holds):
        raise ValueError("shut needs an end of its own")
    return Case(pipe, left, right, start, pressure)


def _pipe(request: LineOptions) -> Pipe:
    if request.oil != OIL:
        raise ValueError(f"oil {request.oil!r} unknown; take {OIL}, with --density, --viscosity or --speed of your own")
    oil, steel = values()["oil"], values()["pipe_1"]
    temperature = option("temperature", request.temperature, "degC")
    viscosity = amount(request, "viscosity", "m^2/s") if request.viscosity else kinematic_viscosity(temperature)
    density = amount(request, "density", "kg/m^3") if request.density else float(oil["density"])
    pipe = Pipe(amount(request, "length", "m"), amount(request, "diameter", "m"), 1.0, density, viscosity)
    if request.speed:
        return pipe._replace(speed=amount(request, "speed", "m/s"))
    measured = float(oil["density"]) * float(oil["wave_speed"]) ** 2
    modulus = fluid_modulus(measured, *(float(steel[name]) for name in ("diameter", "wall", "young")))
    return elastic(pipe, modulus, amount(request, "wall", "m"), amount(request, "young", "Pa"))


def _end(request: LineOptions, kind: str, velocity: float, pressure: float) -> End:
    closure = amount(request, "closure", "s", zero=True)
    if kind == "closed":
        return closed()
    if kind == "reservoir":
        return reservoir(pressure)
    if kind == "push":
        return End(PRESSURE, ramp(pressure, pressure + amount(request, "rise", "Pa", signed=True), closure))
    before, after = (velocity, 0.0) if kind == "shut" else (0.0, velocity)
    return End(VELOCITY, ramp(before, after, closure))


def amount(request: LineOptions, name: str, unit: str, signed: bool = False, zero: bool = False) -> float:
    """A quantity in SI; above zero unless it may be otherwise."""
    limits = {} if signed else {"least": 0.0} if zero else {"above": 0.0}
    return option(name, getattr(request, name), unit, **limits)
