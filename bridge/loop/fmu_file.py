"""An FMU as a file: unpacked, its description read, its instances made by FMPy; every fault is one sentence."""

import shutil
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any
from weakref import finalize

from bridge.errors import RunError, ScenarioError
from controller.grid import NS

LARGEST = 1_000_000_000  # bytes unpacked
ENUMERATION = "Enumeration"
REALS = ("Real", "Float64", "Float32")
WHOLE = ("Boolean", "Integer", ENUMERATION, *(f"{sign}Int{bits}" for sign in ("", "U") for bits in (8, 16, 32, 64)))
MISSING = "controller.kind = 'fmu' needs FMPy: pip install 'hydrotwin[fmu]'"
MISCOUNTING = "PythonFMU"  # frees Python objects once too often when it is freed, which ends this program later
SHOWN = 300  # characters of what an FMU says


class FmuFile:
    """An FMU that is unpacked as long as this lives."""

    def __init__(self, name: str) -> None:
        """Raises ScenarioError for one that cannot be used here."""
        self.label = f"controller.fmu {name!r}"
        self.path = Path(name)
        self.model = self._described()
        if self.model.coSimulation is None:
            raise self.refused("is not for co-simulation: export it as a co-simulation FMU")
        if self.model.fmiVersion not in ("2.0", "3.0"):
            raise self.refused(f"is of FMI {self.model.fmiVersion}; FMI 2.0 and 3.0 can be run")
        self.variables = {variable.name: variable for variable in self.model.modelVariables}
        self.folder = self._unpacked()

    @property
    def three(self) -> bool:
        """Is it of FMI 3.0?"""
        return self.model.fmiVersion == "3.0"

    def refused(self, words: str) -> ScenarioError:
        """An error about this file."""
        return ScenarioError(f"{self.label} {words}")

    def _described(self) -> Any:
        try:
            import fmpy
        except ImportError:
            raise ScenarioError(MISSING) from None
        if not self.path.is_file():
            raise ScenarioError(f"{self.label}: there is no such file beside the scenario or in {Path.cwd()}")
        try:
            with zipfile.ZipFile(self.path) as archive:
                size = sum(entry.file_size for entry in archive.infolist())
            if size > LARGEST:
                raise self.refused(f"has {size} bytes unpacked; at most {LARGEST} are read")
            return fmpy.read_model_description(self.path)
        except ScenarioError:
            raise
        except Exception as error:  # of FMPy: any
            raise self.refused(f"is not an FMU: {_line(error)}") from None

    def _unpacked(self) -> str:
        import fmpy

        try:
            folder = str(fmpy.extract(self.path))
        except Exception as error:  # of FMPy: any
            raise self.refused(f"cannot be unpacked: {_line(error)}") from None
        finalize(self, shutil.rmtree, folder, ignore_errors=True)
        return folder


def is_real(variable: Any) -> bool:
    """Is a variable a single number with a fraction?"""
    return variable.type in REALS and not variable.dimensions


def is_number(variable: Any) -> bool:
    """Is a variable a single number?"""
    return variable.type in (*REALS, *WHOLE) and not variable.dimensions


class FmuInstance:
    """One instance, freed when nobody refers to it any more; of a tool that cannot do that it stays."""

    def __init__(self, file: FmuFile) -> None:
        """Raises ScenarioError where it cannot be made on this machine."""
        from fmpy import instantiate_fmu

        self.file = file
        self._said: list[str] = []
        try:
            self.slave: Any = instantiate_fmu(file.folder, file.model, "CoSimulation", logger=_listener(self._said))
        except Exception as error:  # of FMPy and of the loader: any
            said = f" ({self._said[-1]})" if self._said else ""
            raise file.refused(f"cannot be loaded on this machine: {_line(error)}{said}") from None
        if MISCOUNTING not in (file.model.generationTool or ""):
            finalize(self, _free, self.slave).atexit = False

    def begin(self, stamp: int, parameters: dict[str, float]) -> None:
        """Initialise it at an instant [ns]."""
        with self._calling(stamp):
            self.put(parameters)
            if self.file.three:
                self.slave.enterInitializationMode(startTime=stamp / NS)
            else:
                self.slave.setupExperiment(startTime=stamp / NS)
                self.slave.enterInitializationMode()
            self.slave.exitInitializationMode()

    def put(self, values: dict[str, float]) -> None:
        """Set variables by their names."""
        for name, value in values.items():
            variable = self.file.variables[name]
            plain = value if is_real(variable) else int(value)
            kind = variable.type if variable.type != ENUMERATION else "Int64" if self.file.three else "Integer"
            getattr(self.slave, f"set{kind}")([variable.valueReference], [plain])

    def set(self, stamp: int, values: dict[str, float]) -> None:
        """Set variables in the middle of a run."""
        with self._calling(stamp):
            self.put(values)

    def step(self, stamp: int, values: dict[str, float], period: float, output: Any) -> float:
        """Give it its inputs, step from an instant [ns] by a period [s], and read the output."""
        with self._calling(stamp):
            self.put(values)
            told = self.slave.doStep(currentCommunicationPoint=stamp / NS, communicationStepSize=period)
            if self.file.three and told[1]:
                raise RunError("it asks to end the simulation")
            return float(getattr(self.slave, f"get{output.type}")([output.valueReference])[0])

    @contextmanager
    def _calling(self, stamp: int) -> Iterator[None]:
        self._said.clear()
        try:
            yield
        except Exception as error:  # of FMPy: any
            said = f": {self._said[-1]}" if self._said else ""
            raise RunError(f"{self.file.label} at t = {stamp / NS:g} s: {_line(error)}{said}") from None


def _listener(said: list[str]) -> Any:
    """What keeps the messages of an FMU; FMI 2 hands over one argument more than FMI 3."""

    def keep(*arguments: Any) -> None:
        message = arguments[-1]
        text = message.decode("utf-8", "replace") if isinstance(message, bytes) else str(message)
        said.append(" ".join(text.split())[:SHOWN])

    return keep


def _free(slave: Any) -> None:
    with suppress(Exception):  # an FMU that fails on its way out has nothing to say any more
        slave.freeInstance()


def _line(error: BaseException) -> str:
    return " ".join(str(error).split())[:SHOWN].rstrip(".") or type(error).__name__
