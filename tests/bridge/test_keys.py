"""`hydrotwin keys`: what it makes, and that on the network each role can do its part and nothing else."""

import re
import shutil
import stat
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import zenoh

from bridge.machine import certificates
from bridge.wire.access import MEMBERS, SAVING, Role, rights
from bridge.wire.limits import MESSAGE
from bridge.wire.link import Link, LinkError, free_endpoint, open_session
from bridge.wire.messages import TOPICS
from tests.support.command import hydrotwin_here
from tests.support.processes import wait_for

QUERIES = "scenario", "parameters", "parameters/set", "fault"
PUTS = *TOPICS, "target"
CHANGING = "command", "reset", "target", "parameters/set", "fault"  # what changes what the rig does


class Net(NamedTuple):
    """A router with the keys of a folder, and what a plant on it hears."""

    folder: Path
    endpoint: str
    heard: set[tuple[str, str]]  # sender, key below the rig's

    def join(self, name: str) -> Any:
        return open_session(Link(None, self.endpoint, self.folder / f"{name}.json5", 5.0))


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    home = tmp_path_factory.mktemp("home")
    done = hydrotwin_here("keys", "new", cwd=home)
    assert done.returncode == 0, done.stderr
    return home / "new"


@pytest.fixture(scope="module")
def net(folder) -> Iterator[Net]:
    """The plant's session answers its queries and hears all puts; a payload names its sender."""
    net = Net(folder, free_endpoint().replace("tcp/", "tls/"), set())

    def hear(message: Any) -> None:
        sender = message.payload.to_bytes().decode()[:20].strip()
        net.heard.add((sender, str(message.key_expr).removeprefix("rig/")))

    def answer(query: Any) -> None:
        hear(query)
        query.reply(query.key_expr, b"done")

    with ExitStack() as stack:
        stack.enter_context(open_session(Link(net.endpoint, None, folder / "router.json5", 5.0), mode="router"))
        plant = stack.enter_context(net.join("plant"))
        heard = plant.declare_subscriber("rig/**", zenoh.handlers.Callback(hear, indirect=False))
        answers = [plant.declare_queryable(f"rig/{q}", zenoh.handlers.Callback(answer, indirect=True)) for q in QUERIES]
        yield net
        for declared in (heard, *answers):
            declared.undeclare()


def try_everything(net: Net, session: Any, sender: str) -> set[str]:
    """Put on every key of a rig, and ask everything; what the plant has heard of it."""
    for key in PUTS:
        session.put(f"rig/{key}", sender, congestion_control=zenoh.CongestionControl.BLOCK)
    for key in QUERIES:
        list(session.get(f"rig/{key}", payload=sender, timeout=0.3))
    time.sleep(0.2)
    return {key for who, key in net.heard if who == sender}


@pytest.mark.parametrize("role", [role for role in MEMBERS if role is not Role.PLANT])
def test_a_role_is_heard_where_it_has_the_right_and_nowhere_else(net, role):
    with net.join(role) as session:
        wait_for(lambda: list(session.get("rig/scenario", payload="waits", timeout=0.5)), 5.0)
        heard = try_everything(net, session, role)
    puts, queries, _ = rights(role)
    assert heard == {*puts, *queries, "scenario", "parameters"} - {SAVING}  # the recorder hears that


def test_only_the_controller_commands_and_only_the_operator_changes():
    """The table of rights in words."""
    may = {role: {*rights(role).puts, *rights(role).queries} & set(CHANGING) for role in Role}
    assert may == {
        Role.ROUTER: set(),
        Role.PLANT: set(),
        Role.CONTROLLER: {"command"},
        Role.OPERATOR: {"reset", "target", "parameters/set", "fault"},
        Role.RECORDER: set(),
        Role.VIEWER: set(),
        Role.FOLLOWER: set(),
    }


def test_every_message_of_the_table_has_one_role_that_may_send_it():
    """`status` is everybody's; a replay has no rights on a guarded rig."""
    for topic in TOPICS.values():
        senders = [role for role in Role if topic.name in rights(role).puts]
        assert len(senders) == {"status": 4, "residual": 0}.get(topic.name, 1), topic.name


def test_what_may_not_be_asked_gets_no_answer(net):
    with net.join("viewer") as session:
        assert list(session.get("rig/parameters", payload="curious", timeout=2.0))
        assert not [reply for reply in session.get("rig/fault", payload="curious", timeout=0.3) if reply.ok]


