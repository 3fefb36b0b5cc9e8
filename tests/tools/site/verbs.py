"""A page for every verb of the command line, made from its help by typer."""

import re
from typing import Any

from typer.cli import get_docs_for_click
from typer.main import get_command

from bridge.cli.catalogue import VERBS
from bridge.cli.verbs import app
from tests.tools.site.markdown import CODE_SPAN, prose

FOLDER = "commands"
GUIDE = re.compile(r"\bdocs/([\w-]+\.md)\b")


def verb_pages() -> dict[str, str]:
    """The list of the verbs, their order, and a page for each: path in the site to text."""
    order = ["- [All commands](index.md)", *(f"- [{name}]({name}.md)" for name in VERBS)]
    pages = {"index": overview(), "SUMMARY": "\n".join(order)} | {name: page(name) for name in VERBS}
    return {f"{FOLDER}/{name}.md": text for name, text in pages.items()}


def overview() -> str:
    """All verbs by the panels of the help."""
    lines = ["# Commands", "", "These pages are made from what `hydrotwin VERB --help` prints.", ""]
    for panel in dict.fromkeys(verb.panel for verb in VERBS.values()):
        lines += [f"## {panel}", "", "| verb | does |", "|---|---|"]
        lines += [f"| [{n}]({n}.md) | {plain(v.words)} |" for n, v in VERBS.items() if v.panel == panel] + [""]
    return "\n".join(lines)


def page(name: str) -> str:
    """What a verb's help says, as Markdown; the commands of a group follow one another."""
    commands: Any = get_command(app)
    found = commands.commands[name]
    context = found.make_context("hydrotwin", [], resilient_parsing=True)
    return prose(get_docs_for_click(obj=found, ctx=context, name=f"hydrotwin {name}"), plain)


def plain(line: str) -> str:
    """A line of help as Markdown: rich's bold as Markdown's, signs that are not HTML, guides as links."""
    kept: list[str] = []
    line = CODE_SPAN.sub(lambda m: kept.append(m[0]) or f"\0{len(kept) - 1}\0", line)
    line = re.sub(r"\[/?bold\]", "**", line).replace("<", "&lt;").replace("|", "\\|")
    line = GUIDE.sub(r"[\1](../\1)", line)
    return re.sub("\0(\\d+)\0", lambda m: kept[int(m[1])], line)
