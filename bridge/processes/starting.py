"""The processes of a run as `hydrotwin run` starts them."""

from collections.abc import Mapping
from pathlib import Path

from bridge.loop.identity import derived
from bridge.processes.child import Child
from bridge.processes.failing import faults_of_processes
from bridge.processes.options import RunOptions
from bridge.scenario import Scenario

EAR = "supervisor"  # the supervisor's role on the bus
STARTUP = 90.0  # seconds to the first word: the first start compiles


class Starter:
    """Starts plant, recorder and controller of one run, and a router where a fault concerns the network."""

    def __init__(
        self, scenario: Scenario, options: RunOptions, folder: Path, endpoint: str, environment: Mapping[str, str]
    ) -> None:
        """folder: for their words; endpoint: where they meet; environment: of `guarded`."""
        self._scenario = scenario
        self._options = options
        self._folder = folder
        self._endpoint = endpoint
        self._environment = environment
        self._file = folder / "scenario.json"
        self._file.write_text(scenario.model_dump_json(), encoding="utf-8")
        self._by_router = any(fault.part == "network" for fault in faults_of_processes(scenario).values())

    def all(self) -> list[Child]:
        """Started, the plant first."""
        roles = ["plant", *(["router"] if self._by_router else []), "record"]
        return [self.start(role) for role in (*roles, *([] if self._options.external else ["controller"]))]

    def start(self, role: str, again: int = 0) -> Child:
        """A process of a role; again: how often it was started before."""
        arguments = {
            "plant": self._plant,
            "router": self._router,
            "record": self._record,
            "controller": self._controller,
        }
        return Child(role, arguments[role](again), self._folder, self._environment)

    def _plant(self, again: int) -> list[str]:
        options, scenario = self._options, self._scenario
        place = ["--connect", self._endpoint] if self._by_router else ["--listen", self._endpoint]
        who = ["--run-id", str(derived(scenario.seed, scenario.rig_name)), "--patience", str(options.patience)]
        awaited = [word for role in ("recorder", "controller", EAR) for word in ("--await", role)]
        how = ["--mode", options.mode, "--speed", str(options.speed), "--quiet", *self._priority]
        return [str(self._file), *place, *who, *awaited, *how]

    def _router(self, again: int) -> list[str]:
        return ["--listen", self._endpoint]

    def _record(self, again: int) -> list[str]:
        """A recorder that is started again writes a file of its own."""
        path = self._options.recording
        own = path.with_stem(f"{path.stem}-{again + 1}") if again else path
        return ["--output", str(own), "--rig", self._scenario.rig_name, *self._client, *self._priority]

    def _controller(self, again: int) -> list[str]:
        """One that is started again is another source, as any process is."""
        names = ("controller", str(again)) if again else ("controller",)
        source = ["--source", str(derived(self._scenario.seed, *names))]
        return [str(self._file), *self._client, *source, *self._priority, "--quiet"]

    @property
    def _client(self) -> list[str]:
        return ["--mode", self._options.mode, "--connect", self._endpoint, "--patience", str(STARTUP)]

    @property
    def _priority(self) -> list[str]:
        return ["--priority", self._options.priority]
