"""Builds nodes that can be ticked from the checked model of a tree file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeAlias, TypeGuard, cast

from momantu_bt.engine.blackboard import Board, Cell
from momantu_bt.engine.conditions import Conditions
from momantu_bt.engine.context import RunContext
from momantu_bt.engine.node import BuildError, Parts, TreeNode
from momantu_bt.engine.ports import Reader, cell_of, reader
from momantu_bt.engine.skill_leaf import SkillLeaf
from momantu_bt.engine.substituted import Disabled, Substituted
from momantu_bt.engine.subtree import SubTree
from momantu_bt.errors import PLUGIN_ERRORS, MomantuError, words_of
from momantu_bt.skill import Port, Skill
from momantu_bt.tree.catalogue import AUTOREMAP, NODE_CLASSES, NODES, SUBTREE
from momantu_bt.tree.catalogue.built_in import BUILT_IN
from momantu_bt.tree.language import FAILURE_KEY
from momantu_bt.tree.model import Document, Literal, Node, PortValue, Reference, Tree
from momantu_bt.tree.substitute.substitution import Substitution, reached
from momantu_bt.values.contents import freeze
from momantu_bt.values.words import ConversionError

MAX_DEPTH = 250
"""Deepest nesting, subtrees included. A level takes two of Python's 1000 stack frames in a tick."""

SkillFinder: TypeAlias = Callable[[str], type[Skill]]


@dataclass(frozen=True, slots=True)
class Built:
    """A tree that is ready to be ticked. nodes: in file order. board: of the root."""

    root: TreeNode
    nodes: tuple[TreeNode, ...]
    board: Board


def build(
    document: Document,
    context: RunContext,
    skill_of: SkillFinder,
    board: Board | None = None,
    substitution: Substitution | None = None,
) -> Built:
    """Make the nodes of a document's main tree, subtrees included.

    skill_of: finds a skill's class by name; its PluginError is passed on. board: the root's board;
    by default an empty one. substitution: the nodes to replace, and by what.

    Raises:
        BuildError: an unknown node, a literal that does not fit, nesting beyond MAX_DEPTH.
    """
    board = board or Board(context.writes)
    tree = _tree(document, document.main)
    replacing = substitution or Substitution()
    root = _Builder(document, context, skill_of, replacing).node(tree.root, board, "0")
    nodes = (root, *root.below)
    for index, node in enumerate(nodes):
        node.index = index
        node.depth = 0 if node.above is None else node.above.depth + 1
    return Built(root, nodes, board)


def _tree(document: Document, name: str) -> Tree:
    if name not in document.trees:
        raise BuildError(f"no tree is called {name!r}; trees: {', '.join(document.trees)}")
    return document.trees[name]


def _plugged_in(kind: type[TreeNode], parts: Parts) -> TreeNode:
    """A node of another package, whose constructor may raise anything."""
    try:
        return kind(parts)
    except (MomantuError, ConversionError):
        raise
    except PLUGIN_ERRORS as error:
        raise BuildError(
            f"{parts.model.place}: the node {parts.model.type} cannot be made: its constructor "
            f"({kind.__module__}:{kind.__qualname__}) raised {words_of(error)}",
            hint="Tell its authors, or leave the node out.",
        ) from error


