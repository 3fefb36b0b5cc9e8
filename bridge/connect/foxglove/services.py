"""Services that people at Foxglove can call: JSON in, JSON out, by the queries that `hydrotwin` itself makes."""

import json
from collections.abc import Callable
from typing import Any, NamedTuple

from bridge.connect.asking import Asking

TEXT, MAP = {"type": "string"}, {"type": "object"}
Act = Callable[[Asking, dict[str, Any]], dict[str, Any]]


class Offer(NamedTuple):
    """One service."""

    act: Act
    fields: dict[str, Any]  # of the request, as a JSON schema has them


def _reset(asking: Asking, _: dict[str, Any]) -> dict[str, Any]:
    asking.reset()
    return {"reset": "sent"}


OFFERS = {  # below the rig's name
    "reset": Offer(_reset, {}),
    "recorder/save": Offer(lambda asking, _: {"recorder": asking.save()}, {}),
    "parameters/set": Offer(lambda asking, wanted: asking.order("parameters/set", wanted), {"set": MAP, "over": TEXT}),
    "fault": Offer(lambda asking, wanted: asking.order("fault", wanted), {"target": TEXT, "kind": TEXT, "end": TEXT}),
}


def services(rig: str, asking: Asking) -> list[Any]:
    """All of them. What a plant refuses comes back as the error of the call, in its own words."""
    from foxglove import MessageSchema, Service, ServiceSchema

    def schema(name: str, fields: dict[str, Any]) -> Any:
        return MessageSchema(encoding="json", schema=_schema(name, fields))

    return [
        Service(
            f"{rig}/{name}",
            schema=ServiceSchema(
                name, request=schema(f"{name}_request", offer.fields), response=schema(f"{name}_response", {})
            ),
            handler=_handler(offer.act, asking),
        )
        for name, offer in OFFERS.items()
    ]


def _handler(act: Act, asking: Asking) -> Callable[[Any], bytes]:
    def handle(request: Any) -> bytes:
        wanted = json.loads(request.payload or b"{}")
        return json.dumps(act(asking, wanted if isinstance(wanted, dict) else {})).encode()

    return handle


def _schema(name: str, fields: dict[str, Any]) -> Any:
    from foxglove import Schema

    text = json.dumps({"title": name, "type": "object", "properties": fields})
    return Schema(name=name, encoding="jsonschema", data=text.encode())
