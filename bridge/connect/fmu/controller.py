"""The controller of a scenario as an FMU: its law in C, asked at the sampling instants, its gains as parameters."""

import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

from bridge.connect.fmu.made import Made
from bridge.connect.fmu.source import table_of
from bridge.connect.fmu.variable import Role, Variable, where
from bridge.errors import UsageError
from bridge.loop.c_law import exports_of
from bridge.scenario import Scenario
from bridge.scenario.channels import chosen
from bridge.scenario.controllers import InC
from bridge.scenario.fmu_controller import Fmu
from bridge.scenario.gains import law_gains
from controller.law import CGains
from controller.reference import evaluate
from controller.state_space import StateSpaceGains
from twin.topology import CHANNELS

BUILT_IN_MEMORY = 5  # numbers that laws/common.h and the integral of laws/pid.c take
FACTS = ("sample_period", "limit", "overlap")  # gains that are hydrotwin_facts
SAMPLED = ("position", "velocity", "p1", "p2", "p3")  # hydrotwin_sample
UNITS = {
    "proportional": "1/m",
    "integral": "1/(m s)",
    "derivative": "s/m",
    "feed_forward": "s/m",
    "filter_time": "s",
    "tracking_time": "s",
    "derivative_time": "s",
    "rest": "",
}
READINGS = {  # of controller.state_space.SIGNALS
    "error": "target->position - sample->position",
    "position": "sample->position",
    "velocity": "sample->velocity",
    "p1": "sample->p1",
    "p2": "sample->p2",
    "p3": "sample->p3",
    "reference": "target->position",
    "reference velocity": "target->velocity",
}
Macros = dict[str, str | int | float]


class LawInC(NamedTuple):
    """A law as the FMU has it."""

    source: str  # file of `c/laws`, or the text of a user's
    parameters: dict[str, float]
    memory: int  # numbers
    macros: Macros
    signals: tuple[tuple[str, str], ...] = ()  # name, unit
    channels: tuple[str, ...] = ()
    folder: str = ""  # of a user's law


def controller_fmu(scenario: Scenario) -> Made:
    """The sources of a scenario's controller. Raises UsageError for a law that is not native."""
    law = _law(scenario)
    variables = [*_variables(scenario, law)]
    text = '#include "model.h"\n\n#include <math.h>\n\n' + table_of(variables)
    sources = {"controller_data.c": text}
    ours = ["controller.c"]
    if law.folder:
        sources["law.c"] = law.source
    else:
        ours.append(f"laws/{law.source}")
    return Made(
        kind="controller",
        variables=variables,
        own_state="controller.h",
        macros=_macros(variables, law),
        sources=sources,
        ours=tuple(ours),
        headers=("controller.h", "laws/common.h"),
        period=scenario.loop.grid().sample,
        objects={},
        folder=law.folder,
    )


def _law(scenario: Scenario) -> LawInC:
    controller = scenario.controller
    if isinstance(controller, InC):
        return _users(controller, law_gains(scenario))
    if isinstance(controller, Fmu):
        raise UsageError(f"controller.fmu {controller.fmu!r} is an FMU already: couple that file with the plant's")
    if controller.kind not in MAKE:
        raise UsageError(
            f"controller.kind {controller.kind!r}: a law in Python cannot run without Python; write it in C "
            "(hydrotwin messages --c), or give state-space matrices"
        )
    return MAKE[controller.kind](law_gains(scenario))


def _plain(source: str) -> Callable[[Any], LawInC]:
    """A law whose gains are numbers, and words that are chosen at export."""

    def make(gains: Any) -> LawInC:
        numbers = {key: value for key, value in gains._asdict().items() if not isinstance(value, str)}
        parameters = {key: float(value) for key, value in numbers.items() if key not in FACTS}
        words: Macros = {f"VELOCITY_{gains.source.upper()}": 1} if hasattr(gains, "source") else {}
        if hasattr(gains, "anti_windup"):
            words[f"ANTI_WINDUP_{gains.anti_windup.upper().replace('-', '_')}"] = 1
        return LawInC(source, parameters, BUILT_IN_MEMORY, words)

    return make


def _state_space(gains: StateSpaceGains) -> LawInC:
    matrices = (("A", gains.a), ("B", gains.b), ("C", (gains.c,)), ("D", (gains.d,)))
    parameters = {
        f"{name}[{i},{j}]": float(value)
        for name, matrix in matrices
        for i, row in enumerate(matrix, 1)
        for j, value in enumerate(row, 1)
    }
    readings = ", ".join(READINGS[name] for name in gains.inputs)
    macros: Macros = {"STATES": len(gains.a), "READS": len(gains.inputs), "READINGS": f"{{{readings}}}"}
    if sys.version_info >= (3, 12):  # from there on Python's `sum` keeps what rounding loses
        macros["COMPENSATED_SUM"] = 1
    return LawInC("state_space.c", parameters, len(gains.a), macros)


