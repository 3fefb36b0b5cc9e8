"""What a resistance dp = a Q|Q| + b Q lets pass from one node to another during a step.

Both nodes answer to the flow, p = max(p_v, p* -+ Z Q), so the end of the step is a quadratic in Q per combination of
cavities: solved exactly, without iteration, whatever the step.
"""

from twin.kernel import kernel
from twin.node import Node, implicitness
from twin.orifice import quadratic_flow


@kernel
def exchange(
    drop_before: float, source: Node, sink: Node, a: float, b: float, vapour_pressure: float, step: float
) -> float:
    """Mean flow [m^3/s] from source to sink over a step [s], by the theta rule.

    drop_before: pressure difference [Pa] at the start of the step. The nodes are those at its end with all other
    flows already added.
    """
    flow_before = quadratic_flow(drop_before, a, b)
    conductance = 1.0 / (a * abs(flow_before) + b) if a * abs(flow_before) + b > 0.0 else 0.0
    theta = implicitness(step * conductance * (1.0 / source.capacity + 1.0 / sink.capacity))
    explicit = (1.0 - theta) * step * flow_before
    up = (source.stored - explicit - source.volume) / source.capacity
    down = (sink.stored + explicit - sink.volume) / sink.capacity
    z_up, z_down = theta * step / source.capacity, theta * step / sink.capacity
    return (1.0 - theta) * flow_before + theta * _end_flow(up, down, z_up, z_down, a, b, vapour_pressure)


@kernel
def _end_flow(up: float, down: float, z_up: float, z_down: float, a: float, b: float, vapour_pressure: float) -> float:
    """Q with a Q|Q| + b Q = max(p_v, up - z_up Q) - max(p_v, down + z_down Q).

    The left side rises and the right side falls with Q, so there is one answer. Oil never runs towards the higher
    pressure, hence only the receiving end can still be a cavity when oil flows.
    """
    q = quadratic_flow(up - down, a, b + z_up + z_down)
    if up - z_up * q >= vapour_pressure and down + z_down * q >= vapour_pressure:
        return q
    if up > vapour_pressure:
        return quadratic_flow(up - vapour_pressure, a, b + z_up)
    if down > vapour_pressure:
        return quadratic_flow(vapour_pressure - down, a, b + z_down)
    return 0.0
