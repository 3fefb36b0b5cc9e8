"""The container files, as far as they can be checked without an engine."""

import json
import re
from fnmatch import fnmatch
from pathlib import PurePosixPath
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
    return yaml.safe_load(re.sub(r"\$\{SCENARIO:-(\w+)\}", lambda match: scenario or match[1], COMPOSE))


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
        assert services[name]["depends_on"] == ["router"]
    assert options["plant"]["scenario"] == options["controller"]["scenario"] == "square"
    assert sorted(options["plant"]["partners"]) == ["controller", "recorder"]


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
