"""A picture and its table, side by side."""

from pathlib import Path

from bridge.drawing.canvas import Columns, Sheet
from bridge.figures import write_columns


def save(name: str, columns: Columns, page: Sheet, directory: Path) -> list[Path]:
    """Write NAME.png and NAME.csv into a directory, made if absent."""
    directory.mkdir(parents=True, exist_ok=True)
    picture, table = directory / f"{name}.png", directory / f"{name}.csv"
    page.savefig(picture)
    write_columns(table, columns)
    return [picture, table]
