"""Networks at work: a router; certificates, passwords and access control of `hydrotwin keys`."""

import json
import re
import subprocess
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
import zenoh

from bridge.recording.reader import Recording, read
from bridge.wire.codec import decode
from bridge.wire.link import (
    Link,
    free_endpoint,
    names_addresses,
    open_session,
)
from tests.support.command import hydrotwin_here
from tests.support.processes import (
    COARSE,
    ROOT,
    hydrotwin,
    started,
    wait_for,
)

NETWORK = ROOT / "examples" / "network"
SECONDS = 1.5
NOISE = b"no command at all"


@pytest.fixture(scope="module")
def secured(tmp_path_factory) -> Path:
    """A folder with fresh keys in it."""
    folder = tmp_path_factory.mktemp("secured")
    done = hydrotwin_here("keys", "keys", cwd=folder)
    assert done.returncode == 0, done.stderr
    return folder


def tls_endpoint() -> str:
    return free_endpoint().replace("tcp/", "tls/")


def user(name: str) -> tuple[str, ...]:
    """What a user adds to the command line."""
    return ("--zenoh-config", f"keys/{name}.json5")


def listening(endpoint: str, file: str) -> tuple[str, ...]:
    """What whoever listens adds to the command line."""
    return ("--listen", endpoint, "--zenoh-config", f"keys/{file}")


def run_apart(
    folder: Path, mode: str, plant: tuple[str, ...], others: dict[str, tuple[str, ...]], changes: tuple[str, ...] = ()
) -> Recording:
    """Plant, controller and recorder as processes of their own; all must end well and in time."""
    path = folder / "run.mcap"
    awaited = ("--await", "controller", "--await", "recorder", "--set", f"duration={SECONDS}", *changes)
    commands = [
        ("plant", "step", *awaited, *plant),
        ("record", "--output", str(path), *others["recorder"]),
        ("controller", "step", *changes, *others["controller"]),
    ]
    with ExitStack() as stack:
        for process in [stack.enter_context(started(*command, "--mode", mode, cwd=folder)) for command in commands]:
            assert process.wait(60) == 0, process.communicate()[0]
    return read(path)


def assert_whole(recording: Recording, daq_hz: int = 1000) -> None:
    """Every tick and every sample is there, and nobody announced more than has come."""
    summary = recording.metadata["summary"]
    ticks = round(SECONDS * daq_hz)
    assert summary["ending"] == f"complete after {ticks} ticks"
    assert summary["lost"] == {}
    assert summary["messages"]["measurement"] == summary["messages"]["state"] == ticks + 1
    assert summary["commands"]["sent"] == summary["messages"]["reference"] == round(SECONDS * 100) + 1


@pytest.mark.timed
def test_a_router_carries_a_real_time_run_without_loss(tmp_path):
    endpoint = free_endpoint()
    text = (NETWORK / "router.json5").read_text()
    assert text.count("tcp/0.0.0.0:7447") == 1
    (tmp_path / "router.json5").write_text(text.replace("tcp/0.0.0.0:7447", endpoint))
    connect = ("--connect", endpoint)
    with started("router", "--zenoh-config", "router.json5", cwd=tmp_path):
        others = {"recorder": connect, "controller": connect}
        assert_whole(run_apart(tmp_path, "realtime", connect, others, COARSE), daq_hz=100)


def test_a_router_carries_an_encrypted_run_of_users_with_passwords(secured):
    endpoint = tls_endpoint()
    names = ("plant", "recorder", "controller")
    known = {name: ("--connect", endpoint, *user(name)) for name in names}
    with started("router", *listening(endpoint, "router.json5"), cwd=secured):
        assert_whole(run_apart(secured, "lockstep", known["plant"], known))


def test_a_plant_with_access_control_lets_each_role_do_its_part(secured):
    """Here the plant itself listens and guards its keys."""
    endpoint = tls_endpoint()
    known = {name: ("--connect", endpoint, *user(name)) for name in ("recorder", "controller")}
    assert_whole(run_apart(secured, "lockstep", listening(endpoint, "plant-listening.json5"), known))


def test_who_may_watch_may_not_tune(secured):
    """The operator sets a number; the recorder's user reads it, and is not heard when it sets one."""
    endpoint = tls_endpoint()
    with started("plant", "step", "--set", "duration=60", *listening(endpoint, "plant-listening.json5"), cwd=secured):
        tries = ("--connect", endpoint, *user("operator"))
        done = wait_for(lambda: well(hydrotwin_here("set", "rig", "rig.load.force=100 N", *tries, cwd=secured)), 30)
        assert "rig.load.force = 100" in done.stdout
        watch = ("--connect", endpoint, *user("recorder"))
        read_out = hydrotwin_here("get", "rig", "rig.load.force", "--json", *watch, cwd=secured)
        assert json.loads(read_out.stdout)["parameters"][0]["value"] == 100.0
        denied = hydrotwin_here("set", "rig", "rig.load.force=200 N", *watch, cwd=secured)
        assert denied.returncode == 1
        assert "no plant of rig 'rig' answers" in denied.stderr
        read_out = hydrotwin_here("get", "rig", "rig.load.force", "--json", *tries, cwd=secured)
        assert json.loads(read_out.stdout)["parameters"][0]["value"] == 100.0


