"""The parts of an XML tree file: their order, their models, and comments outside of all trees."""

from __future__ import annotations

from dataclasses import replace
from itertools import groupby

from momantu_bt.formats.text import Beside
from momantu_bt.formats.xml.elements import Element, Parsed
from momantu_bt.tree.catalogue import SUBTREE
from momantu_bt.tree.files.syntax import OURS
from momantu_bt.tree.files.xml.model_writer import model_lines, tree_model_lines
from momantu_bt.tree.files.xml.models import Models
from momantu_bt.tree.model import Document, Node, NodeModel, Tree

PARTS = {"include": "include", "Values": "values", "BehaviorTree": "tree"}
PARTS |= {"TreeNodesModel": "models"}
"""The elements in a root, and their names in `Document.order`."""
_GROUPS = ("include", "values", "tree", "models")
_OF_HEADER = ("BTCPP_format", "main_tree_to_execute")


def usual_order(document: Document) -> tuple[str, ...]:
    """The order of the parts of a file that does not say another one."""
    own = [tree for tree in document.trees.values() if tree.place.file == document.file]
    order = ["include"] * len(document.includes) + ["values"] * bool(document.values)
    order += ["tree"] * len(own)
    modelled = bool(document.models) or any(not tree.open for tree in own)
    return (*order, *["models"] * modelled)


def give_models(document: Document, models: Models) -> None:
    """Give a document its models, without those that its trees say whole.

    Those stand last, in the order of the trees.
    """
    every = models.all
    own = list(document.trees)
    known = {model.name: model for model in every if model.kind == SUBTREE}
    start = len(every)
    while start and (model := every[start - 1]).kind == SUBTREE and model.name in own:
        own = own[: own.index(model.name)]
        tree = document.trees[model.name]
        tree.metadata = model.metadata
        if known[model.name] is not model or not _is_said_by_tree(document, model, models):
            tree.metadata = ()
            break
        start -= 1
    section = models.section
    document.models = tuple(
        model
        for model in every[:start]
        if model.kind != SUBTREE
        or model.name not in document.trees
        or section is None
        or not _has_ours(section, model.name)
    )
    for model in document.models:
        if model.kind == SUBTREE and model.name in document.trees:
            document.trees[model.name].metadata = ()


def _is_said_by_tree(document: Document, model: NodeModel, models: Models) -> bool:
    """Whether the tree's ports and metadata give the same model again, in YAML too."""
    if models.section is not None and _has_ours(models.section, model.name):
        return True
    tree = document.trees[model.name]
    directions = [direction for direction, _ in groupby(p.direction for p in tree.ports.values())]
    in_order = directions == [each for each in ("in", "out", "inout") if each in directions]
    if not in_order or any(port.tag for port in tree.ports.values()):
        return False
    fields = tree.metadata
    if len(fields) > 1 or any(f.comments or f.at not in (0, len(tree.ports)) for f in fields):
        return False
    return model_lines(model) == tree_model_lines(tree)


def _has_ours(section: Element, name: str) -> bool:
    """Whether the model of a tree has attributes of ours, which NodeModel does not hold."""
    return any(
        attribute.space == OURS
        for model in section.children
        if model.name == SUBTREE and (identity := model.get("ID")) and identity.value == name
        for port in model.children
        for attribute in port.attributes
    )


def keep_parts(document: Document, parsed: Parsed) -> None:
    """Give a document the order of its parts, the root's attributes, and the comments between."""
    root = parsed.root
    document.attributes = {name: uri for name, uri in root.prefixes.items() if uri != OURS} | {
        each.said: each.value
        for each in root.attributes
        if each.space != OURS and each.said not in _OF_HEADER
    }
    waiting = [str(text) for text in root.comments if isinstance(text, Beside)]
    document.header_comments = tuple(text for text in root.comments if not isinstance(text, Beside))
    if not root.children:
        waiting, document.after_comments = [], tuple(waiting)
    order: list[str] = []
    includes = list(document.includes)
    for element in root.children:
        own = tuple(text for text in element.comments if isinstance(text, Beside))
        before = (*waiting, *(text for text in element.comments if not isinstance(text, Beside)))
        inside = element.children or element.end_comments
        waiting = [] if inside else [str(text) for text in own]
        part = PARTS.get(element.name, "")
        if part == "include":
            at = order.count("include")
            includes[at] = replace(includes[at], comments=before)
        elif part == "tree":
            _tree_at(document, element).comments = (*before, *(own if inside else ()))
        elif part == "values":
            document.header_comments += (*before, *map(str, own if inside else ()))
            _end_values(document, element)
        elif part == "models":
            document.models_comments = (*before, *(own if inside else ()))
            document.models_end_comments = element.end_comments
            document.models_attributes = {each.said: each.value for each in element.attributes}
        order += [part] if part else []
    document.includes = tuple(includes)
    document.comments = (*waiting, *root.end_comments)
    document.after_comments = (*document.after_comments, *parsed.comments)
    document.order = () if tuple(order) == usual_order(document) else tuple(order)


def _tree_at(document: Document, element: Element) -> Tree:
    """The tree of an element; one with the name of another tree is not in the document."""
    identity = element.get("ID")
    place = element.place if identity is None else identity.place
    found = next((tree for tree in document.trees.values() if tree.place == place), None)
    return found or Tree("", Node("", element.place), element.place)


def _end_values(document: Document, section: Element) -> None:
    """Comments at the end of the values belong to the last one."""
    last = next(reversed(document.values), None)
    if last is not None and section.end_comments:
        before = document.value_comments.get(last, ())
        document.value_comments[last] = before + section.end_comments
