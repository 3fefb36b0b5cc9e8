"""The verb that makes certificates, passwords and Zenoh configurations."""

import re
from pathlib import Path
from typing import Annotated

import typer

from bridge.errors import UsageError

HOST = re.compile(r"[A-Za-z0-9]([A-Za-z0-9.:-]*[A-Za-z0-9])?")  # a name or an address, also of IPv6
RIG = re.compile(r"[A-Za-z0-9_-]+(/[A-Za-z0-9_-]+)*")  # as `rig_name` of a scenario

EXAMPLES = {
    "--host": "write a name or an address, such as rig-pc.lab or 192.168.1.20, without port",
    "--rig": "write the rig_name of a scenario: letters, digits, _ - and / between them",
}


def keys(
    folder: Annotated[Path, typer.Argument(metavar="NEW", help="The folder to make.")],
    host: Annotated[
        list[str] | None,
        typer.Option(help="Name or address of the machine that listens, in addition to this one. Repeatable."),
    ] = None,
    rig: Annotated[list[str] | None, typer.Option(help="Name of a rig.  [default: rig]  Repeatable.")] = None,
    days: Annotated[int, typer.Option(min=1, max=3650, help="How long the certificates are valid.")] = 825,
) -> None:
    """Make certificates, passwords and Zenoh configurations for a network on which each role may do only its part.

    Only the controller writes commands, only the operator changes numbers, injects faults and resets; plant,
    controller, recorder, viewer, follower and operator may watch; nobody else connects. Needs the command openssl.
    """
    hosts, rigs = _fitting("--host", host or [], HOST), _fitting("--rig", rig or ["rig"], RIG)
    from bridge.machine.key_folder import make_keys

    make_keys(folder, hosts, rigs, days)
    print(_guide(folder, hosts[0] if hosts else "localhost", rigs[0]))


def _fitting(option: str, words: list[str], pattern: re.Pattern[str]) -> list[str]:
    for word in words:
        if not pattern.fullmatch(word):
            raise UsageError(f"{option} {word!r}: {EXAMPLES[option]}")
    return words


def _guide(folder: Path, host: str, rig: str) -> str:
    address = f"[{host}]" if ":" in host else host
    join = f"--connect tls/{address}:7447 --zenoh-config {folder}"
    named = "" if rig == "rig" else f" --rig {rig}"
    scenario = "step" if rig == "rig" else f"step --set rig_name={rig}"
    return f"""\
made {folder}; hand out one file per role, and router.json5 with users.txt to the machine that listens:

hydrotwin router --listen tls/0.0.0.0:7447 --zenoh-config {folder}/router.json5
hydrotwin plant {scenario} {join}/plant.json5 --await controller --await recorder
hydrotwin record{named} {join}/recorder.json5
hydrotwin controller {scenario} {join}/controller.json5
hydrotwin view{named} {join}/viewer.json5
hydrotwin watch {rig} {join}/viewer.json5
hydrotwin set {rig} controller.gain=0.8 {join}/operator.json5
hydrotwin reset{named} {join}/operator.json5

Without a router the plant listens itself, and needs users.txt beside its file:

hydrotwin plant {scenario} --listen tls/0.0.0.0:7447 --zenoh-config {folder}/plant-listening.json5

authority.key signs certificates: keep it where nobody else can read it."""
