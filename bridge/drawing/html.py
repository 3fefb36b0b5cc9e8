"""Pieces of HTML: text made safe, tables, figures as inline SVG. Nothing refers to another file or address."""

import re
from collections.abc import Iterable, Sequence
from html import escape
from io import StringIO
from typing import Any

FONT = "DejaVu Sans"  # which the figures are measured with
FAMILY = f"'{FONT}', Verdana, Arial, sans-serif"


def text(value: object) -> str:
    """Text as HTML."""
    return escape(str(value))


def table(head: Sequence[str], rows: Iterable[Sequence[str]], kind: str = "") -> str:
    """A table of cells that are HTML already."""
    top = "".join(f"<th>{cell}</th>" for cell in head)
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    return f'<table class="{kind}"><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>'


def svg(figure: Any, name: str, words: str) -> str:
    """A matplotlib figure as inline SVG, for people who cannot see it with words; letters stay letters."""
    import matplotlib as mpl

    out = StringIO()
    style: dict[Any, Any] = {"svg.fonttype": "none", "svg.hashsalt": name, "font.family": FONT}
    with mpl.rc_context(style):
        figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None, "Title": words})
    return _bare(out.getvalue(), name)


def _bare(document: str, name: str) -> str:
    """The svg element alone, its ids its own, without metadata that name addresses."""
    drawing = document[document.index("<svg") :]
    drawing = re.sub(r"<metadata>.*?</metadata>", "", drawing, flags=re.DOTALL)
    drawing = re.sub(r' xmlns(:xlink)?="[^"]*"', "", drawing)
    drawing = drawing.replace("xlink:href", "href")
    drawing = re.sub(r'id="([^"]+)"', rf'id="{name}-\1"', drawing)
    drawing = re.sub(r'(href="#|url\(#)', rf"\1{name}-", drawing)
    drawing = re.sub(r'width="[\d.]+pt" height="[\d.]+pt"', 'width="100%" role="img"', drawing, count=1)
    return re.sub(r"'DejaVu Sans'[^;\"]*", FAMILY, drawing)
