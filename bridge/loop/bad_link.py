"""Plant and controller with a bad link between them: scans on their way out, commands on their way in."""

from collections.abc import Iterator
from typing import Any, NamedTuple

from bridge.loop.fault_clock import Spell
from bridge.loop.inlet import Inlet
from bridge.loop.link_faults import Way
from bridge.scenario.faults import PlannedFault
from bridge.wire.codec import ValveCommand
from controller.grid import Sampling, is_sample, next_sample

REMEMBERED = 10_000  # scans whose arrival is remembered while no command answers them


class Scan(NamedTuple):
    """What the card read at a tick."""

    tick: int
    stamp: int  # [ns], as the message says it
    reading: dict[str, float]
    further: Any  # the further channels' numbers; None without any


class Coming(NamedTuple):
    """A command that is on its way."""

    command: Any
    faulty: bool  # has a fault had to do with it?


class BadLink:
    """Both directions, with the faults of a run."""

    def __init__(self, seed: int, grid: Sampling, inlet: Inlet, now: int) -> None:
        """now: since when the link may be bad [ns]."""
        self._grid = grid
        self._inlet = inlet
        self._out = Way(seed, "measurement", grid.daq)
        self._in = Way(seed, "command", grid.daq)
        self._heard_at: dict[int, int] = {}  # stamp of a scan -> when the controller had it [ns]
        self._newest = -1  # stamp of the newest sample that the controller has [ns]
        self._open = {*_samples(inlet.answered + 1, now, grid)}  # stamps of those that it has not answered
        self._kept = 0  # samples without a command because of a fault
        self._refused = 0

    def start(self, spell: Spell) -> None:
        """A fault of the link is going to be there."""
        (self._out if spell.fault.part == "measurement" else self._in).start(spell)

    def end(self, fault: PlannedFault, now: int) -> None:
        """End a fault of the link at an instant [ns]."""
        (self._out if fault.part == "measurement" else self._in).end(fault, now)

    def through(self, scan: Scan, now: int) -> Iterator[Scan]:
        """Send a scan; those that the controller hears now."""
        fate, daq = self._out.send(scan.tick, now), self._grid.daq
        if not fate.arrivals:
            self._kept += is_sample(scan.stamp, self._grid)
        for arrival in fate.arrivals:
            self._out.put(arrival, scan._replace(stamp=scan.stamp + round(fate.shift / daq) * daq))
        for arrival, heard in self._out.arrived(now):
            self._note(arrival, heard)
            yield heard

    def take(self, command: Any, now: int) -> None:
        """Send a command; it is offered to the plant when it is there."""
        sample: int = command.sample_stamp
        self._open.discard(sample)
        self._inlet.note_answer(command, now)
        sent: int = self._heard_at.get(sample, sample)
        fate = self._in.send(command.sequence, sent)
        if not fate.arrivals:
            self._kept += 1
            self._inlet.lose(command)
        faulty = sent != sample or fate != ((sent,), 0)
        given = _ahead(command, fate.shift, self._grid.step) if fate.shift else command
        for arrival in fate.arrivals:
            self._in.put(arrival, Coming(given, faulty))

    def offer(self, now: int) -> None:
        """Hand in the commands that are there when the block that begins now is integrated."""
        daq = self._grid.daq
        for arrival, (command, faulty) in self._in.arrived(now):
            there = max(0, -(-arrival // daq) - 1) * daq  # beginning of the block in which it came
            given = _moved(command, there) if command.apply_at < there and faulty else command
            self._refused += not self._inlet.offer(given, now) and faulty

    def awaited(self, now: int, prompt: bool) -> int | None:
        """Stamp of the first sample that the next block cannot do without; None when it has all.

        prompt: every command must be heard at its sample.
        """
        end = now + 1 if prompt else now + self._grid.daq - self._grid.delay
        return min((stamp for stamp in self._open if stamp < end), default=None)

    def unanswered(self) -> bool:
        """Has the controller a sample that it has not answered?"""
        return bool(self._open)

    def counts(self) -> dict[str, int]:
        """Messages by what became of them; `missing`, `refused`: commands that were so because of a fault."""
        way = len(self._in) + len(self._open)
        own = {"missing": self._kept + way, "refused": self._refused}
        return {name: count for name, count in {**self._out.counts, **self._in.counts, **own}.items() if count}

    def _note(self, arrival: int, heard: Scan) -> None:
        first = heard.stamp not in self._heard_at
        self._heard_at[heard.stamp] = arrival
        if len(self._heard_at) > REMEMBERED:
            del self._heard_at[next(iter(self._heard_at))]
        if not is_sample(heard.stamp, self._grid):
            return
        if heard.stamp > self._newest:
            self._open.add(heard.stamp)
            self._newest = heard.stamp
        elif first:
            self._kept += 1  # a newer sample has overtaken it


def _samples(begin: int, end: int, grid: Sampling) -> Iterator[int]:
    """Stamps of the samples in [begin, end)."""
    stamp = next_sample(begin, grid)
    while stamp < end:
        yield stamp
        stamp += grid.sample


def _moved(command: Any, apply_at: int) -> Any:
    return ValveCommand(**vars(command) | {"apply_at": apply_at})


def _ahead(command: Any, shift: int, step: int) -> Any:
    """A command of a clock that is ahead by some time [ns]: to whole steps."""
    ahead = round(shift / step) * step
    return ValveCommand(
        **vars(command) | {"sample_stamp": command.sample_stamp + ahead, "apply_at": command.apply_at + ahead}
    )
