"""Where a user's law is: `controller.law` names it as "module:function" or "path/to/file.py:function"."""

import hashlib
from pathlib import Path
from typing import Any


def law_file(name: str, folder: Path) -> Path | None:
    """The file in a folder that holds a law; None where it is not there."""
    module, _, _ = name.rpartition(":")
    if not module:
        return None
    if module.endswith(".py"):
        candidates = (folder / module,)
    else:
        path = folder.joinpath(*module.split("."))
        candidates = (path.with_name(f"{path.name}.py"), path / "__init__.py")
    return next((file for file in candidates if file.is_file()), None)


def law_facts(controller: Any) -> dict[str, Any]:
    """What a recording keeps of a law that stands in a file: its name, text and hash; nothing of others."""
    name = getattr(controller, "law", None)
    file = law_file(name, Path.cwd()) if name else None
    if name is None or file is None:
        return {}
    return kept_of(f"{file.name}:{name.rpartition(':')[2]}", file.read_bytes())


def kept_of(name: str, text: bytes) -> dict[str, Any]:
    """A law as the head of a recording has it."""
    digest = hashlib.sha256(text).hexdigest()
    return {"law": {"name": name, "sha256": digest, "text": text.decode("utf-8", "replace")}}


def with_kind(controller: dict[str, Any]) -> dict[str, Any]:
    """Plain data of a controller; one that names a function, and no kind, is of the kind that takes one."""
    names_function = "kind" not in controller and ":" in str(controller.get("law", ""))
    return {"kind": "python"} | controller if names_function else controller


def with_place(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Plain data of a scenario file, with its kind of controller and the full path of a law beside that file.

    A law in the working folder keeps its short name: every process of a run finds it there.
    """
    controller = data.get("controller")
    if not isinstance(controller, dict):
        return data
    controller = with_kind(controller)
    data = data | {"controller": controller}
    if folder.resolve() == Path.cwd():
        return data
    name = controller.get("law")
    file = law_file(name, folder) if isinstance(name, str) else None
    if file is None:
        return data
    return data | {"controller": controller | {"law": f"{file.resolve()}:{str(name).rpartition(':')[2]}"}}
