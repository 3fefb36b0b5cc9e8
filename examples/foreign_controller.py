"""A controller for the rig without any of hydrotwin: Zenoh, and the layout of two messages.

Usage: python foreign_controller.py [ADDRESS]. `hydrotwin messages` prints the fields; four bytes of CDR precede them.
"""

import random
import struct
import sys
import time

import zenoh

MEASUREMENT = struct.Struct("<4xQQQqddddd")  # run, sequence, tick, stamp [ns], position [m], velocity, p1, p2, p3
COMMAND = struct.Struct("<4xQQQqqd")  # run, source, sequence, stamp answered [ns], acts at [ns], spool -1..1
SOURCE = random.getrandbits(64)  # who we are: the first controller to speak owns the plant
DELAY = 5_000_000  # [ns] from the sample to the action: time to compute and to travel
GAIN, DEAD_BAND = 37.0, 0.1  # spool per metre; share of the spool's travel in which the valve stays shut
heard = time.monotonic() + 60.0  # patience for the first measurement


def answer(sample: zenoh.Sample) -> None:
    """Steer to a square wave of 4 s between 160 and 120 mm: jump over the dead band, then in proportion."""
    global heard
    heard = time.monotonic()
    run, _, tick, stamp, position, *_ = MEASUREMENT.unpack(sample.payload.to_bytes())
    if tick % 10 == 0:
        error = (0.16 if stamp % 4_000_000_000 < 2_000_000_000 else 0.12) - position
        spool = max(-1.0, min(1.0, GAIN * error + (DEAD_BAND if error > 0.0 else -DEAD_BAND)))
        session.put("rig/command", b"\0\1\0\0" + COMMAND.pack(run, SOURCE, tick // 10, stamp, stamp + DELAY, spool)[4:])


config = zenoh.Config()
config.insert_json5("mode", '"client"')
address = sys.argv[1] if len(sys.argv) > 1 else "tcp/127.0.0.1:7447"
config.insert_json5("connect", f'{{endpoints: ["{address}"], timeout_ms: 60000}}')
with zenoh.open(config) as session:
    measurements = session.declare_subscriber("rig/measurement", answer)
    present = session.liveliness().declare_token(f"rig/alive/controller/{SOURCE}")  # the plant waits for one of these
    while time.monotonic() - heard < 1.0:
        time.sleep(0.1)
