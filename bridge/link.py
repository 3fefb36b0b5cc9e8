"""How processes find one another: the plant listens on loopback, everybody else is its client, nothing is scouted.

A router, TLS, passwords and access control are configuration: a Zenoh configuration file is the base, what the
command line says goes on top.
"""

import socket
from pathlib import Path
from typing import Any, NamedTuple

import zenoh

DEFAULT_ENDPOINT = "tcp/127.0.0.1:7447"
LEASE_MS = 2000


class LinkError(Exception):
    """No connection; the text says to what, why, and what to try."""


class Link(NamedTuple):
    """Where a process listens or connects."""

    listen: str | None
    connect: str | None
    config: Path | None
    patience: float  # seconds to wait for the other side to appear


def open_session(link: Link) -> Any:
    """A Zenoh session. Raises LinkError when the address is taken or nobody answers."""
    config = _configuration(link)
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        raise LinkError(_explain(link, str(error))) from None


def free_endpoint() -> str:
    """A loopback endpoint nobody uses now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{probe.getsockname()[1]}"


def _configuration(link: Link) -> Any:
    try:
        config = zenoh.Config.from_file(str(link.config)) if link.config else zenoh.Config()
    except zenoh.ZError as error:
        raise LinkError(f"{link.config}: {error}") from None
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("transport/link/tx/lease", str(LEASE_MS))
    for priority in ("real_time", "data"):  # a burst after an overrun must fit; the default of 2 batches drops it
        config.insert_json5(f"transport/link/tx/queue/size/{priority}", "16")
    if link.listen:
        config.insert_json5("mode", '"peer"')
        config.insert_json5("listen/endpoints", f'["{link.listen}"]')
        config.insert_json5("listen/exit_on_failure", "true")
    if link.connect:
        if not link.listen:
            config.insert_json5("mode", '"client"')
        config.insert_json5("connect/endpoints", f'["{link.connect}"]')
        config.insert_json5("connect/timeout_ms", str(round(link.patience * 1000)))
        config.insert_json5("connect/exit_on_failure", "true")
        config.insert_json5("connect/retry", "{period_init_ms: 50, period_max_ms: 200, period_increase_factor: 1.5}")
    return config


def _explain(link: Link, error: str) -> str:
    if link.connect:
        return (
            f"nobody answers at {link.connect} within {link.patience:g} s: start the plant first, or name its address "
            f"with --connect ({error})"
        )
    return f"cannot listen on {link.listen}: another plant may run there; choose another with --listen ({error})"
