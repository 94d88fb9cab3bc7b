"""YAML files as documents: every form a node can have, and the header's own mistakes."""

from collections.abc import Callable
from typing import Any

import pytest

from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.model import Document, Literal, Node, Reference, Scope, Template

Expect = Callable[..., None]


def document(text: str) -> Document:
    """A document that reads without a problem."""
    found, problems = read("momantu_bt: 1\n" + text, "t.yaml")
    assert problems.sorted() == []
    return found


def root(node: str) -> Node:
    """The root of `Main`, written on one line."""
    return document(f"trees: {{Main: {node}}}\n").trees["Main"].root


def test_header() -> None:
    found = document(
        "world: rooms\nmain: B\nvalues: {a: 66 mm, b: [1, x]}\ntrees: {A: w, B: [A]}\n"
    )
    assert (found.world, found.main, list(found.trees)) == ("rooms", "B", ["A", "B"])
    assert found.values == {"a": Literal("66 mm"), "b": Literal([1, "x"])}
    assert found.trees["B"].root.children[0].target == "A"


def test_one_tree_needs_no_main() -> None:
    assert document("trees: {Only: w}\n").main == "Only"


def test_a_list_is_a_sequence() -> None:
    node = root("[a, [b, c]]")
    assert (node.type, [c.type for c in node.children]) == ("Sequence", ["a", "Sequence"])
    assert [c.type for c in node.children[1].children] == ["b", "c"]


def test_ports_and_bare_values() -> None:
    assert root("{pick: {object: $can, lift: 3 cm}}").ports == {
        "object": Reference("can"),
        "lift": Literal("3 cm"),
    }
    assert root("{wait: 5 s}").ports == {"duration": Literal("5 s")}
    assert root("pick").ports == root("{pick: }").ports == root("{pick: {}}").ports == {}


def test_children_beside_ports() -> None:
    node = root("{parallel: {failure_count: 2, children: [a, b]}}")
    assert node.ports == {"failure_count": Literal(2)}
    assert [child.type for child in node.children] == ["a", "b"]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("$key", Reference("key")),
        ("'$key'", Reference("key")),
        ("$@key", Reference("key", (), Scope.ROOT)),
        ("$key.pose.x", Reference("key", ("pose", "x"))),
        ("$=", Reference("port")),
        ("$$key", Literal("$key")),
        ('"a ${key.x} of ${@all}, $$5"', None),
        ("plain", Literal("plain")),
        ("[a, $$b]", Literal(["a", "$b"])),
        ("true", Literal(True)),
    ],
)
def test_wires(text: str, value: object) -> None:
    found = root(f"{{say: {{port: {text}}}}}").ports["port"]
    if value is None:
        value = Template(
            ("a ", Reference("key", ("x",)), " of ", Reference("all", (), Scope.ROOT), ", $5")
        )
    assert found == value


def test_modifiers_wrap_in_the_order_written() -> None:
    outer = root("{go: {x: 1}, retry: 3, name: way, timeout: 60 s, skip_if: not $a, note: why}")
    assert (outer.type, outer.ports) == ("Timeout", {"duration": Literal("60 s")})
    inner = outer.children[0]
    assert (inner.type, inner.ports) == ("RetryUntilSuccessful", {"attempts": Literal(3)})
    assert outer.written_as_modifier
    node = inner.children[0]
    assert (node.type, node.name, node.note) == ("go", "way", "why")
    assert node.conditions == {"skip_if": "!a"}


@pytest.mark.parametrize(
    ("text", "type_"),
    [
        ("{go: , invert: }", "Inverter"),
        ("{go: , invert: true}", "Inverter"),
        ("{go: , force: success}", "ForceSuccess"),
        ("{go: , force: failure}", "ForceFailure"),
        ("{go: , repeat: {cycles: 3}}", "Repeat"),
        ("{go: , else_fail: LOST}", "ElseFail"),
        ("{go: , else_fail: {code: LOST, message: gone}}", "ElseFail"),
        ("{else_fail: {code: LOST, child: go}}", "ElseFail"),
        ("{invert: {child: go}}", "Inverter"),
        ("{retry: {attempts: 3, child: go}}", "RetryUntilSuccessful"),
        ("{force_success: {child: go}}", "ForceSuccess"),
        ("{precondition: {if: $a, child: go}}", "Precondition"),
        ("{for_each: {in: $a, as: $b, child: go}}", "ForEach"),
    ],
)
def test_decorators_in_both_forms(text: str, type_: str) -> None:
    node = root(text)
    assert (node.type, node.children[0].type) == (type_, "go")


