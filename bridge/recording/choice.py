"""Which topics: patterns such as "pressure/*", what they choose and what they leave out."""

import difflib
from collections.abc import Collection, Sequence
from fnmatch import fnmatchcase

from bridge.errors import UsageError


def choose(
    valid: Collection[str], wanted: Sequence[str] | None, without: Sequence[str] | None = None
) -> frozenset[str]:
    """Of the valid topics those wanted (all, if nothing is) and not left out. Commas part patterns, too.

    Raises UsageError for a pattern that fits none, and when nothing is left.
    """
    chosen = _matching(valid, wanted) if wanted else frozenset(valid)
    left = chosen - (_matching(valid, without) if without else frozenset())
    if not left:
        raise UsageError(f"no topic is left of {', '.join(sorted(chosen))}")
    return left


def _matching(valid: Collection[str], patterns: Sequence[str]) -> frozenset[str]:
    found: set[str] = set()
    for pattern in (part.strip() for text in patterns for part in text.split(",")):
        matches = {topic for topic in valid if fnmatchcase(topic, pattern)}
        if not matches:
            near = difflib.get_close_matches(pattern, valid, n=1, cutoff=0.0)
            hint = f"; nearest: {near[0]!r} (valid: {', '.join(valid)})" if near else ""
            raise UsageError(f"no topic fits {pattern!r}{hint}")
        found |= matches
    return frozenset(found)
