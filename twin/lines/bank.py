"""All lines of a circuit behind one door: what comes on at their ends, and what leaves.

At each instant t_k = k h every line end offers p = c + Z q, q the flow INTO the line at that end [m^3/s at reference
density], p gauge [Pa]; c and Z come from the past only. Ends are counted line 0 end 1, line 0 end 2, line 1 end 1, ...

    settle(bank, memory, p, q)             once: steady at the instant before the first and ever since
    for tick in 0, 1, 2, ...:              ticks may start anywhere from 0, but follow one another
        arriving(bank, memory, tick, c, z)     reads only; then solve the circuit for q
        departing(bank, memory, tick, q)           exactly once per tick
        profile(bank, memory, tick, ...)       at will, after `departing` of that tick

Turbulent friction beyond the laminar one, r >= 0 from the flow of the instant before, sits half at each end of an
`ends` line, from each end's own flow: where a front divides the pipe only the part behind it resists, and r q^2 takes
energy whatever q does. In `nodes` it sits at both ends of every segment, in `lumped` in the middle; `volume` has none.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.kernel import inlined, kernel, rows
from twin.lines import chunks, ends, lumped, nodes, volume
from twin.lines.friction import turbulence, turbulence_slope
from twin.lines.spec import LOSSES, MODELS, LineNumbers, LineSpec, derive
from twin.lines.wall import ELEMENTS

MOST_STEPS = 50_000  # in a travel time, assumed: filters of more take minutes to fit, and their memory does not end
LUMPED, ENDS, NODES, VOLUME = range(len(MODELS))
Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class Bank(NamedTuple):
    """The lines of a circuit, read-only. Arrays with an entry per line first, then those of each model."""

    step: float  # h [s]
    vapour_pressure: float  # [Pa]
    size: int  # of the memory
    model: Integers  # of MODELS
    slot: Integers  # number of the line among those of its model
    z0: Floats  # rho a/A [Pa s/m^3]
    capacity: Floats  # V/B, at once [m^3/Pa]
    settled_capacity: Floats  # with what the wall gives late [m^3/Pa]
    inertance: Floats  # rho l/A; of `volume` what its scheme has [Pa s^2/m^3]
    resistance: Floats  # laminar, 128 mu l/(pi d^4); 0 without friction [Pa s/m^3]
    travel_time: Floats  # l/a; 0 of `volume` [s]
    turbulent_per_flow: Floats  # Re per flow [s/m^3]; 0 if the friction does not know Re
    ends_place: Integers  # per chunk
    ends_layout: Integers
    ends_numbers: Floats
    nodes_lines: Integers  # which lines
    nodes_place: Integers
    nodes_layout: Integers
    nodes_numbers: Floats
    lumped_lines: Integers
    lumped_place: Integers
    lumped_numbers: Floats
    volume_lines: Integers
    volume_place: Integers
    volume_numbers: Floats


def bank_of(specs: Sequence[LineSpec], step: float, vapour_pressure: float) -> Bank:
    """Fit every line to the step [s]; ValueError names the line, what is wrong and the way out."""
    lines = [_checked(i, s, step) for i, s in enumerate(specs)]
    which = [[i for i, s in enumerate(specs) if s.model == model] for model in MODELS]
    size = 2 * len(specs)  # the turbulent resistances of all ends stand first

    filters = [_attempt(i, specs[i], chunks.fitted, lines[i], step) for i in which[ENDS]]
    laid = chunks.chunks_of(which[ENDS], [lines[i] for i in which[ENDS]], filters, step, size)
    size += laid.size
    meshes = [_attempt(i, specs[i], nodes.prepare, lines[i], step, vapour_pressure) for i in which[NODES]]
    nodes_place = size + np.cumsum([0, *(cells for _, _, cells in meshes)])
    lumps = [_attempt(i, specs[i], lumped.coefficients, lines[i], step) for i in which[LUMPED]]
    lumped_place = nodes_place[-1] + lumped.SIZE * np.arange(len(lumps) + 1)
    volumes = [_attempt(i, specs[i], volume.coefficients, lines[i], step) for i in which[VOLUME]]
    volume_place = lumped_place[-1] + volume.SIZE * np.arange(len(volumes) + 1)

    per_line = [name for name in LineNumbers._fields if name in Bank._fields]
    bank = Bank(
        step=step,
        vapour_pressure=vapour_pressure,
        size=int(volume_place[-1]),
        model=np.array([MODELS.index(s.model) for s in specs]),
        slot=np.array([which[MODELS.index(s.model)].index(i) for i, s in enumerate(specs)]),
        ends_place=laid.place,
        ends_layout=laid.layout,
        ends_numbers=laid.numbers,
        nodes_lines=np.array(which[NODES], dtype=np.int64),
        nodes_place=nodes_place[:-1],
        nodes_layout=np.array([layout for layout, _, _ in meshes], np.int64).reshape(len(meshes), nodes.LAYOUT),
        nodes_numbers=np.array([numbers for _, numbers, _ in meshes]).reshape(len(meshes), nodes.NUMBERS),
        lumped_lines=np.array(which[LUMPED], dtype=np.int64),
        lumped_place=lumped_place[:-1],
        lumped_numbers=np.array(lumps).reshape(len(lumps), lumped.NUMBERS),
        volume_lines=np.array(which[VOLUME], dtype=np.int64),
        volume_place=volume_place[:-1],
        volume_numbers=np.array(volumes).reshape(len(volumes), volume.NUMBERS),
        **{name: np.array([getattr(line, name) for line in lines]) for name in per_line},
    )
    for array in bank[3:]:
        array.flags.writeable = False
    return bank


def _checked(i: int, s: LineSpec, step: float) -> LineNumbers:
    if s.model not in MODELS or s.friction not in LOSSES:
        raise ValueError(f"pipe_{i + 1}: model {s.model}, friction {s.friction}; known: {MODELS}, {tuple(LOSSES)}")
    if len(s.creep) > (most := 0 if s.model == "nodes" else ELEMENTS):
        way = "model ends, lumped or volume, or creep = 0" if most == 0 else "fewer"
        raise ValueError(f"pipe_{i + 1}: {len(s.creep)} elements of creep, limit {most} in model {s.model}; take {way}")
    if s.model == "volume":
        return (line := derive(s._replace(friction="none")))._replace(
            inertance=volume.inertance(line, step), travel_time=0.0
        )
    line = derive(s)
    if s.model in ("ends", "nodes") and line.travel_time > MOST_STEPS * step:
        is_steps = f"travel time {line.travel_time:.3g} s is {line.travel_time / step:.0f} steps, limit {MOST_STEPS}"
        way = "take a larger loop.step, a shorter pipe or model lumped; a unit may be missing"
        raise ValueError(f"pipe_{i + 1}, {s.length:g} m: {is_steps}; {way}")
    return line


def _attempt(i: int, s: LineSpec, prepare, *arguments):
    """What a model makes of a line, its refusal with the line's number and a way out."""
    try:
        return prepare(*arguments)
    except ValueError as error:
        simpler = "volume" if s.model == "lumped" else "lumped"
        way = f"take a smaller loop.step, a longer pipe or model {simpler}"
        raise ValueError(f"pipe_{i + 1}, {s.length:g} m: {error}; {way}") from error


