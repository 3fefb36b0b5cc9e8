"""Verbs that look: describe, convergence, digest, messages, figure, figures, doctor."""

from pathlib import Path
from typing import Annotated

import typer

from bridge.cli.options import AS_JSON, MARK
from bridge.cli.outputs import print_json


def figure(
    name: Annotated[str, typer.Argument(help="Name of a figure, such as 2.4.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for NAME.png and NAME.csv.")] = Path(),
    mark: MARK = None,
    as_json: AS_JSON = False,
) -> None:
    """Draw a figure of the thesis from the twin: NAME.png and NAME.csv."""
    paths = _drawn(name, output, as_json, mark)
    if as_json:
        print_json(paths)


def _drawn(name: str, output: Path, quiet: bool, mark: str | None = None) -> list[str]:
    """Draw a figure, and say what was written unless it is to be quiet."""
    from bridge.figures.catalogue import draw_figure

    paths = [str(path) for path in draw_figure(name, output, mark)]
    if not quiet:
        print("\n".join(paths), flush=True)
    return paths


def figures(
    every: Annotated[bool, typer.Option("--all", help="Draw all of them instead.")] = False,
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for them, with --all.")] = Path("figures"),
    as_json: AS_JSON = False,
) -> None:
    """List the figures, or draw them all."""
    from bridge.cli.tables import print_table
    from bridge.figures.catalogue import FIGURES

    if every:
        paths = [path for name in FIGURES for path in _drawn(name, output, as_json)]
        if as_json:
            print_json(paths)
        return
    rows = [(entry.name, entry.title) for entry in FIGURES.values()]
    if as_json:
        print_json([{"name": name, "title": title} for name, title in rows])
    else:
        print_table(("name", "title"), rows)
