"""Plant and recorder on one side of a network, the controller on the other: cuts, delays and losses against our faults.

The network is a cable between two namespaces of the kernel, or a relay between two processes on loopback.
"""

import statistics
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np
import pytest

from bridge.recording.reader import Recording
from bridge.recording.summarise import known_or_made
from bridge.runs.in_process import run_in_memory
from bridge.scenario import load
from bridge.wire.link import free_endpoint
from controller.bands import Metrics
from tests.support.namespaces import NEAR, Hosts, RefusedError, two_hosts
from tests.support.relay import BadNetwork, Delay, relayed
from tests.support.two_sides import Side, Sides, run_between, spells

LOOSE = ["real_time.overruns=1.0", "real_time.length=100", "real_time.late_commands=1.0", "allowed.safe_states=9"]
TIMEOUT = 0.2  # [s] of silence, after which the plant goes to its safe state
CUT = [*LOOSE, f"loop.command_timeout={TIMEOUT}", "loop.after_timeout=resume"]
QUICK = ["duration=1.7", "reference.at=0.4", "controller.gain=0.4 V/%", "expect=[]", "loop.command_timeout=1.0"]
FAR_AWAY = Delay(20e-3, 10e-3)  # each way, in simulated time
SPEED = 0.25  # of the plant's clock where delays are compared: what the machine itself is late counts as much less
LOST = 0.2  # share, each way
LOSSY = 1.1  # [s] of simulated time that it lasts
EARLIEST, LATEST = 0.45, 1.15  # [s], within that
WAYS = ("measurement", "command")
COMPARED = ("rise_time", "settling_time", "rms_error", "max_error", "overshoot", "valve_travel")
SLACK = 1.5  # of the ten seeds' range, to either side of its middle, beside what the machine's own lateness adds
ONE_RUN = 4.0  # of losses: few of them happen to be where it matters, so their share is the sharper judge
OWN = {"rise_time": 10e-3, "settling_time": 60e-3, "rms_error": 1e-3, "max_error": 1e-3, "overshoot": 0.03}


@pytest.fixture
def hosts() -> Iterator[Hosts]:
    with ExitStack() as stack:
        try:
            made = stack.enter_context(two_hosts())
        except RefusedError as error:
            pytest.skip(f"no namespaces here: {error}")
        yield made


def apart(hosts: Hosts) -> Sides:
    """The plant listens on the cable."""
    here, endpoint = hosts.inside(hosts.near), f"tcp/{NEAR}:7447"
    reached = ("--connect", endpoint)
    return Sides(Side(("--listen", endpoint), here), Side(reached, here), Side(reached, hosts.inside(hosts.far)))


@contextmanager
def by_relay(network: BadNetwork, protocol: str = "tcp") -> Iterator[Sides]:
    """The recorder reaches the plant without the relay."""
    endpoint = free_endpoint().replace("tcp/", f"{protocol}/")
    with relayed(endpoint, network) as bad:
        yield Sides(Side(("--listen", endpoint)), Side(("--connect", endpoint)), Side(("--connect", bad)))


def pull(hosts: Hosts, seconds: float) -> None:
    """Pull the cable for some time."""
    hosts.set_link("down")
    time.sleep(seconds)
    hosts.set_link("up")


def outages(recording: Recording) -> list[tuple[float, float]]:
    """Spells in the safe state; what arrives in one burst after a cut may leave it and enter it again."""
    joined: list[tuple[float, float]] = []
    for begin, end in spells(recording):
        if joined and begin - joined[-1][1] < 0.3:
            joined[-1] = (joined[-1][0], end)
        else:
            joined.append((begin, end))
    return joined


def assert_ticks(recording: Recording) -> None:
    """Every tick was integrated and recorded."""
    ticks = recording.columns("state")["tick"]
    assert np.array_equal(ticks, np.arange(len(ticks)))
    assert len(ticks) == round(recording.scenario().duration * 1000) + 1