def test_a_decorator_as_a_node_can_have_modifiers() -> None:
    node = root("{invert: {child: go}, timeout: 3 s}")
    assert [n.type for n in node.walk()] == ["Timeout", "Inverter", "go"]


def test_if_and_while() -> None:
    node = root("{if: $n > 2, then: a, else: [b]}")
    assert [c.type for c in node.children] == ["ScriptCondition", "a", "Sequence"]
    assert node.children[0].ports == {"code": Literal("n > 2")}
    assert [c.type for c in root("{if: asked, then: a}").children] == ["asked", "a"]
    node = root("{while_do: {asked: {x: 1}}, do: a, else: b}")
    assert (node.type, [c.type for c in node.children]) == ("WhileDoElse", ["asked", "a", "b"])


def test_recover() -> None:
    node = root("{recover: {attempts: 3, try: [a], catch: {A | B: again, pick.C: b, any: {c: }}}}")
    assert (node.type, node.ports) == ("Recover", {"attempts": Literal(3)})
    assert [child.type for child in node.children] == ["Sequence"]
    handlers = [(h.codes, h.node.type if h.node else None) for h in node.handlers]
    assert handlers == [(("A", "B"), None), (("pick.C",), "b"), (("any",), "c")]


def test_inputs_and_outputs() -> None:
    found = document(
        "main: Main\ntrees:\n  Main: [Sub]\n  Sub:\n"
        "    inputs: {a: list of pose, b: {type: int, default: 3}}\n"
        "    outputs: {c: {type: text, doc: what}}\n    doc: Does it.\n    go: {x: $a}\n"
    ).trees["Sub"]
    shown = {p.name: (p.direction, p.type_name, p.default, p.doc) for p in found.ports.values()}
    assert shown == {
        "a": ("in", "list of pose", None, ""),
        "b": ("in", "int", Literal(3), ""),
        "c": ("out", "text", None, "what"),
    }
    assert (found.doc, found.root.type) == ("Does it.", "go")


def test_a_tree_may_be_open_and_a_key_may_come_in_and_go_out() -> None:
    trees = document(
        "main: Main\ntrees:\n  Main: [Sub, Any]\n  Any: {open: true, go: {}}\n  Sub:\n"
        "    inouts: {a: {type: pose, default: $p}}\n    go: {x: $a}\n"
    ).trees
    port = trees["Sub"].ports["a"]
    assert (port.direction, port.type_name, port.default) == ("inout", "pose", Reference("p"))
    assert (trees["Any"].open, trees["Sub"].open) == (True, False)


def test_a_script_of_behaviortree_cpp() -> None:
    node = root("{succeed: , skip_if: {btcpp: a && b || c}}")
    assert node.conditions == {"skip_if": "a && b || c"}


def test_names_and_notes() -> None:
    node = root('{succeed: , name: "", note: 5}')
    assert (node.name, node.note) == (None, "5")


def test_every_node_knows_its_place() -> None:
    found = document("trees:\n  Main:\n    - a\n    - b: {x: $k}\n      retry: 2\n")
    places = {n.type: (n.place.line, n.place.column) for n in found.trees["Main"].root.walk()}
    assert places["a"] == (4, 7)
    assert places["b"] == (5, 7)
    assert places["RetryUntilSuccessful"] == (6, 7)
    node = found.trees["Main"].root.children[1].children[0]
    assert (node.port_places["x"].column, node.port_name_places["x"].column) == (14, 11)