class _Builder:
    def __init__(
        self,
        document: Document,
        context: RunContext,
        skill_of: SkillFinder,
        substitution: Substitution,
    ) -> None:
        self.document = document
        self.context = context
        self.skill_of = skill_of
        self.substitution = substitution

    def node(self, model: Node, board: Board, path: str) -> TreeNode:
        """One node and what is below it. path: positions from the root, such as `0.2.1`."""
        if path.count(".") > MAX_DEPTH:
            raise BuildError(f"{model.place}: nodes are nested more than {MAX_DEPTH} deep")
        try:
            return self._made(model, board, path)
        except ConversionError as error:
            raise BuildError(f"{model.place}: {model.type}: {error}") from None

    def _made(self, model: Node, board: Board, path: str) -> TreeNode:
        conditions = Conditions(model.conditions, board) if model.conditions else None
        parts = Parts(model, self.context, board, conditions=conditions)
        if model.disabled:
            return Disabled(replace(parts, conditions=None))
        if self.substitution.of(model):
            return self._substituted(parts, path)
        if model.type == SUBTREE:
            return self._subtree(parts, path)
        spec = NODES.get(model.type)
        if spec is None:
            return self._skill(parts, path)
        kids = tuple(self.node(m, board, f"{path}.{i}") for i, m in enumerate(model.children))
        parts = replace(parts, ports=spec.ports, kids=kids)
        if spec.handlers:
            parts = self._with_handlers(parts, path)
        kind = cast(type[TreeNode], NODE_CLASSES[model.type])
        return kind(parts) if model.type in BUILT_IN else _plugged_in(kind, parts)

    def _substituted(self, parts: Parts, path: str) -> Substituted:
        model, board = parts.model, parts.board
        kids: tuple[TreeNode, ...] = ()
        if not self.substitution.replaces(model):
            kids = (self.node(replace(model, conditions={}), board, path),)
        cells = {n: cell_of(v, board) for n, v in model.ports.items() if _is_wire(v)}
        results = self.substitution.of(model)
        if results[0].test is not None:
            kids, results = (self.node(results[0].test, board, path),), ()
        return Substituted(replace(parts, kids=kids), results=results, outputs=cells)

    def _skill(self, parts: Parts, path: str) -> SkillLeaf:
        model = parts.model
        kind = self.skill_of(model.type)
        if not self.context.outside.runs_skills(self.context.body):
            raise BuildError(f"{model.place}: {model.type} is a skill and needs a world")
        return SkillLeaf(replace(parts, ports=kind.ports), kind=kind, path=f"{path}:{model.type}")

    def _with_handlers(self, parts: Parts, path: str) -> Parts:
        """Add the handlers' nodes; they see the failure as a key."""
        caught = Cell(f"{path}/failure", self.context.writes)
        inside = parts.board.with_cells({FAILURE_KEY: caught})
        kids = list(parts.kids)
        answers = []
        for number, handler in enumerate(parts.model.handlers, start=len(kids)):
            answer = None
            if handler.node is not None:
                answer = self.node(handler.node, inside, f"{path}.{number}")
                kids.append(answer)
            answers.append((handler.codes, answer))
        return replace(parts, kids=tuple(kids), answers=tuple(answers), caught=caught)

    def _subtree(self, parts: Parts, path: str) -> SubTree:
        model, board = parts.model, parts.board
        tree = _tree(self.document, model.target or "")
        values: dict[str, PortValue] = dict(model.ports)
        autoremap = values.pop(AUTOREMAP, Literal(False)) == Literal(True)
        if not autoremap:  # with it, a key that is not given is the outer one, default or not
            for name, declared in tree.ports.items():
                if declared.default is not None:
                    values.setdefault(name, declared.default)
        wires = {k: cell_of(v, board) for k, v in values.items() if _is_wire(v)}
        inner = Board(
            self.context.writes, board, wires, path=f"{path}/{tree.name}/", autoremap=autoremap
        )
        given: dict[str, tuple[Cell, Reader]] = {}
        constants: dict[str, Cell] = {}
        for name, value in values.items():
            if name in wires:
                continue
            cell, read = inner.own(name), reader(_declared(tree, name), value, board)
            if isinstance(value, Literal):
                constants[name] = cell
                cell.begin(freeze(read()))
            else:
                given[name] = (cell, read)
        child = self.node(tree.root, inner, f"{path}.0")
        parts = replace(parts, kids=(child,))
        return SubTree(parts, given=given, constants=constants, wires=wires, board=inner)


def _is_wire(value: PortValue | None) -> TypeGuard[Reference]:
    return isinstance(value, Reference) and not value.fields


def _declared(tree: Tree, name: str) -> Port:
    declaration = tree.ports.get(name)
    return Port(name, "in", object, "") if declaration is None else declaration.port()


def skills_in(document: Document, substitution: Substitution | None = None) -> tuple[str, ...]:
    """Names of the skills that a run can reach, in file order.

    substitution: skills that it replaces for the whole run are left out.
    """
    replacing = substitution or Substitution()
    found = {
        node.type: None
        for node in reached(document, replacing.results)
        if node.type not in NODES and node.type != SUBTREE and not replacing.replaces(node)
    }
    return tuple(found)
