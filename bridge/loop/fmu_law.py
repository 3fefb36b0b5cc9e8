"""A control law that is an FMU: at each sample it gets its inputs, steps by one sample period, and is asked.

A run's memory is an instance: None makes a fresh one, which begins at its first sample.
"""

import math
from collections.abc import Callable
from contextlib import suppress
from typing import Any, NamedTuple

from bridge.errors import RunError, ScenarioError, nearest
from bridge.loop.fmu_file import FmuFile, FmuInstance, is_number, is_real
from bridge.scenario.fmu_controller import Fmu, FmuGains, Mapped, mapped
from bridge.scenario.unit_dimensions import dimensions
from bridge.scenario.units import UNITS, Unit
from controller.grid import NS
from controller.law import Sample, saturate
from controller.laws import ControlLaw
from controller.reference import Target
from controller.state_space import SIGNALS
from twin.topology import SENSORS

Reading = Callable[[Sample, Target], float]
OWN = {"reference.position": "reference", "reference.velocity": "reference velocity"}  # names in our own FMUs
SIGNAL_UNITS = {"velocity": "m/s", "p1": "Pa", "p2": "Pa", "p3": "Pa", "reference velocity": "m/s"}  # others: m
PLAIN = Unit(1.0)
SPOOL_UNITS = ("", "%", "V")


class Wired(NamedTuple):
    """The variables of an FMU that a run touches."""

    readings: dict[str, Reading]
    constants: dict[str, float]
    output: Any
    unit: str  # of the output, one of SPOOL_UNITS
    channels: tuple[str, ...]


def fmu_law(controller: Fmu) -> ControlLaw:
    """The law of a scenario's controller. Raises ScenarioError where it cannot be run."""
    file = FmuFile(controller.fmu)
    wired = _wired(controller, file)
    first = [FmuInstance(file)]  # loaded already: the first sample does not wait for it

    def answer(sample: Sample, target: Target, memory: "FmuRun | None", gains: FmuGains) -> tuple[float, Any]:
        run = FmuRun(_fresh(first, file), wired, sample.stamp_ns, gains) if memory is None else memory
        return run.answer(sample, target, gains), run

    return ControlLaw(answer, prepare=_preparing(file), name=file.path.name, channels=wired.channels)


def _fresh(first: list[FmuInstance], file: FmuFile) -> FmuInstance:
    with suppress(IndexError):
        return first.pop()
    return FmuInstance(file)


class FmuRun:
    """One run of the law."""

    def __init__(self, instance: FmuInstance, wired: Wired, stamp: int, gains: FmuGains) -> None:
        self._instance, self._wired, self._parameters = instance, wired, gains.parameters
        instance.begin(stamp, gains.parameters | wired.constants)

    def answer(self, sample: Sample, target: Target, gains: FmuGains) -> float:
        """The spool reference. Raises RunError for an FMU that fails or gives no number."""
        wired, stamp = self._wired, sample.stamp_ns
        if gains.parameters != self._parameters:
            changed = {n: value for n, value in gains.parameters.items() if value != self._parameters[n]}
            self._instance.set(stamp, changed)
            self._parameters = gains.parameters
        values = {name: read(sample, target) for name, read in wired.readings.items()}
        told = self._instance.step(stamp, values, gains.sample_period, wired.output)
        spool = told if not wired.unit else told / (100.0 if wired.unit == "%" else gains.full_scale)
        if not math.isfinite(spool):
            label = self._instance.file.label
            raise RunError(f"{label} gave {wired.output.name} = {told} at t = {stamp / NS:g} s: not a spool reference")
        return saturate(spool, gains.limit)


def _preparing(file: FmuFile) -> Callable[[FmuGains], FmuGains]:
    """What checks parameters; those that are fixed keep their first values."""
    fixed: dict[str, float] = {}

    def prepare(gains: FmuGains) -> FmuGains:
        wrong = [text for name, value in gains.parameters.items() if (text := _objection(name, value, file, fixed))]
        if wrong:
            raise ScenarioError("\n".join(wrong))
        _refuse_period(gains.sample_period, file)
        return gains

    return prepare


def _objection(name: str, value: float, file: FmuFile, fixed: dict[str, float]) -> str:
    """What is wrong with a parameter; "" for nothing."""
    place = f"controller.parameters.{name}"
    valid = [v.name for v in file.model.modelVariables if v.causality in ("parameter", "structuralParameter")]
    if name not in valid:
        return f"{place}: {file.label} has no parameter of this name{nearest(name, valid)}"
    variable = file.variables[name]
    if words := _no_number(variable, value):
        return f"{place}: {words}"
    for limit, beyond, words in ((variable.min, value.__lt__, "at least"), (variable.max, value.__gt__, "at most")):
        if limit is not None and beyond(float(limit)):
            return f"{place} = {value:g}: must be {words} {float(limit):g}, says the FMU"
    if variable.variability != "tunable" and fixed.setdefault(name, value) != value:
        return f"{place}: the FMU says it is fixed, so it cannot change during a run"
    return ""


