"""What Zenoh refuses by itself, counted: connections without the right key or password, messages without the right.

Zenoh tells of them in its log alone, which goes to standard output: it is led through a pipe and read line by line.
What else is written to standard output goes where it went before.
"""

import os
import sys
import threading
from contextlib import suppress

from bridge.wire.intake import Turned
from bridge.wire.limits import Excess

LOGGED = ",".join(
    (
        "zenoh_link_tls=warn",  # certificates
        "zenoh_transport::unicast::establishment::accept=debug",  # passwords, numbers of peers
        "zenoh::net::routing::interceptor=trace",  # rights and sizes
        "zenoh::net::routing::interceptor::access_control=off",  # it tells of what is allowed, too
        "zenoh::net::routing::interceptor::low_pass=off",
    )
)
KINDS = (  # the first text that is in a line says what it means
    (b"zenoh_link_tls", "certificate", Excess.CONNECTION),
    (b"Invalid password", "password", Excess.CONNECTION),
    (b"Invalid user", "user", Excess.CONNECTION),
    (b"New transport link accepted", "", None),
    (b"establishment::accept", "peer", Excess.CONNECTION),
    (b"Msg intercepted!", "message", Excess.DENIED),
    (b"routing::interceptor", "", None),
)


def kind_of(line: bytes) -> tuple[str, Excess | None] | None:
    """What a line of the log says was refused, and why; an empty name for nothing; None for somebody else's line."""
    return next(((what, why) for text, what, why in KINDS if text in line), None)


def count_refusals(turned: Turned) -> None:
    """Count from now on; call it before the session is opened. Without a standard output nothing is counted."""
    import zenoh

    try:
        kept = os.dup(1)
    except OSError:
        return
    source, sink = os.pipe()
    sys.stdout.flush()
    os.dup2(sink, 1)
    os.close(sink)
    sys.stdout = os.fdopen(os.dup(kept), "w", encoding="utf-8", errors="replace", buffering=1)
    zenoh.init_log_from_env_or(LOGGED)
    threading.Thread(target=_read, args=(source, kept, turned), daemon=True, name="refusals").start()


def _read(source: int, kept: int, turned: Turned) -> None:
    with os.fdopen(source, "rb") as lines:
        for line in lines:
            kind = kind_of(line)
            if kind is None:
                with suppress(OSError):
                    os.write(kept, line)
            elif kind[1] is not None:
                turned.add(kind[0], kind[1])
