"""The container files, as far as they can be checked without an engine."""

import json
import re
import socket
from fnmatch import fnmatch
from pathlib import Path, PurePosixPath
from typing import Any

import pytest
import typer
import yaml

from bridge.cli.verbs import app
from tests.support.processes import ROOT

DOCKERFILE = (ROOT / "docker" / "Dockerfile").read_text().replace("\\\n", "")
COMPOSE = (ROOT / "docker" / "compose.yaml").read_text()
SERVICES = ("router", "plant", "controller", "recorder", "viewer")


def compose(scenario: str = "") -> dict[str, Any]:
    """The compose file as an engine sees it, with SCENARIO set or left out."""
    text = re.sub(r"\$\{SCENARIO:-(\w+)\}", lambda match: scenario or match[1], COMPOSE)
    return yaml.safe_load(re.sub(r"\$\{ADDRESS:-([\d.]+)\}", r"\1", text))


def parsed(arguments: list[str]) -> dict[str, Any]:
    """The options that the command line makes of them, without running anything. Raises for what it does not know."""
    group: Any = typer.main.get_command(app)
    with group.make_context("hydrotwin", list(arguments)) as context:
        name, command, rest = group.resolve_command(context, list(arguments))
        return command.make_context(name, rest, parent=context).params


def instructions(name: str) -> list[str]:
    return re.findall(rf"^{name} (.+)$", DOCKERFILE, re.MULTILINE)


def test_compose_has_every_role():
    assert sorted(compose()["services"]) == sorted(SERVICES)


@pytest.mark.parametrize("service", SERVICES)
def test_the_command_line_takes_what_a_service_says(service):
    assert parsed(compose()["services"][service]["command"])


def test_a_mistyped_option_would_be_seen():
    with pytest.raises(Exception, match="No such option"):
        parsed(["router", "--listn", "tcp/0.0.0.0:7447"])


def test_all_meet_at_the_router_and_play_the_same_scenario():
    services = compose("square")["services"]
    options = {name: parsed(service["command"]) for name, service in services.items()}
    port = options["router"]["listen"].rpartition(":")[2]
    for name in ("plant", "controller", "recorder"):
        assert options[name]["connect"] == f"tcp/router:{port}"
        assert services[name]["depends_on"] == {"router": {"condition": "service_healthy"}}
    assert options["plant"]["scenario"] == options["controller"]["scenario"] == "square"
    assert sorted(options["plant"]["partners"]) == ["controller", "recorder"]


@pytest.mark.parametrize("service", SERVICES)
def test_a_service_can_write_its_volumes_and_nothing_else_as_a_user_without_rights(service):
    found = compose()["services"][service]
    assert found["user"] == "1000:1000"
    assert "useradd --create-home --uid 1000 hydrotwin" in DOCKERFILE
    assert found["read_only"] is True
    assert found["cap_drop"] == ["ALL"]
    assert "no-new-privileges:true" in found["security_opt"]
    assert "privileged" not in found


def test_only_the_routers_port_is_published_and_on_this_machine_alone():
    published = {name: service["ports"] for name, service in compose()["services"].items() if "ports" in service}
    assert published == {"router": ["127.0.0.1:7447:7447"]}


@pytest.mark.parametrize("service", [name for name in SERVICES if name != "viewer"])
def test_a_health_check_sees_a_connection_to_the_routers_port(service):
    """In the kernel's table: hexadecimal port and state, 0A for listening, 01 for connected."""
    check = compose()["services"][service]["healthcheck"]["test"]
    assert check[:3] == ["CMD", "grep", "--quiet"]
    with socket.create_server(("127.0.0.1", 0)) as door:
        port = f":{door.getsockname()[1]:04X} "
        wanted = check[3].replace(":1D17 ", port)
        assert int("1D17", 16) == 7447
        listens = service == "router"
        assert (wanted in Path("/proc/net/tcp").read_text()) == listens
        with socket.create_connection(door.getsockname()):
            assert wanted in Path("/proc/net/tcp").read_text()


def test_the_viewer_shows_what_the_recorder_wrote_in_the_volume():
    services = compose()["services"]
    written = parsed(services["recorder"]["command"])["output"]
    assert parsed(services["viewer"]["command"])["file"] == written
    for name in ("recorder", "viewer"):
        volume, folder = services[name]["volumes"][0].split(":")[:2]
        assert folder == str(PurePosixPath(written).parent)
        assert volume in compose()["volumes"]
    assert f"--group hydrotwin {PurePosixPath(written).parent}" in DOCKERFILE


def test_every_service_uses_the_one_image():
    services = compose()["services"]
    assert {service["image"] for service in services.values()} == {"hydrotwin"}
    (build,) = [service["build"] for service in services.values() if "build" in service]
    folder = ROOT / "docker"
    assert (folder / build["context"]).resolve() == ROOT
    assert (folder / build["context"] / build["dockerfile"]).is_file()


def test_the_dockerfile_copies_only_what_is_there_and_sent_to_the_engine():
    lines = (ROOT / ".dockerignore").read_text().splitlines()
    sent = [line[1:] for line in lines if line.startswith("!")]
    copied = [name for line in instructions("COPY") if "--from" not in line for name in line.split()[:-1]]
    assert sorted(copied) == sorted(sent)
    assert [name for name in copied if not (ROOT / name).exists()] == []
    packages = re.search(r"^packages = (\[.+\])$", (ROOT / "pyproject.toml").read_text(), re.MULTILINE)
    assert packages is not None
    assert set(json.loads(packages[1])) <= set(copied)
    assert not [name for name in copied if any(fnmatch(name, line) for line in lines[2:] if not line.startswith("!"))]


def test_the_image_checks_hashes_drops_root_and_runs_the_command():
    runs = "\n".join(instructions("RUN"))
    assert "--require-hashes --requirement requirements.lock" in runs
    assert json.loads(instructions("ENTRYPOINT")[-1]) == ["hydrotwin"]
    last_stage = DOCKERFILE.rpartition("\nFROM ")[2]
    assert last_stage.index("USER hydrotwin") < last_stage.index("ENTRYPOINT")
    (first_run,) = [json.loads(line) for line in instructions("RUN") if line.startswith('["hydrotwin"')]
    assert parsed(first_run[1:])["mode"] == "inprocess"