@pytest.mark.timed
def test_a_cable_pulled_for_a_moment_is_bridged_and_for_longer_stops_the_valve(hosts: Hosts, tmp_path: Path):
    """50 ms: the last command holds. 500 ms: the safe state after the time-out, until soon after the cable is back."""

    def cuts() -> None:
        for wait, seconds in ((0.5, 0.05), (1.0, 0.5)):
            time.sleep(wait)
            pull(hosts, seconds)

    recording = run_between(apart(hosts), tmp_path / "a.mcap", [*CUT, "duration=4"], cuts)
    assert_ticks(recording)
    ((begin, end),) = outages(recording)
    assert end - begin == pytest.approx(0.5 - TIMEOUT, abs=0.25)


@pytest.mark.endurance
@pytest.mark.timeout(600)
@pytest.mark.parametrize("seconds", [0.05, 0.5, 5.0])
def test_a_pulled_cable_against_our_freeze(hosts: Hosts, tmp_path: Path, seconds: float):
    assert_cut_like_freeze(apart(hosts), lambda: pull(hosts, seconds), seconds, tmp_path, "cable")


@pytest.mark.endurance
@pytest.mark.timeout(600)
@pytest.mark.parametrize("seconds", [0.05, 0.5, 5.0])
def test_a_cut_relay_against_our_freeze(tmp_path: Path, seconds: float):
    network = BadNetwork()
    with by_relay(network) as sides:
        assert_cut_like_freeze(sides, lambda: network.cut(seconds), seconds, tmp_path, "relay")


def assert_cut_like_freeze(sides: Sides, cut: Callable[[], None], seconds: float, folder: Path, words: str) -> None:
    """As long in the safe state as with our own fault, and longer by what the answers to old samples take."""
    changes = [*CUT, f"duration={4.0 + seconds:g}"]

    def later() -> None:
        time.sleep(0.7)
        cut()

    run = run_between(sides, folder / "a.mcap", changes, later)
    assert_ticks(run)
    ours = run_in_memory(load("step", [*changes, _both(f'kind="freeze", at=1, lasts={seconds}')]))
    real, made = (sum(end - begin for begin, end in outages(one)) for one in (run, ours))
    print(f"{words} cut for {seconds:g} s: {real:.3f} s in the safe state, our freeze {made:.3f} s", flush=True)
    assert made - 0.2 <= real <= made + 0.4 + 0.5 * seconds


def _both(words: str) -> str:
    faults = [f'{{target="link.{way}", {words}}}' for way in WAYS]
    return f"fault=[{', '.join(faults)}]"


DELAYED = f'kind="delay", law="uniform", time={FAR_AWAY.time}, spread={FAR_AWAY.spread}, at=0'
LOSING = f'kind="loss", share={LOST}, at=0'


def metrics(recording: Recording) -> Metrics:
    found = known_or_made(recording, recording.scenario()).metrics
    assert found is not None
    return found


def seeds(fault: str, count: int = 10) -> list[Metrics]:
    """What our fault does, by seed."""
    changes = [*LOOSE, *QUICK, _both(fault)]
    runs = [run_in_memory(load("step", [*changes, f"seed={seed}"])) for seed in range(1, count + 1)]
    return [metrics(run) for run in runs]


def assert_alike(ours: list[Metrics], theirs: list[Metrics], words: str, wider: float = 1.0) -> None:
    """The mean over the real runs is within the spread of our seeds; wider: factor of what the machine may add."""
    for name in COMPARED:
        made, real = ([getattr(one, name) for one in runs] for runs in (ours, theirs))
        low, high, mean = min(made), max(made), statistics.fmean(real)
        print(f"{words} {name}: ours {low:.4g} .. {high:.4g}, real {min(real):.4g} .. {max(real):.4g}, mean {mean:.4g}")
        if name in OWN:
            room = (SLACK - 1.0) / 2.0 * (high - low) + wider * OWN[name]
            assert low - room <= mean <= high + room, name


