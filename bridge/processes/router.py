"""A Zenoh router: the meeting point when plant, controller and recorder sit on several machines."""

import time
from pathlib import Path

from bridge.machine.process import Stop
from bridge.wire.link import Link, names_addresses, open_session


def run_router(listen: str, config_file: Path | None) -> None:
    """Route until interrupted, on the addresses of the configuration file if it names some, else on `listen`.

    Raises LinkError when the address is taken or the configuration is wrong.
    """
    own = config_file is not None and names_addresses(config_file)
    with open_session(Link(None if own else listen, None, config_file, 0.0), mode="router"):
        stop = Stop().listen()
        print(f"hydrotwin: routing on {config_file if own else listen}; Ctrl-C ends it", flush=True)
        while not stop():
            time.sleep(0.1)
