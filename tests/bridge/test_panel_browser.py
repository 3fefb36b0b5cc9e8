"""The panel as a person uses it: start, change a gain, see it, break something, reset, stop, in a real browser."""

import re
import shutil
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.support.processes import COARSE, started, wait_for
from tests.tools.panel_pictures import CALM

playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
pytest.importorskip("uvicorn")
CHROMIUM = shutil.which("chromium")
LONG = 60_000  # [ms] that a busy machine gets
GUARDED = """
extends = "square"
[[alarm]]
id = "end"
when = "measurement.position > 150 mm"
then = "latched"
"""
pytestmark = [
    pytest.mark.endurance,
    pytest.mark.timeout(600),
    pytest.mark.skipif(CHROMIUM is None, reason="no browser is installed: apt-get install chromium"),
]


@pytest.fixture
def page() -> Iterator[Any]:
    """A tab that refuses to go anywhere but to this machine, and fails on any error of the page's scripts."""
    wrong: list[str] = []
    with playwright.sync_playwright() as started_playwright:
        browser = started_playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        tab = browser.new_page(viewport={"width": 1300, "height": 900})
        tab.set_default_timeout(LONG)
        tab.on("pageerror", lambda error: wrong.append(str(error)))
        tab.on("console", lambda said: wrong.append(said.text) if said.type == "error" else None)
        tab.on(
            "request", lambda asked: None if re.match(r"(http|ws)://127|data:", asked.url) else wrong.append(asked.url)
        )
        yield tab
        browser.close()
    assert not wrong


def expect(tab: Any, script: str) -> None:
    """Wait until a script's expression is true; the page's own policy forbids it what would look from inside."""
    wait_for(lambda: tab.evaluate(script), LONG / 1e3)


def test_a_first_minute(page: Any, tmp_path: Path):
    (tmp_path / "guarded.toml").write_text(GUARDED, encoding="utf-8")
    options = ("--scenario", "guarded.toml", *COARSE, *CALM, "--port", "0", "--no-open")
    with started("panel", *options, cwd=tmp_path) as panel:
        assert panel.stdout is not None
        page.goto(panel.stdout.readline().split()[-1])
        page.locator("#phase", has_text="latched").wait_for()
        page.locator("#note", has_text="until somebody presses Reset").wait_for()
        page.click("#reset")
        page.locator("#events", has_text="reset").wait_for()
        expect(page, "Number(document.querySelector('#sheet-position_mm').dataset.points) > 50")
        expect(page, "document.querySelectorAll('#drive polyline').length === 60")
        before = page.evaluate("document.querySelector('[id^=\"drive-moving.\"]').getAttribute('transform')")
        expect(page, f"document.querySelector('[id^=\"drive-moving.\"]').getAttribute('transform') !== {before!r}")

        gain = page.locator("[id='number-controller.gain']")
        gain.fill("1.25")
        gain.press("Enter")
        page.locator("#events", has_text="controller.gain").wait_for()
        expect(page, "document.getElementById('number-controller.gain').value === '1.25'")
        mass = page.locator("[id='number-rig.load.mass']")
        mass.fill("-3")
        mass.press("Enter")
        page.locator(".refused", has_text="must be at least").wait_for()

        page.select_option("#fault-target", "sensor.p2")
        page.select_option("#fault-kind", "stuck")
        page.click("#inject")
        page.locator("#active", has_text="sensor.p2 stuck").wait_for()
        page.click("#active button")
        expect(page, "!document.querySelector('#active li')")
        page.click("#pause")
        page.click("#closer")
        expect(page, "document.querySelector('#pause').textContent === 'Go on'")
        page.click("#pause")
        page.click("#stop")
        page.locator("#phase", has_text="stopped").wait_for()
        page.select_option("#scenario", "sine")
        page.click("#start")
        page.locator("#rig", has_text="scenario sine").wait_for()
        page.locator("#phase", has_text="running").wait_for()
        panel.send_signal(signal.SIGINT)
        panel.wait(20.0)


def test_a_follower_shows_what_it_estimates_until_it_leaves(page: Any, tmp_path: Path):
    """A position within the stroke, closer than the transducer reads it; when it has left the page says so."""
    with started("panel", "--scenario", "sine", *COARSE, *CALM, "--port", "0", "--no-open", cwd=tmp_path) as panel:
        assert panel.stdout is not None
        page.goto(panel.stdout.readline().split()[-1])
        page.locator("#phase", has_text="running").wait_for()
        page.click("#follow")
        page.locator("#health", has_text="estimate: following").wait_for(timeout=2 * LONG)
        page.locator("#timing", has_text="follower").wait_for()
        row = page.locator("#health tr", has_text="position").inner_text()
        print(row)
        estimate, deviation, unit = re.search(r"([\d.]+) ± ([\d.]+) (\w+)", row).groups()  # pyright: ignore
        assert unit == "mm"
        assert 0.0 < float(estimate) < 270.0
        assert 0.0 < float(deviation) < 2.0  # the transducer's resolution is 0.1 mm
        page.click("#follow")
        page.locator("#follower-gone", has_text="It is silent").wait_for()


def test_a_phone_needs_no_sideways_scrolling(page: Any, tmp_path: Path):
    page.set_viewport_size({"width": 390, "height": 800})
    with started("panel", *COARSE, *CALM, "--port", "0", "--no-open", cwd=tmp_path) as panel:
        assert panel.stdout is not None
        page.goto(panel.stdout.readline().split()[-1])
        page.locator("#phase", has_text="running").wait_for()
        expect(page, "document.querySelectorAll('#first .number').length > 5")
        assert page.evaluate("document.documentElement.scrollWidth") <= 390
