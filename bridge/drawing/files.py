"""A picture and its table, side by side."""

import csv
from pathlib import Path

from bridge.drawing.canvas import Columns, Sheet
from bridge.errors import writing


def save(name: str, columns: Columns, page: Sheet, directory: Path) -> list[Path]:
    """Write NAME.png and NAME.csv into a directory, made if absent."""
    picture, table = directory / f"{name}.png", directory / f"{name}.csv"
    with writing(picture):
        page.savefig(picture)
    write_columns(table, columns)
    return [picture, table]


def write_columns(path: Path, columns: Columns) -> None:
    """A table as CSV, nine digits."""
    with writing(path), path.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(columns)
        rows.writerows([f"{value:.9g}" for value in row] for row in zip(*columns.values(), strict=True))
