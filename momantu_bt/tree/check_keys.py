"""Keys and wires: nothing is read before it is written, and what flows fits where it flows.

Each tree is walked once, with what is surely known before each node; the result is what is
known after its success and after its failure.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from momantu_bt.failure import FailureValue
from momantu_bt.skill import Port
from momantu_bt.tree.catalogue import POST_SCRIPTS, PRE_CONDITIONS, SUBTREE, ScriptText
from momantu_bt.tree.check_nodes import check_name
from momantu_bt.tree.keys import NEVER, Key, Known, meet, part_type
from momantu_bt.tree.model import (
    BROKEN,
    Literal,
    Node,
    Place,
    PortValue,
    Reference,
    Scope,
    Template,
    Tree,
)
from momantu_bt.tree.problems import valid_names
from momantu_bt.tree.script import Script, ScriptSyntaxError, parse
from momantu_bt.tree.signatures import Context, Signature
from momantu_bt.tree.types import assignable, label, origin
from momantu_bt.tree.values import ConversionError, convert

FAILURE_KEY = "failure"
"""What a handler reads as `$failure`."""

After = tuple[Known, Known]
"""What is known after success, and after failure."""


@dataclass(slots=True)
class Written:
    """A key that a node's output goes to."""

    key: str
    place: Place
    said: str


