"""YAML values at node positions, as nodes of the model. Reads with a queue, not by recursion."""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Callable, Collection
from dataclasses import dataclass, field

from momantu_bt.failure import CODE
from momantu_bt.tree.catalogue import (
    BUILT_IN,
    FORCED,
    MODIFIERS,
    SPELLED,
    SUBTREE,
    SWITCHES,
    Kind,
    NodeSpec,
    ScriptText,
)
from momantu_bt.tree.model import (
    BROKEN,
    FIRST_INPUT,
    Handler,
    Literal,
    Node,
    Place,
    Reference,
)
from momantu_bt.tree.problems import Problems, nearest
from momantu_bt.tree.script import ScriptSyntaxError, canonical, parse
from momantu_bt.tree.yaml_source import Entries, Items, Raw, Scalar
from momantu_bt.tree.yaml_values import drop_duplicates, port_value, reported_braces, words

AGAIN = "again"
BTCPP = "btcpp"
"""Key of a script that our spelling has no words for: `skip_if: {btcpp: a && b || c}`."""
ANY = "any"
_HANDLER_CODE = re.compile(rf"(?:\w+\.)?{CODE.pattern}|{ANY}")
SWITCH = "switch"
COMPANIONS = {
    "if": ("then", "else"),
    "while_do": ("do", "else"),
    SWITCH: ("cases", "default"),
}
"""Keys that stand beside a node key and hold its other children."""

Put = Callable[[Node], None]


