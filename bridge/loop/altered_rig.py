"""The rig of a run as changes have made it, and the circuit that follows from it."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridge.errors import ScenarioError
from bridge.scenario import Scenario
from bridge.scenario.circuit import circuit_of
from twin.circuit.block import Compiled, record
from twin.circuit.build import rebuild
from twin.circuit.step import Circuit
from twin.circuit.stiffness import keep_oil
from twin.lines.bank import packed


class AlteredRig:
    """Numbers by their names, "rig.load.force"; the circuit is made when it is first needed."""

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self._values: dict[str, dict[str, Any]] = {}
        self._circuit: Circuit | None = None
        self._running: Any = None  # the circuit that the plant has
        self._layout: Any = None

    def refuse(self, numbers: Mapping[str, float]) -> None:
        """Raises ScenarioError for numbers that the rig cannot have now."""
        if numbers:
            self._after(self._now(), numbers)

    def take(self, numbers: Mapping[str, float]) -> None:
        """Change numbers, "rig.load.force" and so on."""
        self._circuit = self._after(self._now(), numbers)
        for name, value in numbers.items():
            _, part, key = name.split(".")
            self._values[part][key] = value

    def write(self, plant: Compiled, state: NDArray[np.float64]) -> None:
        """Let a plant that runs go on with the circuit; no oil is lost."""
        now = self._now()
        plant.parts[:] = record(now.parts)
        if now.lines is not self._running.lines:
            plant.numbers[:] = packed(now.lines)[1]
        if now.lines is not self._running.lines or now.parts.cylinder is not self._running.parts.cylinder:
            keep_oil(state, self._running, now)
        self._running = now

    def _now(self) -> Circuit:
        if self._circuit is None:
            self._circuit, self._values = circuit_of(self._scenario), self._scenario.rig_values()
            self._running = self._circuit
            self._layout = packed(self._circuit.lines)[0]
        return self._circuit

    def _after(self, circuit: Circuit, numbers: Mapping[str, float]) -> Circuit:
        values = {part: dict(entries) for part, entries in self._values.items()}
        for name, value in numbers.items():
            _, part, key = name.split(".")
            values[part][key] = value
            try:
                circuit = rebuild(circuit, values, f"{part}.{key}")
            except ValueError as error:
                raise ScenarioError(f"{name} = {value:g}: {error}") from None
        if circuit.lines is not self._now().lines and (packed(circuit.lines)[0] != self._layout).any():
            name, value = next(iter(numbers.items()))
            raise ScenarioError(
                f"{name} = {value:g}: waves that are under way in the lines would need another time; only lines of "
                "model 'lumped', 'volume' or 'none' can take that (rig.pipe_1.model and so on)"
            )
        return circuit
