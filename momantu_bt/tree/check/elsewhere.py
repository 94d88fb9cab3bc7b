"""Nodes and trees that a file uses and that stand elsewhere: in plug-ins, in other files."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from momantu_bt.formats.names import nearest, valid_names
from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import Problem
from momantu_bt.plugins import PluginError
from momantu_bt.tree.catalogue import AUTOREMAP, NODES, SUBTREE
from momantu_bt.tree.catalogue.absent import why_absent
from momantu_bt.tree.catalogue.nodes import DOCTOR, said_type, why_broken
from momantu_bt.tree.check.declared import tree_models_of
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.check.suggest import LIKE, known_names, suggestion
from momantu_bt.tree.check.trees import reached
from momantu_bt.tree.model import BROKEN, Document, Literal, Node, Reference, Template, Tree
from momantu_bt.values.cpp_types import our_type
from momantu_bt.values.types import parse_type

STUB = "momantu-bt skills stub"
_MOST_NAMED = 8
"""The most names in one hint."""


# trees


def with_trees_elsewhere(document: Document) -> tuple[Document, frozenset[str]]:
    """A copy in which each tree that stands elsewhere has a place holder; and their names.

    A place holder may read and write each key that its callers share with it.
    """
    callers: dict[str, list[Node]] = {}
    for node in _nodes(document):
        if node.type == SUBTREE and node.target and node.target not in document.trees:
            callers.setdefault(node.target, []).append(node)
    if not callers:
        return document, frozenset()
    every = _keys(document) if any(_remaps(n) for found in callers.values() for n in found) else []
    models = tree_models_of(document)
    trees = dict(document.trees)
    for name, nodes in callers.items():
        shared = dict.fromkeys(port for node in nodes for port in node.ports if port != AUTOREMAP)
        shared |= dict.fromkeys(every if any(map(_remaps, nodes)) else ())
        model = models.get(name)
        declared = () if model is None else model.ports
        ports = {
            port.name: replace(port, type_name=_known(port.type_name), default=port.default)
            for port in declared
        }
        keys = dict.fromkeys((*ports, *shared))
        root = Node(BROKEN, nodes[0].place, {key: Reference(key) for key in keys})
        trees[name] = Tree(name, root, nodes[0].place, ports, open=model is None)
    return replace(document, trees=trees), frozenset(callers)


def _known(type_name: str) -> str:
    """A type's name as ours; `any` for one that we do not have."""
    try:
        parse_type(our_type(type_name))
    except KeyError:
        return "any"
    return our_type(type_name)


def _remaps(node: Node) -> bool:
    return node.ports.get(AUTOREMAP) == Literal(True)


def _keys(document: Document) -> list[str]:
    """Every key that some node of the document names, in file order."""
    found: dict[str, None] = {}
    for node in _nodes(document):
        for value in node.ports.values():
            parts = value.parts if isinstance(value, Template) else (value,)
            found |= {part.key: None for part in parts if isinstance(part, Reference) and part.key}
    return list(found)


def _nodes(document: Document) -> Iterator[Node]:
    for tree in document.trees.values():
        yield from tree.root.walk()


# reports


def report_elsewhere(context: Context, trees: frozenset[str]) -> None:
    """Report the nodes and trees that stand elsewhere. trees: names of the trees among them."""
    unknown: dict[str, list[Node]] = {}
    missing: dict[str, list[Node]] = {}
    declared: dict[str, Place] = {}
    models = tree_models_of(context.document)
    for node in _nodes(context.document):
        if node.type == SUBTREE and node.target in trees:
            if node.target in models:
                declared.setdefault(node.target, node.place)
            else:
                missing.setdefault(node.target or "", []).append(node)
        elif node.type not in (SUBTREE, BROKEN) and node.type not in NODES:
            signature = context.signature(node)
            if signature is not None and signature.unknown:
                unknown.setdefault(node.type, []).append(node)
            elif signature is not None and signature.skill is None:
                declared.setdefault(node.type, node.place)
    for nodes in unknown.values():
        if not _report_misspelled_tree(context, nodes):
            _report_unknown(context, nodes)
    for nodes in missing.values():
        _report_missing(context, nodes, trees)
    _report_declared(context, declared)


def _report_misspelled_tree(context: Context, nodes: list[Node]) -> bool:
    """Whether several nodes run a tree by another name than it has; reported at the tree."""
    document, name = context.document, nodes[0].type
    if len(nodes) < 2 or document.main not in document.trees:
        return False
    run = reached(document, [document.main])
    idle = [each for each in document.trees if each not in run]
    near = nearest(name, idle, least=LIKE)
    if near is None or why_absent(name) or _why_broken(context, name):
        return False
    place, first = document.trees[near].place, nodes[0].place
    message = f"nothing runs the tree {near!r}, and {len(nodes)} nodes run {name!r}"
    hint = f"did you mean {name}? The first stands in {first.seen_from(place)}"
    context.problems.error("unknown-node", place, message, hint)
    return True