MAKE: dict[str, Callable[[Any], LawInC]] = {
    "pd": _plain("pd.c"),
    "pid": _plain("pid.c"),
    "relay": _plain("relay.c"),
    "open-loop": _plain("open_loop.c"),
    "state-space": _state_space,
}


def _users(controller: InC, gains: Any) -> LawInC:
    """A user's own law in C, compiled once to learn what it exports."""
    assert isinstance(gains, CGains)
    if not controller.source:
        raise UsageError(
            f"controller.library {controller.library!r}: a compiled law cannot be linked into an FMU; give its text as "
            "controller.source"
        )
    exports = exports_of(controller, gains)
    macros: Macros = {"LAW_HAS_INIT": 1} if "_init" in exports.functions else {}
    parameters = {name: float(gains.parameters[name]) for name in exports.parameters}
    file = Path(controller.source).resolve()
    text, folder = file.read_text(encoding="utf-8"), str(file.parent)
    return LawInC(text, parameters, exports.memory, macros, exports.signals, exports.channels, folder)


def _variables(scenario: Scenario, law: LawInC) -> Iterator[Variable]:
    loop, gains = scenario.loop, law_gains(scenario)
    yield Variable("time", Role.TIME, "s", 0.0, "simulated time")
    for name in SAMPLED:
        yield Variable(f"measurement.{name}", Role.INPUT, CHANNELS[name].unit, 0.0, f"of the card{CHANNELS[name].note}")
    sensors = chosen(scenario)
    for name in law.channels:
        yield Variable(f"channels.{name}", Role.INPUT, sensors[name].unit, 0.0, f"of the card{sensors[name].note}")
    target = evaluate(scenario.reference.reference(), 0.0)
    unit = "m" if scenario.controller.follows else ""
    yield Variable("reference.position", Role.INPUT, unit, target.position, "what the law is after")
    speed = "m/s" if scenario.controller.follows else "1/s"
    yield Variable("reference.velocity", Role.INPUT, speed, target.velocity, "its rate")
    for name, value in law.parameters.items():
        yield Variable(
            f"controller.{name}", Role.TUNABLE, "" if law.folder else UNITS.get(name, ""), value, "of the law"
        )
    yield Variable("controller.limit", Role.TUNABLE, "", gains.limit, "of the spool reference", 0.0, 1.0)
    overlap = getattr(gains, "overlap", 0.0)
    yield Variable("controller.overlap", Role.TUNABLE, "", overlap, "of the valve's lands, jumped over", 0.0, 0.99)
    yield Variable("loop.sample_period", Role.FIXED, "s", loop.sample_period, "from sample to sample", 1e-9, 1e6)
    yield Variable("loop.offset", Role.FIXED, "s", loop.offset, "of the first sample", 0.0, 1e6)
    yield Variable("spool", Role.OUTPUT, "", 0.0, "spool reference of the directional valve")
    for name, unit in law.signals:
        yield Variable(f"signals.{name}", Role.OUTPUT, "", 0.0, f"logged by the law{f', {unit}' if unit else ''}")


def _macros(variables: list[Variable], law: LawInC) -> Macros:
    def first(group: str, names: Any) -> int:
        return next((where(variables, f"{group}.{name}") for name in names), 0)

    places = {f"OF_{name}": place for place, name in enumerate(law.parameters) if name.isidentifier()}
    return {
        "GRID": "INT64_C(1)",
        "PARAMETERS": len(law.parameters),
        "LAW_MEMORY": law.memory,
        "SIGNALS": len(law.signals),
        "FURTHER": len(law.channels),
        "AT_TIME": where(variables, "time"),
        "AT_SAMPLE": first("measurement", SAMPLED),
        "AT_FURTHER": first("channels", law.channels),
        "AT_TARGET": where(variables, "reference.position"),
        "AT_PARAMETERS": first("controller", law.parameters),
        "AT_SIGNALS": first("signals", (name for name, _ in law.signals)),
        "AT_LIMIT": where(variables, "controller.limit"),
        "AT_OVERLAP": where(variables, "controller.overlap"),
        "AT_SAMPLE_PERIOD": where(variables, "loop.sample_period"),
        "AT_SAMPLE_OFFSET": where(variables, "loop.offset"),
        "AT_SPOOL": where(variables, "spool"),
        **places,
        **law.macros,
    }
