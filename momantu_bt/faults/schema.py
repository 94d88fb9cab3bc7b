"""A JSON Schema of files of faults, for editors."""

from __future__ import annotations

from typing import Any

from momantu_bt.descriptions.schema import DIALECT
from momantu_bt.fault_kind import Where
from momantu_bt.faults.catalogue import kinds
from momantu_bt.faults.phase import FORMS
from momantu_bt.faults.spec import FORM
from momantu_bt.tree.language import VERSION


def faults_schema() -> dict[str, Any]:
    """The schema of `my_tree.faults.yaml`, with the faults that are installed."""
    phases = {
        name: {"type": "string", "description": f"{kind.doc} It begins at: {FORMS}"}
        for name, kind in kinds().items()
        if kind.place is not Where.SITE
    }
    return {
        "$schema": DIALECT,
        "title": "momantu-bt file of faults beside a tree",
        "type": "object",
        "properties": {
            "momantu_bt": {"const": VERSION, "description": "the version of the language"},
            "begins": {
                "type": "object",
                "description": "when faults begin in this tree",
                "properties": phases,
                "additionalProperties": False,
            },
            "rows": {
                "type": "array",
                "description": "faults that `bench --faults` runs besides",
                "items": {"type": "string", "description": FORM},
            },
        },
        "required": ["momantu_bt"],
        "additionalProperties": False,
    }