def packed(bank: Bank) -> tuple[Integers, Floats]:
    """A bank as two flat arrays: numba looks at every array of a call for a tenth of a microsecond.

    The first starts with the size of the memory, then where each of its own parts begins and the last ends, then the
    same for the parts of the second; parts stand in the order of the fields.
    """
    whole: list[Any] = [array.ravel() for array in bank[3:] if array.dtype == np.int64]
    numbers: list[Any] = [array.ravel() for array in bank[3:] if array.dtype == np.float64]
    head = 1 + len(whole) + 1 + len(numbers) + 1
    starts = np.cumsum([head, *map(len, whole)]), np.cumsum([2, *map(len, numbers)])
    scalars = np.array([bank.step, bank.vapour_pressure])
    return np.concatenate([[bank.size], *starts, *whole]), np.concatenate([scalars, *numbers])


@inlined
def unpacked(w, f) -> Bank:
    """The bank that `packed` has made flat, as views of it."""
    n_ends, n_nodes, n_lumped, n_volume = w[4] - w[3], w[6] - w[5], w[9] - w[8], w[11] - w[10]
    b = w[13:25]
    return Bank(
        f[0],
        f[1],
        w[0],
        w[w[1] : w[2]],
        w[w[2] : w[3]],
        f[b[0] : b[1]],
        f[b[1] : b[2]],
        f[b[2] : b[3]],
        f[b[3] : b[4]],
        f[b[4] : b[5]],
        f[b[5] : b[6]],
        f[b[6] : b[7]],
        w[w[3] : w[4]],
        rows(w[w[4] : w[5]], n_ends, chunks.LAYOUT * chunks.LANES),
        rows(f[b[7] : b[8]], n_ends, chunks.NUMBERS * chunks.LANES),
        w[w[5] : w[6]],
        w[w[6] : w[7]],
        rows(w[w[7] : w[8]], n_nodes, nodes.LAYOUT),
        rows(f[b[8] : b[9]], n_nodes, nodes.NUMBERS),
        w[w[8] : w[9]],
        w[w[9] : w[10]],
        rows(f[b[9] : b[10]], n_lumped, lumped.NUMBERS),
        w[w[10] : w[11]],
        w[w[11] : w[12]],
        rows(f[b[10] : b[11]], n_volume, volume.NUMBERS),
    )


