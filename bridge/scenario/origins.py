"""Which values of a scenario come from those that it extends."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from bridge.scenario.files import bases_of, parsed, parsed_change

Origins = dict[str, str]  # name of a value, such as "rig.load.mass": the extended scenario that it is from


def origins(which: str, changes: Iterable[str] = ()) -> Origins:
    """Of a scenario's values, but for those that it, or a change on the command line, gives itself."""
    found = _all(which)
    own = {*_names(parsed(which)[0]), *(parsed_change(change)[0] for change in changes)}
    return {name: origin for name, origin in found.items() if name not in own}


def _all(which: str) -> Origins:
    """Of all its values, its own among them."""
    data, folder, _ = parsed(which)
    found: Origins = {}
    for base in bases_of(data, folder):
        found |= _all(base)
    return found | dict.fromkeys(_names(data), Path(which).stem)


def _names(data: dict[str, Any], before: str = "") -> Iterator[str]:
    for key, value in data.items():
        if isinstance(value, dict):
            yield from _names(value, f"{before}{key}.")
        else:
            yield f"{before}{key}"
