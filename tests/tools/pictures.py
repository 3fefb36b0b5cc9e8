"""Make the pictures of report and view in docs/pictures anew: `make pictures`.

Needs a headless Chromium and software graphics: apt-get install chromium chromium-driver mesa-vulkan-drivers.
"""

import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from bridge.report.page import write_report
from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.view.show import show
from bridge.wire.link import free_endpoint
from tests.tools.browser import browser

FOLDER = Path(__file__).parents[2] / "docs" / "pictures"
MOMENTS = {"step": 1.15, "load-change": 1.15, "slow-sampling": 1.35}  # [s], where there is something to see
FINE = 'loop.viewer_period="5 ms"'  # maps that show the waves
LIVE_MOMENT = 4.0  # [s]
REPORT, VIEW = (1100, 1560), (1800, 1080)
DRAWN = 25.0  # [s] until the viewer in a browser has drawn, by software
DRAWN_LIVE = 35.0  # [s], while a loop goes first
SLOWER = "0.4"  # speed of that loop: it and a browser that draws by software are much for two cores
TIMES = (293, 1592)  # [px], where the bar of times begins and ends in a browser


def main() -> None:
    """All pictures, one scenario after the other."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as folder:
        for name, moment in MOMENTS.items():
            scenario = load(name, [FINE])
            file = Path(folder) / f"{name}.mcap"
            record_in_process(scenario, file)
            for path in (
                _report([file], name),
                _native(file, name, moment),
                _web(file, name, moment / scenario.duration),
                *_live(name),
            ):
                _smaller(path)
                print(path.name, flush=True)
        both = [Path(folder) / f"{name}.mcap" for name in ("step", "slow-sampling")]
        print(_smaller(_report(both, "two-runs")).name)


def _report(files: list[Path], name: str) -> Path:
    page = write_report(files, files[0].with_suffix(".html"))
    with browser(*REPORT) as window:
        return window.picture(page.as_uri(), FOLDER / f"report-{name}.png", 1.0)


def _native(file: Path, name: str, moment: float) -> Path:
    path = FOLDER / f"view-{name}.png"
    show(file, picture=path, at=moment)
    return path


def _web(file: Path, name: str, share: float) -> Path:
    """The view in a browser, its cursor moved to a share of the run by a click on the bar of times."""
    press = round(TIMES[0] + share * (TIMES[1] - TIMES[0])), VIEW[1] - 14
    with _page("view", str(file), "--web") as address, browser(*VIEW) as window:
        return window.picture(address, FOLDER / f"view-{name}-web.png", DRAWN, press)


def _live(name: str) -> Iterator[Path]:
    """The same of a plant that runs, in real time, in a window and in a browser."""
    path = FOLDER / f"view-{name}-live.png"
    with _running(name) as endpoint:
        command = ["view", "--connect", endpoint, "--screenshot", str(path), "--at", f"{LIVE_MOMENT} s"]
        subprocess.run(_hydrotwin(*command, "--patience", "60"), check=True)
    yield path
    with (
        _running(name, f"duration={DRAWN_LIVE}", speed=SLOWER) as endpoint,
        _page("view", "--connect", endpoint, "--web", "--patience", "60") as address,
        browser(*VIEW) as window,
    ):
        yield window.picture(address, FOLDER / f"view-{name}-live-web.png", DRAWN_LIVE)


@contextmanager
def _running(name: str, *changes: str, speed: str = "1") -> Iterator[str]:
    """The scenario in real time; gives where its plant listens."""
    endpoint = free_endpoint()
    options = [option for change in changes for option in ("--set", change)]
    with TemporaryDirectory() as folder:
        words = ("--speed", speed, "--listen", endpoint, "--record", f"{folder}/live.mcap")
        command = ["run", name, *words, *options]
        with subprocess.Popen(_hydrotwin(*command), stdout=subprocess.DEVNULL) as process:
            try:
                _await(endpoint)
                yield endpoint
            finally:
                process.terminate()
                process.wait()


def _await(endpoint: str) -> None:
    """Wait until somebody listens."""
    host, port = endpoint.removeprefix("tcp/").split(":")
    until = time.monotonic() + 60.0
    while time.monotonic() < until:
        with socket.socket() as probe:
            if probe.connect_ex((host, int(port))) == 0:
                return
        time.sleep(0.05)


@contextmanager
def _page(*arguments: str) -> Iterator[str]:
    """A page that hydrotwin serves; gives its address."""
    with subprocess.Popen(_hydrotwin(*arguments), stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout
            yield process.stdout.readline().strip()
        finally:
            process.terminate()
            process.wait()


def _hydrotwin(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "bridge", *arguments]


def _smaller(path: Path) -> Path:
    """The picture without what a viewer adds to it: no transparency, best compression; its colours stay."""
    from PIL import Image

    with Image.open(path) as picture:
        flat = picture.convert("RGB")
    flat.save(path, optimize=True)
    return path


if __name__ == "__main__":
    main()
