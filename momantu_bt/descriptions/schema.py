"""JSON Schemas of description files, for editors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from momantu_bt.descriptions.quantities import UNITS_KEY

DIALECT = "https://json-schema.org/draft/2020-12/schema"
_NAMING = ("properties", "patternProperties", "$defs")
"""Keys of a schema beneath which every key is a name, not a word of schemas."""


def editor_schema(made: Mapping[str, Any], title: str) -> dict[str, Any]:
    """A model's schema as editors show it: units of quantities in words, few titles."""
    return {"$schema": DIALECT, **_told(dict(made)), "title": title}


def _told(schema: Any) -> Any:
    """A schema whose quantities name their units, without the titles that repeat the keys."""
    if isinstance(schema, list):
        return [_told(each) for each in schema]
    if not isinstance(schema, dict):
        return schema
    told: dict[str, Any] = {}
    for key, value in schema.items():
        if key in _NAMING:
            told[key] = {name: _told(each) for name, each in value.items()}
        elif key not in ("title", UNITS_KEY):
            told[key] = value if key == "default" else _told(value)
    if UNITS_KEY in schema:
        first, *others = schema[UNITS_KEY]
        unit = f"{first}, or written with a unit: {', '.join((first, *others))}"
        told["description"] = " ".join(filter(None, [schema.get("description"), f"[{unit}]"]))
    return told
