"""The image's steps and the compose file's commands in a clean Debian root, without a container engine.

    sudo python docker/without_engine.py FOLDER [--suite bookworm] [--scenario step] [--seconds 3]

A root is made in FOLDER by debootstrap, each instruction of the Dockerfile is carried out in a copy of it (chroot in a
mount namespace), and then the services of the compose file run as it says: as its user, on a root mounted read-only,
with its tmpfs and volumes, in a network namespace of their own, one after another as their health checks allow.
Needs root, debootstrap, unshare, iproute2 and PyYAML. FOLDER may be deleted afterwards; nothing else is touched.
"""

import argparse
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

import yaml

HERE = Path(__file__).parent
PYTHON = "python3,python3-venv,python-is-python3,ca-certificates"  # what the image's base has beside a Debian
CERTIFICATES = Path("/etc/ssl/certs/ca-certificates.crt")
PATIENCE = 120.0  # [s] until a service is healthy, or has ended
CAPABILITIES = "-all"  # what `cap_drop: [ALL]` leaves


class Stage(NamedTuple):
    """A root with what the Dockerfile has said of it so far."""

    root: Path
    environment: dict[str, str]


def instructions(text: str) -> list[tuple[str, str]]:
    """Of a Dockerfile, in order."""
    joined = text.replace("\\\n", " ")
    lines = [line.strip() for line in joined.splitlines() if line.strip() and not line.startswith("#")]
    return [(word, rest.strip()) for word, _, rest in (line.partition(" ") for line in lines)]


def build(folder: Path, suite: str) -> Stage:
    """The image: the root of the last stage."""
    base = folder / "base"
    if not base.exists():
        subprocess.run(["debootstrap", "--variant=minbase", f"--include={PYTHON}", suite, str(base)], check=True)
    stages: dict[str, Stage] = {}
    stage, user, place = Stage(base, {}), "root", "/"
    for number, (word, rest) in enumerate(instructions((HERE / "Dockerfile").read_text())):
        print(f"{word} {rest}"[:110], flush=True)
        if word == "FROM":
            name = rest.partition(" AS ")[2] or "image"
            stage, user, place = stages.setdefault(name, _copied(base, folder / f"{number}-{name}")), "root", "/"
        elif word == "ENV":
            key, _, value = rest.partition("=")
            stage.environment[key] = value.replace("$PATH", _path(stage))
        elif word == "WORKDIR":
            place = rest
            _inside(stage, rest).mkdir(parents=True, exist_ok=True)
        elif word == "USER":
            user = rest
        elif word == "COPY":
            _copy(stages, stage, place, rest)
        elif word == "RUN":
            command = json.loads(rest) if rest.startswith("[") else ["sh", "-c", rest]
            subprocess.run(chroot(stage, user, place, command), check=True, env=_network_of_pip())
    return stage


def chroot(stage: Stage, user: str, place: str, command: list[str]) -> list[str]:
    """The command that runs another one inside a stage, with /proc and /dev that vanish with it."""
    root = shlex.quote(str(stage.root))
    home = "/root" if user == "root" else f"/home/{user}"
    words = {"PATH": _path(stage), "HOME": home, **stage.environment}
    carried = [f'{name}="${name}"' for name in _network_of_pip() if name.startswith("PIP_")]
    there = shlex.quote(f"cd {place} && exec {shlex.join(command)}")
    inner = " ".join(["env -i", *carried, *(shlex.quote(f"{k}={v}") for k, v in words.items()), "sh -c", there])
    script = (
        f"mount -t proc proc {root}/proc && mount --rbind /dev {root}/dev && "
        f"exec chroot --userspec={user} {root} {inner}"
    )
    return ["unshare", "--mount", "--fork", "--kill-child", "sh", "-c", script]


