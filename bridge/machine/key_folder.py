"""A folder of keys for the rigs of a network: an authority, and for each role one file to hand out.

A file holds its certificate, private key and password, so that it works from any folder and is one thing to copy.
"""

import base64
import json
import secrets
import shutil
from collections.abc import Collection
from pathlib import Path
from typing import Any

from bridge.errors import UsageError, writing
from bridge.machine.certificates import HERE, Certified, certify, found, write_secret
from bridge.wire.access import LISTENERS, MEMBERS, USERS, Identity, Role, listener, member

PASSWORD = 16  # random bytes of a password
SECRETS = "*\n"  # of a .gitignore: nothing in the folder belongs in a repository
LISTENING_PLANT = "plant-listening.json5"


def make_keys(folder: Path, hosts: Collection[str], rigs: Collection[str], days: int) -> list[Path]:
    """Make a folder and everything in it; the files to hand out. Raises UsageError for one that exists, RunError."""
    with writing(folder):
        try:
            folder.mkdir(mode=0o700)
        except FileExistsError:
            raise UsageError(f"{folder} exists: keys are never overwritten; name a new folder") from None
    try:
        with writing(folder):
            return list(_fill(folder, [*HERE, *hosts], rigs, days))
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)  # we have made it
        raise


def _fill(folder: Path, hosts: Collection[str], rigs: Collection[str], days: int) -> list[Path]:
    write_secret(folder / ".gitignore", SECRETS.encode())
    authority = found(folder)
    trusted = _base64(authority.certificate.read_bytes())
    passwords = {role: secrets.token_hex(PASSWORD) for role in MEMBERS}
    write_secret(folder / USERS, "".join(f"{role}:{word}\n" for role, word in passwords.items()).encode())
    made = []
    for role in Role:
        certified = certify(authority, role, hosts if role in LISTENERS else (), days)
        write_secret(folder / f"{role}.pem", certified.certificate)
        identity = _identity(trusted, certified)
        if role in LISTENERS:
            name = LISTENING_PLANT if role is Role.PLANT else f"{role}.json5"
            made.append(_write(folder / name, f"For a {role} that listens", listener(identity, rigs)))
        if role in MEMBERS:
            made.append(
                _write(folder / f"{role}.json5", f"To connect as {role}", member(role, identity, passwords[role]))
            )
    return made


def _identity(authority: str, own: Certified) -> Identity:
    return Identity(authority, _base64(own.certificate), _base64(own.key))


def _base64(data: bytes) -> str:
    return base64.b64encode(data).decode()


def _write(path: Path, words: str, configuration: dict[str, Any]) -> Path:
    text = f"// {words}. It holds a private key: keep it from others.\n{json.dumps(configuration, indent=2)}\n"
    write_secret(path, text.encode())
    return path
