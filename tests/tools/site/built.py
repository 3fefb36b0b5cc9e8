"""The built pages ask nothing of the network, and every link between them leads somewhere; else exit code 1.

The theme loads one script from elsewhere, with which search works in pages opened without a server: it gets ours.
`python -m tests.tools.site.built build/site`.
"""

import os
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADED = {"link": "href", "script": "src", "img": "src", "iframe": "src", "source": "src", "object": "data"}
SHIM = "https://unpkg.com/iframe-worker/shim"
OWN_SHIM = "vendor/iframe-worker.js"
NAMED = ("canonical", "next", "prev", "alternate")  # relations of a link that load nothing


class Page(HTMLParser):
    """Addresses that a page loads, those it leads to, and its anchors."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.loads: list[str] = []
        self.leads: list[str] = []
        self.anchors = {""}
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Called for every tag."""
        found = dict(attrs)
        self.anchors |= {name for key in ("id", "name") if (name := found.get(key))}
        if tag in LOADED and found.get("rel") not in NAMED and (address := found.get(LOADED[tag])):
            self.loads.append(address)
        if tag == "a" and (address := found.get("href")):
            self.leads.append(address)


def take_own_shim(folder: Path) -> None:
    """The script that the theme loads from elsewhere, from the site itself."""
    for path in folder.rglob("*.html"):
        text = path.read_text(encoding="utf-8")
        if SHIM in text:
            path.write_text(text.replace(SHIM, os.path.relpath(folder / OWN_SHIM, path.parent)), encoding="utf-8")


def wrong(folder: Path) -> list[str]:
    """What is wrong with the pages of a folder."""
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in sorted(folder.rglob("*.html"))}
    found: list[str] = []
    for path, page in pages.items():
        name = path.relative_to(folder)
        found += [f"{name}: loads {a} from the network" for a in page.loads if urlsplit(a).netloc]
        found += [f"{name}: {a} leads nowhere" for a in (*page.leads, *page.loads) if _is_lost(folder, path, a, pages)]
    return found


def _is_lost(folder: Path, path: Path, address: str, pages: dict[Path, Page]) -> bool:
    parts = urlsplit(address)
    if parts.scheme or parts.netloc:
        return False
    base = folder if parts.path.startswith("/") else path.parent
    file = Path(os.path.normpath(base / unquote(parts.path).lstrip("/"))) if parts.path else path
    if file.is_dir():
        file = file / "index.html"
    if file not in pages:
        return not file.exists()
    return unquote(parts.fragment) not in pages[file].anchors and not parts.fragment.startswith("__")


if __name__ == "__main__":
    take_own_shim(Path(sys.argv[1]))
    lost = wrong(Path(sys.argv[1]))
    print("\n".join(lost) or "every link of the site leads somewhere, and no page asks the network for anything")
    sys.exit(bool(lost))
