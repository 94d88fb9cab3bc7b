"""Print the fault rows of one tree: when each fault begins, and how a run with it must end."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from momantu_bt.engine.build import skills_in
from momantu_bt.fault import FaultError
from momantu_bt.faults.matrix import Row, rows_like
from momantu_bt.faults.spec import parse_fault
from momantu_bt.faults.stage import plan
from momantu_bt.faults.tree_file import tree_faults
from momantu_bt.skill import Skill
from momantu_bt.tree.model import Document
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.substitute.substitution import Substitution

HEAD = ("fault", "begins", "recover?", "notice within", "true reasons")


@dataclass(frozen=True, slots=True)
class TreeRow:
    """A row of the matrix in one tree. begins: its phase; "" if it cannot happen.

    why: why it cannot happen in this tree.
    """

    row: Row
    begins: str
    why: str = ""

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "fault": self.row.fault,
            "begins": self.begins or None,
            "recoverable": self.row.recoverable,
            "notice_s": self.row.notice,
            "reasons": sorted(self.row.reasons),
            "why": self.why,
        }

    def cells(self) -> tuple[str, ...]:
        """The row in words, below HEAD."""
        can, notice = "yes" if self.row.recoverable else "no", f"{self.row.notice:g} s"
        if not self.begins:
            return self.row.fault, "cannot happen", "", "", self.why
        return self.row.fault, self.begins, can, notice, ", ".join(sorted(self.row.reasons))


def tree_rows(document: Document, registry: Registry) -> tuple[TreeRow, ...]:
    """The faults with which `bench --faults all` runs a checked tree.

    Raises:
        TreeError, TreeNotFound: the file of faults beside the tree is wrong.
    """
    skills = {name: registry.skills[name] for name in skills_in(document)}
    rows = rows_like("all", tree_faults(document).rows)
    return tuple(_in_tree(row, document, skills) for row in rows)


def _in_tree(row: Row, document: Document, skills: Mapping[str, type[Skill]]) -> TreeRow:
    fault = parse_fault(row.fault)
    try:
        (planned,) = plan([fault], document, skills, Substitution(), with_world=True)
    except FaultError as error:
        return TreeRow(row, "", str(error))
    return TreeRow(row, planned.fault.phase or "")