@dataclass(slots=True)
class NodeReader:
    """Reads node positions. trees: names of the document's trees."""

    trees: Collection[str]
    problems: Problems
    _waiting: deque[tuple[Raw, Put]] = field(default_factory=deque)

    def read(self, raw: Raw, put: Put) -> None:
        """Read one node and all below it, and give it to `put`; BROKEN where it cannot be."""
        self._waiting.append((raw, put))
        while self._waiting:
            following, its_put = self._waiting.popleft()
            its_put(self._node(following))

    def _error(self, code: str, place: Place, message: str, hint: str = "") -> None:
        self.problems.error(code, place, message, hint)

    def _broken(self, code: str, place: Place, message: str, hint: str = "") -> Node:
        self._error(code, place, message, hint)
        return Node(BROKEN, place)

    def _misfit(self, node: Node, value: Raw, message: str, hint: str = "") -> None:
        """A value of the wrong form: the node is read no further."""
        self._error("wrong-value", value.place, message, hint)
        node.type = BROKEN

    def _node(self, raw: Raw) -> Node:
        if isinstance(raw, Items):
            return self._list(raw)
        if isinstance(raw, Scalar):
            if isinstance(raw.value, str) and raw.value:
                return self._named(raw, Scalar(None, "", False, raw.place), [])
            return self._broken("not-a-node", raw.place, "a node is missing", "write its name")
        return self._mapping(raw)

    def _list(self, raw: Items) -> Node:
        node = Node("Sequence", raw.place)
        self._children(node, raw)
        return node

    def _children(self, node: Node, raw: Items) -> None:
        for item in raw.items:
            self._waiting.append((item, node.children.append))

    # a mapping: one node key and its modifiers

    def _mapping(self, raw: Entries) -> Node:
        drop_duplicates(raw, self.problems)
        chosen = self._node_key(raw)
        if chosen is None:
            written = ", ".join(key.text for key, _ in raw.entries)
            message = f"only modifiers here ({written}), no node" if written else "no node here"
            return self._broken("no-node", raw.place, message, "write one, such as `wait: 1 s`")
        key, value = chosen
        beside = [(k, v) for k, v in raw.entries if k is not key]
        companions = COMPANIONS.get(key.text, ())
        node = self._named(key, value, [(k, v) for k, v in beside if k.text in companions])
        return self._modified(node, [(k, v) for k, v in beside if k.text not in companions])

    def _node_key(self, raw: Entries) -> tuple[Scalar, Raw] | None:
        companions = {name for key, _ in raw.entries for name in COMPANIONS.get(key.text, ())}
        own = [e for e in raw.entries if e[0].text not in MODIFIERS and e[0].text not in companions]
        if not own:
            nodes = [e for e in raw.entries if _has_child(e[1]) and e[0].text in MODIFIERS]
            return nodes[-1] if nodes else None
        surely = [e for e in own if self._is_known(e[0].text) or not _near_modifier(e[0].text)]
        return (surely or own)[0]

    def _is_known(self, name: str) -> bool:
        return name in SPELLED or name in self.trees

    def _modified(self, node: Node, modifiers: list[tuple[Scalar, Raw]]) -> Node:
        outer = node
        for key, value in modifiers:
            kind = MODIFIERS.get(key.text)
            if kind == "decorator":
                outer = self._decorated(outer, key, value)
            elif kind == "condition":
                self._condition(node, key, value)
            elif kind == "key":
                self._node_entry(node, key, value)
            else:
                self._unknown_modifier(node, key)
        return outer

    def _unknown_modifier(self, node: Node, key: Scalar) -> None:
        near = _near_modifier(key.text)
        if near is not None:
            hint = f"did you mean {near}?"
        elif self._is_known(key.text) or node.type == BROKEN:
            hint = "begin each node with `- `"
        else:
            hint = f"begin it with `- ` if it is a node, indent it if it is a port of {_said(node)}"
        self._error("unknown-modifier", key.place, f"no modifier is called {key.text!r}", hint)

    def _node_entry(self, node: Node, key: Scalar, value: Raw) -> None:
        node.condition_places[key.text] = value.place
        if key.text == "disabled":
            found = self._flag(value)
            node.disabled = bool(found)
            return
        setattr(node, key.text, words(value, self.problems, f"`{key.text}`") or None)

    def _flag(self, value: Raw) -> bool | None:
        if isinstance(value, Scalar) and isinstance(value.value, bool):
            return value.value
        text = value.text if isinstance(value, Scalar) else ""
        near = {"yes": "true", "no": "false", "on": "true", "off": "false"}.get(text.lower())
        hint = f"did you mean {near}?" if near else "write true or false"
        self._error("wrong-value", value.place, "true or false is expected here", hint)
        return None

    def _condition(self, node: Node, key: Scalar, value: Raw) -> None:
        script = self._script(value)
        if script is not None:
            node.conditions[key.text] = script
            node.condition_places[key.text] = value.place

    def _script(self, value: Raw) -> str | None:
        if isinstance(value, Entries) and [key.text for key, _ in value.entries] == [BTCPP]:
            return self._btcpp_script(value.entries[0][1])
        if not isinstance(value, Scalar) or value.value is None:
            hint = "such as $n > 2; a script with `: ` or `{` must be quoted whole"
            self._error("script", value.place, "a script is expected here", hint)
            return None
        try:
            return canonical(value.text)
        except ScriptSyntaxError as error:
            self._error("script", _within(value, error), error.message, error.hint)
            return None

    def _btcpp_script(self, value: Raw) -> str | None:
        """A script in BehaviorTree.CPP's spelling, kept as it is."""
        text = value.text if isinstance(value, Scalar) else ""
        try:
            return parse(text).text
        except ScriptSyntaxError as error:
            place = _within(value, error) if isinstance(value, Scalar) else value.place
            self._error("script", place, error.message, error.hint)
            return None

    def _decorated(self, inner: Node, key: Scalar, value: Raw) -> Node:
        spec = self._decorator_spec(key, value)
        if spec is None:
            return inner
        node = Node(spec.type, key.place, written_as_modifier=True, children=[inner])
        if key.text == "force":
            return node
        if isinstance(value, Entries):
            self._ports(node, value, spec)
        elif spec.first is not None and not _is_empty(value):
            self._port(node, spec.first, value, key.place, spec)
        elif not _is_empty(value) and not (isinstance(value, Scalar) and value.value is True):
            self._error("wrong-value", value.place, f"`{key.text}` takes no value", "remove it")
        return node

    def _decorator_spec(self, key: Scalar, value: Raw) -> NodeSpec | None:
        if key.text != "force":
            return SPELLED[key.text]
        text = value.text if isinstance(value, Scalar) else ""
        if text in FORCED:
            return BUILT_IN[FORCED[text]]
        near = nearest(text, FORCED)
        hint = f"did you mean {near}?" if near else "write success or failure"
        self._error("wrong-value", value.place, "`force` is success or failure", hint)
        return None

    # one node by its name

    def _named(self, key: Scalar, value: Raw, companions: list[tuple[Scalar, Raw]]) -> Node:
        name = key.text
        if name == AGAIN:
            return self._broken(
                "again", key.place, "`again` stands alone, as a handler of `recover`"
            )
        if "$" in name:
            return self._broken("not-a-node", key.place, f"{name} is a wire, not a node")
        if name in BUILT_IN or name == SUBTREE:
            ours = BUILT_IN[name].yaml[0] if name in BUILT_IN else "the tree's name"
            hint = f"did you mean {ours}?"
            return self._broken("unknown-node", key.place, f"no node is called {name!r}", hint)
        if name == SWITCH:
            return self._switch(key, value, companions)
        spec = SPELLED.get(name)
        if spec is None:
            target = name if name in self.trees else None
            node = Node(SUBTREE if target else name, key.place, target=target)
            if target is None and isinstance(value, Entries) and _has_children(value):
                self._split(node, value, None, ("children",))
            else:
                self._leaf(node, value, None)
            return node
        node = Node(spec.type, key.place)
        if name in COMPANIONS:
            self._branches(node, value, companions)
        elif spec.handlers:
            self._with_handlers(node, value, spec)
        elif spec.kind is Kind.CONTROL:
            self._control(node, value, spec)
        elif spec.kind is Kind.DECORATOR:
            self._with_child(node, value, spec)
        else:
            self._leaf(node, value, spec)
        return node

    def _leaf(self, node: Node, value: Raw, spec: NodeSpec | None) -> None:
        if isinstance(value, Entries):
            if reported_braces(value, self.problems):
                node.type = BROKEN
            else:
                self._ports(node, value, spec)
        elif isinstance(value, Items) and (near := _near_control(node)) is not None:
            message = f"no node is called {node.type!r}"
            self._error("unknown-node", node.place, message, f"did you mean {near}?")
            node.type = BROKEN
        elif isinstance(value, Items):
            hint = f"write `{_said(node)}: {{port: value}}`, or begin with `sequence:`"
            self._misfit(node, value, f"{_said(node)} takes ports, no list", hint)
        elif value.value is not None or value.quoted:
            name = FIRST_INPUT if spec is None else spec.first
            if name is None:
                self._misfit(node, value, f"{_said(node)} takes no value")
            else:
                self._port(node, name, value, value.place, spec)

    def _ports(self, node: Node, raw: Entries, spec: NodeSpec | None) -> None:
        drop_duplicates(raw, self.problems)
        for key, value in raw.entries:
            self._port(node, key.text, value, key.place, spec)

    def _port(self, node: Node, name: str, value: Raw, place: Place, spec: NodeSpec | None) -> None:
        node.port_places[name] = value.place
        node.port_name_places[name] = place
        port = spec.ports.get(name) if spec is not None else None
        if port is not None and port.type is ScriptText:
            script = self._script(value)
            if script is not None:
                node.ports[name] = Literal(script)
            return
        found = port_value(value, name, self.problems)
        if found is None:
            found = Reference(BROKEN)
        node.ports[name] = found

    def _control(self, node: Node, value: Raw, spec: NodeSpec) -> None:
        if isinstance(value, Items):
            self._children(node, value)
        elif isinstance(value, Entries):
            self._split(node, value, spec, ("children",))
        elif value.value is not None:
            self._misfit(node, value, f"{_said(node)} takes a list of nodes")

    def _split(
        self, node: Node, raw: Entries, spec: NodeSpec | None, kept: tuple[str, ...]
    ) -> list[Raw]:
        """Ports of a mapping to the node; the values of the kept keys, `children` read."""
        drop_duplicates(raw, self.problems)
        values: list[Raw] = []
        for key, value in raw.entries:
            if key.text not in kept:
                self._port(node, key.text, value, key.place, spec)
            elif key.text == "children" and isinstance(value, Items):
                self._children(node, value)
            elif key.text == "children":
                self._misfit(node, value, "`children` is a list of nodes")
            else:
                values.append(value)
        return values

    def _with_child(self, node: Node, value: Raw, spec: NodeSpec) -> None:
        if not isinstance(value, Entries):
            hint = f"write `{spec.yaml[0]}: {{…, child: …}}`, or put it beside a node"
            self._misfit(node, value, f"{_said(node)} takes `child:`", hint)
            return
        for child in self._split(node, value, spec, ("child",)):
            self._waiting.append((child, node.children.append))

    def _branches(self, node: Node, value: Raw, companions: list[tuple[Scalar, Raw]]) -> None:
        places = {key.text: raw for key, raw in companions}
        condition = _as_condition(value)
        self._waiting.append((condition or value, node.children.append))
        for name in COMPANIONS[BUILT_IN[node.type].yaml[0]]:
            if name in places:
                self._waiting.append((places[name], node.children.append))
            elif name != "else":
                self._error("missing-child", node.place, f"`{_said(node)}` without `{name}:`")

    def _switch(self, key: Scalar, value: Raw, companions: list[tuple[Scalar, Raw]]) -> Node:
        """`switch: $x` with `cases:` and `default:` beside it, or with ports and `children:`."""
        if isinstance(value, Entries) and not companions:
            return self._plain_switch(key, value)
        beside = {name.text: raw for name, raw in companions}
        for name in COMPANIONS[SWITCH]:
            if name not in beside:
                message = f"`{SWITCH}` without `{name}:`"
                return self._broken(
                    "missing-child", key.place, message, f"write `{name}:` beside it"
                )
        cases = beside["cases"]
        fewest, most = min(SWITCHES), max(SWITCHES)
        if not isinstance(cases, Entries) or not fewest <= len(cases.entries) <= most:
            message = f"`cases` is a mapping of {fewest} to {most} values to nodes"
            hint = "such as `cases: {red: stop, green: go}`; `if` decides between two"
            return self._broken("wrong-value", cases.place, message, hint)
        drop_duplicates(cases, self.problems)
        spec = SWITCHES.get(len(cases.entries))
        if spec is None:  # there was a duplicate
            return Node(BROKEN, key.place)
        node = Node(spec.type, key.place)
        self._port(node, "variable", value, value.place, spec)
        for number, (case, raw) in enumerate(cases.entries, start=1):
            self._port(node, f"case_{number}", case, case.place, spec)
            self._waiting.append((raw, node.children.append))
        self._waiting.append((beside["default"], node.children.append))
        return node

    def _plain_switch(self, key: Scalar, value: Entries) -> Node:
        below = next((raw for name, raw in value.entries if name.text == "children"), None)
        count = len(below.items) - 1 if isinstance(below, Items) else 0
        if count not in SWITCHES:
            message = f"`{SWITCH}` takes a value, with `cases:` and `default:` beside it"
            return self._broken("missing-child", value.place, message, "such as `switch: $colour`")
        node = Node(SWITCHES[count].type, key.place)
        self._control(node, value, SWITCHES[count])
        return node

    def _with_handlers(self, node: Node, value: Raw, spec: NodeSpec) -> None:
        if not isinstance(value, Entries):
            self._misfit(node, value, f"{_said(node)} takes `try:` and `catch:`")
            return
        drop_duplicates(value, self.problems)
        for raw in self._split(node, _without(value, "catch"), spec, ("try",)):
            self._waiting.append((raw, node.children.append))
        having = {key.text: raw for key, raw in value.entries}
        for name in ("try", "catch"):
            if name not in having:
                self._error("missing-child", node.place, f"`{_said(node)}` without `{name}:`")
        if "catch" in having:
            self._handlers(node, having["catch"])

    def _handlers(self, node: Node, raw: Raw) -> None:
        if not isinstance(raw, Entries) or not raw.entries:
            hint = "under it, lines such as `CODE | OTHER_CODE: node`"
            self._error("wrong-value", raw.place, "`catch` is a mapping of codes to nodes", hint)
            return
        drop_duplicates(raw, self.problems)
        for key, value in raw.entries:
            handler = Handler(handler_codes(key.text, key.place, self.problems), None, key.place)
            node.handlers.append(handler)
            if isinstance(value, Scalar) and value.text == AGAIN:
                if node.type != "Recover":
                    self._error("again", value.place, "`again` has a meaning in `recover` alone")
                continue
            self._waiting.append((value, _handler_setter(handler)))


