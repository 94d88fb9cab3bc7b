"""SubTree: another tree of the document, on a board of its own."""

from __future__ import annotations

from collections.abc import Mapping

from momantu_bt.engine.blackboard import Board, Cell
from momantu_bt.engine.causes import through
from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.label import ShowsValues
from momantu_bt.engine.node import Parts
from momantu_bt.engine.ports import Reader
from momantu_bt.engine.role import Role
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, Status


class SubTree(ShowsValues, Decorator):
    """Runs another tree and returns its status; failures get this node's name and place.

    An inner key that is connected to an outer key shares its cell. A value and a default are in
    the inner key when the run begins, and what the tree inside makes of them stays, as in
    BehaviorTree.CPP. A part of a value and a text with keys are written to the inner key at each
    start. given: those, with their cells. constants: the cells of values and defaults. board: the
    board inside.
    """

    def __init__(
        self,
        parts: Parts,
        *,
        given: Mapping[str, tuple[Cell, Reader]],
        constants: Mapping[str, Cell],
        wires: Mapping[str, Cell],
        board: Board,
    ) -> None:
        super().__init__(parts)
        self.given = dict(given)
        self.constants = dict(constants)
        self.wires = dict(wires)
        self.board = board

    @property
    def role(self) -> Role:
        """Its role in displays: a tree of its own."""
        return Role.TREE

    def step(self) -> Status:
        """Tick the tree inside."""
        if self.state is IDLE:
            for cell, read in self.given.values():
                cell.store(read())
            for cell in self.constants.values():
                cell.note()
            values = {name: cell.value for name, (cell, _) in self.given.items()}
            values |= {name: cell.value for name, cell in self.constants.items()}
            values |= {name: cell.value for name, cell in self.wires.items()}
            self.show_values(values)
            self.state = RUNNING
        status = self.child.execute()
        if status is FAILURE:
            self.fail_with(through(self, self.failure_of(self.child)))
        if status.completed:
            self.child.reset()
        return status
