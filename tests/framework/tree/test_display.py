"""What a terminal shows: every node and value in words."""

import pytest

from momantu_bt.tree.catalogue import CONDITIONS, NODES
from momantu_bt.tree.catalogue.wording import value_text
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.model import Document, Literal, Reference, Scope, Template
from momantu_bt.tree.show.printing import lines


def document(node: str) -> Document:
    """A tree `Main` of one node, beside a tree `Sub`."""
    text = f"momantu_bt: 1\nmain: Main\ntrees:\n  Main: {node}\n  Sub: {{inputs: [x], leaf: $x}}\n"
    found, problems = read(text, "t.yaml")
    assert problems.sorted() == []
    return found


WRITTEN = {
    "Handle": ("{handle: {try: a, catch: {X: b}}}", ["handle", "a", "on X:", "b"]),
    "Recover": (
        "{recover: {attempts: 1, try: a, catch: {X: again}}}",
        ["recover with 1 try", "a", "on X: try again"],
    ),
    "IfThenElse": ("{if: a, then: b}", ["if", "if: a", "then: b"]),
    "WhileDoElse": (
        "{while_do: $n > 1, do: a, else: b}",
        ["while", "while: condition $n > 1", "do: a", "else: b"],
    ),
    "ForEach": ("{for_each: {in: $l, as: $i, child: a}}", ["for each in $l, as $i", "a"]),
    "Precondition": ("{precondition: {if: not $b, child: a}}", ["precondition not $b", "a"]),
    "Parallel": (
        "{parallel: {success_count: 1, children: [a]}}",
        ["parallel success_count 1", "a"],
    ),
    "Fail": ("{fail: OH_NO}", ["fail OH_NO"]),
    "Script": ("{script: '$n := 1; $m := $n'}", ["script $n := 1; $m := $n"]),
    "ScriptCondition": ("{condition: $a&&$b}", ["condition $a and $b"]),
    "SetBlackboard": ("{set: {key: $k, value: [1, true]}}", ["set key $k, value [1, true]"]),
    "UnsetBlackboard": ("{unset: $k}", ["unset $k"]),
    "Sleep": ("{wait: 1 min 30 s}", ["wait 1 min 30 s"]),
    "AlwaysSuccess": ("succeed", ["succeed"]),
    "RetryUntilSuccessful": ("{a: , retry: 1}", ["a  (1 try)"]),
    "Repeat": ("{a: , repeat: -1}", ["a  (rounds without end)"]),
    "Timeout": ("{a: , timeout: $t}", ["a  (at most $t)"]),
    "Delay": ("{a: , delay: 0.5}", ["a  (after 0.5 s)"]),
    "Inverter": ("{invert: {child: [a]}}", ["sequence  (inverted)", "a"]),
    "ElseFail": ("{a: , else_fail: LOST, retry: 2}", ["a  (else LOST, 2 tries)"]),
    "RunOnce": ("{a: , run_once: }", ["a  (once only)"]),
    "Switch2": (
        "{switch: $x, cases: {1: a, go: [b]}, default: c}",
        ["switch $x", "1: a", "go: sequence", "b", "else: c"],
    ),
    **{
        f"Switch{n}": (
            f"{{switch: $x, cases: {{{', '.join(f'{i}: a' for i in range(n))}}}, default: b}}",
            ["switch $x", *(f"{i}: a" for i in range(n)), "else: b"],
        )
        for n in range(3, 7)
    },
    "TryCatch": ("{try_catch: [a, b, c]}", ["try catch", "a", "b", "in any failure: c"]),
    "RecoveryNode": ("{recovery_node: [a, b]}", ["recovery node", "a", "to recover: b"]),
    "SkipUnlessUpdated": ("{a: , skip_unless_updated: $k}", ["a  (only when $k is new)"]),
    "WaitValueUpdate": ("{a: , wait_value_update: $k}", ["a  (waits until $k is written)"]),
    "SingleTrigger": ("{a: , single_trigger: }", ["a  (once at each start)"]),
    "SubTree": ("{Sub: {x: 3}, name: here}", ["here: Sub x 3"]),
}


@pytest.mark.parametrize("type_", sorted({*NODES, *WRITTEN}))
def test_every_kind_of_node_in_words(type_: str) -> None:
    spec = NODES.get(type_)
    if type_ in WRITTEN:
        node, expected = WRITTEN[type_]
        shown = [line.text for line in lines(document(node)) if line.depth > 0]
        assert shown[:-1] == expected
        return
    assert spec is not None
    child = "a" if spec.positions == ("child",) else "[a, b]"
    node = spec.yaml[0] if spec.children == (0, 0) else f"{{{spec.yaml[0]}: {child}}}"
    if spec.positions == ("child",):
        node = f"{{{spec.yaml[0]}: {{child: a}}}}"
    shown = [line.text for line in lines(document(node)) if line.depth > 0]
    assert "_" not in shown[0]
    assert ("a" in shown) or shown[0].startswith("a  (") or spec.children == (0, 0)


@pytest.mark.parametrize("condition", CONDITIONS)
def test_every_condition_is_shown_as_it_is_written(condition: str) -> None:
    script = "$n := 1" if condition in ("on_success", "on_failure", "on_halt", "after") else "$n"
    shown = [line.text for line in lines(document(f"{{a: , {condition}: {script}}}"))]
    assert shown[1] == f"a  ({condition} {script})"


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (Reference("k"), "$k"),
        (Reference("k", ("x", "y"), Scope.ROOT), "$@k.x.y"),
        (Template(("at ", Reference("k", ("x",)), "!")), '"at ${k.x}!"'),
        (Literal(None), "nothing"),
        (Literal(False), "false"),
        (Literal({"a": [1, {"b": None}]}), "{a: [1, {b: nothing}]}"),
        (Literal("66 mm"), "66 mm"),
    ],
)
def test_every_kind_of_value_as_a_file_writes_it(value: object, shown: str) -> None:
    assert value_text(value) == shown  # type: ignore[arg-type]


def test_long_ports_are_cut_but_names_are_not() -> None:
    node = document("{a: {text: " + "x" * 300 + "}}").trees["Main"].root
    (line,) = [each.text for each in lines(document("{a: {text: " + "x" * 300 + "}}"))][1:2]
    assert node.ports["text"] == Literal("x" * 300)
    assert line.endswith("…")
    assert len(line) < 110
