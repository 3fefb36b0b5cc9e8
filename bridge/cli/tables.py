"""Plain tables on standard output."""

import sys
from collections.abc import Iterable, Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

from bridge.errors import visible

UNFOLDED = 200  # columns, where nobody's window is to be kept to


def print_table(headers: Sequence[str], rows: Iterable[Sequence[str | Text]]) -> None:
    """A plain table on standard output; a text is shown as it is, brackets and all."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for header in headers:
        table.add_column(Text(header), overflow="fold")
    for row in rows:
        table.add_row(*map(plain_text, row))
    Console(width=None if sys.stdout.isatty() else UNFOLDED).print(table)


def plain_text(text: str | Text, style: str = "") -> Text:
    """Words for rich to show as they are: it would read brackets as markup and pass control characters on."""
    return text if isinstance(text, Text) else Text(visible(text), style)
