"""Wall that creeps, at an end of a line without waves: Kelvin-Voigt elements beside the capacity of that end.

An element takes oil q_k late, C_k = w_k C/2 behind a resistance R_k = tau_k/C_k (Covas et al. 2005 for pipes; each
element of strain e_k follows tau_k e_k' + e_k = J_k sigma):

    p = e_k + (R_k + h/(2 C_k)) q_k,      e_k <- e_k + h/C_k q_k       (trapezoidal rule)

In a step it gives h p q_k = C_k/2 (e_k'^2 - e_k^2) + h R_k q_k^2 to store and heat: passive, and no oil is lost.
"""

from twin.kernel import inlined, kernel
from twin.lines.spec import LineNumbers

ELEMENTS = 2  # at most
NUMBERS = 2 * ELEMENTS  # of a line: admittance q_k/(p - e_k) [m^3/(s Pa)], then h/C_k [Pa s/m^3], of each


def wall_numbers(line: LineNumbers, step: float) -> list[float]:
    """Of both ends of a line alike; zeros without creep."""
    numbers = [0.0] * NUMBERS
    for k, element in enumerate(line.creep):
        capacity = 0.5 * line.capacity * element.share
        if capacity > 0.0:
            numbers[2 * k] = 2.0 * capacity / (2.0 * element.time + step)
            numbers[2 * k + 1] = step / capacity
    return numbers


@inlined
def creep_port(c: float, z: float, numbers, states) -> tuple[float, float]:
    """c and Z of an end p = c + Z q with the elements beside it; numbers, states: of its wall."""
    admittance = 1.0 / z
    supply = c * admittance
    for k in range(ELEMENTS):
        admittance += numbers[2 * k]
        supply += numbers[2 * k] * states[k]
    return supply / admittance, 1.0 / admittance


@kernel
def inner_flow(c: float, z: float, q: float, numbers, states) -> float:
    """What is left of a flow into an end [m^3/s] when the elements have taken theirs; their states move on."""
    c_end, z_end = creep_port(c, z, numbers, states)
    p = c_end + z_end * q
    for k in range(ELEMENTS):
        flow = numbers[2 * k] * (p - states[k])
        states[k] += numbers[2 * k + 1] * flow
        q -= flow
    return q
