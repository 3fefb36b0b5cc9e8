"""Oil in a volume: how stored oil, volume and vapour make a pressure.

State: the stored oil S [m^3], measured at reference density, S = V + C p with C = V/B summed over the parts of the
node. What flows in is added to S and never lost. Below the vapour pressure p stays there and a cavity fills what the
oil leaves free: a discrete vapour cavity whose volume follows from S, so it needs no state of its own.
"""

from typing import NamedTuple

from twin.kernel import kernel


class Node(NamedTuple):
    """A place where components and line ends meet, at one instant."""

    stored: float  # S [m^3] at reference density
    volume: float  # V [m^3]
    capacity: float  # C [m^3/Pa]


@kernel
def pressure(node: Node, vapour_pressure: float) -> float:
    """p [Pa], gauge, never below the vapour pressure."""
    return max(vapour_pressure, (node.stored - node.volume) / node.capacity)


@kernel
def cavity(node: Node, vapour_pressure: float) -> float:
    """Volume of vapour [m^3]."""
    return max(0.0, node.volume + node.capacity * vapour_pressure - node.stored)


@kernel
def implicitness(stiffness: float) -> float:
    """theta of the theta rule for a resistance that empties a node in 1/stiffness steps.

    1/2 (second order) as long as a step resolves the node, else just enough that a node never overshoots its
    rest: (1 - theta) stiffness <= 1. As the step goes to zero every node is treated with 1/2.
    """
    return 0.5 if stiffness <= 2.0 else 1.0 - 1.0 / stiffness
