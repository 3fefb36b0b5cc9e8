"""docs/thesis.md: what it names is there, and its counts are those of its rows."""

import re
from collections import Counter
from pathlib import Path

import pytest

from bridge.cli.catalogue import VERBS
from bridge.figures.catalogue import FIGURES
from bridge.scenario.files import names

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/thesis.md").read_text(encoding="utf-8")
STATUSES = ("implemented", "partial", "impossible")
ROWS = [[cell.strip() for cell in line.strip("|").split("|")] for line in PAGE.splitlines() if line.count("|") == 6]
ENTRIES = [row for row in ROWS if row[3] in STATUSES]
NAMED = sorted({name for row in ENTRIES for name in re.findall(r"`([^`]+)`", row[2])})


def test_every_row_has_a_status_that_is_counted_at_the_top():
    others = {row[3] for row in ROWS} - set(STATUSES)
    assert others == {"status", "---"}
    counted = dict(re.findall(r"^\| (implemented|partial|impossible) \| (\d+) \|$", PAGE, re.MULTILINE))
    assert {status: int(number) for status, number in counted.items()} == Counter(row[3] for row in ENTRIES)


def test_what_is_not_implemented_says_why_and_what_is_names_where():
    assert [row[0] for row in ENTRIES if row[3] != "implemented" and not row[4]] == []
    assert [row[0] for row in ENTRIES if row[3] != "impossible" and not row[2]] == []


@pytest.mark.parametrize("name", NAMED)
def test_what_is_named_is_there(name: str):
    if not name.startswith("hydrotwin "):
        assert (ROOT / name).is_file()
        return
    verb, *rest = name.split()[1:]
    assert verb in VERBS
    if verb == "figure":
        assert rest[0] in FIGURES
    elif verb in ("run", "describe", "advise"):
        assert rest[0] in names()
    elif verb == "valve":
        assert rest[0] in _verbs_of_valve()


def _verbs_of_valve() -> set[str]:
    from bridge.cli.valve import app as valve

    return {str(command.name or getattr(command.callback, "__name__", "")) for command in valve.registered_commands}
