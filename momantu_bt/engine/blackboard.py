"""The blackboard of one run: cells that hold values, boards that name them.

Each use of a subtree has a board of its own. If a key of the subtree is connected to a key outside,
both names lead to the same cell. So a node reads a value by one attribute access, at any depth.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, TypeAlias

from momantu_bt.failure import SCRIPT_ERROR, Failure
from momantu_bt.skill import MISSING
from momantu_bt.values.contents import freeze

ROOT_MARK = "@"
"""Prefix of a key in a script: it means the key of the root's board."""
PRIVATE_MARK = "_"
"""Prefix of keys that automatic remapping never connects (BehaviorTree.CPP's rule)."""


Journal: TypeAlias = "list[tuple[Cell, Any]]"
"""Cells in the order of their writes, each with its value before the write."""


class Cell:
    """One value, or MISSING. Values are immutable; each write is noted in the run's journal.

    writes: how often it was written; by this count a node notices a new write.
    """

    __slots__ = ("_journal", "name", "value", "writes")

    def __init__(self, name: str, journal: Journal) -> None:
        self.name = name
        self.value: Any = MISSING
        self.writes = 0
        self._journal = journal

    def write(self, value: Any) -> None:
        """Replace the value, made immutable; MISSING clears it."""
        self.store(freeze(value))

    def store(self, value: Any) -> None:
        """Replace the value by one that is already immutable."""
        self._journal.append((self, self.value))
        self.value = value
        self.writes += 1

    def begin(self, value: Any) -> None:
        """Give it the value with which a run begins; no tick has written it."""
        self.value = value
        self.writes = 1

    def note(self) -> None:
        """Tell the observers of a run which value it holds; this is no write."""
        self._journal.append((self, self.value))


class ReadOnlyCell(Cell):
    """A key that the engine publishes, such as `@robot`: its value is computed when read.

    It counts as written whenever a read finds another object than the read before.
    """

    __slots__ = ("_ask", "_count", "_last")

    def __init__(self, name: str, ask: Callable[[], Any]) -> None:
        self.name = name
        self._ask = ask
        self._count = 0
        self._last: Any = MISSING

    @property
    def value(self) -> Any:
        """The current value."""
        return self._ask()

    @value.setter
    def value(self, value: Any) -> None:
        raise Failure(SCRIPT_ERROR, f"@{self.name} is published by the engine and is read-only")

    @property
    def writes(self) -> int:
        """The number of writes to this key."""
        found = self._ask()
        if found is not self._last:
            self._last, self._count = found, self._count + 1
        return self._count

    @writes.setter
    def writes(self, count: int) -> None:
        raise AttributeError("the engine counts the writes of a key that it publishes")

    def store(self, value: Any) -> None:
        """Raise Failure SCRIPT_ERROR: the key is read-only."""
        self.value = value


class Board:
    """The keys that one use of a tree sees. It has the methods that scripts need: get, set, has.

    outer: the board of the tree that contains this subtree; None for the root.
    wires: keys of this board that are connected to cells of the outer one. autoremap: all other
    keys are connected to the outer keys of the same name.
    """

    def __init__(
        self,
        journal: Journal,
        outer: Board | None = None,
        wires: Mapping[str, Cell] | None = None,
        *,
        path: str = "",
        autoremap: bool = False,
    ) -> None:
        self.cells: dict[str, Cell] = dict(wires or {})
        self.root: Board = self if outer is None else outer.root
        self.path = path
        self._journal = journal
        self._outer = outer if autoremap else None

    def cell(self, key: str) -> Cell:
        """The cell of a key; it is created if needed. `@key` is a key of the root's board."""
        if key.startswith(ROOT_MARK):
            return self.root.cell(key[1:])
        found = self.cells.get(key)
        if found is None:
            if self._outer is not None and not key.startswith(PRIVATE_MARK):
                found = self._outer.cell(key)
            else:
                found = Cell(f"{self.path}{key}", self._journal)
            self.cells[key] = found
        return found

    def own(self, key: str) -> Cell:
        """A cell of this board alone, which automatic remapping leaves out."""
        found = self.cells[key] = Cell(f"{self.path}{key}", self._journal)
        return found

    def publish(self, cell: ReadOnlyCell) -> None:
        """Add a read-only key. Call it before nodes are built, as they keep the cells they find."""
        self.cells[cell.name] = cell

    def with_cells(self, cells: Mapping[str, Cell]) -> Board:
        """A board with the same keys, but other cells for some names (`failure` in a handler)."""
        return _Overlay(self, cells)

    def get(self, key: str) -> Any:
        """A key's value; KeyError if it has none."""
        value = self.cell(key).value
        if value is MISSING:
            raise KeyError(key)
        return value

    def set(self, key: str, value: Any) -> None:
        """Make a value immutable and write it; Failure SCRIPT_ERROR if the key is read-only."""
        self.cell(key).write(value)

    def has(self, key: str) -> bool:
        """Whether a key has a value."""
        return self.cell(key).value is not MISSING

    def values(self) -> dict[str, Any]:
        """All keys that have a value, sorted by name, without read-only ones."""
        found = {key: self.cells[key] for key in sorted(self.cells)}
        return {
            key: cell.value
            for key, cell in found.items()
            if not isinstance(cell, ReadOnlyCell) and cell.value is not MISSING
        }


class _Overlay(Board):
    def __init__(self, under: Board, cells: Mapping[str, Cell]) -> None:
        super().__init__(under._journal, path=under.path)
        self.root = under.root
        self._under = under
        self.cells = dict(cells)

    def cell(self, key: str) -> Cell:
        return self.cells.get(key) or self._under.cell(key)


def written(journal: Journal) -> list[tuple[Cell, Any]]:
    """Each write of a journal: its cell and the value that it wrote."""
    after: dict[Cell, Any] = {}
    found = []
    for cell, before in reversed(journal):
        found.append((cell, after.get(cell, cell.value)))
        after[cell] = before
    found.reverse()
    return found


def rollback(before: Iterable[tuple[Cell, Any]]) -> None:
    """Restore the values that cells had before; MISSING clears a cell."""
    for cell, value in before:
        if cell.value is not value:
            cell.store(value)
