"""Keys of scripts: what a script reads must have a value, and its operands must fit together."""

from __future__ import annotations

import re
from collections.abc import Mapping

from momantu_bt.formats.places import Place, within
from momantu_bt.tree.catalogue.known import Key, Known
from momantu_bt.tree.check.keys.reads import KeyReads, Written
from momantu_bt.tree.check.keys.shared import ROOT_MARK
from momantu_bt.tree.model import Reference, Scope
from momantu_bt.tree.script import Script, ScriptSyntaxError, parse
from momantu_bt.tree.script.nodes import Variable
from momantu_bt.tree.script.types import Mismatch, check_types
from momantu_bt.values.kinds import ValueType

_WORD = re.compile(r"[^\W\d]\w*")


class ScriptKeys:
    """Checks the scripts of one tree. reads: the tree's keys, to which it adds."""

    def __init__(self, reads: KeyReads) -> None:
        self.reads, self.context, self.tree = reads, reads.context, reads.tree

    def run(self, text: str, before: Known, place: Place) -> Known:
        """What is known after a script. A script that cannot be read is reported."""
        try:
            script = parse(text)
        except ScriptSyntaxError as error:
            self.context.problems.error("script", place, error.message, error.hint)
            named = {word: Key(object, place) for word in _WORD.findall(text)}
            self.reads.given.update(named)
            return before.having_all(named)  # it may be meant to write what it names
        return self._keys(script, before, place)

    def _on_board(self, variable: str) -> str | None:
        """The key of the tree's own board that a script names; the root's in the main tree."""
        if not variable.startswith(ROOT_MARK):
            return variable
        return variable[1:] if self.tree.name == self.context.document.main else None

    def _written(self, written: Written) -> None:
        """Whether a script's key may be a result: the report shows the main tree's keys."""
        self.reads.written.append(written)
        if self.tree.name == self.context.document.main:
            self.reads.seen.add(written.key)

    def _place(self, key: str, place: Place) -> Place:
        """The place of a key in a script."""
        shown = key if self.context.in_xml(place) else f"${key}"
        return within(place, shown, self.context.document.source)

    def _types(self, script: Script, known: Mapping[str, ValueType], place: Place) -> None:
        """Report operands that do not fit together. Keys that the script writes have any type."""
        written = {variable.key for variable in script.writes}

        def type_of(variable: Variable) -> ValueType:
            name = ".".join((variable.key, *variable.parts))
            return object if variable.key in written else known.get(name, object)

        for statement in script.statements:
            try:
                check_types(statement, type_of)
            except Mismatch as mismatch:
                where, wrong = place, mismatch.variable
                if wrong is not None:
                    where = within(place, f"${wrong.key}", self.context.document.source)
                self.context.problems.error("wrong-type", where, str(mismatch))

    def _keys(self, script: Script, before: Known, place: Place) -> Known:
        """Check the keys that a script needs and reads, and record those that it writes."""
        for variable in script.reads:
            self.reads.see(_reference(variable.key))
        known: dict[str, ValueType] = {}
        for name, parts in dict.fromkeys((needed.key, needed.parts) for needed in script.needs):
            where = self._place(name, place)
            assigned = any(name == variable.key for variable in script.writes)
            read = self.reads.lookup(_reference(name), before, where, assigned=assigned)
            if read is not None:
                known[".".join((name, *parts))] = self.reads.part_of(read, parts, where) or object
        self._types(script, known, place)
        self.reads.given.update(variable.key for variable in script.writes)
        names = (self._on_board(v.key) for v in script.writes)
        keys = dict.fromkeys(name for name in names if name is not None)
        for key in keys:
            self._written(Written(key, self._place(key, place), "the script"))
        return before.having_all({name: Key(object, place) for name in keys})


def _reference(variable: str) -> Reference:
    if variable.startswith(ROOT_MARK):
        return Reference(variable[1:], scope=Scope.ROOT)
    return Reference(variable)
