"""A user's law and hooks, whose failures and wrong answers are one sentence each."""

import traceback
from pathlib import Path
from typing import Any

from bridge.errors import RunError
from bridge.loop.logged import in_words, number_of
from controller.grid import NS
from controller.law import Answer, Law, Sample
from controller.laws import Hook, forget
from controller.reference import Target

FAILURES = (Exception, SystemExit)  # scripts end the interpreter, which a law must not
EXPECTED = "a law returns (spool, memory), or (spool, memory, signals)"


def checked(law: Any, name: str, file: Path) -> Law:
    """A user's law; `file`: that of its code. Raises RunError."""

    def answer(sample: Sample, target: Target, memory: Any, gains: Any) -> Answer:
        try:
            answered = law(sample, target, memory, gains)
        except FAILURES as error:
            raise RunError(f"controller.law {name!r}: {explained(error, file)}") from None
        if not isinstance(answered, tuple | list) or len(answered) not in (2, 3):
            raise RunError(f"controller.law {name!r} returned {_at(answered, sample)}: {EXPECTED}")
        if (spool := number_of(answered[0])) is None:
            words = f"returned as spool {_at(answered[0], sample)}: give a number from -1 to 1"
            raise RunError(f"controller.law {name!r} {words}")
        return (spool, *answered[1:])

    return answer


def told(hook: Any, name: str, file: Path) -> Hook:
    """A user's hook, where there is one. Raises RunError."""
    if not callable(hook):
        return forget

    def tell(memory: Any) -> Any:
        try:
            return hook(memory)
        except FAILURES as error:
            raise RunError(f"controller.law {name}: {explained(error, file)}") from None

    return tell


def explained(error: BaseException, file: Path | None) -> str:
    """What went wrong in a user's code, in one line with its place there."""
    words = " ".join(str(error).split())
    if isinstance(error, SyntaxError) and error.filename:
        return f"{short(error.filename)}, line {error.lineno}: {error.msg}"
    frames = traceback.extract_tb(error.__traceback__)
    theirs = [frame for frame in frames if file and _belongs(Path(frame.filename), file)]
    place = f"{short(str(file))}: " if file else ""
    if theirs:
        place = f"{short(theirs[-1].filename)}, line {theirs[-1].lineno}: "
    return f"{place}{type(error).__name__}: {words}"


def short(filename: str) -> str:
    """A file as people call it: from the working folder on where it is below that."""
    path = Path(filename)
    return str(path.relative_to(Path.cwd()) if Path.cwd() in path.parents else path)


def _belongs(code: Path, file: Path) -> bool:
    """Is code of the law's own folder?"""
    folder = file.resolve().parent
    return folder in code.parents and "site-packages" not in code.relative_to(folder).parts


def _at(value: Any, sample: Sample) -> str:
    return f"{in_words(value)} at t = {sample.stamp_ns / NS:g} s"
