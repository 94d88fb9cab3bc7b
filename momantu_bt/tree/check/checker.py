"""The checker: runs all checks on a document."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace

from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import Problem
from momantu_bt.tree.check.calls import check_calls
from momantu_bt.tree.check.conditions import check_conditions
from momantu_bt.tree.check.elsewhere import report_elsewhere, with_trees_elsewhere
from momantu_bt.tree.check.guards import check_guards
from momantu_bt.tree.check.handlers import check_handlers
from momantu_bt.tree.check.keys.flow_check import check_keys
from momantu_bt.tree.check.misspelled import mend_declarations, mend_ports
from momantu_bt.tree.check.nodes import check_node, check_tree_ports, with_named_inputs
from momantu_bt.tree.check.reactive import check_reactive
from momantu_bt.tree.check.robot_fit import check_robot_fit
from momantu_bt.tree.check.root_keys import ROBOT_KEY, report_broken_services, root_keys
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.check.surroundings import look_up_surroundings
from momantu_bt.tree.check.trees import (
    callees_first,
    check_given_names,
    check_nesting,
    check_parallel,
    check_unused,
    reached,
)
from momantu_bt.tree.model import Document, Tree
from momantu_bt.tree.problems import Problems, TooManyProblems
from momantu_bt.tree.registry import Registry


@dataclass(frozen=True, slots=True)
class Checked:
    """A checked document. problems: errors, warnings and hints in file order.

    document: the document to run; bare values (`dock: bay_a`) now have the names of their ports.
    """

    document: Document
    problems: list[Problem]


def check(
    document: Document,
    registry: Registry,
    *,
    world: str | None = None,
    robot: str | None = None,
    reading: Problems | None = None,
    tolerant: bool = False,
) -> Checked:
    """Check a document, without changing it.

    world, robot: names from the command line, instead of the file's world and the world's robot.
    reading: problems that were found while reading the file; the result includes them.
    tolerant: nodes, trees and keys that stand elsewhere are warnings and not errors.
    """
    problems = reading if reading is not None else Problems()
    whole, elsewhere = with_trees_elsewhere(document)
    context = Context(_concerned(whole), registry, problems, tolerant)
    with suppress(TooManyProblems):  # the last of them says that there are more
        mend_declarations(context)
        context.document = with_named_inputs(context)
        mend_ports(context)
        _check(context, world, robot, elsewhere)
    trees = {n: tree for n, tree in context.document.trees.items() if n not in elsewhere}
    return Checked(replace(document, trees={**document.trees, **trees}), problems.sorted())


def _concerned(document: Document) -> Document:
    """The document without included trees that none of the file's own trees runs.

    Such trees are checked with their own file, or with a file that runs them.
    """
    trees, file = document.trees, document.file
    starts = [n for n, tree in trees.items() if n == document.main or tree.place.file == file]
    kept = reached(document, starts)
    return replace(document, trees={name: tree for name, tree in trees.items() if name in kept})


def _check(
    context: Context, world: str | None, robot: str | None, elsewhere: frozenset[str]
) -> None:
    document = context.document
    if document.main not in document.trees:
        if not document.trees and document.models:
            return
        message = "no tree is left to run: those that there are cannot be read"
        context.problems.error("no-trees", _start(document), message, "see the other problems")
        return
    look_up_surroundings(context, world, robot)
    for tree in document.trees.values():
        if tree.name in elsewhere:
            continue
        check_tree_ports(context, tree)
        _check_tree_name(context, tree)
        for node in tree.root.walk():
            check_node(context, node)
            check_conditions(context, node)
        check_given_names(context, tree)
    report_elsewhere(context, elsewhere)
    check_unused(context)
    check_calls(context)
    check_robot_fit(context)
    shallow = [check_nesting(context, tree) for tree in document.trees.values()]
    order = callees_first(context)
    if order is not None and all(shallow):
        check_parallel(context, order)
        check_handlers(context, order)
        check_reactive(context, order)
        check_guards(context, order, frozenset({ROBOT_KEY, *context.registry.services}))
        check_keys(context, order, root_keys(context))
        report_broken_services(context)


def _start(document: Document) -> Place:
    return Place(document.file, 1, 1)


def _check_tree_name(context: Context, tree: Tree) -> None:
    if context.in_xml(tree.place) or not tree.name[:1].islower():
        return  # in XML a tree is run by <SubTree>; a name spelled like a tree means the tree
    if tree.name in context.registry.skills:
        message = f"{tree.name!r} is the name of an installed skill"
        hint = f"rename the tree, and each node that runs it; a node {tree.name} could mean both"
        context.problems.error("bad-name", tree.place, message, hint)


__all__ = ["Checked", "check"]
