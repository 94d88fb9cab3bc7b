"""The YAML spellings in which a node can be written."""

from __future__ import annotations

from momantu_bt.formats.text import Beside
from momantu_bt.formats.yaml.writer import scalar
from momantu_bt.tree.catalogue import FORCED, NODES, Kind
from momantu_bt.tree.files.scalars import port_text
from momantu_bt.tree.files.yaml.lines import above, is_nested
from momantu_bt.tree.files.yaml.scripts import script_spelling
from momantu_bt.tree.model import Literal, Node, PortValue

FORCE = {type_: f"force: {word}" for word, type_ in FORCED.items()}
"""Modifiers for the nodes that force a result."""


def is_short(node: Node) -> bool:
    """Whether it may stand in braces: a leaf with only ports, or a decorator around one."""
    spec = NODES.get(node.type)
    if spec is not None and spec.kind is Kind.DECORATOR:
        if len(node.children) != 1 or node.children[0].children:
            return False
        return not _says_more(node) and is_short(node.children[0])
    leaf = not node.children and (spec is None or spec.kind is Kind.LEAF)
    return leaf and not _says_more(node) and not node.handlers


def _says_more(node: Node) -> bool:
    """Whether something other than its key and ports needs a line."""
    remarks = node.port_comments or node.end_comments or above(node.comments, "")
    return bool(remarks) or has_modifiers(node)


def has_modifiers(node: Node) -> bool:
    """Whether it has modifiers as keys beside its own key, or is a modifier of its child."""
    named = node.name is not None or node.note is not None or node.disabled
    return bool(named or node.conditions or says_xml(node) or can_be_modifier(node))


def says_xml(node: Node) -> bool:
    """Whether it has keys for what only XML says."""
    words = node.tag is not None or node.text or node.tail
    return bool(words or node.attributes or node.comments_apart)


def can_be_modifier(node: Node) -> bool:
    """Whether it is a decorator that a key beside its child can replace."""
    spec = NODES.get(node.type)
    if spec is None or not (spec.modifier or node.type in FORCE) or len(node.children) != 1:
        return False
    if node.name is not None or node.note is not None or node.disabled or node.conditions:
        return False
    beside = any(isinstance(comment, Beside) for comment in node.comments)
    if says_xml(node) or beside or above(node.children[0].comments, ""):
        return False
    values = list(node.ports.values())
    fits = not values or (list(node.ports) == [spec.first] and not _is_nothing(values[0]))
    return fits and not any(is_nested(value) for value in values)


def _is_nothing(value: PortValue) -> bool:
    return isinstance(value, Literal) and value.value is None


def switch_cases(node: Node) -> list[str] | None:
    """The keys of `cases:`; None if the ports cannot be written so."""
    values = [node.ports.get(name) for name in NODES[node.type].ports]
    if len(node.ports) != len(values) or len(node.children) != len(values):
        return None
    if any(value is None or is_nested(value) for value in values):
        return None
    variable, *cases = (port_text(value) for value in values if value is not None)
    bare = {case.strip("\"'") for case in cases}
    return cases if len(bare) == len(cases) and variable else None


def bare_condition(node: Node) -> str | None:
    """The script that `if:` can have instead of a node; None if the node says more."""
    code = node.ports.get("code")
    if node.type != "ScriptCondition" or not isinstance(code, Literal) or len(node.ports) != 1:
        return None
    if has_modifiers(node) or node.children or node.end_comments or node.port_comments:
        return None
    spelled = script_spelling(str(code.value), asked=True)
    return scalar(spelled, typed=False) if spelled is not None and "$" in spelled else None