def memory_size(bank: Bank) -> int:
    """Numbers [float64] that the kernels keep for a bank."""
    return bank.size


@inlined
def arriving(bank, memory, tick: int, c, z) -> None:
    """Fill c [Pa] and z [Pa s/m^3] of all ends for the instant of the tick."""
    if len(bank.ends_place):
        ends.arriving(bank.ends_place, bank.ends_layout, bank.ends_numbers, memory, c, z)
    if len(bank.nodes_lines):
        nodes.arriving(bank.nodes_lines, bank.nodes_place, bank.nodes_layout, bank.nodes_numbers, memory, tick, c, z)
    if len(bank.lumped_lines):
        lumped.arriving(bank.lumped_lines, bank.lumped_place, bank.lumped_numbers, memory, c, z)
    if len(bank.volume_lines):
        volume.arriving(bank.volume_lines, bank.volume_place, bank.volume_numbers, memory, c, z)


@inlined
def departing(bank, memory, tick: int, q) -> None:
    """Take the flows into all ends [m^3/s] at the instant of the tick."""
    if len(bank.ends_place):
        ends.departing(bank.ends_place, bank.ends_layout, bank.ends_numbers, memory, tick, q)
    if len(bank.nodes_lines):
        nodes.departing(bank.nodes_lines, bank.nodes_place, bank.nodes_layout, bank.nodes_numbers, memory, tick, q)
    if len(bank.lumped_lines):
        lumped.departing(bank.lumped_lines, bank.lumped_place, bank.lumped_numbers, memory, q)
    if len(bank.volume_lines):
        volume.departing(bank.volume_lines, bank.volume_place, bank.volume_numbers, memory, q, bank.vapour_pressure)


@kernel
def settle(bank, memory, p, q) -> None:
    """Start steady: p[2n] pressures at all ends, q[n] flows from end 1 to end 2, with p_1 - p_2 = steady_drop(q)."""
    memory[:] = 0.0
    ends.settle(bank.ends_place, bank.ends_layout, bank.ends_numbers, memory, p, q)
    nodes.settle(bank.nodes_lines, bank.nodes_place, bank.nodes_layout, bank.nodes_numbers, memory, p, q)
    lumped.settle(bank.lumped_lines, bank.lumped_place, bank.lumped_numbers, memory, p, q)
    volume.settle(bank.volume_lines, bank.volume_place, bank.volume_numbers, memory, p, q)


@kernel
def profile(bank, memory, tick: int, line: int, xi, out) -> None:
    """Pressure [Pa] at places xi (0 end 1 .. 1 end 2) after `departing` of the tick."""
    slot = bank.slot[line]
    if bank.model[line] == ENDS:
        ends.profile(bank.ends_place, bank.ends_layout, bank.ends_numbers, memory, slot, tick, xi, out)
    elif bank.model[line] == NODES:
        nodes.profile(bank.nodes_place[slot], bank.nodes_layout[slot], bank.nodes_numbers[slot], memory, xi, out)
    elif bank.model[line] == LUMPED:
        lumped.profile(bank.lumped_place[slot], memory, xi, out)
    else:
        volume.profile(bank.volume_place[slot], memory, xi, out)


@kernel
def inner_cavity(bank, memory, line: int) -> float:
    """Vapour inside a line [m^3]; only `nodes` has any."""
    if bank.model[line] != NODES:
        return 0.0
    slot = bank.slot[line]
    return nodes.cavity(bank.nodes_place[slot], bank.nodes_layout[slot], memory)


@kernel
def steady_drop(bank, line: int, q: float) -> float:
    """Pressure drop [Pa] from end 1 to end 2 at a steady flow q [m^3/s]."""
    return bank.resistance[line] * turbulence(abs(q) * bank.turbulent_per_flow[line]) * q


@kernel
def steady_slope(bank, line: int, q: float) -> float:
    """Slope of `steady_drop` by the flow [Pa s/m^3]."""
    return bank.resistance[line] * turbulence_slope(abs(q) * bank.turbulent_per_flow[line])
