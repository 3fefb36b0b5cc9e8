"""Where a user's law is: `controller.law` names it as "module:function" or "path/to/file.py:function"."""

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


def with_place(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Plain data of a scenario file, with the full path of a law that stands beside that file.

    A law in the working folder keeps its short name: every process of a run finds it there.
    """
    controller = data.get("controller")
    if not isinstance(controller, dict) or folder.resolve() == Path.cwd():
        return data
    name = controller.get("law")
    file = law_file(name, folder) if isinstance(name, str) else None
    if file is None:
        return data
    return data | {"controller": controller | {"law": f"{file.resolve()}:{str(name).rpartition(':')[2]}"}}
