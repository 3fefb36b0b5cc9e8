"""Equations in LaTeX become MathML, which browsers draw without a script, in a font that comes with the pages.

Written as GitHub takes them: a block ```` ```math ````, and $`...`$ within a line. Runs in the environment of the site:
`python equations.py build/pages`. The font is STIX Two Math, of the package ziamath (SIL Open Font License).
"""

import re
import shutil
import sys
from importlib.resources import files
from pathlib import Path

from latex2mathml.converter import convert  # pyright: ignore[reportMissingImports]

FONT = "STIXTwoMath-Regular.ttf"
BLOCK = re.compile(r"^```math\n(.*?)^```$", re.MULTILINE | re.DOTALL)
INLINE = re.compile(r"\$`([^`]+)`\$")
MARKED = {ord(sign): f"&#{ord(sign)};" for sign in "*_`[]\\|"}  # what Markdown would take for its own


def drawn(text: str) -> str:
    """The text with its equations as MathML."""
    text = BLOCK.sub(lambda m: f'<div class="equation">{convert(m[1].strip(), display="block")}</div>', text)
    return INLINE.sub(lambda m: f"<span>{convert(m[1]).translate(MARKED)}</span>", text)


def main(folder: Path) -> None:
    """All pages of a folder, and the font beside them."""
    (folder / "fonts").mkdir(exist_ok=True)
    shutil.copy(str(files("ziamath") / "fonts" / FONT), folder / "fonts" / FONT)
    for path in folder.rglob("*.md"):
        text = path.read_text(encoding="utf-8")
        if (found := drawn(text)) != text:
            path.write_text(found, encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
