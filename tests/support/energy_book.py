"""The book of energy of a run with faults in it: what comes in, what is turned to heat, what is stored, what is left.

The border is the pump's outlet, the tank and the load. A step's work at a place is the mean pressure times the mean
flow of its two instants: so what flows from part to part cancels to the bit, and what the book lacks is the error of
the scheme inside the parts. Heat is what each law says of the flows and speeds, not what the pressures leave over. For
the calibrated rig: gear pump, relief valve at the tee, proportional valve, cylinder without necks.

A chamber keeps E(S, V) = B (S ln(S/V) - S + V), which is what p = B (S/V - 1) asks for: dE = mu dS - p dV, mu = B
ln(S/V). Where its oil is vapour E grows by -p_v for each volume. A line keeps C p^2/2, so that oil which passes from
one to the other brings p and is worth mu: the difference, p/2B of what flows, is an entry by itself.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.loop.controller import ControllerSide
from bridge.loop.exchange import exchange
from bridge.loop.identity import derived
from bridge.loop.plant import PlantSide
from bridge.scenario import Scenario
from tests.support.energy_reading import Piece, Reading, mean
from twin.circuit.block import Compiled
from twin.kernel import interpreted
from twin.lines.bank import ENDS, unpacked
from twin.topology import LINES

Array = NDArray[np.float64]


class Watched(PlantSide):
    """A plant that keeps its state after each internal step."""

    def __init__(self, scenario: Scenario, run_id: int) -> None:
        self.pieces: list[tuple[Compiled, list[Array]]] = []
        super().__init__(scenario, run_id)

    def _run(self, reference: float, steps: int, now: int = 0) -> None:
        if not self.pieces or _differs(self.pieces[-1][0], self._circuit):
            self.pieces.append((_copied(self._circuit), [self._state.copy()]))
        for i in range(steps):
            super()._run(reference, 1, now + i * self.grid.step)
            self.pieces[-1][1].append(self._state.copy())
        if not steps:
            super()._run(reference, 0, now)


def watched(made: Scenario) -> list[Piece]:
    """A run of a scenario in process."""
    plant = Watched(made, derived(made.seed, made.rig_name))
    for _ in exchange(plant, ControllerSide(made, derived(made.seed, "controller")), made.ticks, lean=True):
        pass
    return [
        Piece(then.parts[0], interpreted(unpacked)(then.whole, then.numbers), np.array(rows))
        for then, rows in plant.pieces
    ]


def _copied(circuit: Compiled) -> Compiled:
    return Compiled(circuit.parts.copy(), circuit.whole.copy(), circuit.numbers.copy())


def _differs(one: Compiled, other: Compiled) -> bool:
    return bool((one.parts != other.parts).any() or (one.numbers != other.numbers).any())


def energy_of(made: Scenario) -> "Book":
    """The book of a run of a scenario."""
    return book(watched(made))


class Book(NamedTuple):
    """Entries over a run, each summed up from its begin [J]; a row for each internal step."""

    brought: dict[str, Array]  # to the oil and the load
    lost: dict[str, Array]  # to heat, to the tank and to the outside
    stored: Array
    given: Array  # by the changes themselves, in what is stored

    def missing(self, **signs: float) -> Array:
        """What the book lacks [J]; signs: other factors of some entries."""
        brought = sum(signs.get(name, 1.0) * entry for name, entry in self.brought.items())
        lost = sum(signs.get(name, 1.0) * entry for name, entry in self.lost.items())
        return self.stored - signs.get("given", 1.0) * self.given - brought + lost

    @property
    def throughput(self) -> float:
        """What has been turned over [J]: all that came in."""
        return float(sum(np.abs(np.diff(entry)).sum() for entry in self.brought.values()))


def book(pieces: list[Piece]) -> Book:
    """The book of a run."""
    brought, lost, stored, given, entered = [], [], [], [], []
    one = None
    for piece in pieces:
        one = Reading(piece, one)
        kept = one.stored()
        given.append(kept[0] - (one.earlier.stored()[-1] if one.earlier else kept[0]))
        brought.append(one.brought())
        lost.append(one.lost())
        stored.append(np.diff(kept))
        entered.append(one.entered())
    changes = np.concatenate([_first(jump, len(steps)) for jump, steps in zip(given, stored, strict=True)])
    held = np.cumsum(np.concatenate(stored) + changes) + _waves(entered, pieces[0])
    return Book(_summed(brought), _summed(lost), held, np.cumsum(changes))


def _first(value: float, rows: int) -> Array:
    column = np.zeros(rows)
    column[0] = value
    return column


def _waves(entered: list[Array], piece: Piece) -> Array:
    """What lines without friction hold beyond what they held at the start [J]: what has entered in a travel time.

    Before the start all was steady. Lines of another model keep their own books.
    """
    held = np.zeros(1 + sum(len(part) - 1 for part in entered))
    for line in np.flatnonzero(piece.lines.model[:LINES] == ENDS):
        power = np.concatenate([entered[0][:1, line], *(part[1:, line] for part in entered)])
        total = np.concatenate([[0.0], np.cumsum(mean(power))]) * piece.parts["step"]
        instants = np.arange(len(power)) * piece.parts["step"]
        then = instants - piece.lines.travel_time[line]
        gone = np.where(then < 0.0, then * power[0], np.interp(then, instants, total))
        held = held + (total - gone) - (total - gone)[0]
    return held[1:]


def _summed(parts: list[dict[str, Array]]) -> dict[str, Array]:
    return {name: np.cumsum(np.concatenate([part[name] for part in parts])) for name in parts[0]}
