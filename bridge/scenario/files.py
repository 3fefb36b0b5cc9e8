"""Scenario files: found, and read as plain data, with changes from the command line."""

from collections.abc import Collection
from contextlib import suppress
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple

from bridge.errors import ScenarioError, nearest
from bridge.scenario.law_file import with_place
from bridge.scenario.matrices_file import note_change, with_matrices, without_origin
from bridge.scenario.units import quantity
from bridge.scenario.untrusted import LONGEST_TABLE, MOST_FILES, parsed_json, parsed_toml, text_of

UNION_SECTIONS = ("controller", "reference")  # whose `kind` says what else stands in them
GATHERED = ("timeline", "fault", "alarm", "expect")  # lists that a piece of a scenario adds to
NAMES = {list: "list", str: "text", int: "number", float: "number"}  # of what a JSON file may hold instead
DURATION = 10.0  # [s] of a scenario that gives none


class Listed(NamedTuple):
    """What a list of scenarios shows of one."""

    name: str
    title: str
    duration: float
    bands: list[str]


def names() -> list[str]:
    """The built-in scenarios."""
    return sorted(path.name.removesuffix(".toml") for path in _built_in().iterdir() if path.name.endswith(".toml"))


def _built_in():
    return resources.files("bridge.scenario") / "built_in"


def listed(name: str) -> Listed:
    """A built-in scenario for a list: it has been checked, so that its plain data will do."""
    data = plain(name)
    duration = quantity(data.get("duration", DURATION), "s")
    return Listed(
        data["name"],
        data.get("title", ""),
        duration,
        [e if isinstance(e, str) else e["band"] for e in data.get("expect", [])],
    )


def plain(which: str) -> dict[str, Any]:
    """The plain data of a built-in scenario or of a file, by whatever name. Raises ScenarioError."""
    data = _read(which, (), [])
    data["name"] = data.get("name", Path(which).stem)
    return data


def _read(which: str, extended_by: tuple[str, ...], read: list[str]) -> dict[str, Any]:
    """The plain data of a scenario, on top of what it extends: one, or several, each on top of those before.

    extended_by: the way to it; read: all that were read so far.
    """
    data, folder, place = parsed(which)
    read.append(place)
    if len(read) > MOST_FILES:
        raise ScenarioError(f"{which}: more than {MOST_FILES} files extend one another")
    if place in extended_by:
        raise ScenarioError(f"{which}: extends itself{_by_way_of(extended_by[extended_by.index(place) + 1 :])}")
    data = with_place(with_matrices(with_tables(data, folder), folder), folder)
    found: dict[str, Any] = {}
    for base in bases_of(data, folder):
        found = _merged(found, _read(base, (*extended_by, place), read))
        found.pop("name", None)
    data.pop("extends", None)
    return with_own(found, data)


def parsed(which: str) -> tuple[dict[str, Any], Path, str]:
    """What a scenario itself says, the folder that its names of files start from, and the place that it is."""
    text, folder, place = _source(which)
    try:
        data = parsed_json(text) if which.endswith(".json") else parsed_toml(text)
    except ValueError as error:
        raise ScenarioError(f"{which}: cannot be read: {error}") from None
    if not isinstance(data, dict):
        raise ScenarioError(f"{which}: holds a {NAMES.get(type(data), 'value')}; a scenario is a table of sections")
    return data, folder, place


def bases_of(data: dict[str, Any], folder: Path) -> list[str]:
    """The scenarios that one extends: files beside it, else built-in ones."""
    bases = data.get("extends", [])
    besides = [(folder / str(base), str(base)) for base in (bases if isinstance(bases, list) else [bases])]
    return [str(beside) if beside.is_file() else base for beside, base in besides]


def with_own(base: dict[str, Any], own: dict[str, Any]) -> dict[str, Any]:
    """Plain data on top of those that they extend."""
    from bridge.scenario.inherited import without_unfitted

    daq = own.get("daq")
    return without_unfitted(_merged(base, own), base, isinstance(daq, dict) and "channels" in daq)


def _by_way_of(places: tuple[str, ...]) -> str:
    return f", by way of {', '.join(Path(place).name for place in places)}" if places else ""


