"""Who may look at the panel and who may operate: on this machine everybody, over a network by a token."""

import ipaddress
import secrets
from collections.abc import Mapping
from enum import StrEnum
from typing import NamedTuple
from urllib.parse import urlsplit

LOOPBACK = ("localhost", "127.0.0.1", "::1")
BYTES = 16  # of a token


class Guest(StrEnum):
    """Who looks at the page."""

    OPERATOR = "operator"
    WATCHER = "watcher"


class Doors(NamedTuple):
    """The tokens of one server, by what they allow; none where everybody on this machine may do all."""

    tokens: Mapping[Guest, str] = {}
    watch_only: bool = False

    def guest(self, token: str | None) -> Guest | None:
        """Who comes with a token; None for nobody."""
        if not self.tokens:
            return Guest.WATCHER if self.watch_only else Guest.OPERATOR
        found = [
            who for who, own in self.tokens.items() if token and secrets.compare_digest(own.encode(), token.encode())
        ]
        return found[0] if found else None


def doors_for(host: str, watch_only: bool) -> Doors:
    """What a server on an address needs: tokens where others than this machine's people can reach it."""
    if is_loopback(host):
        return Doors({}, watch_only)
    guests = [Guest.WATCHER] if watch_only else list(Guest)
    return Doors({who: secrets.token_urlsafe(BYTES) for who in guests}, watch_only)


def is_loopback(host: str) -> bool:
    """Does an address lead to this machine alone?"""
    if host in LOOPBACK:
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def is_own(origin: str | None, host: str | None) -> bool:
    """Does a page ask that we have sent, or no page at all? Another page in the same browser must not operate a rig."""
    return origin is None or (host is not None and urlsplit(origin).netloc == host)
