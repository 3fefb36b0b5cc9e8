"""Where a key belongs that stands in the wrong section of a scenario: the words that say it."""

from typing import Any, get_args

from bridge.errors import has_near
from twin.quantity import Choice
from twin.rig import RIG

MOST_SECTIONS = 4  # that are named; a key that more of them have says nothing


def instead_of(place: list[str]) -> str:
    """What to write instead of a key that the section at its place does not have; "" where nothing suggests itself."""
    key, inside = place[-1], place[:-1]
    if (said := _section_of_its_own(key, inside)) or (said := _of_rig(key, inside)) or (said := _kind(key, inside)):
        return said
    known = _sections()
    if has_near(key, known.get(".".join(inside), [])):
        return ""
    there = [f"[{section}]" for section, keys in known.items() if key in keys]
    return f"does not belong here; write it under {' or '.join(there)}" if 0 < len(there) <= MOST_SECTIONS else ""


def _section_of_its_own(key: str, inside: list[str]) -> str:
    """Of a key of the scenario itself."""
    from bridge.scenario.model import Scenario

    if not inside or key not in Scenario.model_fields:
        return ""
    if key in _top_sections():
        named = "not a part of the rig but " if inside[0] == "rig" else ""
        return f"{named}a section of its own; write [{key}] (with --set: {key}.NAME=...)"
    if any(hasattr(member, "model_fields") for member in get_args(Scenario.model_fields[key].annotation)):
        return f"a list of its own; write [[{key}]]"
    return f"belongs to the scenario itself; write {key} = ... at the top of the file, before the first [section]"


def _of_rig(key: str, inside: list[str]) -> str:
    """Of a part of the rig that stands outside of it, or in another part."""
    if key not in RIG or inside == ["rig"]:
        return ""
    return f"a part of the rig; write [rig.{key}] (with --set: rig.{key}.NAME=...)"


def _kind(key: str, inside: list[str]) -> str:
    """Of the word of a kind where a section is expected."""
    if inside not in ([], ["rig"]):
        return ""
    slots = [part for part, entries in RIG.items() if isinstance(c := entries.get("kind"), Choice) and key in c.options]
    if not slots or key == "none":
        return ""
    sections = " or ".join(f"[rig.{slot}]" for slot in slots)
    return f'a kind of {" and ".join(slots)}; write kind = "{key}" under {sections}'


def _top_sections() -> list[str]:
    from bridge.scenario.kinds import UNIONS
    from bridge.scenario.model import Scenario

    fields = Scenario.model_fields
    return [name for name, field in fields.items() if name in UNIONS or hasattr(field.annotation, "model_fields")]


def _sections() -> dict[str, list[str]]:
    """The keys of each section, by its name as a file has it."""
    from bridge.scenario.kinds import UNIONS
    from bridge.scenario.model import Scenario

    found: dict[str, list[str]] = {}
    for name in _top_sections():
        kinds: list[Any] = [*UNIONS[name].values()] if name in UNIONS else [Scenario.model_fields[name].annotation]
        found[name] = sorted({key for kind in kinds for key in kind.model_fields})
    del found["rig"]
    return found | {f"rig.{part}": list(entries) for part, entries in RIG.items()}
