"""The keyboard as a remote control of a replay, where there is one."""

import os
import select
import sys
import termios
import threading
import tty
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from bridge.replay.player import Player

KEYS = {
    b" ": ("toggle", ""),
    b"s": ("step", ""),
    b"+": ("faster", "2"),
    b"-": ("faster", "0.5"),
    b"\x1b[C": ("skip", "1"),
    b"\x1b[D": ("skip", "-1"),
    b"q": ("quit", ""),
}
HELP = "space: pause, resume   s: step   + -: speed   left/right: seek 1 s back/forward   q: quit"


@contextmanager
def keyboard(player: Player) -> Iterator[bool]:
    """While this lasts keys are read; gives False where standard input is not a terminal."""
    if not sys.stdin.isatty():
        yield False
        return
    terminal, over = sys.stdin.fileno(), threading.Event()
    before = termios.tcgetattr(terminal)
    reader = threading.Thread(target=_read, args=(terminal, player, over), daemon=True)
    try:
        tty.setcbreak(terminal)
        print(HELP, file=sys.stderr, flush=True)
        reader.start()
        yield True
    finally:
        over.set()
        reader.join(1.0)
        termios.tcsetattr(terminal, termios.TCSADRAIN, before)


def _read(terminal: int, player: Player, over: threading.Event) -> None:
    while not over.is_set():
        if not select.select([terminal], [], [], 0.1)[0]:
            continue
        for key in _keys(os.read(terminal, 64)):
            if key in KEYS:
                _show(player.ask(*KEYS[key]).result(5.0))


def _keys(raw: bytes) -> Iterator[bytes]:
    """Single keys; an arrow is three bytes."""
    while raw:
        length = 3 if raw.startswith(b"\x1b[") else 1
        yield raw[:length]
        raw = raw[length:]


def _show(status: dict[str, Any]) -> None:
    state = "paused" if status["paused"] else f"speed {status['speed']}"
    print(f"\r{status['time']:.3f} s of {status['end']:.3f} s, {state}   ", end="", file=sys.stderr, flush=True)
