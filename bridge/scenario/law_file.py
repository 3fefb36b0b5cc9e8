"""Where a user's law is: `controller.law` names it as "module:function" or "path/to/file.py:function"."""

import hashlib
from pathlib import Path
from typing import Any

C_FILES = ("library", "source", "fmu")  # of a controller in C, or one that is an FMU


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
    """What a recording keeps of a law that stands in a file: its name, hash and, if it is one, text."""
    if origin := getattr(controller, "origin", None):
        return {"law": {"name": origin.file, "sha256": origin.sha256}}
    if controller.kind == "c":
        file = Path(controller.library or controller.source)
        return kept_of(file.name, file.read_bytes(), bool(controller.source)) if file.is_file() else {}
    if controller.kind == "fmu":
        file = Path(controller.fmu)
        return kept_of(file.name, file.read_bytes(), is_text=False) if file.is_file() else {}
    name = getattr(controller, "law", None)
    file = law_file(name, Path.cwd()) if name else None
    if name is None or file is None:
        return {}
    return kept_of(f"{file.name}:{name.rpartition(':')[2]}", file.read_bytes())


def kept_of(name: str, content: bytes, is_text: bool = True) -> dict[str, Any]:
    """A law as the head of a recording has it."""
    text = {"text": content.decode("utf-8", "replace")} if is_text else {}
    return {"law": {"name": name, "sha256": hashlib.sha256(content).hexdigest(), **text}}


def c_file(name: str) -> str:
    """The name of a file that a C compiler takes. Raises ValueError for another one."""
    if name and not name.endswith(".c"):
        raise ValueError(f"{name!r} is not a C file; compile it yourself, and give the result as controller.library")
    return name


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
    if folder.resolve() != Path.cwd():
        controller = controller | _places(controller, folder)
    return data | {"controller": controller}


def _places(controller: dict[str, Any], folder: Path) -> dict[str, str]:
    """The names of a controller's files that are in a folder, with their full paths."""
    given = {key: controller[key] for key in ("law", *C_FILES) if isinstance(controller.get(key), str)}
    found = {key: str((folder / given[key]).resolve()) for key in C_FILES if (folder / given.get(key, "")).is_file()}
    file = law_file(given.get("law", ""), folder)
    return found | ({"law": f"{file.resolve()}:{given['law'].rpartition(':')[2]}"} if file else {})
