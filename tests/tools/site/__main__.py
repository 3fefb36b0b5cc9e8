"""Gather the pages of the site: `python -m tests.tools.site build/pages`."""

import shutil
import sys
from pathlib import Path

from tests.tools.site.api import api_pages
from tests.tools.site.sources import ROOT, Gatherer
from tests.tools.site.verbs import verb_pages

ASSETS = ("site.css", "vendor/iframe-worker.js")  # in docs/


def main(folder: Path) -> None:
    """All pages and what they need, into a folder that holds nothing else."""
    shutil.rmtree(folder, ignore_errors=True)
    Gatherer().write(folder)
    for place, text in (verb_pages() | api_pages()).items():
        (folder / place).parent.mkdir(parents=True, exist_ok=True)
        (folder / place).write_text(text, encoding="utf-8")
    for asset in ASSETS:
        (folder / asset).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / "docs" / asset, folder / asset)


main(Path(sys.argv[1]))
