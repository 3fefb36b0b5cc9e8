"""What ends a run badly, what keeps it from starting, and the words for a name that is not known."""

import difflib
from collections.abc import Collection

LIKENESS = 0.55  # of 1: below this a suggestion would mislead


class RunError(Exception):
    """The run cannot go on; the text names who or what, and when."""


class UsageError(Exception):
    """Something was asked for that cannot be done; the text has one line per mistake, each with the way out."""


class ScenarioError(UsageError):
    """A scenario that cannot be used."""


def nearest(word: str, valid: Collection[str], further: str = "") -> str:
    """The end of a sentence on an unknown word: what may have been meant, and what there is."""
    near = difflib.get_close_matches(word, valid, n=1, cutoff=LIKENESS)
    known = ", ".join([*(name or "none" for name in valid), *([further] if further else [])])
    return (f"; did you mean {near[0]!r}?" if near else "") + f" (valid: {known})"
