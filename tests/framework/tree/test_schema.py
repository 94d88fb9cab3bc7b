"""The JSON Schema takes every good tree, and what it refuses the checker refuses too."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from momantu_bt.formats.problems import Problem, errors
from momantu_bt.formats.yaml.reader import YamlSyntaxError
from momantu_bt.formats.yaml.values import plain_value
from momantu_bt.skill import Port
from momantu_bt.tree.catalogue import MODIFIERS, SPELLED
from momantu_bt.tree.check.checker import check as check_document
from momantu_bt.tree.files.lookup import bundled
from momantu_bt.tree.files.syntax import compose
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.problems import TreeError
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.show.problem_pages import codes, explanation
from momantu_bt.tree.show.schema import tree_schema
from momantu_bt.tree.show.schema_values import value_schema
from momantu_bt.values.kinds import ValueType

TREES = sorted(bundled().values())
HEADER = "momantu_bt: 1\nworld: rooms\ntrees:\n  Main:\n"
GOOD = """
    - reset_pose: home
      retry: 3
      skip_if: {btcpp: 1 > 2 && 2 > 3 || 1 > 3}
    - navigate: {in_front_of: table_a, tolerance: 3 cm}
      timeout: 2 min
    - if: $@robot.gripper_width > 0.05
      then: {wait: 1 s}
      else: [succeed, {wait: {duration: 2 s}}]
    - recover:
        attempts: 3
        try: {reset_pose: {pose: home}}
        catch:
          NO_PLAN | reset_pose.TIMEOUT: again
          any: {round_robin: [succeed, Other]}
    - parallel: {success_count: 1, children: [succeed, {wait: 1 s}]}
    - {invert: {child: always_failure}}
"""
MISTAKES = {
    "unknown key": "momantu_bt: 1\nwolrd: rooms\ntrees: {Main: succeed}\n",
    "no trees": "momantu_bt: 1\n",
    "no version": "trees: {Main: succeed}\n",
    "wrong version": "momantu_bt: 2\ntrees: {Main: succeed}\n",
    "port": HEADER + "    - navigate: {in_fornt_of: table_a}\n",
    "modifier among the ports": HEADER + "    - reset_pose: {pose: home, retry: 3}\n",
    "missing input": HEADER + "    - pick\n",
    "missing inputs in a mapping": HEADER + "    - detect_object: {on: table_a}\n",
    "type": HEADER + "    - navigate: {in_front_of: table_a, side: left}\n",
    "choice": HEADER + "    - {wait: 1 s, force: sucess}\n",
    "flag": HEADER + "    - {wait: 1 s, disabled: yes}\n",
    "children": HEADER + "    - fallback: {childern: [succeed]}\n",
    "code": HEADER + "    - {recover: {attempts: 2, try: succeed, catch: {no_plan: again}}}\n",
    "output": HEADER + "    - detect_object: {object: $o, on: table_a, found: found}\n",
}


@pytest.fixture(scope="module")
def installed() -> Draft202012Validator:
    """The schema of what is installed."""
    return Draft202012Validator(tree_schema(dict(Registry.installed().skills)))


@pytest.fixture
def validator(registry: Registry) -> Draft202012Validator:
    """The schema of the small registry."""
    return Draft202012Validator(tree_schema(dict(registry.skills)))


def data(text: str) -> Any:
    return plain_value(compose(text, "tree.yaml"))


def test_it_is_a_schema(installed: Draft202012Validator) -> None:
    Draft202012Validator.check_schema(installed.schema)


@pytest.mark.parametrize("tree", TREES, ids=lambda path: path.stem)
def test_bundled_trees_are_valid(installed: Draft202012Validator, tree: Path) -> None:
    installed.validate(data(tree.read_text(encoding="utf-8")))


def test_every_form_of_a_node_is_valid(validator: Draft202012Validator) -> None:
    validator.validate(data(HEADER + GOOD))
    validator.validate(data("momantu_bt: 1\nmodels: [{Action: Go}]\ntrees: {Main: succeed}\n"))


BLOCKS = [block for code in codes() for block in explanation(code).split("```yaml\n")[1:]]
"""Every tree on the pages of problems, right and wrong."""


@pytest.mark.parametrize("block", BLOCKS)
def test_what_it_refuses_the_checker_refuses(installed: Draft202012Validator, block: str) -> None:
    text = block.partition("```")[0]
    try:
        if installed.is_valid(data(text)):
            return
        document, reading = read(text, "tree.yaml")
    except (YamlSyntaxError, TreeError):
        return
    assert errors(check_document(document, Registry.installed(), reading=reading).problems)


@pytest.mark.parametrize("name", ["Look around", "v1.2", "to-do list", "Straße"])
def test_every_name_that_a_tree_may_have(validator: Draft202012Validator, name: str) -> None:
    called = (
        f"{{Main: [{name}, {{{name}: {{at: 1}}}}], {name}: {{inputs: {{at: int}}, wait: 1 s}}}}"
    )
    validator.validate(data(f"momantu_bt: 1\ntrees: {called}\n"))
    assert not validator.is_valid(data(f"momantu_bt: 1\ntrees: {{'{name} ': succeed}}\n"))


@pytest.mark.parametrize("mistake", MISTAKES)
def test_typical_mistakes_are_refused_by_both(
    validator: Draft202012Validator, check: Callable[[str], list[Problem]], mistake: str
) -> None:
    assert not validator.is_valid(data(MISTAKES[mistake]))
    assert errors(check(MISTAKES[mistake]))


def test_every_node_and_modifier_completes_with_a_description(
    installed: Draft202012Validator,
) -> None:
    keys = installed.schema["$defs"]["mapping"]["properties"]
    assert {*SPELLED, *Registry.installed().skills, *MODIFIERS} <= set(keys)
    assert all(keys[name].get("description") for name in (*SPELLED, *Registry.installed().skills))


def test_every_code_of_every_skill_completes(installed: Draft202012Validator) -> None:
    handlers = installed.schema["$defs"]["catch"]["properties"]
    for skill in Registry.installed().skills.values():
        assert set(skill.failures) <= set(handlers)


@pytest.mark.parametrize(
    ("type_", "good", "bad"),
    [
        (float, [1, 0.5, "3 cm", "$x"], ["far", True]),
        (int, [3, "$x"], [0.5, "three"]),
        (bool, [True, "$@x.y"], ["yes", 1]),
        (str, ["home", "at ${x}"], [3, True]),
        (str | None, ["home", None], [3]),
        (tuple[int, ...], [[1, 2], []], [3, ["a"]]),
    ],
)
def test_values(type_: ValueType, good: list[Any], bad: list[Any]) -> None:
    unit = "m" if type_ is float else None
    validator = Draft202012Validator(value_schema(Port("p", "in", type_, "", unit=unit), {}))
    assert all(validator.is_valid(value) for value in good)
    assert not any(validator.is_valid(value) for value in bad)


def test_names_are_choices_where_they_are_known() -> None:
    port = Port("on", "in", str, "where", names="surface")
    validator = Draft202012Validator(value_schema(port, {"surface": ["table_a"]}))
    assert validator.is_valid("table_a")
    assert validator.is_valid("$where")
    assert not validator.is_valid("tabel_a")