def assert_answered(recording: Recording) -> None:
    """A sample is answered where both ways let it pass."""
    stamps = recording.columns("command")["sample_stamp"] / 1e9
    samples = round((LATEST - EARLIEST) * 100)
    share = np.sum((stamps > EARLIEST) & (stamps < LATEST)) / samples
    assert share == pytest.approx((1.0 - LOST) ** 2, abs=0.17)  # three standard deviations of so few


def through_relay(folder: Path, count: int, protocol: str) -> list[Metrics]:
    """Runs through a relay that delays what goes over TCP and drops what goes over UDP."""
    found = []
    for seed in range(count):
        network = BadNetwork(seed, Delay(*(each / SPEED for each in FAR_AWAY)) if protocol == "tcp" else Delay())
        with by_relay(network, protocol) as sides:
            changes = [*LOOSE, *QUICK, f"seed={seed + 1}"]

            def lose(network: BadNetwork = network) -> None:
                if protocol == "udp":
                    network.loss = LOST
                    time.sleep(LOSSY / SPEED)
                    network.loss = 0.0  # what the plant says last is sent once

            run = run_between(sides, folder / f"{protocol}{seed}.mcap", changes, lose, speed=SPEED)
        if protocol == "udp":
            assert 0.1 < network.dropped / (network.dropped + network.passed) < 0.3
            assert_answered(run)
        found.append(metrics(run))
    return found


@pytest.mark.endurance
@pytest.mark.timeout(300)
def test_a_relay_that_delays_does_what_our_delay_does(tmp_path: Path):
    """Over TCP, 20 +- 10 ms each way: the step's metrics are those of ten seeds of our fault."""
    assert_alike(seeds(DELAYED), through_relay(tmp_path, 1, "tcp"), "delay by relay")


@pytest.mark.endurance
@pytest.mark.timeout(300)
def test_a_relay_that_drops_datagrams_does_what_our_loss_does(tmp_path: Path):
    """Zenoh over UDP sends nothing again: 20 % are lost each way, so 64 % of the samples are answered."""
    assert_alike(seeds(LOSING), through_relay(tmp_path, 1, "udp"), "loss by relay", ONE_RUN)


@pytest.mark.endurance
@pytest.mark.timeout(1200)
@pytest.mark.parametrize(("protocol", "fault"), [("tcp", DELAYED), ("udp", LOSING)])
def test_ten_runs_through_a_relay_are_ten_seeds(tmp_path: Path, protocol: str, fault: str):
    assert_alike(seeds(fault), through_relay(tmp_path, 10, protocol), f"{protocol} relay")


@pytest.mark.timed
def test_netem_delays_as_our_fault(hosts: Hosts, tmp_path: Path):
    """`tc netem delay` on both ends of a cable, where the kernel has it."""
    _shaped(hosts, "netem", "delay", *(f"{each / SPEED * 1e3:g}ms" for each in FAR_AWAY))
    run = run_between(apart(hosts), tmp_path / "a.mcap", [*LOOSE, *QUICK], speed=SPEED)
    assert_alike(seeds(DELAYED), [metrics(run)], "delay by netem")


@pytest.mark.timed
def test_netem_loses_datagrams_as_our_fault(hosts: Hosts, tmp_path: Path):
    """`tc netem loss 20%` on both ends of a cable, Zenoh over UDP, where the kernel has it."""
    _shaped(hosts, "netem", "loss", "0%")
    sides = Sides(*(side._replace(address=(side.address[0], f"udp/{NEAR}:7447")) for side in apart(hosts)))

    def lose() -> None:
        hosts.shape("netem", "loss", f"{100 * LOST:g}%")
        time.sleep(LOSSY / SPEED)
        hosts.shape("netem", "loss", "0%")

    run = run_between(sides, tmp_path / "a.mcap", [*LOOSE, *QUICK], lose, speed=SPEED)
    assert_answered(run)
    assert_alike(seeds(LOSING), [metrics(run)], "loss by netem", ONE_RUN)


def _shaped(hosts: Hosts, *words: str) -> None:
    try:
        hosts.shape(*words)
    except RefusedError as error:
        pytest.skip(f"the relay's tests stand in for it: {error}")