@dataclass(slots=True)
class KeyCheck:
    """The check of one tree. root_keys: names on the root's board that `$@key` may read.

    demands: of each subtree's inputs, the kinds of names (place, surface, named_pose) that its
    nodes expect there; callees come first, so theirs are known.
    """

    context: Context
    tree: Tree
    root_keys: set[str]
    demands: dict[tuple[str, str], set[str]]
    read: set[str] = field(default_factory=set)
    written: list[Written] = field(default_factory=list)

    def run(self) -> None:
        """Walk the tree and report."""
        start = self.start()
        success, _ = self.node(self.tree.root, start)
        for name, declaration in self.tree.ports.items():
            if declaration.direction != "out":
                continue
            self.read.add(name)
            key = success.get(name)
            port = self.context.tree_signature(self.tree).ports[name]
            if key is None and success.reached:
                message = f"the output {name!r} is not written on every way to success"
                self.context.problems.error("unwritten-output", declaration.place, message)
            elif key is not None and not assignable(key.type, port.type):
                message = f"the output {name!r} is {label(port.type)}, but {label(key.type)} comes"
                self.context.problems.error("wrong-type", declaration.place, message)
        self.unread_outputs()

    def start(self) -> Known:
        keys: dict[str, Key] = {}
        if self.tree.name == self.context.document.main:
            for name, value in self.context.document.values.items():
                place = self.context.document.value_places.get(name, self.tree.place)
                keys[name] = Key(literal_type(value), place, value)
        for name, port in self.context.tree_signature(self.tree).ports.items():
            if port.direction == "in":
                keys[name] = Key(port.type, self.tree.ports[name].place)
        return Known(keys)

    def unread_outputs(self) -> None:
        for written in self.written:
            if written.key not in self.read:
                message = f"nothing reads ${written.key}, which {written.said} writes"
                self.context.problems.warning("unread-output", written.place, message)

    # one node

    def node(self, node: Node, before: Known) -> After:
        if node.disabled:
            return before, NEVER
        for name in PRE_CONDITIONS:
            if name in node.conditions:
                self.script(node.conditions[name], before, self.condition_place(node, name), node)
        success, failure = _FLOWS.get(node.type, KeyCheck.leaf)(self, node, before)
        if "fail_if" in node.conditions:
            failure = meet(failure, before)
        if not node.conditions.keys().isdisjoint(("succeed_if", "skip_if", "while")):
            success = meet(success, before)
        for name in POST_SCRIPTS:
            if name in node.conditions:
                success, failure = self.post_script(node, name, before, success, failure)
        return success, failure

    def condition_place(self, node: Node, name: str) -> Place:
        return node.condition_places.get(name, node.place)

    def post_script(
        self, node: Node, name: str, before: Known, success: Known, failure: Known
    ) -> After:
        text, place = node.conditions[name], self.condition_place(node, name)
        if name == "on_halt":
            self.script(text, before, place, node)
        if name in ("on_success", "after"):
            success = self.script(text, success, place, node)
        if name in ("on_failure", "after"):
            failure = self.script(text, failure, place, node)
        return success, failure

    def leaf(self, node: Node, before: Known) -> After:
        signature = self.context.signature(node)
        if signature is None:
            self.wires_of_unknown(node)
            return before, before
        self.inputs(node, signature, before)
        if node.type == "ScriptCondition" or node.type == "Script":
            return self.script_leaf(node, before)
        if node.type == "UnsetBlackboard":
            key = node.ports.get("key")
            after = before.lacking([key.key]) if isinstance(key, Reference) else before
            return after, before
        after = self.outputs(node, signature, before)
        if node.type == "AlwaysSuccess":
            return after, NEVER
        if node.type in ("AlwaysFailure", "Fail"):
            return NEVER, before
        return after, before

    def wires_of_unknown(self, node: Node) -> None:
        for value in node.ports.values():
            self.read.update(reference.key for reference in references(value))

    def script_leaf(self, node: Node, before: Known) -> After:
        code = node.ports.get("code")
        if not isinstance(code, Literal):
            return before, before
        after = self.script(str(code.value), before, node.port_places["code"], node)
        return after, before

    def inputs(self, node: Node, signature: Signature, before: Known) -> None:
        for name, value in node.ports.items():
            port = signature.ports.get(name)
            if port is None or port.direction == "out":
                continue
            place = node.port_places.get(name, node.place)
            if port.type is ScriptText and node.type == "Precondition":
                if isinstance(value, Literal):
                    self.script(str(value.value), before, place, node)
                continue
            for reference in references(value):
                whole = port if isinstance(value, Reference) else None
                self.wire(reference, before, place, whole, signature)
            if isinstance(value, Reference | Literal):
                self.named(node, name, value, before, port, place)

    def wire(
        self,
        reference: Reference,
        before: Known,
        place: Place,
        port: Port | None,
        signature: Signature,
    ) -> None:
        key = self.lookup(reference, before, place)
        if key is None or port is None:
            return
        if key.literal is not None and not reference.fields:
            self.literal_through(key, reference, place, port)
            return
        try:
            type_ = part_type(key.type, reference.fields)
        except KeyError as error:
            part, valid = error.args
            message = f"{label(key.type)} has no part {part!r}"
            hint = valid_names(part, valid, "parts")
            self.context.problems.error("unknown-part", place, message, hint)
            return
        if not assignable(type_, port.type):
            shown = ".".join((reference.key, *reference.fields))
            message = f"${shown} is {label(type_)}; {port.name!r} of {signature.said} takes "
            self.context.problems.error(
                "wrong-type", place, message + label(port.type), _written_at(key)
            )

    def literal_through(self, key: Key, reference: Reference, place: Place, port: Port) -> None:
        assert key.literal is not None
        try:
            convert(key.literal.value, port)
        except ConversionError as error:
            message = f"${reference.key} does not fit {port.name!r}: {error}"
            self.context.problems.error("wrong-value", place, message, _written_at(key))

    def named(
        self, node: Node, name: str, value: PortValue, before: Known, port: Port, place: Place
    ) -> None:
        """Names of places, surfaces and poses, through wires and into subtrees."""
        kinds = {port.names} if port.names is not None else set()
        if node.type == SUBTREE:
            kinds |= self.demands.get((node.target or "", name), set())
        if not kinds:
            return
        if isinstance(value, Literal) and node.type == SUBTREE:
            self.check_names(value, place, kinds)
        if not isinstance(value, Reference) or value.fields or value.scope is Scope.ROOT:
            return
        key = before.get(value.key)
        if key is not None and key.literal is not None:
            self.check_names(key.literal, key.place, kinds)
        elif value.key in self.tree.ports:
            known = {kind for kind in kinds if kind is not None}
            self.demands.setdefault((self.tree.name, value.key), set()).update(known)

    def check_names(self, value: Literal, place: Place, kinds: set[str | None] | set[str]) -> None:
        if isinstance(value.value, str):
            for kind in sorted(kind for kind in kinds if kind is not None):
                check_name(self.context, value.value, place, kind)

    def lookup(self, reference: Reference, before: Known, place: Place) -> Key | None:
        """What is known of a key that is read; None (and reported) when it may have no value."""
        self.read.add(reference.key)
        if reference.key == BROKEN or not before.reached:
            return None
        if reference.scope is Scope.ROOT:
            if reference.key not in self.root_keys:
                message = f"the root's board has no key {reference.key!r}"
                hint = valid_names(reference.key, sorted(self.root_keys), "keys")
                self.context.problems.error("unknown-key", place, message, hint)
            return None
        key = before.get(reference.key)
        if key is None:
            self.report_unwritten(reference.key, before, place)
        return key

    def report_unwritten(self, name: str, before: Known, place: Place) -> None:
        later = next((w for w in self.written if w.key == name), None)
        if later is not None:
            message = f"${name} may have no value here"
            hint = f"{later.said} (line {later.place.line}) writes it, but not on every way here"
        else:
            message = f"nothing writes ${name} before it is read here"
            hint = valid_names(name, sorted(before.keys or {}), "keys with a value here")
        self.context.problems.error("read-before-write", place, message, hint)

    def outputs(self, node: Node, signature: Signature, before: Known) -> Known:
        after = before
        for name, value in node.ports.items():
            port = signature.ports.get(name)
            if port is None or port.direction != "out" or not isinstance(value, Reference):
                continue
            place = node.port_places.get(name, node.place)
            if value.scope is Scope.ROOT:
                continue
            self.written.append(Written(value.key, place, signature.said))
            after = after.having(value.key, Key(self.output_type(node, port), place))
        return after

    def output_type(self, node: Node, port: Port) -> object:
        value = node.ports.get("value")
        if node.type == "SetBlackboard" and isinstance(value, Literal):
            return literal_type(value)
        return port.type

    def script(self, text: str, before: Known, place: Place, node: Node) -> Known:
        try:
            script = parse(text)
        except ScriptSyntaxError as error:
            self.context.problems.error("script", place, error.message, error.hint)
            return before
        return self.script_keys(script, before, place)

    def script_keys(self, script: Script, before: Known, place: Place) -> Known:
        after = before
        created: set[str] = set()
        for variable in script.reads:
            if variable.key in created or variable.key in {w.key for w in script.writes}:
                self.read.add(variable.key)
                if variable.key in {w.key for w in script.writes}:
                    continue
            self.lookup(_reference(variable.key), before, place)
        for variable in script.writes:
            if not variable.key.startswith("@"):
                after = after.having(variable.key, Key(object, place))
        return after

    # nodes with children

    def in_turn(self, node: Node, before: Known) -> After:
        failures = [NEVER]
        for child in node.children:
            before, failed = self.node(child, before)
            failures.append(failed)
        return before, meet(*failures)

    def until_success(self, node: Node, before: Known) -> After:
        successes = [NEVER]
        for child in node.children:
            succeeded, before = self.node(child, before)
            successes.append(succeeded)
        return meet(*successes), before

    def any_first(self, node: Node, before: Known) -> After:
        results = [self.node(child, before) for child in node.children]
        return meet(*(s for s, _ in results)), before

    def together(self, node: Node, before: Known) -> After:
        signature = self.context.signature(node)
        assert signature is not None
        self.inputs(node, signature, before)
        results = [self.node(child, before) for child in node.children]
        wanted = node.ports.get("success_count", Literal(-1))
        if node.type == "Parallel" and wanted == Literal(-1):
            success = before
            for succeeded, _ in results:
                for name, key in (succeeded.keys or {}).items():
                    success = success.having(name, key)
            return success, before
        return before, before

    def branches(self, node: Node, before: Known) -> After:
        if not node.children:
            return before, before
        yes, no = self.node(node.children[0], before)
        results = [self.node(c, b) for c, b in zip(node.children[1:], (yes, no), strict=False)]
        successes = [s for s, _ in results]
        failures = [f for _, f in results]
        if len(results) < 2:
            failures.append(no)
        return meet(*successes), meet(*failures)

    def recover(self, node: Node, before: Known) -> After:
        signature = self.context.signature(node)
        assert signature is not None
        self.inputs(node, signature, before)
        success, failure = self.all_of(node, before)
        handled = self.handlers(node, failure)
        failed = meet(failure, *(f for _, f in handled))
        if node.type == "Handle":
            return meet(success, *(s for s, _ in handled)), failed
        return success, failed

    def all_of(self, node: Node, before: Known) -> After:
        return self.node(node.children[0], before) if node.children else (before, before)

    def handlers(self, node: Node, failure: Known) -> list[After]:
        results: list[After] = []
        for handler in node.handlers:
            if handler.node is not None:
                told = failure.having(FAILURE_KEY, Key(FailureValue, handler.place))
                results.append(self.node(handler.node, told))
        return results

    def decorator(self, node: Node, before: Known) -> After:
        signature = self.context.signature(node)
        assert signature is not None
        self.inputs(node, signature, before)
        if node.type == "ForEach":
            return self.for_each(node, before)
        success, failure = self.all_of(node, before)
        if node.type == "Inverter":
            return failure, success
        if node.type == "ForceSuccess":
            return meet(success, failure), NEVER
        if node.type == "ForceFailure":
            return NEVER, meet(success, failure)
        if node.type == "KeepRunningUntilFailure":
            return NEVER, failure
        if node.type == "Precondition":
            return meet(success, before), meet(failure, before)
        return success, meet(failure, before)

    def for_each(self, node: Node, before: Known) -> After:
        item = node.ports.get("as")
        inside = before
        if isinstance(item, Reference):
            place = node.port_places["as"]
            type_ = self.item_type(node, before)
            inside = before.having(item.key, Key(type_, place))
            self.written.append(Written(item.key, place, "for_each"))
        success, failure = self.all_of(node, inside)
        return meet(success, before), failure

    def item_type(self, node: Node, before: Known) -> object:
        items = node.ports.get("in")
        if isinstance(items, Reference) and not items.fields:
            key = before.get(items.key)
            if key is not None and origin(key.type) is tuple:
                return key.type.__args__[0]
        return object


