"""What ends a run badly, what keeps it from starting, and the words for it."""

import difflib
import errno
import unicodedata
from collections.abc import Collection, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

LIKENESS = 0.55  # of 1: below this a suggestion would mislead
SLIP = 0.8  # of 1: from this on it is likely the same word
LONGEST_WORD = 100  # characters that are compared
FOLDER_GONE = "the working folder no longer exists; change to another one"


class RunError(Exception):
    """The run cannot go on; the text names who or what, and when."""


class UsageError(Exception):
    """Something was asked for that cannot be done; the text has one line per mistake, each with the way out."""


class ScenarioError(UsageError):
    """A scenario that cannot be used."""


class MisplacedError(ValueError):
    """A key that does not belong where it stands; the text says what to write instead."""

    def __init__(self, key: str, text: str) -> None:
        super().__init__(text)
        self.key = key


def has_near(word: str, valid: Collection[str]) -> bool:
    """Is there a word that is so like it that only a slip of the pen can be between them?"""
    return bool(difflib.get_close_matches(word, valid, n=1, cutoff=SLIP))


def nearest(word: str, valid: Collection[str], further: str = "") -> str:
    """The end of a sentence on an unknown word: what may have been meant, and what there is."""
    near = difflib.get_close_matches(word[:LONGEST_WORD], valid, n=1, cutoff=LIKENESS)
    known = ", ".join([*(name or "none" for name in valid), *([further] if further else [])])
    return (f"; did you mean {near[0]!r}?" if near else "") + f" (valid: {known})"


def reason(error: OSError) -> str:
    """What the system refuses, in one line: the file if it is known, and why."""
    place = error.filename or "cannot write to standard output or to a temporary file"
    return FOLDER_GONE if _folder_is_gone(error) else f"{place}: {error.strerror or error}"


def _folder_is_gone(error: OSError) -> bool:
    """Is the cause that the working folder was removed?"""
    if error.errno != errno.ENOENT:
        return False
    try:
        return not Path.cwd()
    except OSError:
        return True


@contextmanager
def writing(path: Path) -> Iterator[Path]:
    """Make the folder of a file to be written; what the system then refuses is a RunError that names the file."""
    try:
        with suppress(FileExistsError):  # a file of that name: to open what lies in it says so better
            path.parent.mkdir(parents=True, exist_ok=True)
        yield path
    except OSError as error:
        why = FOLDER_GONE if _folder_is_gone(error) else error.strerror or error
        raise RunError(f"{path}: cannot be written: {why}") from None


def is_hidden(character: str) -> bool:
    """Does a character steer a terminal, break a line, or have no place in XML?"""
    return unicodedata.category(character) in ("Cc", "Cs", "Zl", "Zp") or character in "\ufffe\uffff"


def visible(text: str) -> str:
    """A text with hidden characters spelled out."""
    return "".join(c.encode("unicode_escape").decode() if is_hidden(c) else c for c in text)
