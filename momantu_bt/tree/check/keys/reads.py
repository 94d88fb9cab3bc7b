"""Checks of each read of a key: value, type, part and name."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import TypeAlias

from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import NOWHERE, Place, within
from momantu_bt.formats.units import UnitError, in_unit
from momantu_bt.skill import Port
from momantu_bt.tree.catalogue import AUTOREMAP, SUBTREE
from momantu_bt.tree.catalogue.known import Key, Known, part_type
from momantu_bt.tree.check.bounds import converted
from momantu_bt.tree.check.keys.shared import Call, TreeKeys
from momantu_bt.tree.check.names import check_name, check_named
from momantu_bt.tree.check.nodes import autoremaps
from momantu_bt.tree.check.signatures import Context, Signature
from momantu_bt.tree.model import BROKEN, Literal, Node, PortValue, Reference, Scope, Template, Tree
from momantu_bt.values.convert import convert
from momantu_bt.values.kinds import Number, ScriptText, ValueType, kind_of, without_none
from momantu_bt.values.types import label
from momantu_bt.values.words import ConversionError

_CAPITALS = re.compile(r"[A-Z][A-Z0-9_]+")
_CHANGES = "`=` changes a key that has a value; `:=` makes a new one"

Demand: TypeAlias = tuple[str, str | Port]
"""What a value must be: a name, ("names", "place"), or a number with a unit, ("number", port)."""


@dataclass(frozen=True, slots=True)
class Written:
    """A key that a node writes or watches. said: the node, in the file's words.

    live: it is written while the node runs, also for observers outside the tree.
    """

    key: str
    place: Place
    said: str
    live: bool = False


@dataclass(slots=True)
class KeyReads:
    """The reads of one tree. Each is reported when it is met.

    root_keys: the keys that `$@key` may read, each with what is known of it, or None.
    demands: by tree and input, what nodes below expect of a text there; a tree comes before the
    trees that run it. written: what has been written so far, in the order of the file.
    given: keys that may come from elsewhere: a script, a loop, the tree's inputs. watched: keys
    that a node only looks at; who writes them is not known yet. keys: what is known of each tree's
    keys, by the tree's name. seen: keys of this tree that are read. seen_on_root: keys that any
    tree reads as `$@key`. told: keys without a value that are reported.
    """

    context: Context
    tree: Tree
    root_keys: Mapping[str, Key | None]
    demands: dict[tuple[str, str], set[Demand]]
    keys: dict[str, TreeKeys]
    seen_on_root: set[str]
    seen: set[str] = field(default_factory=set)
    written: list[Written] = field(default_factory=list)
    given: set[str] = field(default_factory=set)
    watched: list[Written] = field(default_factory=list)
    told: set[str] = field(default_factory=set)

    def inputs(self, node: Node, signature: Signature, before: Known) -> None:
        """Check all inputs of a node. Those that may be empty count as read and need no value."""
        lenient = signature.spec.may_be_empty if signature.spec is not None else ()
        self.seen.update(name for name in lenient if name not in node.ports)
        lenient += tuple(p.name for p in signature.ports.values() if p.may_be_empty)
        if node.type == SUBTREE:
            self.given.update(r.key for value in node.ports.values() for r in references(value))
        for name, value in node.ports.items():
            port = signature.ports.get(name)
            if port is None or port.direction == "out" or port.type is ScriptText:
                continue
            place = node.port_places.get(name, node.place)
            if name in lenient:
                self._watch(name, value, place, signature.said)
                continue
            if port.direction == "inout" and isinstance(value, Reference) and not value.fields:
                self._shared(value, before, place, port, signature.said)
                continue
            if isinstance(value, Reference):
                self._wire(value, before, place, port, signature.said)
            for reference in references(value):
                if value is not reference:
                    self.lookup(reference, before, place)
            self._demands(node, name, value, before, port)

    def _watch(self, port: str, value: PortValue, place: Place, said: str) -> None:
        for reference in references(value):
            self.see(reference)
            if reference.scope is Scope.LOCAL and reference.key not in (port, BROKEN):
                self.watched.append(Written(reference.key, place, said))

    def see(self, reference: Reference) -> None:
        """Note a key that something reads, whether it has a value or not."""
        (self.seen_on_root if reference.scope is Scope.ROOT else self.seen).add(reference.key)

    def lookup(
        self, reference: Reference, before: Known, place: Place, *, assigned: bool = False
    ) -> Key | None:
        """What is known of a key that is read here; None, with a report, if it may be empty.

        assigned: a script changes the key here.
        """
        self.see(reference)
        if reference.key == BROKEN or not before.reached:
            return None
        if reference.scope is Scope.ROOT:
            if reference.key not in self.root_keys:
                message = f"the root's board has no key {reference.key!r}"
                hint = valid_names(reference.key, sorted(self.root_keys), "keys")
                self.context.tell_elsewhere("unknown-key", place, message, hint)
            return self.root_keys.get(reference.key)
        key = before.get(reference.key)
        if key is None:
            self._unwritten(reference.key, before, place, assigned=assigned)
        return key

    def _unwritten(self, name: str, before: Known, place: Place, *, assigned: bool) -> None:
        """Report a key without a value, unless a caller or a write of `$@key` may give it one.

        Each key is reported once, where it is read first: the others follow from the same mistake.
        """
        if name in self.keys[self.tree.name].written_as_root or self.tree.misread:
            return
        if name in self.told:
            return
        declared = self.tree.ports.get(name)
        from_outside = self.tree.open if declared is None else declared.direction == "inout"
        if from_outside:
            self.keys[self.tree.name].needed.setdefault(name, place)
            return
        self.told.add(name)
        shown = self.context.wire(name, place)
        writer = next((w for w in self.written if w.key == name), None)
        if writer is not None:
            message = f"{shown} may have no value here"
            hint = f"{writer.said} (line {writer.place.line}) writes it, but not on every way here"
        else:
            message = f"nothing writes {shown} before it is read here"
            hint = valid_names(name, sorted(before.keys or {}), "keys that have a value here")
            if assigned and not hint.startswith("did you mean"):
                hint = _CHANGES
            hint = _enum_hint(name) or hint
        self.context.tell_elsewhere("read-before-write", place, message, hint)

    def of_call(self, call: Call, inside: TreeKeys, before: Known) -> None:
        """Check the keys that a tree needs, and the attributes that it never mentions."""
        for name, place in inside.needed.items():
            reference = call.outside(name)
            if reference is not None:
                self.lookup(reference, before, call.place(name))
            elif not call.gives_value(name):
                self._report_needed(name, place, inside)
        if autoremaps(call.node):
            for name, port in self.context.tree_signature(call.tree).ports.items():
                if port.direction == "in" and name not in call.node.ports:
                    self.lookup(Reference(name), before, call.node.place)
        for name in call.node.ports if call.tree.open else ():
            if name not in inside.mentioned and name not in (AUTOREMAP, *call.tree.ports):
                place = call.node.port_name_places.get(name, call.node.place)
                message = f"the tree {call.tree.name!r} never mentions {name!r}"
                hint = valid_names(name, sorted(inside.mentioned), "its keys")
                self.context.problems.warning("unused-port", place, message, hint)
        self.seen.update(call.local(inside.mentioned))

    def report_needed(self) -> None:
        """Report keys that the main tree reads and nothing outside writes."""
        mine = self.keys[self.tree.name]
        for name, place in mine.needed.items():
            self._report_needed(name, place, mine)

    def _report_needed(self, name: str, place: Place, keys: TreeKeys) -> None:
        shown = self.context.wire(name, place)
        if name in keys.written:
            message = f"{shown} may have no value here"
            hint = "something writes it, but perhaps not before"
            self.context.problems.warning("read-before-write", place, message, hint)
        else:
            hint = valid_names(name, sorted(keys.written), "keys that something writes")
            if not hint.startswith("did you mean"):
                hint = f"give it a value: --set {name}=…, or <momantu:Value key={name!r}>"
            hint = _enum_hint(name) or hint
            message = f"nothing writes {shown}, which is read here"
            self.context.tell_elsewhere("read-before-write", place, message, hint)

    def _shared(
        self, reference: Reference, before: Known, place: Place, port: Port, said: str
    ) -> None:
        """Check a key that may come in with a value: what is known of it must fit."""
        self.see(reference)
        key = before.get(reference.key) if reference.scope is Scope.LOCAL else None
        if key is not None and any(key.misfits(port.type)):
            message = f"{self.context.wire_to(reference, place)} is {label(key.type)}; "
            hint = _origin(key, place)
            message += f"{port.name!r} of {said} takes {label(port.type)}"
            self.context.problems.error("wrong-type", place, message, hint)

    def _report_misfit(self, key: Key, place: Place, message: str) -> None:
        """Report a value that is wrong for the node that reads it: where the value is written."""
        hint = f"it is used in {place.seen_from(key.place)}"
        self.context.problems.error("wrong-value", key.place, message, hint)

    def _wire(
        self, reference: Reference, before: Known, place: Place, port: Port, said: str
    ) -> None:
        key = self.lookup(reference, before, place)
        if key is None:
            return
        if key.literals and not reference.fields:
            wire = self.context.wire_to(reference, place)
            for literal in key.literals:
                try:
                    found = converted(literal.value, port)
                except ConversionError as error:
                    message = f"{wire} does not fit {port.name!r} of {said}: {error}"
                    self._report_misfit(key, place, message)
                else:
                    check_named(self.context, found, key.place, replace(port, names=None))
            return
        type_ = self.part_of(key, reference.fields, place)
        whole = Key(type_, key.place, either=() if reference.fields else key.either)
        for wrong in whole.misfits(port.type) if type_ is not None else ():
            wire = self.context.wire_to(reference, place)
            wanted = f"{port.name!r} of {said} takes {label(port.type)}"
            message = f"{wire} is {label(wrong.type)}; {wanted}"
            hint = self._fitting_part(reference, wrong, port, place) or _origin(wrong, place)
            self.context.problems.error("wrong-type", place, message, hint)

    def _fitting_part(self, wire: Reference, key: Key, port: Port, place: Place) -> str:
        """The hint that names the one part of the value that has the wanted type; else empty."""
        record = key.type if isinstance(key.type, type) and is_dataclass(key.type) else None
        parts = [] if record is None else [item.name for item in fields(record)]
        types = {name: part_type(key.type, (name,)) for name in parts}
        fit = [
            name
            for name, type_ in types.items()
            if type_ is not object and not any(Key(type_, place).misfits(port.type))
        ]
        if len(fit) != 1:
            return ""
        part = replace(wire, fields=(*wire.fields, fit[0]))
        return f"did you mean {self.context.wire_to(part, place)}?"

    def part_of(self, key: Key, parts: tuple[str, ...], place: Place) -> ValueType | None:
        """The type of a part of a key's value; None, with a report, if there is no such part."""
        try:
            return part_type(key.type, parts)
        except KeyError as error:
            whole, part, valid = error.args
            message = f"{label(whole)} has no part {part!r}"
            hint = valid_names(part, valid, "parts")
            self.context.problems.error("unknown-part", place, message, hint)
            return None

    def _demands(self, node: Node, name: str, value: PortValue, before: Known, port: Port) -> None:
        """Check names and quantities that reach a port by wire or through a subtree."""
        demands: set[Demand] = {("names", port.names)} if port.names is not None else set()
        if port.unit is not None or port.bounded:
            demands.add(
                (
                    "number",
                    replace(
                        _NUMBER,
                        unit=port.unit,
                        least=port.least,
                        most=port.most,
                        endless=port.endless,
                    ),
                )
            )
        if self._takes_number(value, before, port):
            demands.add(("text", Port(port.name, "in", port.type, "", unit=port.unit)))
        if node.type == SUBTREE:
            demands |= self.demands.get((node.target or "", name), set())
            if isinstance(value, Literal):
                self._check_demands(value, node.port_places.get(name, node.place), demands)
        if not isinstance(value, Reference) or value.fields:
            return
        root = value.scope is Scope.ROOT
        key = self.root_keys.get(value.key) if root else before.get(value.key)
        if key is not None and key.literals:
            if node.type != SUBTREE:  # the check of the wire has converted it with the port's unit
                demands = {demand for demand in demands if demand[0] == "names"}
            for literal in key.literals:
                self._check_demands(literal, key.place, demands)
        elif root or not demands:
            return
        elif value.key in self.tree.ports or self._is_open(value, before):
            self.demands.setdefault((self.tree.name, value.key), set()).update(demands)

    def _is_open(self, value: Reference, before: Known) -> bool:
        """Whether a key comes from whoever runs this tree, which declares no type for it."""
        return self.tree.open and value.key not in self.tree.ports and not before.get(value.key)

    def _takes_number(self, value: PortValue, before: Known, port: Port) -> bool:
        """Whether a number is read here from a key that may hold a text from outside."""
        kinds = without_none(kind_of(port.type))
        numbers = all(isinstance(kind, Number) for kind in kinds)
        return numbers and isinstance(value, Reference) and self._is_open(value, before)

    def _check_demands(self, value: Literal, place: Place, demands: set[Demand]) -> None:
        items = value.value if isinstance(value.value, list) else [value.value]
        for kind, what in sorted(demands, key=repr):
            for item in items:
                if isinstance(what, Port) and kind == "text":
                    self._check_text(item, place, what)
                elif isinstance(what, Port):
                    self._check_number(item, place, what)
                elif isinstance(item, str):
                    where = within(place, item, self.context.document.source)
                    check_name(self.context, item, where if item != value.value else place, what)

    def _check_text(self, value: object, place: Place, port: Port) -> None:
        """Check a text that a port for numbers reads inside an open tree, such as `1.500`."""
        try:
            convert(value if isinstance(value, str) else 0, port)
        except ConversionError as error:
            message = f"the tree reads it as a number, at {port.name!r}: {error}"
            self.context.problems.error("wrong-value", place, message)

    def _check_number(self, value: object, place: Place, port: Port) -> None:
        """Check a quantity or a number; other values are checked by their type."""
        try:
            text = isinstance(value, str)
            if text and (port.unit is None or in_unit(str(value), port.unit) is None):
                return
            if text or (isinstance(value, int | float) and not isinstance(value, bool)):
                converted(value, port)
        except (UnitError, ConversionError) as error:
            self.context.problems.error("wrong-value", place, str(error))


_NUMBER = Port("", "in", float, "")


def _origin(key: Key, place: Place) -> str:
    """Where a key's value comes from, in words; empty for what the run itself publishes."""
    return "" if key.place is NOWHERE else f"it comes from {key.place.seen_from(place)}"


def _enum_hint(name: str) -> str:
    """A hint for a name in capitals, which may be an enum that a program registers in C++."""
    if not _CAPITALS.fullmatch(name):
        return ""
    return (
        f"if {name} is an enum of a C++ program: those are not known here; write its number, or "
        f"give the main tree the value {name} and read it elsewhere as @{name}"
    )


def references(value: PortValue) -> list[Reference]:
    """The keys that a port's value reads."""
    if isinstance(value, Reference):
        return [value]
    if isinstance(value, Template):
        return list(dict.fromkeys(part for part in value.parts if isinstance(part, Reference)))
    return []
