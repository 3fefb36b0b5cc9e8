"""The sections of a scenario whose `kind` says what else stands in them, and what each kind knows."""

from bridge.scenario import controllers, references
from bridge.scenario.fields import Part, by_kind

UNIONS: dict[str, dict[str, type[Part]]] = {
    "controller": controllers.KINDS,
    "reference": by_kind(references.AnyReference),
}


def known(section: str, kind: str) -> set[str]:
    """The keys that a kind has; none for a kind that is unknown, which is refused later."""
    model = UNIONS[section].get(kind)
    return set(model.model_fields) if model else set()
