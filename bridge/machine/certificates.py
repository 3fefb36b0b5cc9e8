"""An authority of our own and the certificates that it signs, by the system's `openssl`.

openssl and not a package: one verb needs it once, and wherever Python has certificates to trust, openssl is installed
with them. Keys: elliptic curve P-256 (NIST SP 800-186), PKCS 8. Private keys pass through pipes and files that only
their owner may read.
"""

import ipaddress
import os
import subprocess
from collections.abc import Collection
from pathlib import Path
from typing import NamedTuple

from bridge.errors import RunError

AUTHORITY_DAYS = 3650  # assumed: an authority outlives some generations of certificates
PATIENCE = 30.0  # seconds for a call of openssl
HERE = ("localhost", "127.0.0.1", "::1")  # names of the machine itself
MISSING = "the command openssl is missing: it makes the certificates (Debian: apt-get install openssl)"


class Certified(NamedTuple):
    """A certificate and its private key, PEM."""

    certificate: bytes
    key: bytes


class Authority(NamedTuple):
    """Who signs; files in a folder that only their owner may read."""

    certificate: Path
    key: Path


def write_secret(path: Path, data: bytes) -> None:
    """Write a new file that only its owner may read. Raises FileExistsError for one that is there."""
    with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
        file.write(data)


def found(folder: Path) -> Authority:
    """A new authority, authority.pem and authority.key in a folder. Raises RunError."""
    authority = Authority(folder / "authority.pem", folder / "authority.key")
    write_secret(authority.key, _new_key())
    extensions = ("-addext", "keyUsage=critical,keyCertSign,cRLSign")
    name = ("-subj", "/CN=hydrotwin authority", "-days", str(AUTHORITY_DAYS))
    write_secret(authority.certificate, _openssl("req", "-x509", "-key", str(authority.key), *name, *extensions))
    return authority


def certify(authority: Authority, name: str, hosts: Collection[str], days: int) -> Certified:
    """A certificate for a role, valid so many days; with `hosts`, for one that listens under these names, too."""
    folder = authority.key.parent
    key, request, wanted = (folder / f".{name}.{end}" for end in ("key", "request", "extensions"))
    made = _new_key()
    write_secret(key, made)
    try:
        write_secret(request, _openssl("req", "-new", "-key", str(key), "-subj", f"/CN={name}"))
        write_secret(wanted, _extensions(hosts).encode())
        signer = ("-CA", str(authority.certificate), "-CAkey", str(authority.key), "-CAcreateserial")
        terms = ("-days", str(days), "-extfile", str(wanted))
        return Certified(_openssl("x509", "-req", "-in", str(request), *signer, *terms), made)
    finally:
        for path in (key, request, wanted, authority.certificate.with_suffix(".srl")):
            path.unlink(missing_ok=True)


def _extensions(hosts: Collection[str]) -> str:
    usage = "serverAuth,clientAuth" if hosts else "clientAuth"
    names = ",".join(f"{'IP' if _is_address(host) else 'DNS'}:{host}" for host in hosts)
    alternatives = f"subjectAltName={names}\n" if hosts else ""
    terms = "basicConstraints=critical,CA:FALSE\nkeyUsage=critical,digitalSignature\n"
    return f"{terms}extendedKeyUsage={usage}\n{alternatives}"


def _is_address(host: str) -> bool:
    try:
        return bool(ipaddress.ip_address(host))
    except ValueError:
        return False


def _new_key() -> bytes:
    return _openssl("genpkey", "-algorithm", "EC", "-pkeyopt", "ec_paramgen_curve:P-256")


def _openssl(*arguments: str) -> bytes:
    try:
        done = subprocess.run(["openssl", *arguments], capture_output=True, timeout=PATIENCE, stdin=subprocess.DEVNULL)
    except FileNotFoundError:
        raise RunError(MISSING) from None
    except subprocess.TimeoutExpired:
        raise RunError(f"openssl {arguments[0]} did not answer within {PATIENCE:g} s") from None
    if done.returncode:
        words = " ".join(done.stderr.decode(errors="replace").split())
        raise RunError(f"openssl {arguments[0]} failed: {words}")
    return done.stdout
