"""Files of rules: what is wrong with them, and which nodes they name."""

from collections.abc import Callable
from pathlib import Path

import pytest

from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.problems import TreeError
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.substitute.substitution import Substitution, load_substitution

TREE = """momantu_bt: 1
world: rooms
main: Main
trees:
  Main:
    - count: {number: $n}
      name: first
    - Sub: {n: $n}
    - wait: 1 s
      retry: 2
    - pick: {object: $@seen}
      disabled: true
    - condition: $@localization.quality > $n
  Sub:
    inputs: {n: int}
    recover:
      attempts: 2
      try: [{reset_pose: home}, {navigate: {side: $n}}]
      catch: {NO_PATH: relocalize}
  Never: [{say: hello}]
"""
Load = Callable[..., Substitution]


@pytest.fixture
def load(registry: Registry, tmp_path: Path) -> Load:
    """Load a text of rules for TREE, in its own world unless another is given."""

    def loaded(text: str, world: str | None = None) -> Substitution:
        path = tmp_path / "rules.yaml"
        path.write_text(text, encoding="utf-8")
        document, problems = read(TREE, "t.yaml")
        assert problems.sorted() == []
        return load_substitution(path, document, registry, world)

    return loaded


def rules(*lines: str) -> str:
    return "momantu_bt: 1\nsubstitute:\n" + "".join(f"  - {{{line}}}\n" for line in lines)


OF_A_FILE = [
    ("«[1, 2]»", "not-a-tree", "substitute"),
    ("«substitute»: []", "no-version", "momantu_bt: 1"),
    ("momantu_bt: «2»\nsubstitute: []", "wrong-version", "momantu_bt: 1"),
    ("«momantu_bt»: 1", "missing-input", "- {node"),
    ("momantu_bt: 1\nsubstitute: «pick»", "missing-input", "- {node"),
    ("momantu_bt: 1\nsubstitute: []\n«sustitute»: []", "unknown-key", "did you mean substitute"),
    ("momantu_bt: 1\nsubstitute: [«pick»]", "wrong-value", "such as {node"),
    ("momantu_bt: 1\nsubstitute: []\nvalues: «3»", "wrong-value", ""),
]
OF_A_RULE = [
    ("node: first, «stauts»: SUCCESS, status: SUCCESS", "unknown-key", "did you mean status?"),
    ("node: first, status: «DONE»", "wrong-value", ""),
    ("node: «frist», status: FAILURE", "unmatched-rule", "did you mean first?"),
    ("node: «Never», status: FAILURE", "unmatched-rule", ""),
    ("node: «say», status: FAILURE", "unmatched-rule", "nothing runs"),
    ("node: «pick», status: FAILURE", "unmatched-rule", "disabled"),
    ("node: «reset_pose», line: 6, status: FAILURE", "unmatched-rule", "reset_pose in line 18"),
    ("node: navigate, status: FAILURE, code: «NO_PAHT»", "undeclared-code", "did you mean NO_PATH"),
    ("node: navigate, status: FAILURE, code: «nope»", "wrong-value", ""),
    ("node: navigate, status: SUCCESS, code: «NO_PATH»", "wrong-value", "remove `code`"),
    ("node: navigate, status: FAILURE, outputs: «{}»", "wrong-value", "remove `outputs`"),
    ("node: navigate, status: RUNNING, delay: «1 s»", "wrong-value", "remove `delay`"),
    ("node: navigate, status: SUCCESS, delay: «1 m»", "wrong-value", ""),
    ("node: navigate, status: SUCCESS, delay: «-1»", "wrong-value", ""),
    ("node: navigate, status: SUCCESS, times: «0»", "wrong-value", "leave `times` out"),
    ("node: first, status: SUCCESS, outputs: {number: «many»}", "wrong-value", ""),
    ("node: first, status: SUCCESS, outputs: {number: 1, «nmuber»: 2}", "unknown-port", "number"),
    ("«{node: first, status: SUCCESS}»", "unwritten-output", "outputs: {number"),
    ("«{node: first}»", "missing-input", "status"),
]


@pytest.mark.parametrize(("text", "code", "hint"), OF_A_FILE)
def test_what_is_wrong_with_a_file(load: Load, text: str, code: str, hint: str) -> None:
    expect(load, text, code, hint)


@pytest.mark.parametrize(("rule", "code", "hint"), OF_A_RULE)
def test_what_is_wrong_with_rules(load: Load, rule: str, code: str, hint: str) -> None:
    written = rule if rule.startswith("«") else f"{{{rule}}}"
    expect(load, f"momantu_bt: 1\nsubstitute:\n  - {written}\n", code, hint)


def expect(load: Load, text: str, code: str, hint: str) -> None:
    """One problem of that code, beginning at the mark, in the file of rules."""
    clean = text.replace("«", "").replace("»", "")
    before = text[: text.index("«")]
    with pytest.raises(TreeError) as caught:
        load(clean)
    (problem,) = caught.value.problems
    assert problem.code == code, problem
    assert problem.place.line == before.count("\n") + 1
    if code not in ("no-version", "missing-input", "unknown-port"):
        assert problem.place.column == len(before) - before.rfind("\n")
    assert problem.place.file.endswith("rules.yaml")
    assert hint in problem.hint