def well(done: subprocess.CompletedProcess[str]) -> subprocess.CompletedProcess[str] | None:
    return done if done.returncode == 0 else None


@pytest.mark.parametrize(
    ("pattern", "instead"),
    [
        (r'"password": ".*"', '"password": "guessed"'),
        (r'"user": ".*?"', '"user": "somebody"'),
        (r'"root_ca_certificate_base64": ".*",', ""),
        (r'"connect_(certificate|private_key)_base64": ".*",', ""),
    ],
    ids=["password", "user", "authority", "certificate"],
)
def test_what_does_not_fit_is_refused_in_one_line(secured, pattern, instead):
    """A wrong password, an unknown user, a client that does not know the authority, one without a certificate."""
    good = (secured / "keys/recorder.json5").read_text()
    bad = re.sub(pattern, instead, good)
    assert bad != good
    (secured / "keys/bad.json5").write_text(bad)
    endpoint = tls_endpoint()
    with started("router", *listening(endpoint, "router.json5"), cwd=secured), session(secured, endpoint, "recorder"):
        done = hydrotwin("record", "--connect", endpoint, *user("bad"), "--patience", "1", cwd=secured, timeout=20)
    assert done.returncode == 1
    assert done.stdout == ""
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"hydrotwin: nobody answers at {endpoint} within 1 s, or refuses the name, password")


def session(folder: Path, endpoint: str, name: str) -> Any:
    """A user's own session."""
    return open_session(Link(None, endpoint, folder / f"keys/{name}.json5", 15.0))


def test_only_the_controller_reaches_the_valve(secured):
    """The same bytes on the same key: the plant counts those of the controller, and of others sees nothing."""
    endpoint = tls_endpoint()
    plant = ("plant", "step", "--set", "duration=60", "--speed", "0.1", *listening(endpoint, "plant-listening.json5"))
    with (
        started(*plant, cwd=secured),
        session(secured, endpoint, "recorder") as outsider,
        session(secured, endpoint, "controller") as controller,
    ):
        statuses: list[dict[str, float]] = []
        keep = controller.declare_subscriber("rig/status", lambda sample: statuses.append(values(sample)))
        wait_for(lambda: statuses, 15.0)
        for key in ("rig/command", "rig/comman$*", "rig/**"):
            for _ in range(20):
                outsider.put(key, NOISE, congestion_control=zenoh.CongestionControl.BLOCK)
        told = len(statuses)
        wait_for(lambda: len(statuses) > told + 3, 10.0)
        assert not [status for status in statuses if refused(status)]
        controller.put("rig/command", NOISE)
        assert wait_for(lambda: refused(statuses[-1]), 10.0) == {"refused/undecodable": 1.0}
        keep.undeclare()


def values(sample: Any) -> dict[str, float]:
    status = decode(sample.payload.to_bytes(), "status")
    return dict(zip(status.names, (float(value) for value in status.values), strict=True))


def refused(status: dict[str, float]) -> dict[str, float]:
    return {name: value for name, value in status.items() if name.startswith("refused/")}


def test_a_router_without_addresses_in_its_file_listens_where_it_is_told(tmp_path):
    """So that one file serves routers and plants on any address."""
    assert names_addresses(NETWORK / "router.json5")
    endpoint = free_endpoint()
    (tmp_path / "empty.json5").write_text("{}")
    assert not names_addresses(tmp_path / "empty.json5")
    router = ("router", "--listen", endpoint, "--zenoh-config", "empty.json5")
    with started(*router, cwd=tmp_path), open_session(Link(None, endpoint, None, 15.0)) as opened:
        assert len(list(opened.info.routers_zid())) == 1


def test_a_mistake_in_a_configuration_is_told_in_one_line(tmp_path):
    (tmp_path / "wrong.json5").write_text(json.dumps({"scoutin": {}}))
    done = hydrotwin("router", "--zenoh-config", "wrong.json5", cwd=tmp_path, timeout=20)
    assert done.returncode == 1
    (line,) = done.stderr.splitlines()
    assert line.startswith("hydrotwin: wrong.json5: ")
    assert "scoutin" in line