@pytest.mark.parametrize(
    ("text", "code", "hint"),
    [
        ("«[a]»", "not-a-tree", "momantu_bt: 1"),
        ("«m»omantu_bt: 1\n", "no-trees", "trees:"),
        ("momantu_bt: 1\n«trees»:\n", "no-trees", "Name:"),
        ("momantu_bt: «2»\ntrees: {A: {wait: 1}}\n", "wrong-version", "known: 1"),
        ("«t»rees: {A: {wait: 1}}\n", "no-version", "begin with"),
        ("momantu_bt: 1\n«wrld»: rooms\ntrees: {A: {wait: 1}}\n", "unknown-key", "world?"),
        ("momantu_bt: 1\nworld: «3»\ntrees: {A: {wait: 1}}\n", "wrong-value", ""),
        ("momantu_bt: 1\ntrees: {«A»: A2, A2: {wait: 1}}\n", "no-main", "main: A"),
        ("momantu_bt: 1\nmain: «a»\ntrees: {A: {wait: 1}}\n", "unknown-tree", "A?"),
        (
            "momantu_bt: 1\nvalues: {«$a»: 1}\ntrees: {A: {wait: 1}}\n",
            "bad-name",
            "did you mean a?",
        ),
        ("momantu_bt: 1\nvalues: {a: «$b»}\ntrees: {A: {wait: 1}}\n", "wire-inside", ""),
        ("momantu_bt: 1\nvalues: «3»\ntrees: {A: {wait: 1}}\n", "wrong-value", "{key: value}"),
        ("momantu_bt: 1\ntrees: {«wait»: {wait: 1}}\n", "bad-name", "another name"),
        ("momantu_bt: 1\ntrees: {«my/tree»: {wait: 1}}\n", "bad-name", "one line"),
        ("momantu_bt: 1\ntrees: {«A»: {inputs: {a: int}}}\n", "no-node", ""),
        ("momantu_bt: 1\ntrees: {A: {wait: 1, disabled: «yes»}}\n", "wrong-value", "true?"),
        ("momantu_bt: 1\ntrees: {A: {wait: 1, force: «sucess»}}\n", "wrong-value", "success?"),
        ("momantu_bt: 1\ntrees: {A: {wait: 1, invert: «3»}}\n", "wrong-value", "remove it"),
        ("momantu_bt: 1\ntrees: {A: {say: «[a]»}}\n", "wrong-value", "port: value"),
        ("momantu_bt: 1\ntrees: {A: {sequence: «3»}}\n", "wrong-value", ""),
        ("momantu_bt: 1\ntrees: {A: [«$x»]}\n", "not-a-node", ""),
        ("momantu_bt: 1\ntrees: {A: [{wait: 1}, «~»]}\n", "not-a-node", "write its name"),
        ("momantu_bt: 1\ntrees: {A: {say: «$5 off»}}\n", "dollar", "$$ for a dollar"),
        ("momantu_bt: 1\ntrees: {A: {say: {text: a, pace: [«$a»]}}}\n", "wire-inside", ""),
        ("momantu_bt: 1\ntrees: {A: {wait: 1, skip_if: «[a]»}}\n", "script", ""),
        ("momantu_bt: 1\ntrees: {A: {wait: 1, skip_if: {btcpp: «&&»}}}\n", "script", ""),
        ('momantu_bt: 1\ntrees: {A: {wait: 1, name: «"a\\0"»}}\n', "wrong-value", "remove it"),
        ("momantu_bt: 1\ntrees: {A: {wait: 1, note: «[a]»}}\n", "wrong-value", ""),
        ("momantu_bt: 1\nmodels: «3»\ntrees: {A: {wait: 1}}\n", "wrong-value", "Action: Name"),
        ("momantu_bt: 1\nmodels: [«{editable: true}»]\ntrees: {A: {wait: 1}}\n", "wrong-value", ""),
        (
            "momantu_bt: 1\nmodels: [{Action: a, «b»: c}]\ntrees: {A: {wait: 1}}\n",
            "unknown-key",
            "",
        ),
    ],
)
def test_what_is_refused(expect: Expect, text: str, code: str, hint: str) -> None:
    expect(code, text, hint=hint, whole=True)


def test_every_duplicate_key_is_reported(check: Any) -> None:
    text = (
        "momantu_bt: 1\nmain: M\nmain: M\ntrees:\n  M:\n    - {wait: 1, wait: 2}\n"
        "    - say: {text: a, text: b, pace: 1, pace: 2}\n  M: [{wait: 1}]\n"
    )
    found = [(p.code, p.place.line) for p in check(text)]
    assert found == [("duplicate-key", line) for line in (3, 6, 7, 7, 8)]