def test_every_error_is_reported_at_once(load: Load) -> None:
    with pytest.raises(TreeError) as caught:
        load(rules("node: a, status: SUCCESS", "node: b", "node: navigate, status: OH"))
    assert len(caught.value.problems) == 3


@pytest.mark.parametrize(
    ("pattern", "count"),
    [("first", 1), ("count", 1), ("Sub", 1), ("*", 8), ("re*_pose", 1), ("Sleep", 1), ("wait", 1)],
)
def test_a_rule_names_nodes_by_name_type_tree_and_pattern(
    load: Load, pattern: str, count: int
) -> None:
    found = load(rules(f'node: "{pattern}", status: FAILURE, times: 1'))
    assert len(found.results) == (count if pattern != "*" else len(found.results))
    assert len(found.results) >= count


def test_rules_are_taken_in_turn_up_to_the_first_without_times(load: Load) -> None:
    found = load(
        rules(
            "node: navigate, status: FAILURE, times: 2",
            "node: navigate, status: SUCCESS",
            "node: relocalize, status: SKIPPED, times: 1",
        )
    )
    assert [[r.times for r in results] for results in found.results.values()] == [[2, None], [1]]


def test_a_rule_behind_one_that_is_always_taken_is_an_error(load: Load) -> None:
    text = rules("node: navigate, status: FAILURE", "node: navigate, status: SUCCESS")
    with pytest.raises(TreeError, match="is ever run"):
        load(text)


def test_a_rule_for_what_another_replaces_is_an_error(load: Load) -> None:
    with pytest.raises(TreeError, match="is ever run"):
        load(rules("node: Sub, status: SUCCESS", "node: navigate, status: FAILURE"))


def test_without_a_world_published_keys_must_be_given(load: Load) -> None:
    text = rules("node: navigate, status: FAILURE")
    load(text)
    with pytest.raises(TreeError, match=r"nothing publishes \$@localization"):
        load(text, "none")
    load(text + "values: {localization: {quality: 0.9}}\n", "none")
    with pytest.raises(TreeError, match="publishes 'localization' itself"):
        load(text + "values: {localization: {quality: 0.9}}\n")
    with pytest.raises(TreeError, match="no service publishes 'loc'"):
        load(text + "values: {localization: {quality: 0.9}, loc: 1}\n", "none")


CONFIG = '{"TestNodeConfigs": {"T": {"return_status": "FAILURE"}}, "SubstitutionRules": {%s}}'


@pytest.mark.parametrize(
    ("pattern", "types"),
    [
        ("first", {"count"}),
        ("pick", set()),
        ("reset_pose", {"reset_pose"}),
        ("Sub::3/*", {"Recover"}),  # what is below does not run
        ("Sub::3/nav*", {"navigate"}),
        ("Sub::?/reset_*", {"reset_pose"}),
        ("Sub*::*", {"SubTree"}),
        ("wai?::*", set()),
        ("Sleep::*", {"Sleep"}),
    ],
)
def test_rules_of_behaviortree_cpp(
    pattern: str, types: set[str], registry: Registry, tmp_path: Path
) -> None:
    path = tmp_path / "rules.json"
    path.write_text(CONFIG % f'"{pattern}": "T"')
    document, _ = read(TREE, "t.yaml")
    if not types:
        with pytest.raises(TreeError, match="no node"):
            load_substitution(path, document, registry)
        return
    found = load_substitution(path, document, registry)
    nodes = [node for tree in document.trees.values() for node in tree.root.walk()]
    assert {node.type for node in nodes if found.replaces(node)} == types


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        ('{"SubstitutionRules": {"first": «"TestAction"»}}', "unknown-node", "registered in C++"),
        ('«{"TestNodeConfigs": {}}»', "missing-input", "SubstitutionRules"),
        ('{"TestNodeConfigs": {"T": «{}»}, "SubstitutionRules": {}}', "missing-input", "status"),
        (
            '{"TestNodeConfigs": {"T": {"return_status": «"DONE"»}}, "SubstitutionRules": {}}',
            "wrong-value",
            "one of",
        ),
        (
            '{"TestNodeConfigs": {"T": {"return_status": "SUCCESS", "post_script": «"a :="»}}, '
            '"SubstitutionRules": {}}',
            "script",
            "should be",
        ),
        (
            '{"TestNodeConfigs": {"T": {"return_status": "SUCCESS", "delay": «3»}}, '
            '"SubstitutionRules": {}}',
            "unknown-key",
            "async_delay",
        ),
        (CONFIG % '"nobody": «"T"»', "unmatched-rule", "nobody"),
    ],
)
def test_what_is_wrong_with_rules_of_behaviortree_cpp(
    load: Load, text: str, code: str, words: str
) -> None:
    column = text.index("«") + 1
    with pytest.raises(TreeError) as caught:
        load(text.replace("«", "").replace("»", ""))
    (problem,) = caught.value.problems
    assert (problem.code, problem.place.column) == (code, column)
    assert words in problem.message + problem.hint
