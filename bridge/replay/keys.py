"""On which keys a replay speaks, and who else speaks there."""

import time
from collections import Counter
from collections.abc import Iterable

from bridge.errors import UsageError
from bridge.wire.bus import Bus
from bridge.wire.messages import TOPICS

LISTEN = 0.4  # seconds


def remapped(keys: dict[str, str], rules: Iterable[str]) -> dict[str, str]:
    """Topic -> key, after rules a:=b; a is a key, the beginning of some, or a topic below the rig.

    Raises UsageError for a text that is not a rule, fits nothing, or lets two topics fall together.
    """
    found = dict(keys)
    for rule in rules:
        old, sign, new = (part.strip("/") for part in rule.partition(":="))
        if not (old and sign and new):
            raise UsageError(f"--remap {rule}: write OLD:=NEW, such as rig:=twin or measurement:=rig/again")
        hits = {topic: _moved(topic, key, old, new) for topic, key in keys.items()}
        moved = {topic: key for topic, key in hits.items() if key is not None}
        if not moved:
            raise UsageError(f"--remap {rule}: no key begins so (there are: {', '.join(sorted(keys.values()))})")
        found |= moved
    double = [key for key, count in Counter(found.values()).items() if count > 1]
    if double:
        raise UsageError(f"--remap: several topics would go to {', '.join(double)}")
    return found


def _moved(topic: str, key: str, old: str, new: str) -> str | None:
    if old in (key, topic):
        return new
    return new + key[len(old) :] if key.startswith(f"{old}/") else None


def live_publishers(bus: Bus, keys: dict[str, str]) -> list[str]:
    """Who speaks on some of the keys now: known by their presence, others by what they say meanwhile."""
    heard: Counter[str] = Counter()
    listeners = [
        bus.session.declare_subscriber(key, lambda sample: heard.update([str(sample.key_expr)]))
        for key in keys.values()
    ]
    bus.watch()
    time.sleep(LISTEN)
    for listener in listeners:
        listener.undeclare()
    publishers = {TOPICS[topic].publisher for topic, key in keys.items() if key == f"{bus.rig_name}/{topic}"}
    present = [role for role in (*sorted(publishers - {"all"}), "replay") if bus.present.get(role)]
    return [f"a {role}" for role in present] or [f"somebody on {key}" for key in sorted(heard)]
