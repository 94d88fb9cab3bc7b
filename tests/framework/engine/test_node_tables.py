"""Every built-in node against its tables: child status x tick x halt x skip.

`recorded.txt` holds what BehaviorTree.CPP 4.10 and Nav2 did; `written.txt` what only we have, what
depends on the clock, and where the reference engine throws an exception.
"""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path

import pytest

from momantu_bt.tree.catalogue import NODES, SUBTREE, Kind
from momantu_bt.tree.catalogue.spec import Dialect
from tests.framework.engine.node_table import Row, played, rows

FOLDER = Path(__file__).parent / "node_tables"
TABLES: dict[str, list[Row]] = defaultdict(list)
for name in ("recorded", "written"):
    for each in rows((FOLDER / f"{name}.txt").read_text(encoding="utf-8")):
        TABLES[each.type].append(each)


@pytest.mark.parametrize("type_", sorted(TABLES))
def test_a_node_does_what_its_tables_say(type_: str) -> None:
    wrong = [
        f"{row.text}\n  ours: {' '.join(found)}"
        for row in TABLES[type_]
        if (found := played(row)) != row.trace
    ]
    assert not wrong, f"{len(wrong)} of {len(TABLES[type_])}:\n" + "\n".join(wrong[:10])


def test_every_node_has_a_table() -> None:
    """Nav2's leaves act on goals, paths and poses: nodes/test_nav2.py tests them."""
    leaves = {t for t, s in NODES.items() if s.dialect is Dialect.NAV2 and s.kind is Kind.LEAF}
    assert {*NODES, SUBTREE} - leaves <= set(TABLES) <= {*NODES, SUBTREE}


@pytest.mark.parametrize("type_", [t for t, s in NODES.items() if s.kind is not Kind.LEAF])
def test_a_table_has_every_status_of_a_child_a_halt_and_a_second_start(type_: str) -> None:
    ticks = " ".join(" ".join(row.trace) for row in TABLES[type_])
    for letter in "RSFK":
        assert f"0{letter}" in ticks, f"no row in which the first child returns {letter}"
    assert any("!~" in step.split("/")[0] for row in TABLES[type_] for step in row.trace)
    again = [row for row in TABLES[type_] if any("~" in step for step in row.trace[:-1])]
    assert again, "no row goes on after a reset"
