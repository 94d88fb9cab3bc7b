"""The rows of every bundled tree stay as they are: results of benches can then be compared.

`bundled_rows.json` was written before skills and trees told their own share of the rows.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

from momantu_bt.engine.build import skills_in
from momantu_bt.faults.kinds.catalogue import kinds
from momantu_bt.faults.matrix import rows
from momantu_bt.faults.spec import parse_fault
from momantu_bt.faults.stage import plan
from momantu_bt.tree.load import load
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.substitute.substitution import Substitution

TABLE = json.loads(Path(__file__).with_name("bundled_rows.json").read_text(encoding="utf-8"))


def plain(value: Any) -> Any:
    return "inf" if value == math.inf else value


def test_every_row_demands_what_it_did() -> None:
    found = {
        row.fault: {
            "recoverable": row.recoverable,
            "notice": row.notice,
            "reasons": sorted(row.reasons),
            "ends_process": row.kind.ends_process,
            "place": row.kind.place.value,
            "parameters": {k: plain(v) for k, v in parse_fault(row.fault).parameters.items()},
        }
        for row in rows()
    }
    assert list(found) == list(TABLE["rows"])
    assert found == TABLE["rows"]


@pytest.mark.parametrize("tree", TABLE["begins"])
def test_every_fault_begins_when_it_did(tree: str) -> None:
    registry = Registry.installed()
    document = load(tree, registry).document
    skills = {name: registry.skills[name] for name in skills_in(document)}
    faults = [parse_fault(name) for name in kinds()]
    planned = plan(faults, document, skills, Substitution(), with_world=True)
    assert {one.fault.name: one.fault.phase for one in planned} == TABLE["begins"][tree]
