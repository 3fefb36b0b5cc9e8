"""A campaign file: TOML that names scenarios, faults, parameters, draws and seeds. Every mistake gets one line."""

from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from bridge.errors import UsageError, nearest
from bridge.runs.campaign.draws import Distribution, Draw, draw_of
from bridge.runs.campaign.margins import MARGINS
from bridge.scenario.units import quantity
from bridge.scenario.untrusted import parsed_toml, text_of
from bridge.wire.messages import Mode

KEYS = {
    "title": str,
    "scenarios": list,
    "common": dict,
    "baseline": bool,
    "faults": dict,
    "parameters": dict,
    "draw": dict,
    "seeds": object,
    "metrics": list,
    "margin": dict,
    "shrink": list,
    "accept": object,
    "pictures": int,
    "mode": str,
}
DRAW_KEYS = ("runs", "seed", *map(str, Distribution))
NAMES = {list: "a list", str: "a text", dict: "a table", int: "a whole number", bool: "true or false"}
BASELINE = "none"  # the name of the column without a fault
OWN = ("title", "scenarios")  # keys of a fault that are not of a scenario
MOST_PICTURES, MOST_SEED = 100, 2**63
MODES = (Mode.INPROCESS, Mode.LOCKSTEP)


class Fault(NamedTuple):
    """A column of the matrix: what is laid over a scenario."""

    name: str
    title: str
    piece: dict[str, Any]  # of a scenario
    scenarios: tuple[str, ...]  # for which it is meant, as the file names them; empty: all


class CampaignFile(NamedTuple):
    """A campaign file, read: words and numbers, no scenario loaded yet."""

    name: str
    folder: Path
    title: str
    scenarios: list[str]
    common: dict[str, Any]
    faults: list[Fault]
    parameters: dict[str, Any]
    draws: list[Draw]
    drawn: int  # how often; 0 for never
    draw_seed: int
    seeds: list[int] | None  # None: one, or with draws one for each
    metrics: list[str]
    margins: dict[str, Any]
    shrink: list[str]
    accept: float  # share of the runs that must pass
    pictures: int
    mode: Mode


def read_campaign(path: Path) -> CampaignFile:
    """Raises UsageError with one line."""
    data = _toml(path)
    try:
        return _campaign(data, path)
    except UsageError as error:
        raise UsageError(f"{path}: {error}") from None


def _toml(path: Path) -> dict[str, Any]:
    try:
        return parsed_toml(text_of(path))
    except ValueError as error:
        raise UsageError(f"{path}: cannot be read: {error}") from None


def known(table: Mapping[str, Any], valid: Collection[str], where: str) -> None:
    """Raises UsageError for a key that a table does not have."""
    for key in table:
        if key not in valid:
            raise UsageError(f"{where}{key}: unknown key{nearest(key, valid)}")


def _campaign(data: dict[str, Any], path: Path) -> CampaignFile:
    if "fault" in data:
        raise UsageError("fault: a campaign gives its faults names: write [faults.NAME], or [[faults.NAME.fault]]")
    if isinstance(data.get("scenarios"), str):
        data["scenarios"] = [data["scenarios"]]
    known(data, KEYS, "")
    for key, value in data.items():
        if (kind := KEYS[key]) is not object and (not isinstance(value, kind) or (kind is int and value is True)):
            raise UsageError(f"{key}: {value!r} is not {NAMES[kind]}")
    if not (scenarios := _texts("scenarios", data)):
        raise UsageError('scenarios: none is named; write scenarios = ["step"], names or files beside this one')
    draws, drawn, draw_seed = _draws(data.get("draw", {}))
    pictures, mode = data.get("pictures", 12), data.get("mode", Mode.INPROCESS)
    if not 0 <= pictures <= MOST_PICTURES:
        raise UsageError(f"pictures: {pictures} is not from 0 to {MOST_PICTURES}")
    if mode not in MODES:
        raise UsageError(f"mode: {mode!r} is unknown{nearest(mode, MODES)}")
    margins = data.get("margin", {})
    known(margins, MARGINS, "margin.")
    return CampaignFile(
        name=path.stem,
        folder=path.parent,
        title=data.get("title", path.stem),
        scenarios=scenarios,
        common=data.get("common", {}),
        faults=list(_faults(data)),
        parameters=dict(_flat(data.get("parameters", {}))),
        draws=draws,
        drawn=drawn,
        draw_seed=draw_seed,
        seeds=_seeds(data.get("seeds")),
        metrics=_texts("metrics", data),
        margins=margins,
        shrink=_texts("shrink", data),
        accept=_accept(data.get("accept", 1.0)),
        pictures=pictures,
        mode=Mode(mode),
    )


