"""Our control laws by the kind of controller, and what a law does when it is told that its commands do not act.

The plant centres the valve when commands stay away (safe state) and takes commands again when it is reset or they
resume. A law is told of both, so that what it has gathered does not act on a rig that has moved on meanwhile.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from controller.law import Law, open_loop, pd, relay
from controller.pid import pid
from controller.state_space import state_space

Hook = Callable[[Any], Any]  # memory -> memory


def forget(memory: Any) -> None:
    """Start as at the first sample."""
    return


class ControlLaw(NamedTuple):
    """A law and its hooks."""

    answer: Law
    on_safe_state: Hook = forget  # the valve has been centred: what comes now does not act
    on_resume: Hook = forget  # commands act again
    prepare: Callable[[Any], Any] = lambda gains: gains  # makes what the law is given of a scenario's gains
    name: str = ""  # of a user's, as people call it
    channels: tuple[str, ...] = ()  # further ones of the card that it cannot do without


LAWS: dict[str, ControlLaw] = {
    "pd": ControlLaw(pd),
    "pid": ControlLaw(pid),
    "relay": ControlLaw(relay),
    "open-loop": ControlLaw(open_loop),
    "state-space": ControlLaw(state_space),
}
