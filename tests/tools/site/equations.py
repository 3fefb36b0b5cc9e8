"""Equations in LaTeX become MathML, which browsers draw without a script or a font from elsewhere.

Written as GitHub takes them: a block ```` ```math ````, and $`...`$ within a line. Runs in the environment of the site:
`python equations.py build/pages`.
"""

import re
import sys
from pathlib import Path

from latex2mathml.converter import convert  # pyright: ignore[reportMissingImports]

BLOCK = re.compile(r"^```math\n(.*?)^```$", re.MULTILINE | re.DOTALL)
INLINE = re.compile(r"\$`([^`]+)`\$")
MARKED = {ord(sign): f"&#{ord(sign)};" for sign in "*_`[]\\|"}  # what Markdown would take for its own


def drawn(text: str) -> str:
    """The text with its equations as MathML."""
    text = BLOCK.sub(lambda m: f'<div class="equation">{convert(m[1].strip(), display="block")}</div>', text)
    return INLINE.sub(lambda m: convert(m[1]).translate(MARKED), text)


def main(folder: Path) -> None:
    """All pages of a folder."""
    for path in folder.rglob("*.md"):
        text = path.read_text(encoding="utf-8")
        if (found := drawn(text)) != text:
            path.write_text(found, encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