def handler_codes(text: str, place: Place, problems: Problems) -> tuple[str, ...]:
    """What a handler is for (`A | B`), without what cannot be a code, which is reported."""
    codes = tuple(part.strip() for part in text.split("|"))
    wrong = dict.fromkeys(code for code in codes if not _HANDLER_CODE.fullmatch(code))
    for code in wrong:
        hint = "codes are upper-case words, `A | B` several, `any` the rest"
        problems.error("bad-code", place, f"{code!r} is no failure code", hint)
    return tuple(code for code in codes if code not in wrong)


def _handler_setter(handler: Handler) -> Put:
    def put(node: Node) -> None:
        handler.node = node

    return put


def _without(raw: Entries, name: str) -> Entries:
    kept = [(key, value) for key, value in raw.entries if key.text != name]
    return Entries(kept, raw.place, raw.flow)


def _has_child(value: Raw) -> bool:
    return isinstance(value, Entries) and any(key.text == "child" for key, _ in value.entries)


def _has_children(value: Entries) -> bool:
    """Whether it is a control node that nobody knows here."""
    return any(key.text == "children" and isinstance(raw, Items) for key, raw in value.entries)


def _near_modifier(name: str) -> str | None:
    return nearest(name, MODIFIERS)


def _near_control(node: Node) -> str | None:
    """What a mistyped node with a list of others was meant to be."""
    controls = [name for name, spec in SPELLED.items() if spec.kind is Kind.CONTROL]
    return None if node.type in (SUBTREE, *BUILT_IN) else nearest(node.type, controls)


def _is_empty(value: Raw) -> bool:
    return isinstance(value, Scalar) and value.value is None and not value.quoted


def _said(node: Node) -> str:
    """The node as the file calls it."""
    spec = BUILT_IN.get(node.type)
    return node.target or (spec.yaml[0] if spec is not None else node.type)


def _as_condition(value: Raw) -> Raw | None:
    """`if: $n > 2` as the node `condition: $n > 2`; None where the value is a node itself."""
    if not isinstance(value, Scalar):
        return None
    if isinstance(value.value, str) and "$" not in value.value:
        return None
    key = Scalar("condition", "condition", False, value.place)
    return Entries([(key, value)], value.place)


def _within(value: Scalar, error: ScriptSyntaxError) -> Place:
    place = value.place
    quotes = 1 if value.quoted else 0
    if place.length != len(value.text) + 2 * quotes:
        return place  # several lines, or escapes: an offset in the text is none in the file
    offset = error.offset + quotes
    if offset >= place.length:
        return place
    return Place(place.file, place.line, place.column + offset, error.length)