def _texts(key: str, data: Mapping[str, Any]) -> list[str]:
    texts = data.get(key, [])
    for text in texts:
        if not isinstance(text, str) or not text.strip():
            raise UsageError(f"{key}: {text!r} is not a name")
        if texts.count(text) > 1:
            raise UsageError(f"{key}: {text!r} stands twice")
    return texts


def _faults(data: Mapping[str, Any]) -> Iterator[Fault]:
    """The columns, the one without a fault first."""
    table = data.get("faults", {})
    if data.get("baseline", True) or not table:
        yield Fault(BASELINE, "no fault", {}, ())
    for name, piece in table.items():
        where = f"faults.{name}"
        if not isinstance(piece, dict):
            raise UsageError(f"{where}: {piece!r} is not a table; write [{where}] and below it what is changed")
        if name == BASELINE or "." in name or not name.strip():
            raise UsageError(f"{where}: {name!r} cannot be its name; take another one, without dots")
        own = {key: value for key, value in piece.items() if key not in OWN}
        if not own:
            raise UsageError(f"{where}: is empty; write a piece of a scenario, such as rig.load.mass = '300 kg'")
        yield Fault(name, str(piece.get("title", "")), own, tuple(_texts("scenarios", piece)))


def _flat(table: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    """Names with dots and what is given for them, whether TOML has read the dots as tables or not."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{before}{key}.")
        else:
            yield f"{before}{key}", value if isinstance(value, list) else str(value)


def _draws(table: Mapping[str, Any]) -> tuple[list[Draw], int, int]:
    """What is drawn, how often, with which seed."""
    known(table, DRAW_KEYS, "draw.")
    if not table:
        return [], 0, 0
    for kind in Distribution:
        if not isinstance(table.get(kind, {}), dict):
            raise UsageError(f"draw.{kind}: write [draw.{kind}], and below it places with their numbers")
    draws = [draw_of(p, kind, given) for kind in Distribution for p, given in _flat(table.get(kind, {}))]
    runs, seed = table.get("runs", 100), table.get("seed", 1)
    _whole("draw.runs", runs, 1, 10**9)
    _whole("draw.seed", seed, 0, MOST_SEED)
    if not draws:
        raise UsageError(
            "draw: nothing is drawn; write [draw.uniform] and below it rig.load.mass = ['100 kg', '300 kg']"
        )
    places = [draw.place for draw in draws]
    if twice := [place for place in places if places.count(place) > 1]:
        raise UsageError(f"draw: {twice[0]} is drawn twice")
    return draws, runs, seed


def _seeds(given: object) -> list[int] | None:
    """A list of them, or how many: 5 are 1 to 5."""
    if given is None:
        return None
    seeds = list(range(1, given + 1)) if isinstance(given, int) and given < 10**6 else given
    if not isinstance(seeds, list) or not seeds or isinstance(given, bool):
        raise UsageError(f"seeds: {given!r}: write how many, such as 5, or which, such as [1, 2, 3]")
    for seed in seeds:
        _whole("seeds", seed, 0, MOST_SEED)
    if len(set(seeds)) < len(seeds):
        raise UsageError("seeds: one stands twice")
    return seeds


def _whole(name: str, value: object, least: int, below: int) -> None:
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value < below:
        raise UsageError(f"{name}: {value!r} is not a whole number from {least} to {below - 1}")


def _accept(given: object) -> float:
    try:
        share = quantity(given, "")
    except ValueError:
        share = -1.0
    if not 0.0 < share <= 1.0:
        raise UsageError(f"accept: {given!r} is not a share of the runs; write one such as '95 %'")
    return share
