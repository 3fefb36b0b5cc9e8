"""Two hosts on one machine: network namespaces joined by a pair of virtual cards, as root on Linux with iproute2."""

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

NEAR, FAR = "10.77.0.1", "10.77.0.2"  # addresses of the hosts, on no card of the machine


class RefusedError(Exception):
    """The system does not do it; the text says which call, and its words."""


class Hosts(NamedTuple):
    """Names of the namespaces; the card of each is called as it is."""

    near: str
    far: str

    def inside(self, name: str) -> tuple[str, ...]:
        """What runs a command on a host."""
        return ("ip", "netns", "exec", name)

    def set_link(self, state: str) -> None:
        """Plug the cable, `up`, or pull it, `down`."""
        call("ip", "-n", self.near, "link", "set", self.near, state)

    def shape(self, *words: str) -> None:
        """Let both cards treat what they send as `tc qdisc` says, such as netem delay 20ms."""
        for name in self:
            call("tc", "-n", name, "qdisc", "replace", "dev", name, "root", *words)


@contextmanager
def two_hosts() -> Iterator[Hosts]:
    """Made and removed. Raises RefusedError."""
    hosts = Hosts(f"near{os.getpid()}", f"far{os.getpid()}")
    try:
        for name in hosts:
            call("ip", "netns", "add", name)
            call("ip", "-n", name, "link", "set", "lo", "up")
        pair = ("type", "veth", "peer", "name", hosts.far, "netns", hosts.far)
        call("ip", "link", "add", hosts.near, "netns", hosts.near, *pair)
        for name, address in zip(hosts, (NEAR, FAR), strict=True):
            call("ip", "-n", name, "address", "add", f"{address}/24", "dev", name)
            call("ip", "-n", name, "link", "set", name, "up")
        yield hosts
    finally:
        for name in hosts:
            if shutil.which("ip"):
                subprocess.run(["ip", "netns", "del", name], capture_output=True)


def call(*command: str) -> None:
    """Raises RefusedError."""
    if shutil.which(command[0]) is None:
        raise RefusedError(f"{command[0]} is not installed (iproute2)")
    done = subprocess.run(command, capture_output=True, text=True, timeout=20)
    if done.returncode:
        raise RefusedError(f"`{' '.join(command)}`: {' '.join(done.stderr.split())}")