def test_a_message_that_is_too_long_is_not_passed_on(net):
    with net.join("controller") as session:
        for sender, length in (("short", MESSAGE), ("long", MESSAGE + 1)):
            session.put("rig/command", sender.ljust(length), congestion_control=zenoh.CongestionControl.BLOCK)
        wait_for(lambda: ("short", "command") in net.heard, 5.0)
        session.put("rig/command", "later", congestion_control=zenoh.CongestionControl.BLOCK)
        wait_for(lambda: ("later", "command") in net.heard, 5.0)
    assert ("long", "command") not in net.heard


def test_a_name_and_a_certificate_of_two_roles_have_no_rights(net):
    """Who steals the controller's password still needs its key, and the other way round."""
    texts = {role: (net.folder / f"{role}.json5").read_text() for role in ("viewer", "controller")}
    for sender, mine, stolen in (("password", "viewer", "controller"), ("key", "controller", "viewer")):
        login = re.search(r'"usrpwd": \{.*?\}', texts[stolen], re.DOTALL)
        assert login
        (net.folder / f"{sender}-mixed.json5").write_text(
            re.sub(r'"usrpwd": \{.*?\}', login[0], texts[mine], flags=re.DOTALL)
        )
        with net.join(f"{sender}-mixed") as session:
            assert try_everything(net, session, sender) == set()


def test_a_certificate_of_another_authority_does_not_connect(net, tmp_path):
    """Same names, same password, same trust in the router's authority: only the signature differs."""
    assert hydrotwin_here("keys", "other", cwd=tmp_path).returncode == 0
    ours, theirs = ((folder / "controller.json5").read_text() for folder in (net.folder, tmp_path / "other"))
    pattern = r'"connect_certificate_base64": ".*",\n +"connect_private_key_base64": ".*"'
    own = re.search(pattern, theirs)
    assert own
    (net.folder / "foreign.json5").write_text(re.sub(pattern, own[0], ours))
    with pytest.raises(LinkError, match="nobody answers"):
        open_session(Link(None, net.endpoint, net.folder / "foreign.json5", 1.0))


def test_a_connection_without_encryption_is_refused(net):
    with pytest.raises(LinkError, match="nobody answers"):
        open_session(Link(None, net.endpoint.replace("tls/", "tcp/"), None, 1.0))


def test_only_the_owner_may_read_what_it_makes(folder):
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    modes = {path.name: stat.S_IMODE(path.stat().st_mode) for path in folder.iterdir() if "-mixed" not in path.name}
    assert {mode for name, mode in modes.items() if name != "foreign.json5"} == {0o600}
    assert (folder / ".gitignore").read_text() == "*\n"


def test_nothing_is_ever_overwritten(folder):
    before = {path: path.read_bytes() for path in folder.iterdir()}
    done = hydrotwin_here("keys", "new", cwd=folder.parent)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "hydrotwin: new exists: keys are never overwritten; name a new folder\n"
    assert {path: path.read_bytes() for path in folder.iterdir()} == before


@pytest.mark.parametrize(
    ("option", "value", "words"),
    [
        ("--host", "rig pc", "--host 'rig pc': write a name or an address, such as rig-pc.lab or 192.168.1.20"),
        ("--host", "x\nbasicConstraints=CA:TRUE", "--host 'x\\nbasicConstraints=CA:TRUE': write a name"),
        ("--rig", "**", "--rig '**': write the rig_name of a scenario"),
    ],
)
def test_a_name_that_would_mean_more_is_refused(tmp_path, option, value, words):
    done = hydrotwin_here("keys", "new", option, value, cwd=tmp_path)
    assert done.returncode == 2
    assert words in done.stderr
    assert not list(tmp_path.iterdir())


def test_without_openssl_nothing_is_left_behind(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path / "nowhere"))
    assert shutil.which("openssl") is None
    done = hydrotwin_here("keys", "new", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (1, f"hydrotwin: {certificates.MISSING}\n")
    assert not (tmp_path / "new").exists()


def test_other_rigs_and_hosts_stand_in_files_and_commands(tmp_path):
    done = hydrotwin_here("keys", "new", "--host", "10.0.0.7", "--rig", "press", "--rig", "lab/b", cwd=tmp_path)
    assert "--connect tls/10.0.0.7:7447" in done.stdout
    assert "step --set rig_name=press" in done.stdout
    text = (tmp_path / "new/router.json5").read_text()
    assert '"press/command"' in text
    assert '"lab/b/command"' in text
    assert '"rig/command"' not in text
