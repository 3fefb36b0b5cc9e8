"""How much of what arrives is taken: sizes, rates, numbers of peers and of queries. The only place for these numbers.

They are assumed: well above what the loop itself needs, well below what would hold it up. docs/security.md lists them.
"""

from collections.abc import Iterable
from typing import Any, NamedTuple

MESSAGE = 4_000_000  # bytes of any message that a session takes; Zenoh closes the connection of a longer one
QUERY = 64_000  # bytes of a message or query to a guarded rig; the longest of our own, `lines`, has some 5000


class Peers(NamedTuple):
    """Connections, by their names in Zenoh's `transport/unicast`."""

    max_sessions: int
    accept_pending: int  # at the same time, not yet let in
    accept_timeout: int  # [ms] for one to prove who it is
    max_links: int  # per session


PEERS = Peers(max_sessions=64, accept_pending=32, accept_timeout=5000, max_links=1)


def guarding(keys: Iterable[str], size: int) -> list[dict[str, Any]]:
    """Zenoh's filter: what arrives on keys and is longer than so many bytes is dropped before it is passed on."""
    return [
        {"messages": ["put", "query"], "flows": ["ingress"], "key_exprs": list(keys), "size_limit": size},
    ]
