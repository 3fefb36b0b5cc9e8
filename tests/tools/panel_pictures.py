"""Make the pictures of docs/panel.md anew: `python -m tests.tools.panel_pictures`. Needs a Chromium (apt-get)."""

import shutil
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.support.processes import started
from tests.tools.pictures import FOLDER

CALM = ("--set", "loop.command_timeout=10 s")  # a browser that draws by software keeps the loop from its processor
SHOTS = {  # name: width, height, colours of the system
    "panel": (1400, 1000, "light"),
    "panel-dark": (1400, 1000, "dark"),
    "panel-phone": (400, 860, "light"),
}
MOMENT = 14.0  # [s] after the page was opened


def main() -> None:
    """All of them, of one run."""
    from playwright.sync_api import sync_playwright

    options = ("--scenario", "square", *CALM, "--port", "0", "--no-open")
    with TemporaryDirectory() as folder, started("panel", *options, cwd=Path(folder)) as panel:
        assert panel.stdout is not None
        address = panel.stdout.readline().split()[-1]
        time.sleep(MOMENT)
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
            for name, (width, height, scheme) in SHOTS.items():
                page = browser.new_page(viewport={"width": width, "height": height}, color_scheme=scheme)  # pyright: ignore[reportArgumentType]
                page.goto(address)
                time.sleep(MOMENT)
                page.screenshot(path=FOLDER / f"{name}.png")
                page.close()
                print(f"{name}.png", flush=True)
            browser.close()


if __name__ == "__main__":
    main()
