"""The control law of a run: one of ours by its name, or a user's function, loaded from its file.

The folder of a user's file comes last in the search for modules: a law may import its neighbours, and none of them can
take the place of a package that is installed.
"""

import importlib
import importlib.util
import inspect
import re
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

from bridge.errors import ScenarioError
from bridge.loop.checked_law import FAILURES, checked, explained, short, told
from bridge.loop.hearing import aside
from bridge.loop.parameters import filled
from bridge.scenario.controllers import Controller, InC, Python
from bridge.scenario.fmu_controller import Fmu
from bridge.scenario.law_file import kept_of, law_file
from controller.laws import LAWS, ControlLaw
from controller.linear_system import system_law

OURS = ("bridge", "controller", "twin")  # no laws themselves
HOOKS = ("on_safe_state", "on_resume")  # functions beside a user's law that are told of both; each gets the memory


def law_of(controller: Controller) -> ControlLaw:
    """The law of a scenario's controller. Raises ScenarioError when there is none."""
    if isinstance(controller, InC):
        from bridge.loop.c_law import c_law

        return c_law(controller)
    if isinstance(controller, Fmu):
        from bridge.loop.fmu_law import fmu_law

        return fmu_law(controller)
    return find_law(controller.law) if isinstance(controller, Python) else LAWS[controller.kind]


def find_law(name: str) -> ControlLaw:
    """A user's law by "module:function" or "file.py:function", in the working folder or installed.

    A hook that does not stand beside it forgets the memory. Raises ScenarioError when there is no law.
    """
    module, _, function = name.rpartition(":")
    file = law_file(name, Path.cwd())
    if file is None and (module.endswith(".py") or module in OURS):
        raise ScenarioError(f"controller.law {name!r}: there is no such file beside the scenario or in {Path.cwd()}")
    try:
        with aside():
            loaded = importlib.import_module(module) if file is None else _from_file(file.resolve())
    except FAILURES as error:
        raise ScenarioError(f"controller.law {name!r}: {explained(error, file)}") from None
    law = getattr(loaded, function, None)
    if not callable(law):
        raise ScenarioError(f"controller.law {name!r}: {loaded.__file__} has no function {function!r}")
    place = Path(loaded.__file__ or "")
    if is_system(law):
        linear = _system_law(law, name)
        answer: Any = checked(linear, name, place)
        answer.system = linear.system
        return ControlLaw(answer)
    hooks: Any = {hook: told(getattr(loaded, hook, None), f"{name}: {hook}", place) for hook in HOOKS}
    return ControlLaw(checked(law, name, place), **hooks, prepare=_prepared(loaded, place), name=name)


def _prepared(module: ModuleType, file: Path) -> Callable[[Any], Any]:
    """What fills the parameters that a module declares as `Parameters` from those of the scenario."""
    declared = getattr(module, "Parameters", None)
    return lambda gains: gains._replace(parameters=filled(gains.parameters, declared, short(str(file))))


def law_object(law: Any) -> ControlLaw:
    """A law that is a function in memory, and no file names. Raises ScenarioError for what is not a function."""
    if not callable(law):
        raise ScenarioError(f"{law!r:.80} is not a law: give a function (sample, target, memory, gains)")
    code = getattr(law, "__code__", None)
    name = _name(law)
    return ControlLaw(checked(law, name, Path(code.co_filename if code else name)), name=name)


def facts_of(law: Any) -> dict[str, Any]:
    """What a recording keeps of a law that is a function in memory: name and source, as far as Python knows it."""
    try:
        text = inspect.getsource(law)
    except (OSError, TypeError):
        text = ""
    kept = kept_of(_name(law), text.encode())
    return kept | {"law": kept["law"] | {"in_memory": True}}


def _name(law: Any) -> str:
    return getattr(law, "__qualname__", type(law).__qualname__)


def _from_file(file: Path) -> ModuleType:
    """The module in a file; one that belongs to a package as a part of it."""
    root, names = file.parent, [] if file.stem == "__init__" else [file.stem]
    while (root / "__init__.py").is_file():
        root, names = root.parent, [root.name, *names]
    if str(root) not in sys.path:
        sys.path.append(str(root))
    return _alone(file) if root == file.parent else _of_package(file, ".".join(names))


def _of_package(file: Path, name: str) -> ModuleType:
    module = importlib.import_module(name)
    if module.__file__ != str(file):
        raise ImportError(f"{file} is hidden by {module.__file__}: give its package another name")
    return module


def _alone(file: Path) -> ModuleType:
    """A file under a name of its own, which is nobody else's."""
    name = f"law_{re.sub(r'[^A-Za-z0-9]', '_', str(file))}"
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        raise ImportError(f"{file} is not Python")
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module


def is_system(law: Any) -> bool:
    """Is it a linear system of the package `control`?"""
    return type(law).__module__.partition(".")[0] == "control" and hasattr(law, "dt")


def _system_law(system: Any, name: str) -> Any:
    """A sampled linear system as a law. Raises ScenarioError for one that is none."""
    import control

    if not (isinstance(system.dt, float | int) and not isinstance(system.dt, bool) and system.dt > 0.0):
        raise ScenarioError(f"controller.law {name!r} has dt {system.dt}: give the sampling period in seconds")
    if (system.ninputs, system.noutputs) != (1, 1):
        raise ScenarioError(f"controller.law {name!r}: a system takes the position error alone and has one output")
    states: Any = control.ss(system)
    a, b, c, d = (matrix.tolist() for matrix in (states.A, states.B, states.C, states.D))
    return system_law(a, b, c, d, float(system.dt))
