"""The `<root>` of an XML tree file: its attributes, and the parts it may have."""

from __future__ import annotations

from collections.abc import Mapping

from momantu_bt.formats.names import nearest, valid_names
from momantu_bt.formats.xml.elements import Attribute, Element
from momantu_bt.tree.files.syntax import OURS
from momantu_bt.tree.language import VERSION
from momantu_bt.tree.model import Tree
from momantu_bt.tree.problems import Problems

FORMAT = "4"
"""What `BTCPP_format` says; version 3 of BehaviorTree.CPP means other things by the same words."""

_ROOT = "root"
_PARTS = ("BehaviorTree", "TreeNodesModel", "include")
_OF_ROOT = ("BTCPP_format", "main_tree_to_execute", "project_name")
_OURS_OF_ROOT = ("world", "goal", "version")
_OLD = "3"


def is_root(root: Element, problems: Problems) -> bool:
    """Whether the element begins a tree file. If not, report a problem."""
    if root.name == _ROOT and not root.space:
        return True
    message = f"a tree file begins with <root>, not with <{root.said}>"
    problems.error("not-a-tree", root.place, message, f'write <root BTCPP_format="{FORMAT}">')
    return False


def check_header(root: Element, problems: Problems) -> None:
    """Report unsupported versions, and unknown attributes and parts."""
    _check_format(root, problems)
    for each in root.attributes:
        if each.space == OURS:
            if each.name not in _OURS_OF_ROOT:
                report_unknown_attribute(each, [*_OURS_OF_ROOT], "<root>", problems)
        elif not each.space and each.name not in _OF_ROOT and _is_slip(each.name):
            with problems.keeping():
                report_unknown_attribute(each, list(_OF_ROOT), "<root>", problems)
    ours = root.get("version", OURS)
    if ours is not None and ours.value != str(VERSION):
        message = "this version of the language is not known"
        problems.error("wrong-version", ours.place, message, f"known: {VERSION}")
    for element in root.children:
        _check_part(element, problems)


def main_tree(
    root: Element, trees: Mapping[str, Tree], outside: Mapping[str, Tree], problems: Problems
) -> str:
    """The name of the tree to run. outside: trees of the files that this one includes."""
    known = {**trees, **outside}
    named = root.get("main_tree_to_execute")
    first = next(iter(known), "")
    if named is not None and named.value in known:
        return named.value
    with problems.keeping():
        if named is not None:
            hint = valid_names(named.value, known, "trees")
            message = f"no tree is called {named.value!r}"
            problems.error("unknown-tree", named.place, message, hint)
        elif len(trees or known) > 1:
            message = f"the file does not say which of {', '.join(trees or known)} to run"
            hint = f'write <root … main_tree_to_execute="{first}">'
            problems.error("no-main", root.place, message, hint)
    return first


def _is_slip(name: str) -> bool:
    """Whether an attribute is almost one that means something. Others are kept."""
    return name.startswith("main") or nearest(name, _OF_ROOT) is not None


def report_unknown_attribute(
    attribute: Attribute, known: list[str], said: str, problems: Problems
) -> None:
    """Report an attribute that an element cannot have.

    known: the attributes that it can have. said: the element, in the message's words.
    """
    message = f"{said} has no attribute {attribute.name!r}"
    hint = valid_names(attribute.name, known, "attributes")
    problems.error("unknown-key", attribute.name_place, message, hint)


def _check_format(root: Element, problems: Problems) -> None:
    version = root.get("BTCPP_format")
    place = root.place if version is None else version.place
    hint = f"convert it with `momantu-bt convert --from {_OLD} {place.file} -o NEW.xml`"
    if version is None:
        message = f"without BTCPP_format this is format {_OLD} of BehaviorTree.CPP"
        hint += f'; if it is not, write <root BTCPP_format="{FORMAT}">'
        problems.error("no-version", place, message, hint)
    elif version.value == _OLD:
        message = f"this is format {_OLD} of BehaviorTree.CPP"
        problems.error("wrong-version", place, message, hint)
    elif version.value != FORMAT:
        message = f"format {version.value} of BehaviorTree.CPP is not known"
        problems.error("wrong-version", place, message, f"known: {FORMAT}, and {_OLD} to convert")


def _check_part(element: Element, problems: Problems) -> None:
    if element.name in _PARTS and not element.space:
        return
    if element.name == "Values" and element.space == OURS:
        return
    hint = valid_names(element.name, [*_PARTS, "momantu:Values"], "parts of a tree file")
    message = f"a tree file has no <{element.said}>"
    problems.error("unknown-key", element.place, message, hint)
