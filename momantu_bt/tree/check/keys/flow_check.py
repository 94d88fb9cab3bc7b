"""Checks of keys and wires: nothing is read before it is written, and every value fits.

Each tree is walked once. The walk knows which keys surely have a value before each node. Its
result is what is known after the tree's success and after its failure.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeGuard

from momantu_bt.formats.names import valid_names
from momantu_bt.skill import Port
from momantu_bt.tree.catalogue import NODES, PRE_CONDITIONS, SUBTREE, NodeSpec
from momantu_bt.tree.catalogue.flow import After, Walk, as_written
from momantu_bt.tree.catalogue.known import NEVER, Key, Known, literal_type, meet
from momantu_bt.tree.catalogue.spec import Kind, Scripts
from momantu_bt.tree.check.keys.changes import KeyChanges
from momantu_bt.tree.check.keys.reads import Demand, KeyReads, Written, references
from momantu_bt.tree.check.keys.script_keys import ScriptKeys
from momantu_bt.tree.check.keys.shared import Call, call_of, shared_keys
from momantu_bt.tree.check.keys.switches import check_switch
from momantu_bt.tree.check.keys.unused import warn_of_unused_values
from momantu_bt.tree.check.reachable import report_unreachable
from momantu_bt.tree.check.signatures import Context, Signature
from momantu_bt.tree.model import Literal, Node, Reference, Scope, Tree
from momantu_bt.values.kinds import Fixed, Items, ScriptText, ValueType, kind_of
from momantu_bt.values.types import label


def check_keys(context: Context, order: list[Tree], root_keys: Mapping[str, Key | None]) -> None:
    """Check all keys of all trees. order: each tree comes after the trees that it runs.

    root_keys: every name that `$@name` can mean, with what is known of it, or None.
    """
    demands: dict[tuple[str, str], set[Demand]] = {}
    keys = shared_keys(context, order)
    if keys is None:
        return
    on_root: set[str] = set()
    checks = [
        _KeyCheck(KeyReads(context, tree, root_keys, demands, keys, on_root)) for tree in order
    ]
    for check in checks:
        check.run()
    for check in checks:
        check.report_unread()


class _KeyCheck:
    def __init__(self, reads: KeyReads) -> None:
        self.reads, self.context, self.tree = reads, reads.context, reads.tree
        self.ports = self.context.tree_signature(self.tree).ports
        self.changes = KeyChanges(self.context, self.tree, reads.keys)
        self.scripts = ScriptKeys(reads)
        self.walk = self.walking(self.node)
        self.at: dict[int, bool] = {}

    def run(self) -> None:
        after = self.node(self.tree.root, self.start())
        success, mine = after.passed, self.reads.keys[self.tree.name]
        mine.success = frozenset(success.keys or ())
        mine.failure = frozenset(after.failure.keys or ())
        mine.succeeds, mine.fails = success.reached, after.failure.reached
        if self.tree.name == self.context.document.main:
            self.reads.report_needed()
        for name, port in self.ports.items():
            if port.direction != "in":
                self.reads.seen.add(name)
            if port.direction == "out":
                self.output_of_tree(name, success.get(name), success)
        self.watched()

    def walking(self, into: Callable[[Node, Known], After]) -> Walk:
        """The functions with which a node's flow is walked."""
        removed, rewritten = self.changes.removed, self.changes.rewritten
        return Walk(into, removed, rewritten, self.outputs, self.script_at)

    def report_unread(self) -> None:
        """Report keys that are written and never read. Any tree may read the main tree's keys."""
        mine, seen = self.reads.keys[self.tree.name], self.reads.seen
        if self.tree.name == self.context.document.main:
            seen = seen | self.reads.seen_on_root
        for written in self.reads.written:
            unread = written.key not in seen and not written.live
            if unread and not mine.goes_out(written.key):
                wire = self.context.wire(written.key, written.place)
                message = f"nothing reads {wire}, which {written.said} writes"
                self.context.problems.warning("unread-output", written.place, message)
        if self.context.problems.grave:
            return
        report_unreachable(self.context, self.tree.root, self.at)
        if self.tree.name == self.context.document.main:
            warn_of_unused_values(self.context, self.tree, seen)

    def watched(self) -> None:
        """Check watched keys: they need not have a value, but something must write them."""
        given = {written.key for written in self.reads.written} | self.reads.given
        for watch in self.reads.watched if not (self.tree.open or self.tree.misread) else ():
            if watch.key not in given:
                message = f"nothing writes ${watch.key}, which {watch.said} watches"
                hint = valid_names(watch.key, sorted(given), "keys that something writes")
                self.context.problems.error("read-before-write", watch.place, message, hint)

    def start(self) -> Known:
        keys: dict[str, Key] = {}
        document = self.context.document
        if self.tree.name == document.main:
            for name, value in document.values.items():
                place = document.value_places.get(name, self.tree.place)
                keys[name] = Key(literal_type(value), place, (value,))
        for name, port in self.ports.items():
            if port.direction == "in":
                keys.setdefault(name, Key(port.type, self.tree.ports[name].place))
        self.reads.given.update(keys, self.ports)
        return Known(keys)

    def output_of_tree(self, name: str, key: Key | None, success: Known) -> None:
        place = self.tree.ports[name].place
        if key is None and success.reached and not self.tree.misread:
            message = f"the output {name!r} is not written on every way to success"
            self.context.problems.error("unwritten-output", place, message)
        for wrong in key.misfits(self.ports[name].type) if key is not None else ():
            message = f"the output {name!r} is {label(self.ports[name].type)}, "
            hint = f"line {wrong.place.line} writes it"
            self.context.problems.error(
                "wrong-type", place, message + f"but {label(wrong.type)} comes", hint
            )

    def at_any_tick(self, node: Node, before: Known) -> Known:
        """What is known when a node reads its wires again, during its children and after."""
        wired = any(isinstance(value, Reference) for value in node.ports.values())
        if not wired or not node.children:
            return before
        known = before.lacking(self.changes.removed(*node.children))
        written = (self.changes.rewritten(child) for child in node.children)
        return known.rewritten(each for changes in written for each in changes)

    def node(self, node: Node, before: Known) -> After:
        self.at[id(node)] = self.at.get(id(node), False) or before.reached
        if node.disabled:
            return After(NEVER, NEVER, before)
        if not node.conditions:
            return self.inside(node, before)
        # `while` and `on_halt` run at any tick, also after something below has taken a key away
        anytime = before.lacking(self.changes.removed(node))
        for name in PRE_CONDITIONS:
            if name in node.conditions:
                self.condition(node, name, anytime if name == "while" else before)
        after = self.inside(node, before)
        success, failure, skipped = after.success, after.failure, after.skipped
        if not node.conditions.keys().isdisjoint(PRE_CONDITIONS):
            # a condition may fail the node by its value, or because evaluating it fails
            failure = meet(failure, before)
        if "succeed_if" in node.conditions:
            success = meet(success, before)
        if not node.conditions.keys().isdisjoint(("skip_if", "while")):
            skipped = meet(skipped, anytime)
        if "on_halt" in node.conditions:
            self.condition(node, "on_halt", anytime)
        return self.post_scripts(node, After(success, failure, skipped))

    def condition(self, node: Node, name: str, known: Known) -> Known:
        place = node.condition_places.get(name, node.place)
        return self.scripts.run(node.conditions[name], known, place)

    def post_scripts(self, node: Node, after: After) -> After:
        success, failure, skipped = after.success, after.failure, after.skipped
        for name in ("on_success", "after"):
            if name in node.conditions:
                failure = meet(failure, success)
                success = self.condition(node, name, success)
        for name in ("on_failure", "after"):
            if name in node.conditions:
                failure = self.condition(node, name, failure)
        return After(success, failure, skipped)

    def inside(self, node: Node, before: Known) -> After:
        signature = self.context.signature(node)
        if signature is None:
            return self.elsewhere(node, before)
        self.reads.inputs(node, signature, self.at_any_tick(node, before))
        spec = signature.spec
        if spec is not None and spec.switch:
            check_switch(self.context, self.tree, node, self.at_any_tick(node, before))
        scripts = Scripts.ASKED if spec is None else spec.scripts
        for name, port in signature.ports.items():
            code = node.ports.get(name)
            if port.type is ScriptText and isinstance(code, Literal) and scripts is not Scripts.OWN:
                after = self.script_at(node, name, before)
                before = after if scripts is Scripts.RUN else before
        if node.type == SUBTREE:
            return self.subtree(call_of(self.context, node), before)
        if spec is None:
            return as_written(self.walk, node, before)
        if spec.item is not None:
            return spec.flow(self.with_item(node, spec.item), node, before)
        if spec.kind is not Kind.LEAF:
            before = self.handed_on(node, signature, spec, before)
        return spec.flow(self.walk, node, before)

    def elsewhere(self, node: Node, before: Known) -> After:
        """What is known after something that is not here: it may read and write what it names."""
        found: dict[str, Key] = {}
        for name, value in node.ports.items():
            for reference in references(value):
                self.reads.see(reference)
                if value is reference and reference.scope is Scope.LOCAL and reference.key:
                    place = node.port_places.get(name, node.place)
                    found[reference.key] = Key(object, place)
        self.reads.given.update(found)
        after = before.having_all(found)
        return After(after, after)

    def subtree(self, call: Call, before: Known) -> After:
        """Check a node that runs a tree: its needs, and which shared keys have a value then."""
        inside = self.reads.keys[call.tree.name]
        self.reads.of_call(call, inside, before)
        kept = before.lacking(call.local(inside.removed))
        success = self.outputs(call.node, kept)
        given = call.local(call.node.ports) if call.tree.misread else {}
        success = self.known_after(success, call, {**given, **call.local(inside.success)})
        failure = self.known_after(kept, call, {**given, **call.local(inside.failure)})
        return After(success if inside.succeeds else NEVER, failure if inside.fails else NEVER)

    def known_after(self, known: Known, call: Call, shared: Mapping[str, str]) -> Known:
        """Give values to keys that the tree inside shares. What was known of them may be outdated.

        shared: each key's name outside, with its name inside.
        """
        writes, ports = self.reads.keys[call.tree.name].written, call.tree.ports
        types = self.context.tree_signature(call.tree).ports
        having = known.keys or {}
        found: dict[str, Key] = {}
        for outer, inner in shared.items():
            if inner in writes or outer not in having:
                type_ = types[inner].type if inner in ports else object
                found[outer] = Key(type_, call.place(inner))
        return known.having_all(found)

    def outputs(self, node: Node, before: Known) -> Known:
        """What is known after the outputs of a node have been written."""
        signature = self.context.signature(node)
        if signature is None:
            return before
        copies = {} if signature.spec is None else signature.spec.copies
        after = before
        for name, value in node.ports.items():
            port = signature.ports.get(name)
            if not _writes(port, signature) or not isinstance(value, Reference):
                continue
            on_root = value.scope is Scope.ROOT
            if (on_root and self.tree.name != self.context.document.main) or value.fields:
                continue
            place = node.port_places.get(name, node.place)
            self.reads.given.add(value.key)
            if not on_root and port.direction == "out":
                self.reads.written.append(Written(value.key, place, signature.said, port.live))
            given = node.ports.get(copies.get(name, ""))
            type_ = literal_type(given) if isinstance(given, Literal) else port.type
            choices = () if signature.spec is None else _choices(node, name, signature.spec)
            after = after.having(value.key, Key(type_, place, choices=choices))
        return after

    def handed_on(self, node: Node, signature: Signature, spec: NodeSpec, before: Known) -> Known:
        """The keys that a node writes for its children, from the inputs that it copies."""
        after = before
        for name, value in node.ports.items():
            source = node.ports.get(spec.copies.get(name, ""))
            port = spec.ports.get(name)
            if port is None or port.direction != "out" or not isinstance(value, Reference):
                continue
            place = node.port_places.get(name, node.place)
            self.reads.written.append(Written(value.key, place, signature.said))
            key = before.get(source.key) if isinstance(source, Reference) else None
            if key is not None and value.scope is Scope.LOCAL:
                after = after.having(value.key, Key(key.type, place))
        return after

    def with_item(self, loop: Node, item: tuple[str, str]) -> Walk:
        """Walk a loop's child, which also knows the item."""
        output, source = item

        def walk(child: Node, before: Known) -> After:
            value = loop.ports.get(output)
            if isinstance(value, Reference) and value.scope is Scope.LOCAL:
                place = loop.port_places.get(output, loop.place)
                key = Key(self.item_type(loop, output, source, before), place)
                key = self.written_items(loop, source, before) or key
                before = before.having(value.key, key)
                self.reads.given.add(value.key)
            return self.node(child, before)

        return self.walking(walk)

    def written_items(self, loop: Node, source: str, before: Known) -> Key | None:
        """What is known of the item, for a loop over a list that is written in the file."""
        items = loop.ports.get(source)
        place = loop.port_places.get(source, loop.place)
        if isinstance(items, Reference) and not items.fields:
            root = items.scope is Scope.ROOT
            key = self.reads.root_keys.get(items.key) if root else before.get(items.key)
            if key is not None and len(key.literals) == 1:
                items, place = key.literals[0], key.place
        if not isinstance(items, Literal) or not isinstance(items.value, list) or not items.value:
            return None
        literals = tuple(Literal(item) for item in items.value)
        types = {literal_type(literal) for literal in literals}
        return Key(types.pop() if len(types) == 1 else object, place, literals)

    def item_type(self, loop: Node, output: str, source: str, before: Known) -> ValueType:
        declared = NODES[loop.type].ports[output].type
        items = loop.ports.get(source)
        if declared is object and isinstance(items, Reference) and not items.fields:
            key = before.get(items.key)
            match None if key is None else kind_of(key.type):
                case Items(item=item) | Fixed(items=(item, *_)):
                    return item.type
        return declared

    def script_at(self, node: Node, port: str, before: Known) -> Known:
        """What is known after the script at a port."""
        code = node.ports.get(port)
        if not isinstance(code, Literal):
            return before
        return self.scripts.run(str(code.value), before, node.port_places[port])


def _choices(node: Node, output: str, spec: NodeSpec) -> tuple[Literal, ...]:
    """The possible values of an output, if the file lists them."""
    listed = node.ports.get(spec.choices.get(output, ""))
    if not isinstance(listed, Literal) or not isinstance(listed.value, list):
        return ()
    return tuple(Literal(value) for value in listed.value)


def _writes(port: Port | None, signature: Signature) -> TypeGuard[Port]:
    """Whether a node itself writes what one of its ports is wired to; a subtree's nodes do it."""
    own = "inout" if signature.spec is not None else "out"
    return port is not None and port.direction in ("out", own)
