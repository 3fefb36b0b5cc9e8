"""Which topics: patterns such as "pressure/*", what they choose and what they leave out."""

from collections.abc import Collection, Sequence
from fnmatch import fnmatchcase

from bridge.errors import UsageError, nearest


def choose(
    valid: Collection[str], wanted: Sequence[str] | None, without: Sequence[str] | None = None
) -> frozenset[str]:
    """Of the valid topics those wanted (all, if nothing is) and not left out. Commas separate patterns, too.

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
            raise UsageError(f"no topic fits {pattern!r}{nearest(pattern, valid)}")
        found |= matches
    return frozenset(found)