_FLOWS: dict[str, Callable[[KeyCheck, Node, Known], After]] = {
    **dict.fromkeys(
        ("Sequence", "AsyncSequence", "SequenceWithMemory", "ReactiveSequence"), KeyCheck.in_turn
    ),
    **dict.fromkeys(("Fallback", "AsyncFallback", "ReactiveFallback"), KeyCheck.until_success),
    "RoundRobin": KeyCheck.any_first,
    **dict.fromkeys(("Parallel", "ParallelAll"), KeyCheck.together),
    **dict.fromkeys(("IfThenElse", "WhileDoElse"), KeyCheck.branches),
    **dict.fromkeys(("Recover", "Handle"), KeyCheck.recover),
    **dict.fromkeys(
        (
            "RetryUntilSuccessful",
            "Repeat",
            "Timeout",
            "Delay",
            "Inverter",
            "ForceSuccess",
            "ForceFailure",
            "KeepRunningUntilFailure",
            "RunOnce",
            "Precondition",
            "ForEach",
        ),
        KeyCheck.decorator,
    ),
}


def references(value: PortValue) -> list[Reference]:
    """The keys that a port's value reads."""
    if isinstance(value, Reference):
        return [value]
    if isinstance(value, Template):
        return [part for part in value.parts if isinstance(part, Reference)]
    return []


def literal_type(value: Literal) -> object:
    """The type that a written value has where nothing says otherwise."""
    plain = value.value
    if isinstance(plain, bool | int | float):
        return type(plain)
    return object


def _reference(variable: str) -> Reference:
    if variable.startswith("@"):
        return Reference(variable[1:], scope=Scope.ROOT)
    return Reference(variable)


def _written_at(key: Key) -> str:
    return f"it comes from line {key.place.line}"
