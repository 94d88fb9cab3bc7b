"""From the checked model of a tree file to nodes that can be ticked."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeAlias, TypeGuard

from momantu_bt.engine.blackboard import Board, Cell
from momantu_bt.engine.conditions import Conditions
from momantu_bt.engine.context import RunContext
from momantu_bt.engine.makers import MAKERS, BuildError, Parts
from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.nodes import guards, recovery
from momantu_bt.engine.nodes.skill import SkillLeaf
from momantu_bt.engine.nodes.substituted import Substituted
from momantu_bt.engine.nodes.subtree import SubTree
from momantu_bt.engine.ports import Reader, cell_of, inputs_of, outputs_of, reader
from momantu_bt.skill import Port, Skill
from momantu_bt.tree.catalogue import AUTOREMAP, BUILT_IN, SUBTREE
from momantu_bt.tree.model import Document, Literal, Node, PortValue, Reference, Tree
from momantu_bt.tree.substitute.substitution import Substitution, reached
from momantu_bt.values.words import ConversionError

MAX_DEPTH = 250
"""Nodes within nodes, subtrees counted; each costs two of Python's 1000 frames when ticked."""

SkillFinder: TypeAlias = Callable[[str], type[Skill]]


@dataclass(frozen=True, slots=True)
class Built:
    """A tree ready to be ticked. nodes: in the order of the file. board: the root's."""

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

    skill_of: a skill's class by name; PluginError passes through. board: the root's, an empty
    one unless given. substitution: what nodes do instead of themselves.

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
        node.depth = 0 if node.parent is None else _depth(node)
    return Built(root, nodes, board)


def _depth(node: TreeNode) -> int:
    parent = node.parent
    assert isinstance(parent, TreeNode)
    return parent.depth + 1


def _tree(document: Document, name: str) -> Tree:
    if name not in document.trees:
        raise BuildError(f"no tree is called {name!r}; trees: {', '.join(document.trees)}")
    return document.trees[name]


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
        if model.disabled:
            return guards.Disabled(model, self.context)
        if self.substitution.of(model):
            return self._substituted(model, board, path, conditions)
        if model.type == SUBTREE:
            return self._subtree(model, board, path, conditions)
        if model.type in ("Recover", "Handle"):
            return self._catching(model, board, path, conditions)
        spec = BUILT_IN.get(model.type)
        if spec is None:
            return self._skill(model, board, path, conditions)
        if model.type not in MAKERS:
            raise BuildError(f"{model.place}: the engine has no node {model.type!r}")
        kids = [self.node(m, board, f"{path}.{i}") for i, m in enumerate(model.children)]
        return MAKERS[model.type](Parts(model, spec, self.context, kids, conditions, board))

    def _substituted(
        self, model: Node, board: Board, path: str, conditions: Conditions | None
    ) -> Substituted:
        kids: tuple[TreeNode, ...] = ()
        if not self.substitution.replaces(model):
            kids = (self.node(replace(model, conditions={}), board, path),)
        cells = {n: cell_of(v, board) for n, v in model.ports.items() if _is_wire(v)}
        results = self.substitution.of(model)
        return Substituted(model, self.context, kids, conditions, results=results, outputs=cells)

    def _skill(
        self, model: Node, board: Board, path: str, conditions: Conditions | None
    ) -> SkillLeaf:
        kind = self.skill_of(model.type)
        if not self.context.outside.runs_skills(self.context.body):
            raise BuildError(f"{model.place}: {model.type} is a skill and needs a world")
        return SkillLeaf(
            model,
            self.context,
            (),
            conditions,
            kind=kind,
            inputs=inputs_of(kind.ports, model.ports, board),
            outputs=outputs_of(kind.ports, model.ports, board),
            path=f"{path}:{model.type}",
        )

    def _catching(
        self, model: Node, board: Board, path: str, conditions: Conditions | None
    ) -> TreeNode:
        caught = Cell(f"{path}/failure", self.context.writes)
        inside = board.with_cells({"failure": caught})
        kids = [self.node(model.children[0], board, f"{path}.0")]
        catches = []
        for number, handler in enumerate(model.handlers, start=1):
            answer = None
            if handler.node is not None:
                answer = self.node(handler.node, inside, f"{path}.{number}")
                kids.append(answer)
            catches.append(recovery.Catch(handler.codes, answer))
        made: Any = (model, self.context, kids, conditions)
        if model.type == "Handle":
            return recovery.Handle(*made, catches=catches, caught=caught)
        inputs = inputs_of(BUILT_IN["Recover"].ports, model.ports, board)
        return recovery.Recover(*made, catches=catches, caught=caught, inputs=inputs)

    def _subtree(
        self, model: Node, board: Board, path: str, conditions: Conditions | None
    ) -> SubTree:
        tree = _tree(self.document, model.target or "")
        wired = {n: d.default for n, d in tree.ports.items() if _is_wire(d.default)}
        values: dict[str, PortValue] = {**wired, **model.ports}
        autoremap = values.pop(AUTOREMAP, Literal(False)) == Literal(True)
        wires = {k: cell_of(v, board) for k, v in values.items() if _is_wire(v)}
        inner = Board(
            self.context.writes, board, wires, path=f"{path}/{tree.name}/", autoremap=autoremap
        )
        given = self._given(tree, values, board, inner)
        child = self.node(tree.root, inner, f"{path}.0")
        made: Any = (model, self.context, (child,), conditions)
        return SubTree(*made, given=given, wires=wires, board=inner)

    def _given(
        self, tree: Tree, values: Mapping[str, PortValue], outer: Board, inner: Board
    ) -> dict[str, tuple[Cell, Reader]]:
        """What is written to inner keys at each start: all that is no plain wire, and defaults."""
        given: dict[str, tuple[Cell, Reader]] = {}
        for name, value in values.items():
            if not _is_wire(value):
                port = _declared(tree, name)
                given[name] = (inner.cell(name), reader(port, value, outer))
        for name, declaration in tree.ports.items():
            if name not in values and declaration.default is not None:
                constant = reader(declaration.port(), declaration.default, outer)
                given[name] = (inner.cell(name), constant)
        return given


def _is_wire(value: PortValue | None) -> TypeGuard[Reference]:
    return isinstance(value, Reference) and not value.fields


def _declared(tree: Tree, name: str) -> Port:
    declaration = tree.ports.get(name)
    return Port(name, "in", object, "") if declaration is None else declaration.port()


def skills_in(document: Document, substitution: Substitution | None = None) -> tuple[str, ...]:
    """Names of the skills that a run can reach, in the order of the file.

    substitution: what it replaces for good is not run.
    """
    replacing = substitution or Substitution()
    found = {
        node.type: None
        for node in reached(document, replacing.results)
        if node.type not in BUILT_IN and node.type != SUBTREE and not replacing.replaces(node)
    }
    return tuple(found)
