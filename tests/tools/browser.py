"""Pictures of pages in headless Chromium, by chromedriver's own protocol.

It draws by software and yields the processor to everybody: in a picture of a live view the plant keeps its time.
"""

import base64
import json
import shutil
import socket
import subprocess
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

FRAME = 143  # [px] that a window is higher than its page
HOLD = 2000  # [ms] of a click
FLAGS = (
    *("--headless=new", "--no-sandbox", "--hide-scrollbars", "--use-gl=angle", "--use-angle=swiftshader"),
    *("--enable-unsafe-swiftshader", "--disable-background-networking"),
)
MISSING = "headless Chromium is not installed; on Debian and Ubuntu: apt-get install chromium chromium-driver"


class Browser:
    """One headless window."""

    def __init__(self, port: int, size: tuple[int, int]) -> None:
        self._driver = f"http://127.0.0.1:{port}"
        options = {"args": [*FLAGS, f"--window-size={size[0]},{size[1] + FRAME}"]}
        wanted = {"capabilities": {"alwaysMatch": {"browserName": "chrome", "goog:chromeOptions": options}}}
        self._session = self._call("POST", "/session", wanted)["sessionId"]

    def picture(self, address: str, path: Path, wait: float, press: tuple[int, int] | None = None) -> Path:
        """Open a page, give it time [s], perhaps press a point of it, and keep a picture of the window."""
        self._call("POST", f"/session/{self._session}/url", {"url": address})
        time.sleep(wait)
        if press:
            self._press(*press)
            time.sleep(0.3 * wait)
        path.write_bytes(base64.b64decode(self._call("GET", f"/session/{self._session}/screenshot")))
        return path

    def _press(self, x: int, y: int) -> None:
        """A click of the left button, slow enough for pages that draw by software."""
        move, pause = {"type": "pointerMove", "duration": 0, "x": x, "y": y}, {"type": "pause", "duration": HOLD}
        down, up = {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}
        pointer = {"type": "pointer", "id": "mouse", "actions": [move, pause, down, pause, up]}
        self._call("POST", f"/session/{self._session}/actions", {"actions": [pointer]})

    def close(self) -> None:
        """Close the window."""
        self._call("DELETE", f"/session/{self._session}")

    def _call(self, method: str, path: str, body: Any = None) -> Any:
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self._driver + path, data, {"Content-Type": "application/json"}, method=method)
        with urllib.request.urlopen(request, timeout=120) as answer:
            return json.load(answer)["value"]


@contextmanager
def browser(width: int, height: int) -> Iterator[Browser]:
    """A headless window of that size, gone afterwards."""
    program = shutil.which("chromedriver")
    if program is None:
        raise SystemExit(MISSING)
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    driver = subprocess.Popen(["nice", "-n", "19", program, f"--port={port}"], stdout=subprocess.DEVNULL)
    try:
        _await(port)
        window = Browser(port, (width, height))
        try:
            yield window
        finally:
            window.close()
    finally:
        driver.terminate()
        driver.wait()


def _await(port: int) -> None:
    until = time.monotonic() + 20.0
    while time.monotonic() < until:
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.05)
    raise SystemExit("chromedriver did not start")