def _merged(base: dict[str, Any], own: dict[str, Any]) -> dict[str, Any]:
    """Sections are merged, all else is replaced; of another kind's section only what the new kind knows is kept."""
    both = {
        key: _merged(_kept(key, base[key], own[key]), own[key])
        for key in own
        if isinstance(base.get(key), dict) and isinstance(own[key], dict)
    }
    return base | own | both


def with_piece(data: dict[str, Any], piece: dict[str, Any]) -> dict[str, Any]:
    """Plain data with a piece of a scenario laid over them: sections are merged, entries of GATHERED are added."""
    added = {key: [*data.get(key, []), *piece[key]] for key in GATHERED if isinstance(piece.get(key), list)}
    return _merged(data, piece | added)


def _kept(section: str, values: dict[str, Any], own: dict[str, Any]) -> dict[str, Any]:
    """What a section takes over from the one that it extends."""
    kept = _of_kind(section, values, own.get("kind"))
    return without_origin(kept, own) if section == "controller" else kept


def _of_kind(section: str, values: dict[str, Any], kind: Any) -> dict[str, Any]:
    """What a controller or reference of a kind can take over from one of another kind."""
    if section not in UNION_SECTIONS or kind is None or kind == values.get("kind"):
        return values
    from bridge.scenario.kinds import known

    return {key: value for key, value in values.items() if key in known(section, str(kind))}


def _source(which: str) -> tuple[str, Path, str]:
    """The text, the folder that its names of files start from, and the one place that it is, however written."""
    if which in names():
        return (_built_in() / f"{which}.toml").read_text(encoding="utf-8"), Path(), which
    path = Path(which)
    if path.is_file():
        return text_of(path), path.parent, str(path.resolve())
    raise ScenarioError(f"{which}: no such scenario or file{nearest(which, names())}")


def with_tables(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """A reference's CSV file is read here, so that the scenario carries all it needs."""
    reference = data.get("reference")
    if isinstance(reference, dict) and isinstance(name := reference.get("csv"), str) and "\n" not in name:
        path = folder / name
        if not path.is_file():
            raise ScenarioError(f"reference.csv: no file {str(path)!r}")
        return data | {"reference": reference | {"csv": text_of(path, LONGEST_TABLE)}}
    return data


def ordered(changes: Collection[str]) -> list[str]:
    """Changes in the order to apply: a kind first, so that the others are of the new one; a function has its kind."""
    kinds = [f"{section}.kind" for section in UNION_SECTIONS]
    given = {change.partition("=")[0].strip(): change.partition("=")[2] for change in changes}
    implied = ":" in given.get("controller.law", "") and "controller.kind" not in given
    return sorted(
        [*(["controller.kind=python"] if implied else []), *changes],
        key=lambda change: change.partition("=")[0].strip() not in kinds,
    )


def apply(data: dict[str, Any], change: str) -> None:
    """Change a value by a text such as "controller.gain=0.4". Raises ScenarioError."""
    key, value = parsed_change(change)
    *path, last = key.split(".")
    if last == "kind" and len(path) == 1 and isinstance(data.get(path[0]), dict):
        data[path[0]] = _of_kind(path[0], data[path[0]], value)
    for name in path:
        data = data.setdefault(name, {})
        if not isinstance(data, dict):
            raise ScenarioError(f"{change!r}: {name!r} is a value, not a section")
    data[last] = value
    if path == ["controller"]:
        note_change(data, last)


def parsed_change(change: str) -> tuple[str, Any]:
    """The name and the value of a text such as "controller.gain=0.4". Raises ScenarioError."""
    key, sign, text = change.partition("=")
    if not sign or not key.strip():
        raise ScenarioError(f"{change!r} is not a change; write section.name=value, such as controller.gain=0.4")
    return key.strip(), _value(text)


def _value(text: str) -> Any:
    """What stands behind the sign: TOML, JSON, or a text without its quotes."""
    with suppress(ValueError):
        return parsed_toml(f"value = {text}")["value"]
    if text.strip()[:1] in ("[", "{"):
        with suppress(ValueError):
            return parsed_json(text)
    return text.strip()
