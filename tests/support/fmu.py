"""FMUs of ours in the hands of others: FMPy, and a host in C."""

import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from numpy.typing import NDArray

from bridge.connect.fmu.build import OURS, PATIENCE, write_fmu
from bridge.connect.fmu.controller import controller_fmu
from bridge.connect.fmu.plant import plant_fmu
from bridge.connect.fmu.platforms import PLATFORMS, platforms, zig
from bridge.recording.reader import Recording
from bridge.scenario import Scenario

HOST = Path(__file__).with_name("fmu_host.c")
FOLDERS = {"2": "linux64", "3": "x86_64-linux"}
EMULATORS = {  # of other platforms: on Debian the packages qemu-user and libc6-arm64-cross, and wine64
    "aarch64-linux": ["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"],
    "x86_64-windows": ["wine"],
}
ON_WINDOWS = """\
#include <windows.h>
#define RTLD_NOW 0
#define RTLD_GLOBAL 0
#define dlopen(path, flags) ((void *)LoadLibraryA(path))
#define dlsym(library, name) ((void *)GetProcAddress((HMODULE)(library), name))
#define dlerror() "the library cannot be loaded"
"""
Array = NDArray[np.float64]


def exported(kind: str, scenario: Scenario, version: str, path: Path, names: tuple[str, ...] = ()) -> Path:
    """An FMU of a scenario for platforms, or for this machine."""
    machines = platforms([*names])
    made = plant_fmu(scenario, machines) if kind == "plant" else controller_fmu(scenario)
    write_fmu(made, scenario, version, machines, path)
    return path


class Opened:
    """An FMU in FMPy."""

    def __init__(self, path: Path, starts: dict[str, Any] | None = None) -> None:
        self.model: Any = fmpy.read_model_description(path)
        self.at = {v.name: v.valueReference for v in self.model.modelVariables}
        self.version = self.model.fmiVersion[0]
        self.folder = Path(str(fmpy.extract(path)))
        self.slave: Any = fmpy.instantiate_fmu(str(self.folder), self.model, "CoSimulation")
        for name, value in (starts or {}).items():
            self.set(name, value)
        if self.version == "2":
            self.slave.setupExperiment(startTime=0.0)
            self.slave.enterInitializationMode()
        else:
            self.slave.enterInitializationMode(startTime=0.0)
        self.slave.exitInitializationMode()

    @property
    def library(self) -> Path:
        """The file that a host loads."""
        return self.folder / f"binaries/{FOLDERS[self.version]}/{self.model.coSimulation.modelIdentifier}.so"

    @property
    def token(self) -> str:
        """What a host hands over to instantiate it."""
        return self.model.guid if self.version == "2" else self.model.instantiationToken

    def get(self, names: list[str]) -> list[float]:
        """Real values."""
        read = self.slave.getReal if self.version == "2" else self.slave.getFloat64
        return list(read([self.at[name] for name in names]))

    def set(self, name: str, value: Any) -> None:
        """A value of any type."""
        kind = {bool: "Boolean", int: "Integer" if self.version == "2" else "Int64"}.get(type(value))
        kind = kind or ("Real" if self.version == "2" else "Float64")
        getattr(self.slave, f"set{kind}")([self.at[name]], [value])

    def step(self, time: float, step: float) -> None:
        """One communication step."""
        self.slave.doStep(currentCommunicationPoint=time, communicationStepSize=step)

    def close(self) -> None:
        """Free it and remove what was unpacked."""
        self.slave.freeInstance()
        shutil.rmtree(self.folder)


@contextmanager
def opened(path: Path, **starts: Any) -> Iterator[Opened]:
    """An FMU in FMPy, initialised; starts: parameters, "__" for each dot of a name."""
    fmu = Opened(path, {name.replace("__", "."): value for name, value in starts.items()})
    try:
        yield fmu
    finally:
        fmu.close()


def watched(fmu: Opened, run: Recording) -> dict[str, Array]:
    """The outputs of a plant that a recording has too, and what it recorded."""
    groups = {"measurement": run.columns("measurement"), "state": run.columns("state")}
    if any(name.startswith("channels.") for name in fmu.at):
        groups["channels"] = run.columns("channels")
    named = {f"{group}.{name}": column for group, columns in groups.items() for name, column in columns.items()}
    return {name: column for name, column in named.items() if name in fmu.at}


def coupled(plant: Opened, law: Opened, run: Recording, step: float, ticks: int, folder: Path) -> Array:
    """What a host in C sees of a plant and a law that it couples: a row per tick, what is `watched`, then the spool."""
    host = folder / f"host{plant.version}"
    flags = ["-O1", "-Wall", "-Wextra", "-Werror", *(["-DFMI3"] if plant.version == "3" else [])]
    subprocess.run(["cc", *flags, "-I", str(OURS / "fmi"), "-o", str(host), str(HOST), "-ldl"], check=True)
    told = _told(plant, law, run, f"{plant.library} {plant.token} {law.library} {law.token} {step!r} {ticks}", step)
    return _seen([str(host)], told)


def coupled_elsewhere(name: str, plant: Opened, law: Opened, run: Recording, folder: Path) -> Array:
    """The same of FMI 2 on another platform: the host is built by zig and runs in an emulator, 1 ms a step."""
    machine, ticks = PLATFORMS[name], len(run.columns("state")["stamp"]) - 1
    host = folder / f"host{'.exe' if machine.suffix == '.dll' else ''}"
    if machine.suffix == ".dll":
        (folder / "dlfcn.h").write_text(ON_WINDOWS)
    command = [*zig(), "cc", "-target", machine.zig, "-O1", "-I", str(folder), "-I", str(OURS / "fmi")]
    subprocess.run([*command, "-o", str(host), str(HOST)], check=True, timeout=PATIENCE)
    inside = f"binaries/{machine.folders['2']}"
    libraries = [next((fmu.folder / inside).glob(f"*{machine.suffix}")) for fmu in (plant, law)]
    first = f"{libraries[0]} {plant.token} {libraries[1]} {law.token} 0.001 {ticks}"
    return _seen([*EMULATORS[name], str(host)], _told(plant, law, run, first, 1e-3))


def _told(plant: Opened, law: Opened, run: Recording, first: str, step: float) -> str:
    """What the host reads: who is coupled, by which variables, and the reference."""
    lines = [first]
    lines += [f"{plant.at[name]} {law.at[name]}" for name in law.at if name.startswith("measurement.")]
    lines += ["end", f"{law.at['spool']} {plant.at['spool']}"]
    wanted, follows = run.columns("reference"), run.scenario().controller.follows
    position = wanted["position"] if follows else run.columns("command")["spool"]  # what an open-loop law puts out
    for stamp, *values in zip(*(c.tolist() for c in (wanted["stamp"], position, wanted["velocity"])), strict=True):
        for name, value in zip(("position", "velocity"), values, strict=True):
            lines.append(f"{stamp // round(step * 1e9)} {law.at[f'reference.{name}']} {value!r}")
    lines += ["end", *(str(plant.at[name]) for name in watched(plant, run))]
    return "\n".join(lines) + "\n"


def _seen(command: list[str], told: str) -> Array:
    done = subprocess.run(command, input=told, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return np.array([[float.fromhex(value) for value in line.split()] for line in done.stdout.splitlines()])
