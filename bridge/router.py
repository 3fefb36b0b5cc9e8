"""A Zenoh router: the meeting point when plant, controller and recorder sit on several machines."""

import time
from pathlib import Path

import zenoh

from bridge.clock import Stop
from bridge.link import LinkError


def run_router(listen: str, config_file: Path | None) -> None:
    """Route until interrupted. Raises LinkError when the address is taken or the configuration is wrong."""
    stop = Stop()
    try:
        config = zenoh.Config.from_file(str(config_file)) if config_file else zenoh.Config()
        config.insert_json5("mode", '"router"')
        if not config_file:
            config.insert_json5("listen/endpoints", f'["{listen}"]')
            config.insert_json5("scouting/multicast/enabled", "false")
        config.insert_json5("listen/exit_on_failure", "true")
        session = zenoh.open(config)
    except zenoh.ZError as error:
        raise LinkError(f"cannot route on {config_file or listen}: {error}") from None
    print(f"hydrotwin: routing on {config_file or listen}; Ctrl-C ends it", flush=True)
    with session:
        while not stop():
            time.sleep(0.1)