def _network_of_pip() -> dict[str, str]:
    """What pip needs to reach its index from here: the system's own certificates and time-outs, no folders of ours."""
    kept = {name: value for name, value in os.environ.items() if name in ("PATH", "PIP_CERT", "PIP_DEFAULT_TIMEOUT")}
    return {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin"} | kept


def _copied(base: Path, root: Path) -> Stage:
    shutil.rmtree(root, ignore_errors=True)
    subprocess.run(["cp", "--archive", "--reflink=auto", str(base), str(root)], check=True)
    for file in (Path("/etc/resolv.conf"), CERTIFICATES):
        if file.exists():
            shutil.copyfile(file, _inside(Stage(root, {}), str(file)))
    return Stage(root, {})


def _copy(stages: dict[str, Stage], stage: Stage, place: str, words: str) -> None:
    found = re.match(r"--from=(\w+) ", words)
    source = stages[found[1]].root if found else HERE.parent
    *names, target = words[found.end() if found else 0 :].split()
    goal = _inside(stage, str(Path(place) / target))
    for name in names:
        origin = source / name.lstrip("/")
        if origin.is_dir():
            shutil.copytree(origin, goal, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(origin, goal)


def _path(stage: Stage) -> str:
    return stage.environment.get("PATH", "/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin")


def _inside(stage: Stage, path: str) -> Path:
    return stage.root / path.lstrip("/")


def compose(scenario: str, seconds: float) -> dict[str, Any]:
    """The services as an engine sees them; the plant's run is shorter."""
    text = re.sub(r"\$\{SCENARIO:-\w+\}", scenario, (HERE / "compose.yaml").read_text())
    services = yaml.safe_load(text)["services"]
    for name in ("plant", "controller"):
        services[name]["command"] += ["--set", f"duration={seconds:g}"]
    return {name: service for name, service in services.items() if "profiles" not in service}


def serve(stage: Stage, folder: Path, scenario: str, seconds: float) -> int:
    """Run the services in this process's namespaces to their end; the recording is in FOLDER/recordings."""
    subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
    services = compose(scenario, seconds)
    hosts = "".join(f"127.0.0.1 {name}\n" for name in ("localhost", *services))
    _inside(stage, "/etc/hosts").write_text(hosts)
    running: dict[str, subprocess.Popen[bytes]] = {}
    for name, service in services.items():
        print(f"{name}: {shlex.join(service['command'])}", flush=True)
        for other in service.get("depends_on", {}):
            _await_health(stage, services[other], running[other])
        running[name] = subprocess.Popen(_service(stage, folder, service))
    codes = {name: process.wait(PATIENCE) for name, process in running.items() if name != "router"}
    for name in services:
        print(f"{name}: exit code {codes.get(name, 'none, it routes on')}", flush=True)
    running["router"].kill()  # unshare hands no other signal on; its child goes with it
    return max(codes.values())


def _service(stage: Stage, folder: Path, service: dict[str, Any], command: list[str] | None = None) -> list[str]:
    """A service in a mount namespace of its own, with the rights that the file leaves it."""
    entry = next(
        json.loads(rest) for word, rest in instructions((HERE / "Dockerfile").read_text()) if word == "ENTRYPOINT"
    )
    root, user = str(stage.root), str(service["user"])
    lines = [f"mount --bind {root} {root}", f"mount -t proc proc {root}/proc", f"mount --rbind /dev {root}/dev"]
    lines += [f"mount -t tmpfs tmpfs {root}{place}" for place in service.get("tmpfs", [])]
    for volume in service.get("volumes", []):
        name, place = volume.split(":")[:2]
        lines += [f"mount --bind {_volume(stage, folder, name, place, user)} {root}{place}"]
    lines += [f"mount -o remount,bind,ro {root}"] if service.get("read_only") else []
    words = command or [*entry, *service["command"]]
    inner = shlex.join(["env", "-i", f"PATH={_path(stage)}", "HOME=/home/hydrotwin", *words])
    uid, _, gid = user.partition(":")
    drop = f"--reuid {uid} --regid {gid} --clear-groups --no-new-privs --inh-caps=-all --bounding-set={CAPABILITIES}"
    lines += [f"exec chroot {root} setpriv {drop} sh -c {shlex.quote('cd /recordings && exec ' + inner)}"]
    return ["unshare", "--mount", "--fork", "--kill-child", "sh", "-ec", "\n".join(lines)]


def _volume(stage: Stage, folder: Path, name: str, place: str, user: str) -> Path:
    """A named volume: empty ones begin with what the image has there."""
    volume = folder / name
    if not volume.exists():
        subprocess.run(["cp", "--archive", str(_inside(stage, place)), str(volume)], check=True)
    subprocess.run(["chown", "--recursive", user, str(volume)], check=True)
    return volume


def _await_health(stage: Stage, service: dict[str, Any], process: subprocess.Popen[bytes]) -> None:
    kind, *command = service["healthcheck"]["test"]
    assert kind == "CMD", kind
    until = time.monotonic() + PATIENCE
    while subprocess.run(_service(stage, stage.root.parent, service, command)).returncode:
        if process.poll() is not None or time.monotonic() > until:
            raise SystemExit(f"not healthy within {PATIENCE:g} s: {shlex.join(service['command'])}")
        time.sleep(0.5)


def main() -> None:
    """Build, then run in namespaces of its own: whatever the services leave ends with them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--suite", default="bookworm")
    parser.add_argument("--scenario", default="step")
    parser.add_argument("--seconds", type=float, default=3.0)
    parser.add_argument("--inside", type=json.loads, help=argparse.SUPPRESS)
    given = parser.parse_args()
    folder = given.folder.resolve()
    if given.inside:
        raise SystemExit(serve(Stage(Path(given.inside[0]), given.inside[1]), folder, given.scenario, given.seconds))
    folder.mkdir(parents=True, exist_ok=True)
    image = build(folder, given.suite)
    own = [sys.executable, __file__, *sys.argv[1:], "--inside", json.dumps([str(image.root), image.environment])]
    raise SystemExit(subprocess.run(["unshare", "--net", "--pid", "--fork", "--kill-child", *own]).returncode)


main()
