"""Plain tables on standard output."""

import sys
from collections.abc import Iterable, Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

from bridge.errors import visible

UNFOLDED = 200  # columns, where nobody's window is to be kept to


def print_table(headers: Sequence[str], rows: Iterable[Sequence[str | Text]]) -> None:
    """A plain table on standard output; a text is shown as it is, brackets and all.

    In a narrow window cells are broken between words, never within one: a name can be copied. Where that is not enough
    lines are longer than the window.
    """
    table = Table(box=None, header_style="bold", pad_edge=False)
    cells = [[*map(plain_text, row)] for row in rows]
    for place, header in enumerate(headers):
        least = max((len(word) for cell in _column(cells, place, header) for word in cell.split()), default=0)
        of_words = max(map(len, _column(cells, place, header))) == least
        table.add_column(Text(header), overflow="fold", no_wrap=of_words, min_width=least)
    for row in cells:
        table.add_row(*row)
    Console(width=None if sys.stdout.isatty() else UNFOLDED).print(table, crop=False)


def _column(cells: Sequence[Sequence[Text]], place: int, header: str) -> list[str]:
    return [header, *(row[place].plain for row in cells if place < len(row))]


def plain_text(text: str | Text, style: str = "") -> Text:
    """Words for rich to show as they are: it would read brackets as markup and pass control characters on."""
    return text if isinstance(text, Text) else Text(visible(text), style)
