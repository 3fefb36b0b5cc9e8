"""An extension of griffe: the comment behind a field, which has its unit, is the field's documentation."""

import re
from typing import Any

import griffe  # pyright: ignore[reportMissingImports]

COMMENT = re.compile(r"  # (.+)$")


class FieldComments(griffe.Extension):
    """Fields without a docstring get their comment."""

    def on_attribute_instance(self, *, attr: griffe.Attribute, **_: Any) -> None:
        """Called for every attribute found."""
        if attr.docstring is None and attr.lineno and (found := COMMENT.search(attr.source.splitlines()[0])):
            attr.docstring = griffe.Docstring(found[1], lineno=attr.lineno, parent=attr)
