"""JSON Schemas of description files, for editors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from momantu_bt.descriptions.quantities import UNITS_KEY

DIALECT = "https://json-schema.org/draft/2020-12/schema"
_NAMING = ("properties", "patternProperties", "$defs")
"""Keywords of a schema whose value is a mapping by names, not another schema."""


def editor_schema(made: Mapping[str, Any], title: str) -> dict[str, Any]:
    """A model's schema for editors: it describes units in words and has few titles."""
    return {"$schema": DIALECT, **_told(dict(made)), "title": title}


def _told(schema: Any) -> Any:
    """A copy of a schema that names units, without titles that only repeat keys."""
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
