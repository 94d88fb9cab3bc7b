"""What an unknown node probably means, in the words of its file."""

from __future__ import annotations

import re
from collections.abc import Sequence

from momantu_bt.formats.names import nearest, valid_names
from momantu_bt.tree.catalogue import NODES, SPELLED
from momantu_bt.tree.catalogue.nodes import said_type
from momantu_bt.tree.catalogue.synonyms import in_spelling, meant_type
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.language import AGAIN
from momantu_bt.tree.model import Node

_RUN_TOGETHER = re.compile(r"(\w+)[\s{(]+\$?(\w+)")
LIKE = 0.75
"""Names of nodes count as near from this likeness on; half a word in common is not enough."""
_PARTS = {
    "then": "the child that runs if the condition holds",
    "else": "the child that runs if the condition does not hold",
    "do": "the child that runs while the condition holds",
    "catch": "the handlers of a failure",
    "try": "what is run and perhaps tried again",
    AGAIN: "a handler that tries again",
}
"""Words of the language that are parts of nodes, and what they are."""
_IN_XML = {
    "then": "the second child of <IfThenElse>",
    "else": "the last child of <IfThenElse> and <WhileDoElse>",
    "do": "the second child of <WhileDoElse>",
    "catch": "<momantu:Catch> in <momantu:Recover>",
    "try": "the first child of <momantu:Recover>",
    AGAIN: "an empty <momantu:Catch> in <momantu:Recover>",
}
_IN_YAML = {
    "then": "it stands beside `if:`, as `then:`",
    "else": "it stands beside `if:` or `while_do:`, as `else:`",
    "do": "it stands beside `while_do:`, as `do:`",
    "catch": "it stands in `recover:` or `handle:`, as `catch:`",
    "try": "it stands in `recover:` or `handle:`, as `try:`",
}


def suggestion(context: Context, node: Node) -> str:
    """What to write instead of an unknown node's name; empty if nothing is near enough."""
    name, xml = node.type, context.in_xml(node.place)
    if name != said_type(name):
        return f'did you mean ID="momantu:{said_type(name)}"?'
    part = name.lower()
    if part in _PARTS:
        where = _IN_XML[part] if xml else _IN_YAML.get(part, "")
        if where:
            return f"`{part}` is {_PARTS[part]}: {where}"
    trees = {_run_as(tree, xml=xml): tree for tree in context.document.trees}
    exact = [spelled for spelled, tree in trees.items() if tree == name]
    if exact:
        return f"did you mean {exact[0]}?"
    own = [*context.registry.skills, *context.models]
    same = nearest(name, own, least=1.0)
    if same is not None:
        return f"did you mean {same}?"
    colon = _without_colon(name, own, context)
    if colon:
        return colon
    meant = meant_type(name)
    if meant is not None:
        return f"did you mean {in_spelling(meant, xml=xml)}?"
    built_in = {type_ if xml else NODES[type_].yaml[0]: type_ for type_ in NODES}
    near = nearest(name, [*trees.values(), *own, *built_in], least=LIKE)
    if near is None or near not in (*trees.values(), *own):
        called = _also_called(context, name)
        near = called or near
    if near is None:
        return ""
    if near in trees.values() and near not in own:
        return f"did you mean {_run_as(near, xml=xml)}?"
    return f"did you mean {in_spelling(built_in[near], xml=xml) if near in built_in else near}?"


def _also_called(context: Context, name: str) -> str | None:
    """The skill that people call by a name, such as `grab`."""
    small = name.lower().replace("_", "").replace("-", "")
    for each in context.registry.skills:
        skill = context.skill(each)
        words = () if skill is None else skill.also_called
        if any(small == word.replace("_", "") for word in words):
            return each
    return None


def _without_colon(name: str, own: Sequence[str], context: Context) -> str:
    """The hint for `navigate {in_front_of: …}` and `navigate in_front_of: …`; else empty."""
    found = _RUN_TOGETHER.match(name)
    known = (*own, *context.document.trees, *SPELLED)
    if found is None or found[1] not in known:
        return ""
    return f"`{found[1]}` needs a colon after it: `{found[1]}: {{{found[2]}: …}}`"


def known_names(context: Context, node: Node) -> str:
    """The trees and skills that there are, for a name that is near to none of them."""
    names = [*context.document.trees, *context.registry.skills, *context.models]
    return valid_names(node.type, names, "trees and skills", least=LIKE)


def _run_as(tree: str, *, xml: bool) -> str:
    return f'<SubTree ID="{tree}"/>' if xml else tree
