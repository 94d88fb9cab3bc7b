"""Functions that read a node's inputs and write its outputs, made when the tree is built."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Any, TypeAlias

from momantu_bt.engine.blackboard import ROOT_MARK, Board, Cell
from momantu_bt.failure import INPUT_MISSING, WRONG_TYPE, Failure
from momantu_bt.skill import MISSING, Port
from momantu_bt.tree.model import Literal, PortValue, Reference, Scope, Template
from momantu_bt.tree.script import ScriptError, part
from momantu_bt.values.admit import admit
from momantu_bt.values.convert import convert
from momantu_bt.values.words import ConversionError, render

Reader: TypeAlias = Callable[[], Any]


def cell_of(reference: Reference, board: Board) -> Cell:
    """The cell of the key that a reference names; for `$found.pose` that of `found`."""
    mark = ROOT_MARK if reference.scope is Scope.ROOT else ""
    return board.cell(mark + reference.key)


def reader(port: Port, value: PortValue, board: Board) -> Reader:
    """Make a function that returns the input's value, converted to the port's type.

    Raises:
        ConversionError: a literal does not fit its port. (A key that does not fit raises Failure
            INPUT_MISSING or WRONG_TYPE when it is read.)
    """
    if isinstance(value, Literal):
        constant = convert(value.value, port)
        return lambda: constant
    if isinstance(value, Template):
        return _template_reader(port, value, board)
    return _wire_reader(port, value, board)


def wire(reference: Reference) -> str:
    """A reference as in a tree file: `$found.pose`, `$@key`."""
    mark = ROOT_MARK if reference.scope is Scope.ROOT else ""
    return "$" + ".".join((mark + reference.key, *reference.fields))


def _wire_reader(port: Port, reference: Reference, board: Board) -> Reader:
    """A function that reads a cell; it caches the converted value until the cell changes."""
    cell = cell_of(reference, board)
    last: Any = MISSING
    fitted: Any = None

    def read() -> Any:
        nonlocal last, fitted
        value = cell.value
        if value is not last or value is MISSING:
            fitted = _fitted(_follow(reference, cell, port.name), port, wire(reference))
            last = value
        return fitted

    return read


def _follow(reference: Reference, cell: Cell, port: str) -> Any:
    value = cell.value
    text = wire(reference)
    if value is MISSING:
        raise Failure(
            INPUT_MISSING,
            f"input {port} reads {text}, which holds no value: nobody has written it yet",
            port=port,
            key=text,
        )
    if not reference.fields:
        return value
    try:
        return part(value, reference.fields)
    except ScriptError as error:
        raise Failure(WRONG_TYPE, f"input {port} reads {text}: {error}", port=port) from None


def _fitted(value: Any, port: Port, source: str) -> Any:
    try:
        return convert(value, port)
    except ConversionError as error:
        raise Failure(
            WRONG_TYPE, f"input {port.name} reads {source}: {error}", port=port.name
        ) from None


def _template_reader(port: Port, template: Template, board: Board) -> Reader:
    pieces: list[str | tuple[Reference, Cell]] = [
        piece if isinstance(piece, str) else (piece, cell_of(piece, board))
        for piece in template.parts
    ]

    def read() -> Any:
        parts = [p if isinstance(p, str) else _follow(p[0], p[1], port.name) for p in pieces]
        return _fitted(render(parts), port, "a text")

    return read


class Inputs:
    """The inputs of one node by port name; each access reads the current value.

    constant: names of those that always have the same value.
    """

    def __init__(self, readers: Mapping[str, Reader], constant: Collection[str] = ()) -> None:
        self.readers = dict(readers)
        self._changing = [(n, read) for n, read in readers.items() if n not in constant]
        self._template = {n: read() if n in constant else None for n, read in readers.items()}

    def __getitem__(self, name: str) -> Any:
        return self.readers[name]()

    def __contains__(self, name: str) -> bool:
        return name in self.readers

    def all(self) -> dict[str, Any]:
        """The values of all inputs; the first that cannot be read raises a Failure."""
        values = self._template.copy()
        for name, read in self._changing:
            values[name] = read()
        return values


def inputs_of(ports: Mapping[str, Port], values: Mapping[str, PortValue], board: Board) -> Inputs:
    """Readers of all inputs that the tree gives or that have a default.

    Raises:
        ConversionError: a literal does not fit its port.
    """
    readers: dict[str, Reader] = {}
    constant: set[str] = set()
    for name, port in ports.items():
        if port.direction != "in":
            continue
        if name in values:
            given, steady = reader(port, values[name], board), isinstance(values[name], Literal)
            readers[name] = _perhaps(given, port) if port.may_be_empty else given
        elif port.default is not MISSING:
            readers[name], steady = _default_reader(port)
        else:
            continue
        if steady:
            constant.add(name)
    return Inputs(readers, constant)


def _perhaps(given: Reader, port: Port) -> Reader:
    """A reader of an input whose key may have no value: the input then is the port's default."""
    default, _ = _default_reader(port)

    def read() -> Any:
        try:
            return given()
        except Failure as failure:
            if failure.value.code == INPUT_MISSING:
                return default()
            raise

    return read


def _default_reader(port: Port) -> tuple[Reader, bool]:
    """A reader of the port's default, and whether the default fits the type.

    The default None fits every type and means "not given". One that does not fit raises Failure
    WRONG_TYPE when it is read.
    """
    try:
        default = None if port.default is None else admit(port.default, port)
    except Failure:
        return lambda: admit(port.default, port), False
    return lambda: default, True


class Output:
    """An output of a node that is connected to a key. cell: the key's cell."""

    def __init__(self, port: Port, cell: Cell) -> None:
        self.port = port
        self.cell = cell

    def write(self, value: Any) -> None:
        """Write a value; Failure WRONG_TYPE if it does not fit the port's type."""
        self.cell.store(admit(value, self.port))


def outputs_of(
    ports: Mapping[str, Port], values: Mapping[str, PortValue], board: Board
) -> dict[str, Output]:
    """The outputs that are connected to keys, by port name."""
    return {
        name: Output(ports[name], cell_of(value, board))
        for name, value in values.items()
        if name in ports and ports[name].direction == "out" and isinstance(value, Reference)
    }
