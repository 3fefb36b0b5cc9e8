"""Who may do what on a rig's keys: Zenoh configurations for mutual TLS, passwords and access control.

What a role may publish follows from the table of messages. Nothing is allowed that is not written here. Names of the
options: Zenoh's manual (zenoh.io/docs/manual/access-control, /tls, /user-password) and its DEFAULT_CONFIG.json5.
"""

from collections.abc import Collection, Iterable
from enum import StrEnum
from typing import Any, NamedTuple

from bridge.wire.limits import PEERS, guarding
from bridge.wire.messages import TOPICS

JOINS = "declare_subscriber", "liveliness_query", "declare_liveliness_subscriber"  # to watch
ANSWERS = "scenario", "parameters", "parameters/set", "fault"  # queries that a plant answers
OPEN_QUERIES = "scenario", "parameters"  # those of them that change nothing
ORDERS = "parameters/set", "fault"  # those that change the rig
SAVING = "recorder/save"  # the query by which somebody triggers a recorder
TARGET = "target"  # of a live reference
USERS = "users.txt"  # of the one that listens: names and passwords


class Role(StrEnum):
    """Who takes part; the common name of the certificate and the name of the user."""

    ROUTER = "router"
    PLANT = "plant"
    CONTROLLER = "controller"
    OPERATOR = "operator"
    RECORDER = "recorder"
    VIEWER = "viewer"
    FOLLOWER = "follower"


MEMBERS = tuple(role for role in Role if role is not Role.ROUTER)  # who connects
LISTENERS = (Role.ROUTER, Role.PLANT)  # who may be connected to


class Rights(NamedTuple):
    """What a role may send, by the keys below the rig's name."""

    puts: tuple[str, ...] = ()
    queries: tuple[str, ...] = ()
    answers: tuple[str, ...] = ()


class Identity(NamedTuple):
    """What a role shows of itself, as base64 of PEM, and the authority that has signed it."""

    authority: str
    certificate: str
    key: str


def rights(role: Role) -> Rights:
    """What a role may send, in addition to the queries that everybody may make."""
    puts = tuple(topic.name for topic in TOPICS.values() if topic.publisher == role)
    if role is Role.OPERATOR:
        orders = tuple(topic.name for topic in TOPICS.values() if topic.publisher == "anybody")
        return Rights((*orders, TARGET), (*ORDERS, SAVING))
    if role is Role.PLANT:
        return Rights((*puts, "status"), answers=ANSWERS)
    if role is Role.RECORDER:
        return Rights((*puts, "status"), answers=(SAVING,))
    return Rights((*puts, "status")) if role in (Role.CONTROLLER, Role.FOLLOWER) else Rights()


def member(role: Role, identity: Identity, password: str) -> dict[str, Any]:
    """The configuration to connect with."""
    tls = {
        "root_ca_certificate_base64": identity.authority,
        "enable_mtls": True,
        "connect_certificate_base64": identity.certificate,
        "connect_private_key_base64": identity.key,
        "verify_name_on_connect": True,
    }
    return {
        "transport": {
            "link": {"protocols": ["tls"], "tls": tls},
            "auth": {"usrpwd": {"user": str(role), "password": password}},
        }
    }


def listener(identity: Identity, rigs: Iterable[str]) -> dict[str, Any]:
    """The configuration of who listens, a router or a plant, and guards the keys of rigs."""
    tls = {
        "root_ca_certificate_base64": identity.authority,
        "enable_mtls": True,
        "listen_certificate_base64": identity.certificate,
        "listen_private_key_base64": identity.key,
    }
    keys = [f"{rig}/**" for rig in rigs]
    return {
        "transport": {
            "unicast": PEERS._asdict(),
            "link": {"protocols": ["tls"], "tls": tls},
            "auth": {"usrpwd": {"dictionary_file": USERS}},
        },
        "access_control": access_control(rigs),
        "low_pass_filter": guarding(keys),
    }


def access_control(rigs: Iterable[str]) -> dict[str, Any]:
    """Rules, subjects and policies; a subject is a certificate and a user of the same name."""
    rigs = list(rigs)
    rules = [_watching(rigs), _joining(rigs), _asking(rigs)]
    policies = [{"subjects": list(MEMBERS), "rules": [rule["id"] for rule in rules]}]
    for role in MEMBERS:
        own = list(_own(role, rigs))
        rules += own
        if own:
            policies.append({"subjects": [role], "rules": [rule["id"] for rule in own]})
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": [{"id": role, "cert_common_names": [role], "usernames": [role]} for role in MEMBERS],
        "policies": policies,
    }


def _watching(rigs: Collection[str]) -> dict[str, Any]:
    messages = ("put", "delete", "declare_queryable", "query", "reply", "liveliness_token", *JOINS)
    return _rule("everybody receives", "egress", messages, rigs, ("**",))


def _joining(rigs: Collection[str]) -> dict[str, Any]:
    return _rule("everybody may watch", "ingress", JOINS, rigs, ("**",))


def _asking(rigs: Collection[str]) -> dict[str, Any]:
    return _rule("everybody may ask", "ingress", ("query",), rigs, OPEN_QUERIES)


def _own(role: Role, rigs: Collection[str]) -> Iterable[dict[str, Any]]:
    puts, queries, answers = rights(role)
    parts = (
        ("sends", ("put",), puts),
        ("asks", ("query",), queries),
        ("answers", ("declare_queryable", "reply"), answers),
        ("is present", ("liveliness_token",), (f"alive/{role}/*",)),
    )
    for verb, messages, keys in parts:
        if keys:
            yield _rule(f"{role} {verb}", "ingress", messages, rigs, keys)


def _rule(name: str, flow: str, messages: Iterable[str], rigs: Iterable[str], keys: Iterable[str]) -> dict[str, Any]:
    return {
        "id": name,
        "flows": [flow],
        "permission": "allow",
        "messages": list(messages),
        "key_exprs": [f"{rig}/{key}" for rig in rigs for key in keys],
    }
