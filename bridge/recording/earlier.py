"""Facts of recordings made by earlier versions, in today's words."""

from collections.abc import Mapping
from typing import Any

from bridge.scenario.controllers import KINDS, WithGains
from bridge.scenario.units import split

RELAY = ("velocity", "filter_time", "limit")
OF_LAW = {"pd": tuple(WithGains.model_fields), "relay": RELAY, "open-loop": ("limit",)}


def in_todays_words(facts: dict[str, Any]) -> dict[str, Any]:
    """The facts of a run.

    Until 0.2 `controller.law` named the kind, and every law had the gains of a PD controller; `real_time.overruns` was
    a number of ticks, which says nothing of the share that it is today.
    """
    scenario = facts.get("scenario")
    if not isinstance(scenario, dict):
        return facts
    return facts | {"scenario": scenario | _with_kind(scenario) | _in_shares(scenario)}


def _with_kind(scenario: Mapping[str, Any]) -> dict[str, Any]:
    controller = scenario.get("controller")
    if not isinstance(controller, dict) or "kind" in controller or not isinstance(controller.get("law"), str):
        return {}
    return {"controller": _controller(controller)}


def _in_shares(scenario: Mapping[str, Any]) -> dict[str, Any]:
    policy = scenario.get("real_time")
    if not isinstance(policy, dict) or isinstance(policy.get("overruns", 0.0), float):
        return {}
    return {"real_time": {name: value for name, value in policy.items() if name != "overruns"}}


def _controller(old: Mapping[str, Any]) -> dict[str, Any]:
    law = old["law"]
    if law not in KINDS:
        return {"kind": "python", **old}
    kept = {name: old[name] for name in OF_LAW[law] if name in old and name != "kind"}
    return {"kind": law, **kept} | (_derivative_time(old) if law == "relay" else {})


def _derivative_time(old: Mapping[str, Any]) -> dict[str, float]:
    """Of a relay that was given both gains in V and %, or both in SI; nothing where they say no time."""
    try:
        (gain, unit), (derivative, of) = split(str(old["gain"])), split(str(old["derivative"]))
    except (KeyError, ValueError):
        return {}
    return {"derivative_time": derivative / gain} if gain > 0.0 and unit[:1] == of[:1] else {}