def _no_number(variable: Any, value: float) -> str:
    """Why a number cannot be given to a variable; "" where it can."""
    if not is_number(variable):
        what = "an array" if variable.dimensions else f"of the type {variable.type}"
        return f"it is {what}; a number cannot be given to it, leave it out and it keeps its start value"
    return "" if is_real(variable) or value == int(value) else f"it takes whole numbers, not {value:g}"


def _refuse_period(period: float, file: FmuFile) -> None:
    """Raises ScenarioError for a sample period [s] that is not whole steps of the FMU."""
    own = file.model.coSimulation.fixedInternalStepSize
    if own and abs(period / float(own) - round(period / float(own))) > 1e-9:
        below = max(1, int(period / float(own))) * float(own)
        raise file.refused(
            f"steps by {float(own):g} s, of which loop.sample_period {period:g} s is not a whole number; nearest: "
            f"{below:g} or {below + float(own):g} s"
        )


def _wired(controller: Fmu, file: FmuFile) -> Wired:
    """The map of a scenario, checked. Raises ScenarioError, a line per mistake."""
    inputs = [v.name for v in file.model.modelVariables if v.causality == "input"]
    given = controller.inputs or {name: own for name in inputs if (own := _own(name))}
    absent = [name for name in given if name not in inputs]
    wrong = [f"controller.inputs: {file.label} has no input {name!r}{nearest(name, inputs)}" for name in absent]
    wrong += [
        f"controller.inputs: the FMU's input {name!r} reads nothing: map it to a signal, or give it a number"
        for name in inputs
        if name not in given and is_number(file.variables[name])  # others keep their start values
    ]
    readings: dict[str, Reading] = {}
    constants: dict[str, float] = {}
    channels: list[str] = []
    for name, what in given.items():
        if name not in inputs:
            continue
        try:
            if isinstance(what, str):
                readings[name] = _reading(mapped(what), file.variables[name], file, channels)
            elif words := _no_number(file.variables[name], what):
                wrong.append(f"controller.inputs.{name}: {words}")
            else:
                constants[name] = float(what)
        except ValueError as error:
            wrong.append(f"controller.inputs.{name}: {error}")
    output, unit = _output(mapped(controller.output), file, wrong)
    if wrong:
        raise ScenarioError("\n".join(wrong))
    return Wired(readings, constants, output, unit, tuple(channels))


def _own(name: str) -> str:
    """The signal of an input of our own FMUs; "" for another name."""
    group, _, rest = name.partition(".")
    return OWN.get(name, rest if group in ("measurement", "channels") else "")


def _reading(wanted: Mapped, variable: Any, file: FmuFile, channels: list[str]) -> Reading:
    """What gives an input its value, in its own unit. Raises ValueError."""
    name = wanted.signal
    if not is_real(variable):
        what = "an array" if variable.dimensions else f"of the type {variable.type}"
        raise ValueError(f"it is {what}; a signal goes into a single Real, Float64 or Float32")
    if name in SIGNALS:
        read, unit = SIGNALS[name], SIGNAL_UNITS.get(name, "m")
    elif name.isidentifier():
        channels.append(name)  # whether the scenario has it, is asked when the run begins
        read, unit = (lambda sample, _: sample.channels[name]), (SENSORS[name].unit if name in SENSORS else "")
    else:
        raise ValueError(f"{name!r} is not a signal{nearest(name, SIGNALS, 'a channel of daq.channels')}")
    scale = _unit(wanted.unit, unit, variable, file)
    if scale == PLAIN:
        return read
    return lambda sample, target: (read(sample, target) - scale.offset) / scale.factor


def _unit(written: str, unit: str, variable: Any, file: FmuFile) -> Unit:
    """What turns a value of the FMU into SI. Raises ValueError for a unit of something else."""
    if written:
        known = UNITS.get(unit, {})
        if written not in known:
            raise ValueError(f"unit {written!r} does not fit here{nearest(written, known)}")
        return known[written]
    if not variable.unit:
        return PLAIN
    declared = next((u.baseUnit for u in file.model.unitDefinitions if u.name == variable.unit), None)
    if declared is None:
        return UNITS.get(unit, {}).get(variable.unit, PLAIN)
    found = {base: getattr(declared, base) for base in ("kg", "m", "s", "A", "K", "mol", "cd", "rad")}
    if unit and {base: n for base, n in found.items() if n} != dimensions(unit):
        raise ValueError(f"the FMU has it in {variable.unit}, the signal is in {unit}: map another signal")
    return Unit(float(declared.factor), float(declared.offset))


def _output(wanted: Mapped, file: FmuFile, wrong: list[str]) -> tuple[Any, str]:
    """The variable of the spool reference, and its unit."""
    outputs = [v.name for v in file.model.modelVariables if v.causality == "output" and is_real(v)]
    if wanted.signal not in outputs:
        near = nearest(wanted.signal, outputs)
        wrong.append(f"controller.output: {file.label} has no output {wanted.signal!r} that is a single number{near}")
        return None, ""
    variable = file.variables[wanted.signal]
    unit = wanted.unit or variable.unit or ""
    if unit not in SPOOL_UNITS:
        words = f"write '{wanted.signal} in V' or '{wanted.signal} in %'"
        wrong.append(f"controller.output: {unit!r} is not a unit of a spool reference: {words}")
    return variable, unit
