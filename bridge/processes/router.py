"""A Zenoh router: the meeting point when plant, controller and recorder sit on several machines."""

import time
from pathlib import Path

from bridge.machine.process import Stop
from bridge.machine.refusals import count_refusals
from bridge.wire.intake import Turned
from bridge.wire.link import Link, is_guarded, names_addresses, open_session

TELLING = 5.0  # seconds between two lines on what was refused


def run_router(listen: str, config_file: Path | None) -> None:
    """Route until interrupted, on the addresses of the configuration file if it names some, else on `listen`.

    Raises LinkError when the address is taken or the configuration is wrong.
    """
    own = config_file is not None and names_addresses(config_file)
    turned = Turned()
    if config_file is not None and is_guarded(config_file):
        count_refusals(turned)
    with open_session(Link(None if own else listen, None, config_file, 0.0), mode="router"):
        stop = Stop().listen()
        print(f"hydrotwin: routing on {config_file if own else listen}; Ctrl-C ends it", flush=True)
        told: dict[str, int] = {}
        due = time.monotonic()
        while not stop():
            time.sleep(0.1)
            if time.monotonic() >= due and turned.counts() != told:
                told, due = turned.counts(), time.monotonic() + TELLING
                print(refusals(told), flush=True)
        print(refusals(turned.counts()), flush=True)


def refusals(counts: dict[str, int]) -> str:
    """What a router has refused, in a line."""
    words = ", ".join(f"{number} {what}" for what, number in sorted(counts.items()))
    return f"hydrotwin: refused: {words or 'none'}"
