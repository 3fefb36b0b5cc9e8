"""Which file of the repository becomes which page of the site, and where the links between them lead then."""

import os
from pathlib import Path, PurePosixPath

from tests.tools.site.markdown import rewritten

ROOT = Path(__file__).parents[3]
BROUGHT_IN = {
    "README.md": "index.md",
    "CHANGELOG.md": "project/changelog.md",
    "CONTRIBUTING.md": "project/contributing.md",
    "twin/README.md": "theory/plant.md",
    "recordings/README.md": "project/golden-recordings.md",
    "docker/README.md": "docker.md",
    "examples/network/README.md": "network-example.md",
}
SHOWN = "files"  # folder of the site for files of the repository that a page links to
LANGUAGES = {".py": "python", ".toml": "toml", ".json5": "js", ".h": "c", ".yaml": "yaml"}


def pages() -> dict[str, str]:
    """Every Markdown file that is a page: path in the repository to path in the site."""
    ours = {str(p.relative_to(ROOT)): str(p.relative_to(ROOT / "docs")) for p in sorted((ROOT / "docs").rglob("*.md"))}
    return BROUGHT_IN | ours


def target_of(source: str, address: str) -> tuple[str, str]:
    """File of the repository and anchor that a link in a file leads to. Raises ValueError where there is none."""
    path, _, anchor = address.partition("#")
    file = os.path.normpath(PurePosixPath(source).parent / path) if path else source
    if file.startswith("..") or not (ROOT / file).exists():
        raise ValueError(f"{source}: the link {address} leads nowhere")
    return file, anchor


def is_outside(address: str) -> bool:
    """Does a link leave the repository?"""
    return address.startswith(("https://", "http://", "mailto:"))


def place_of(file: str) -> str:
    """Path in the site of a file of the repository."""
    if (page := pages().get(file)) is not None:
        return page
    return file.removeprefix("docs/") if _is_picture(file) else f"{SHOWN}/{file}.md"


def _is_picture(file: str) -> bool:
    return Path(file).suffix in (".png", ".svg")


class Gatherer:
    """Pages as the site shows them; what they link to comes along."""

    def __init__(self) -> None:
        self.needed: set[str] = set()  # files of the repository that are not pages

    def page(self, source: str) -> str:
        """A page with its links leading to pages of the site."""
        return rewritten((ROOT / source).read_text(encoding="utf-8"), lambda address: self._link(source, address))

    def _link(self, source: str, address: str) -> str:
        if is_outside(address):
            return address
        file, anchor = target_of(source, address)
        if file not in pages():
            self.needed.add(file)
        here = PurePosixPath(place_of(source)).parent
        way = os.path.relpath(place_of(file), here)
        return f"{way}#{anchor}" if anchor else way

    def write(self, folder: Path) -> None:
        """All pages, and what they need, into a folder."""
        for source, place in pages().items():
            _put(folder / place, self.page(source).encode())
        for file in sorted(self.needed):
            content = (ROOT / file).read_bytes() if _is_picture(file) else shown(file).encode()
            _put(folder / place_of(file), content)


def shown(file: str) -> str:
    """A page with the text of a file, or of all files of a folder."""
    path = ROOT / file
    files = sorted(p for p in path.iterdir() if p.is_file() and p.suffix in LANGUAGES) if path.is_dir() else [path]
    texts = [f"## {p.name}\n\n{_fenced(p)}" if path.is_dir() else _fenced(p) for p in files]
    return f"# {file}\n\n" + "\n".join(texts)


def _fenced(path: Path) -> str:
    return f"````{LANGUAGES.get(path.suffix, 'text')}\n{path.read_text(encoding='utf-8').rstrip()}\n````\n"


def _put(path: Path, content: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)
