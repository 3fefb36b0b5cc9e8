"""How processes find one another: the plant listens on loopback, everybody else is its client, nothing is scouted.

A router, TLS, passwords and access control are configuration: a Zenoh configuration file is the base; what the
command line says goes on top, and so do no scouting and queues that hold a burst.
"""

import json
import os
import re
import socket
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

from bridge.errors import RunError
from bridge.wire.limits import FRAME, PEERS, guarding

DEFAULT_ENDPOINT = "tcp/127.0.0.1:7447"
LOOPBACK = ((socket.AF_INET, "127.0.0.1", "127.0.0.1"), (socket.AF_INET6, "::1", "[::1]"))
NAMES_FILES = (
    "transport/auth/usrpwd/dictionary_file",
    *(
        f"transport/link/tls/{name}"
        for name in (
            "root_ca_certificate",
            *("listen_private_key", "listen_certificate", "connect_private_key", "connect_certificate"),
        )
    ),
)
WAIT_BEFORE_DROP_US = 10_000  # once; from then on a reader that stays stuck costs nothing


class LinkError(RunError):
    """No connection; the text says to what, why, and what to try."""


class Link(NamedTuple):
    """Where a process listens or connects."""

    listen: str | None
    connect: str | None
    config: Path | None
    patience: float  # seconds to wait for the other side to appear


def open_session(link: Link, mode: str | None = None, lease: float | None = None, only_short: bool = False) -> Any:
    """A Zenoh session: peer where it listens, else client, unless `mode` is given.

    lease: after so many seconds of silence the others give this one up; Zenoh's own is 10 s.
    only_short: Zenoh itself drops messages that are too long, for whoever does not look at each as it comes.

    Raises LinkError when the address is taken, nobody answers, or the configuration is wrong.
    """
    import zenoh

    try:
        config = _configuration(link, mode)
        if only_short:
            config.insert_json5("low_pass_filter", json.dumps(guarding(["**"])))
        if lease is not None:
            config.insert_json5("transport/link/tx/lease", str(round(lease * 1000)))
        return zenoh.open(config)
    except zenoh.ZError as error:
        raise LinkError(_explain(link, _reason(error))) from None


def names_addresses(file: Path) -> bool:
    """Does a configuration file say itself where to listen?"""
    import zenoh

    return _base(file).get_json("listen/endpoints") != zenoh.Config().get_json("listen/endpoints")


def is_guarded(file: Path) -> bool:
    """Does a configuration file ask those who connect for a password, or look at what they may do?"""
    config = _base(file)
    named = json.loads(config.get_json("transport/auth/usrpwd/dictionary_file"))
    return bool(named) or json.loads(config.get_json("access_control/enabled"))


def free_endpoint() -> str:
    """A loopback endpoint nobody uses now."""
    for family, host, written in LOOPBACK:
        with suppress(OSError), socket.socket(family) as probe:
            probe.bind((host, 0))
            return f"tcp/{written}:{probe.getsockname()[1]}"
    raise LinkError(
        "this machine has no loopback address, neither 127.0.0.1 nor ::1: set its network up (ip link set lo up), "
        "name another address with --listen, or run with --mode inprocess"
    )


def is_free(endpoint: str) -> bool:
    """Does nobody listen on a loopback endpoint such as DEFAULT_ENDPOINT?"""
    host, _, port = endpoint.partition("/")[2].rpartition(":")
    with suppress(OSError), socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        probe.bind((host, int(port)))
        return True
    return False


def _configuration(link: Link, mode: str | None) -> Any:
    config = _base(link.config)
    if mode or link.listen or link.connect:
        config.insert_json5("mode", json.dumps(mode or ("peer" if link.listen else "client")))
    if link.listen:
        config.insert_json5("listen/endpoints", json.dumps([link.listen]))
    config.insert_json5("listen/exit_on_failure", "true")
    if link.connect:
        config.insert_json5("connect/endpoints", json.dumps([link.connect]))
        config.insert_json5("connect/timeout_ms", str(round(link.patience * 1000)))
        config.insert_json5("connect/exit_on_failure", "true")
        config.insert_json5("connect/retry", "{period_init_ms: 50, period_max_ms: 200, period_increase_factor: 1.5}")
    return config


def _base(file: Path | None) -> Any:
    """What all our sessions share, on top of a configuration file if there is one."""
    import zenoh

    try:
        config = zenoh.Config.from_file(str(file)) if file else zenoh.Config()
    except zenoh.ZError as error:
        raise LinkError(f"{file}: {_reason(error)}") from None
    if file:
        _find_beside(file, config)
    config.insert_json5("transport/link/rx/max_message_size", str(FRAME))
    for name, value in PEERS._asdict().items():
        if config.get_json(key := f"transport/unicast/{name}") == zenoh.Config().get_json(key):
            config.insert_json5(key, str(value))
    config.insert_json5("scouting/multicast/enabled", "false")
    if file is None or not os.access("/dev/shm", os.W_OK):  # our messages are too small for it, and it may be missing
        config.insert_json5("transport/shared_memory/enabled", "false")
    for priority in ("real_time", "data"):  # a burst after an overrun must fit; the default of 2 batches drops it
        config.insert_json5(f"transport/link/tx/queue/size/{priority}", "16")
    config.insert_json5("transport/link/tx/queue/congestion_control/drop/wait_before_drop", str(WAIT_BEFORE_DROP_US))
    return config


def _find_beside(file: Path, config: Any) -> None:
    """A relative path in a configuration counts from the working folder, or from the configuration's where it is."""
    for key in NAMES_FILES:
        named = json.loads(config.get_json(key))
        if named and not Path(named).exists() and (beside := file.resolve().parent / named).exists():
            config.insert_json5(key, json.dumps(str(beside)))


def _reason(error: Exception) -> str:
    """Zenoh's own words in one line, without the place in its sources that they come from."""
    return " ".join(re.sub(r" at \S+\.rs:\d+\.?", "", str(error)).split())


def _explain(link: Link, error: str) -> str:
    if link.connect:
        refused = f", or refuses the name, password or certificate in {link.config}" if link.config else ""
        return (
            f"nobody answers at {link.connect} within {link.patience:g} s{refused}: start the plant first, or name its "
            f"address with --connect, and the password that it may ask for with --zenoh-config ({error})"
        )
    what = link.listen or f"the addresses in {link.config}"
    return (
        f"cannot listen on {what}: another plant may run there, or the address is not this machine's; choose another "
        f"with --listen ({error})"
    )
