"""A controller as a node of ROS 2, without ROS: by zenoh-ros2-sdk, through `hydrotwin ros`.

Usage: python ros_controller.py PACKAGE [PORT]. PACKAGE: what `hydrotwin ros --package PACKAGE` has written; PORT: of
the router of the nodes. A node of rclpy does the same with the messages of that package, built.
"""

import random
import sys
import threading
import time
from pathlib import Path
from typing import Any

from zenoh_ros2_sdk import ROS2Publisher, ROS2Subscriber  # pyright: ignore[reportMissingImports]
from zenoh_ros2_sdk.discovery import get_topic_names_and_types  # pyright: ignore[reportMissingImports]

MESSAGES = Path(sys.argv[1]) / "hydrotwin_msgs" / "msg"
PORT = int(sys.argv[2]) if len(sys.argv) > 2 else 7448
DELAY = 10_000_000  # [ns] from the sample to the action: time to compute and to travel, through the bridge both ways
GAIN, DEAD_BAND = 37.0, 0.1  # spool per metre; share of the spool's travel in which the valve stays shut
SOURCE = random.getrandbits(64)  # who we are: the first controller to speak owns the plant
heard = time.monotonic() + 60.0  # patience for the first measurement
ready = threading.Event()
sent = 0


def definition(name: str) -> dict[str, Any]:
    """A type of the package, as this library wants it."""
    text = (MESSAGES / f"{name}.msg").read_text(encoding="utf-8")
    return {"msg_type": f"hydrotwin_msgs/msg/{name}", "msg_definition": text, "router_port": PORT, "domain_id": 0}


def answer(measured: Any) -> None:
    """Steer to a square wave of 4 s between 160 and 120 mm: jump over the dead band, then in proportion."""
    global heard, sent
    heard = time.monotonic()
    if measured.tick % 10 == 0 and ready.wait(10.0):
        error = (0.16 if measured.stamp % 4_000_000_000 < 2_000_000_000 else 0.12) - measured.position
        spool = max(-1.0, min(1.0, GAIN * error + (DEAD_BAND if error > 0.0 else -DEAD_BAND)))
        who = {"run_id": measured.run_id, "source": SOURCE, "sequence": measured.tick // 10}
        commands.publish(**who, sample_stamp=measured.stamp, apply_at=measured.stamp + DELAY, spool=spool)
        sent += 1


measurements = ROS2Subscriber("/rig/measurement", callback=answer, node_name="steering", **definition("Measurement"))
print(len(get_topic_names_and_types(router_port=PORT)), "topics", flush=True)
commands = ROS2Publisher("/rig/command", node_name="steering", **definition("ValveCommand"))
ready.set()
while time.monotonic() - heard < 1.0:
    time.sleep(0.1)
measurements.close()  # its thread would keep the program alive
commands.close()
print(sent, "commands", flush=True)
