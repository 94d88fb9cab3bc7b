"""JSON Schemas of our own messages."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeAlias

from momantu_bt.engine.role import Role

Schema: TypeAlias = Mapping[str, Any]

TEXT: Schema = {"type": "string"}
NUMBER: Schema = {"type": "number"}
COUNT: Schema = {"type": "integer", "minimum": 0}
ANY: Schema = {}
"""A value as `codec` writes it."""


def record(required: Mapping[str, Schema], optional: Mapping[str, Schema] | None = None) -> Schema:
    """An object with these keys and no others."""
    return {
        "type": "object",
        "properties": {**required, **(optional or {})},
        "required": list(required),
        "additionalProperties": False,
    }


def array(items: Schema) -> Schema:
    """An array of any length."""
    return {"type": "array", "items": items}


def row(*columns: Schema) -> Schema:
    """An array with one schema for each column, in draft 7: viewers know no newer one."""
    return {
        "type": "array",
        "items": list(columns),
        "minItems": len(columns),
        "maxItems": len(columns),
    }


def optional(schema: Schema) -> Schema:
    """The same, or null."""
    return {"anyOf": [schema, {"type": "null"}]}


STATUSES = ("IDLE", "RUNNING", "SUCCESS", "FAILURE", "SKIPPED")

RUN = record(
    {
        "format": COUNT,
        "tree": TEXT,
        "main": TEXT,
        "world": optional(TEXT),
        "robot": optional(TEXT),
        "seed": {"type": "integer"},
        "options": {"type": "object"},
        "values": {"type": "object"},
        "versions": {"type": "object", "additionalProperties": TEXT},
        "unix_time": NUMBER,
    }
)
"""`/run`, once."""

FILE = record(
    {
        "name": TEXT,
        "kind": {"enum": ["tree", "values", "substitution", "site", "world", "robot"]},
        "text": TEXT,
    }
)
"""`/files`, once for each."""

NODE = record(
    {
        "index": COUNT,
        "name": TEXT,
        "type": TEXT,
        "place": TEXT,
        "depth": COUNT,
        "parent": optional(COUNT),
        "label": TEXT,
        "role": {"enum": [role.value for role in Role]},
    },
    {"plan": array(row(TEXT, {"type": "boolean"})), "around": TEXT},
)
NODES = record({"nodes": array(NODE)})
"""`/nodes`, once."""

TICK = record(
    {"number": COUNT, "now": NUMBER},
    {
        "changes": array(row(COUNT, {"enum": list(STATUSES)}, TEXT, ANY)),
        "writes": array(row(TEXT, ANY)),
        "reads": array(row(TEXT, ANY)),
        "steps": array(row(COUNT, {"enum": list(STATUSES)}, TEXT, ANY, {"type": "object"})),
        "issued": array(row(TEXT, ANY)),
        "state": TEXT,
        "notes": array(row(COUNT, TEXT)),
        "labels": array(row(COUNT, TEXT)),
        "logs": array(row(COUNT, TEXT)),
        "settling": {"const": True},
    },
)
"""`/tick`, each tick. Every part is optional: changes [node, status, note, failure], writes [cell,
value], reads [key, value], steps of skills [node, status, phase, failure, outputs], issued
[actuator, goal], notes of running nodes [node, note], new lines of nodes [node, label],
what skills logged [node, text]."""

SERVICE: Schema = {"type": "object"}
"""`/service/<name>`: published values by key."""

END: Schema = {"type": "object", "required": ["status", "fingerprint", "ticks"]}
"""`/end`, once: the report."""