def _report_unknown(context: Context, nodes: list[Node]) -> None:
    """Report the nodes of a name that no node has, or say why the plug-in cannot be used."""
    first = nodes[0]
    broken = _why_broken(context, first.type)
    if broken is not None:
        for node in nodes:
            context.problems.error("broken-plugin", node.place, broken, DOCTOR)
        return
    message = f"no node is called {said_type(first.type)!r}"
    if context.tolerant:
        hint = (
            why_absent(first.type)
            or suggestion(context, first)
            or f"`{STUB} FILE` writes a plug-in for it"
        )
        context.problems.warning("unknown-node", first.place, message + _more(nodes), hint)
        return
    for node in nodes:
        hint = why_absent(node.type) or suggestion(context, node)
        if context.in_xml(node.place) and not why_absent(node.type):
            begin = f"{hint} If it stands elsewhere: " if hint else ""
            hint = f"{begin}`{STUB} FILE` writes a plug-in for it; --undeclared warn accepts it"
        context.problems.error(
            "unknown-node", node.place, message, hint or known_names(context, node)
        )


def _report_missing(context: Context, nodes: list[Node], elsewhere: Iterable[str]) -> None:
    """Report the nodes that run a tree of a name that no tree has."""
    name, known = nodes[0].target or "", sorted({*context.document.trees} - {*elsewhere})
    message = f"no tree is called {name!r}"
    if context.tolerant:
        near = nearest(name, known)
        hint = f"did you mean {near}?" if near else "--include adds the file that has it"
        place = nodes[0].condition_places.get("ID", nodes[0].place)
        context.problems.warning("unknown-tree", place, message + _more(nodes), hint)
        return
    for node in nodes:
        hint = valid_names(name, known, "trees")
        if not hint.startswith("did you mean"):
            hint += "; --include adds the file that has it"
        place = node.condition_places.get("ID", node.place)
        context.problems.error("unknown-tree", place, message, hint)


def _more(nodes: list[Node]) -> str:
    return f" ({len(nodes)} nodes)" if len(nodes) > 1 else ""


def _report_declared(context: Context, declared: dict[str, Place]) -> None:
    """Say in one hint which nodes and trees are declared by the file and offered by nobody."""
    if not declared:
        return
    shown = ", ".join([said_type(name) for name in declared][:_MOST_NAMED])
    shown += ", …" if len(declared) > _MOST_NAMED else ""
    message = f"the file declares {shown}; no installed plug-in or file here has it"
    if len(declared) > 1:
        message = f"the file declares {shown}; no installed plug-in or file here has them"
    hint = f"before a run: `{STUB} FILE` writes a plug-in; `run --substitute` replaces nodes"
    place = next(iter(declared.values()))
    context.problems.hint("declared-only", place, message, hint)


def _why_broken(context: Context, name: str) -> str | None:
    """Why the plug-in of this name cannot be used; None if it can."""
    try:
        if name in context.registry.skills:
            context.registry.skills[name]
    except PluginError as error:
        return str(error)
    return why_broken(name)


# runs


def missing_for_a_run(context: Context, reached: Iterable[tuple[Node, bool]]) -> list[Problem]:
    """Why a run cannot begin: the nodes and trees that it may need and that nobody offers.

    reached: each node that can run and is not replaced for good, with whether a rule replaces it
    for some of its starts.
    """
    found: dict[str, Problem] = {}
    for node, sometimes in reached:
        name = node.target or "" if node.type == SUBTREE else node.type
        absent = _is_absent(context, node)
        if not absent or name in found:
            continue
        what = "tree" if node.type == SUBTREE else "node"
        message = f"nothing here has the {what} {said_type(name)!r}, which the run may need"
        if sometimes:
            message += ": the rules replace it only so many times"
        hint = (
            "--include adds its file" if node.type == SUBTREE else f"`{STUB} FILE` writes a plug-in"
        )
        hint += "; `run --substitute RULES` replaces it"
        found[name] = Problem("declared-only", message, node.place, hint)
    return list(found.values())


def _is_absent(context: Context, node: Node) -> bool:
    if node.type == SUBTREE:
        return node.target not in context.document.trees
    if node.type in NODES or node.type == BROKEN:
        return False
    signature = context.signature(node)
    return signature is not None and signature.skill is None
