"""Types along wires and through subtrees: what is accepted never meets a value that does not fit.

Random trees write ints, numbers and bools to three keys, hand them to subtrees with typed inputs
and outputs, and read them where a node takes one type only.
"""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import momantu_bt
from momantu_bt.engine.node import TreeNode
from momantu_bt.failure import INPUT_MISSING, WRONG_TYPE
from momantu_bt.tree.load import TreeError
from momantu_bt.tree.registry import Registry

KEYS = st.sampled_from(["a", "b", "c"])
VALUES = st.sampled_from(["1", "2", "0.1", "true", "false"])
SUBTREES = """
  Double:
    inputs: {x: int}
    outputs: {y: bool}
    sequence:
      - {succeed: , retry: $x}
      - set: {key: $y, value: true}
  Pause:
    inputs: {x: number}
    outputs: {y: number}
    fallback:
      - {sequence: [{wait: $x}, {set: {key: $y, value: 0.1}}]}
      - set: {key: $y, value: 0.1}
  Once:
    inputs: {x: bool}
    outputs: {y: int}
    sequence: [{set: {key: $y, value: 2}}, {succeed: , run_once: {then_skip: $x}}]
"""
LEAVES = st.one_of(
    st.tuples(KEYS, VALUES).map(lambda t: f"{{set: {{key: ${t[0]}, value: {t[1]}}}}}"),
    KEYS.map(lambda k: f"{{unset: ${k}}}"),
    KEYS.map(lambda k: f"{{wait: ${k}}}"),
    KEYS.map(lambda k: f"{{wait: {{msec: ${k}}}}}"),
    st.sampled_from(["{succeed: }", "{always_failure: }", "{fail: OH}"]),
    st.tuples(st.sampled_from(["Double", "Pause", "Once"]), KEYS, KEYS).map(
        lambda t: f"{{{t[0]}: {{x: ${t[1]}, y: ${t[2]}}}}}"
    ),
)
AROUND = st.one_of(
    st.tuples(st.sampled_from(["retry", "repeat", "timeout", "delay"]), KEYS).map(
        lambda t: f"{t[0]}: ${t[1]}"
    ),
    KEYS.map(lambda k: f"run_once: {{then_skip: ${k}}}"),
    st.sampled_from(["invert: ", "force: success", "skip_if: 1 > 2"]),
)
LISTED = ["sequence", "fallback", "parallel", "reactive_sequence", "sequence_with_memory"]


def _above(node: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    children = st.lists(node, min_size=1, max_size=3).map(", ".join)
    return st.one_of(
        st.tuples(st.sampled_from(LISTED), children).map(lambda t: f"{{{t[0]}: [{t[1]}]}}"),
        st.tuples(node, node, node).map(lambda t: f"{{if: {t[0]}, then: {t[1]}, else: {t[2]}}}"),
        st.tuples(node, node).map(lambda t: f"{{handle: {{try: {t[0]}, catch: {{any: {t[1]}}}}}}}"),
        st.tuples(KEYS, st.lists(VALUES, min_size=1, max_size=3).map(", ".join), node).map(
            lambda t: f"{{for_each: {{in: [{t[1]}], as: ${t[0]}, child: {t[2]}}}}}"
        ),
        st.tuples(node, AROUND)
        .filter(lambda t: t[1].split(":")[0] + ":" not in t[0])
        .map(lambda t: f"{t[0][:-1]}, {t[1]}}}"),
    )


TREES = st.lists(st.recursive(LEAVES, _above, max_leaves=8), min_size=1, max_size=4).map(
    lambda nodes: (
        f"momantu_bt: 1\nmain: Main\nvalues: {{a: 1, b: 0.1}}\ntrees:\n"
        f"  Main: [{', '.join(nodes)}]{SUBTREES}"
    )
)


def wrongly_read(path: Path) -> list[str]:
    """Reads that found no value, or one of the wrong type, in a run of the tree.

    Raises:
        TreeError: the checker refuses it.
    """
    found: list[str] = []
    fail = TreeNode._broken

    def noting(self: TreeNode, error: Exception) -> object:
        if getattr(error, "code", "") in (INPUT_MISSING, WRONG_TYPE):
            found.append(f"{self.name}: {error}")
        return fail(self, error)  # type: ignore[arg-type]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(TreeNode, "_broken", noting)
        report = momantu_bt.run(path, world="none", max_time=1.0, registry=Registry())
    assert report.error is None
    return found


def test_no_value_of_a_wrong_type_arrives(tmp_path: Path) -> None:
    path = tmp_path / "typed.yaml"
    ran = 0

    @settings(max_examples=300, suppress_health_check=list(HealthCheck), deadline=None)
    @given(TREES)
    def accepted_trees_read_what_fits(text: str) -> None:
        nonlocal ran
        path.write_text(text, encoding="utf-8")
        try:
            wrong = wrongly_read(path)
        except TreeError:
            return
        assert wrong == []
        ran += 1

    accepted_trees_read_what_fits()
    assert ran >= 40, "it would hold as well where every tree is refused"


@pytest.mark.parametrize(
    "nodes",
    [
        "{Double: {x: $b, y: $c}}",
        "{Once: {x: $a, y: $c}}",
        "{Double: {x: $a, y: $c}}, {wait: $c}",
        "{Double: {x: $a, y: $c}}, {Once: {x: $c, y: $b}}, {Once: {x: $b, y: $a}}",
        "{for_each: {in: [1, true], as: $c, child: {wait: $c}}}",
        "{if: {succeed: }, then: {set: {key: $a, value: true}}, else: {succeed: }}, {wait: $a}",
    ],
)
def test_values_that_do_not_fit_are_refused(tmp_path: Path, nodes: str) -> None:
    path = tmp_path / "t.yaml"
    head = "momantu_bt: 1\nmain: Main\nvalues: {a: 1, b: 0.1}\ntrees:\n"
    path.write_text(f"{head}  Main: [{nodes}]{SUBTREES}", encoding="utf-8")
    with pytest.raises(TreeError) as caught:
        wrongly_read(path)
    assert {p.code for p in caught.value.problems} <= {"wrong-type", "wrong-value"} | {
        "unread-output",
        "unused-tree",
    }
