"""How much of what arrives is taken: sizes, rates, numbers of peers and of queries. The only place for these numbers.

They are assumed: well above what the loop itself needs, well below what would hold it up. docs/security.md lists them.
"""

from collections.abc import Iterable
from enum import StrEnum
from typing import Any, NamedTuple

FRAME = 4_000_000  # bytes of anything that a session takes; Zenoh closes the connection that sends more
MESSAGE = 64_000  # bytes of a message on a rig's keys; the longest of our own, `lines`, has some 5000
QUERY = 64_000  # bytes of a query's payload
TOKENS = 256  # signs of life of other processes that are remembered, over all roles
WAITING_QUERIES = 16  # of one kind
QUERY_RATE = 100.0  # per second, of one kind
WAITING_COMMANDS = 20_000  # at the plant, with resets and orders
WAITING_TARGETS = 1000  # at the plant, between two ticks
FAULTS = 1000  # of a run, those injected included
STRANGERS = 20  # controllers of other scenarios that a plant tells of
WAITING_RECORDS = 500_000  # messages at the recorder, two minutes at 1 kHz: a disk slower than that costs messages
WAITING_BYTES = 500_000_000  # of them

FASTEST = 20_000.0  # messages per second on a key in real time: four times the fastest card, which has 5 kHz
RATES = {"reset": 10.0, "target": 1000.0, "status": 1000.0}  # per second; of other topics FASTEST
COMMANDS = 10.0  # times the rate that the scenario's sample period makes
LEAST_COMMANDS = 1000.0  # per second
IN_A_ROW = 1.0  # seconds' worth of messages that may come at once: what an overrun has held up


class Excess(StrEnum):
    """Why something that arrived was not even looked at, or could not be read."""

    LONG = "too long"
    OFTEN = "too often"
    WAITING = "too many waiting"
    UNREADABLE = "unreadable"
    CONNECTION = "connection refused"
    DENIED = "without the right, or too long"


class Peers(NamedTuple):
    """Connections to whoever listens, by their names in Zenoh's `transport/unicast`."""

    max_sessions: int
    accept_pending: int  # at the same time, not yet let in
    accept_timeout: int  # [ms] for one to prove who it is
    max_links: int  # per session


PEERS = Peers(max_sessions=256, accept_pending=64, accept_timeout=5000, max_links=1)


def guarding(keys: Iterable[str]) -> list[dict[str, Any]]:
    """Zenoh's filter: what arrives on keys and is too long is dropped before it is passed on."""
    return [{"messages": ["put", "query"], "flows": ["ingress"], "key_exprs": list(keys), "size_limit": MESSAGE}]


def command_rate(sample_period: float, speed: float) -> float:
    """Commands per second that a plant takes in real time, from its sample period [s] and speed."""
    return max(COMMANDS * speed / sample_period, LEAST_COMMANDS)
