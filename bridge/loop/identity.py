"""Who is who in a run: 64-bit numbers, the same for the same seed, else random."""

import hashlib
import secrets


def derived(seed: int, *names: str) -> int:
    """A stable number for a role in the run of a seed, so that equal runs make equal bytes."""
    text = "/".join((str(seed), *names))
    return int.from_bytes(hashlib.blake2b(text.encode(), digest_size=8).digest(), "little")


def fresh() -> int:
    """A random number, for a process that was started by hand."""
    return secrets.randbits(64)
