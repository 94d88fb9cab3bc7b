"""What the checker lets through, the engine can run: no key is missing, nothing is unknown."""

import re
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, reject, settings
from hypothesis import strategies as st

import momantu_bt
from momantu_bt.engine.node import TreeNode
from momantu_bt.failure import INPUT_MISSING
from momantu_bt.tree.catalogue import NODE_CLASSES, NODES
from momantu_bt.tree.load import TreeError
from momantu_bt.tree.registry import Registry

KEYS = st.sampled_from(["a", "b", "c"])
LEAVES = st.one_of(
    KEYS.map(lambda k: f"{{set: {{key: ${k}, value: 1}}}}"),
    st.tuples(KEYS, KEYS).map(lambda t: f"{{set: {{key: ${t[0]}, value: ${t[1]}}}}}"),
    KEYS.map(lambda k: f"{{unset: ${k}}}"),
    KEYS.map(lambda k: f"{{condition: ${k} > 1}}"),
    KEYS.map(lambda k: f"{{script: '${k} := 2'}}"),
    KEYS.map(lambda k: f"{{fail: {{code: OH, message: '${{{k}}}'}}}}"),
    st.sampled_from(["succeed", "always_failure", "{fail: OH}", "{wait: 0.1}", "goal_updated"]),
    KEYS.map(lambda k: f"{{was_entry_updated: ${k}}}"),
    st.tuples(st.sampled_from(["SUCCESS", "FAILURE", "SKIPPED"]), KEYS).map(
        lambda t: f"{{test_node: {{return_status: {t[0]}, success_script: '${t[1]} := 4'}}}}"
    ),
)
MODIFIERS = st.one_of(
    st.sampled_from(
        ["invert: ", "force: success", "force: failure", "else_fail: OH", "disabled: true"]
    ),
    st.sampled_from(["retry: 2", "repeat: 2", "timeout: 0.1", "run_once: "]),
    st.sampled_from(["rate_controller: 10", "single_trigger: ", "goal_updated_controller: "]),
    st.tuples(st.sampled_from(["skip_unless_updated", "wait_value_update"]), KEYS).map(
        lambda t: f"{t[0]}: ${t[1]}"
    ),
    st.tuples(st.sampled_from(["skip_if", "fail_if", "succeed_if", "while"]), KEYS).map(
        lambda t: f"{t[0]}: ${t[1]} > 1"
    ),
    st.tuples(st.sampled_from(["on_success", "on_failure", "after"]), KEYS).map(
        lambda t: f"{t[0]}: '${t[1]} := 3'"
    ),
)


def _listed(node: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    kinds = [
        "sequence",
        "fallback",
        "round_robin",
        "parallel",
        "parallel_all",
        "reactive_sequence",
        "reactive_fallback",
        "sequence_with_memory",
        "pipeline_sequence",
        "nonblocking_sequence",
    ]
    children = st.lists(node, min_size=1, max_size=3).map(", ".join)
    return st.tuples(st.sampled_from(kinds), children).map(lambda t: f"{{{t[0]}: [{t[1]}]}}")


TEMPLATES = [
    "{switch: $K, cases: {1: A, 2: B}, default: C}",
    "{try_catch: [A, B, C]}",
    "{try_catch: {catch_on_halt: true, children: [A, B, C]}}",
    "{recovery_node: [A, B]}",
    "{persistent_sequence: {current_child_idx: $K, children: [A, B]}}",
    "{loop_int: {queue: [], value: $K, child: A}}",
    "{loop_int: {queue: [1, 2], value: $K, child: A}}",
    "{loop_number: {queue: $K, value: $L, child: A}}",
    "{for_each: {in: [], as: $K, child: A}}",
    "{for_each: {in: [1, 2], as: $K, child: A}}",
    "{goal_updater: {input_goal: $K, output_goal: $L, child: A}}",
]
"""Nodes with keys K and L and children A, B and C."""


@st.composite
def _filled(draw: st.DrawFn, node: st.SearchStrategy[str]) -> str:
    parts = {key: draw(KEYS) for key in "KL"}
    template = draw(st.sampled_from(TEMPLATES))
    parts |= {key: draw(node) for key in "ABC" if key in template}
    return re.sub(r"\b[KLABC]\b", lambda found: parts[found[0]], template)


def _branched(node: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    return st.one_of(
        st.tuples(KEYS, node, node).map(
            lambda t: f"{{if: ${t[0]} > 1, then: {t[1]}, else: {t[2]}}}"
        ),
        st.tuples(node, node).map(lambda t: f"{{if: {t[0]}, then: {t[1]}}}"),
        st.tuples(node, node).map(
            lambda t: f"{{recover: {{attempts: 2, try: {t[0]}, catch: {{any: {t[1]}}}}}}}"
        ),
        st.tuples(node, node).map(lambda t: f"{{handle: {{try: {t[0]}, catch: {{any: {t[1]}}}}}}}"),
        _filled(node),
        st.tuples(node, MODIFIERS)
        .filter(lambda t: t[0].startswith("{") and t[1].split(":")[0] + ":" not in t[0])
        .map(lambda t: f"{t[0][:-1]}, {t[1]}}}"),
    )


ANY_NODE = st.recursive(LEAVES, lambda n: st.one_of(_listed(n), _branched(n)), max_leaves=10)


@st.composite
def trees(draw: st.DrawFn) -> str:
    """A file in which only $c has no value at first."""
    nodes = ", ".join(draw(st.lists(ANY_NODE, min_size=1, max_size=5)))
    return f"momantu_bt: 1\nvalues: {{a: 1, b: 3}}\ntrees:\n  Main: [{nodes}]\n"


@settings(max_examples=120, suppress_health_check=list(HealthCheck))
@given(trees())
def test_a_checked_tree_never_misses_a_key(
    tmp_path_factory: pytest.TempPathFactory, text: str
) -> None:
    path: Path = tmp_path_factory.getbasetemp() / "generated.yaml"
    path.write_text(text, encoding="utf-8")
    missing: list[str] = []
    fail = TreeNode._broken

    def noting(self: TreeNode, error: Exception) -> object:
        if getattr(error, "code", "") == INPUT_MISSING or "has no value" in str(error):
            missing.append(f"{self.name}: {error}")
        return fail(self, error)  # type: ignore[arg-type]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(TreeNode, "_broken", noting)
        try:
            report = momantu_bt.run(path, world="none", max_time=1.0, registry=Registry())
        except TreeError:
            reject()
    assert missing == []
    assert report.error is None


def test_every_node_of_the_language_has_a_class_of_its_own() -> None:
    assert {kind.spec.type: kind.__name__ for kind in NODE_CLASSES.values()} == {
        n: n for n in NODES
    }
