"""The trees of an XML file: their names, what their models say, and their nodes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from momantu_bt.formats.names import nearest, valid_names
from momantu_bt.formats.places import Place
from momantu_bt.formats.xml.elements import Element
from momantu_bt.tree.files.queue import into_tree
from momantu_bt.tree.files.syntax import OURS
from momantu_bt.tree.files.xml.header import report_unknown_attribute
from momantu_bt.tree.files.xml.models import Models
from momantu_bt.tree.files.xml.nodes import NodeReader
from momantu_bt.tree.files.xml.ports import DESCRIPTION
from momantu_bt.tree.language import TREE_NAME, TREE_NAME_HINT
from momantu_bt.tree.model import Node, PortDeclaration, Tree
from momantu_bt.tree.problems import Problems
from momantu_bt.tree.registry import Registry


@dataclass(frozen=True, slots=True)
class TreesReader:
    """Reads the trees of a file. models: what the file says of their ports."""

    models: Models
    registry: Registry
    problems: Problems

    def trees(self, root: Element, outside: Mapping[str, Tree]) -> dict[str, Tree]:
        """The file's own trees. outside: trees of the files that it includes."""
        elements = [e for e in root.children if e.name == "BehaviorTree" and not e.space]
        named: list[tuple[str, Element]] = []
        for number, element in enumerate(elements, 1):
            named.append((self._name(element, number), element))
        ports = {name: dict(tree.ports) for name, tree in outside.items()}
        ports |= {name: self.models.trees.get(name, {}) for name, _ in named}
        reader = NodeReader(ports, self.registry, self.problems)
        trees: dict[str, Tree] = {}
        for name, element in named:
            if name in trees:
                _report_twice(self.problems, name, trees[name].place, element.place)
            else:
                trees[name] = self._tree(name, element, reader, ports[name])
        self._model_others(outside)
        self._report_models_of_nothing(root, {**outside, **trees})
        return trees

    def _name(self, element: Element, number: int) -> str:
        """The name of a tree; without an ID, the one that BehaviorTree.CPP gives it."""
        identity = element.get("ID")
        if identity is None:
            message, hint = "a tree needs a name", 'write <BehaviorTree ID="Name">'
            with self.problems.keeping():
                self.problems.error("bad-name", element.place, message, hint)
            return f"BehaviorTree_{number}"
        if not TREE_NAME.fullmatch(identity.value):
            message = f"{identity.value!r} cannot be the name of a tree"
            with self.problems.keeping():
                self.problems.error("bad-name", identity.place, message, TREE_NAME_HINT)
        return identity.value

    def _tree(
        self, name: str, element: Element, reader: NodeReader, ports: dict[str, PortDeclaration]
    ) -> Tree:
        tree = Tree(name, Node("", element.place), _place(element), ports)
        tree.open = name not in self.models.trees
        tree.unnamed = element.get("ID") is None
        tree.comments, tree.end_comments = element.comments, element.end_comments
        self._attributes(tree, element)
        with self.problems.keeping():
            self._count(name, element)
        for number, child in enumerate(element.children):
            reader.read(child, into_tree(tree) if not number else tree.further.append)
        return tree

    def _count(self, name: str, element: Element) -> None:
        """Report a number of nodes other than one."""
        if not element.children:
            message = f"the tree {name!r} has no node"
            self.problems.error("no-node", element.place, message)
        for extra in element.children[1:]:
            message = f"the tree {name!r} has {len(element.children)} nodes at its root; it has one"
            self.problems.error("children", extra.place, message, "put them into a <Sequence>")

    def _attributes(self, tree: Tree, element: Element) -> None:
        """Give a tree its description and what programs keep for themselves; report slips."""
        for each in element.attributes:
            if each.space == OURS and each.name == "doc":
                tree.doc = each.value
            elif each.space == OURS:
                known = ["ID", "momantu:doc"]
                report_unknown_attribute(each, known, "<BehaviorTree>", self.problems)
            elif each.name == DESCRIPTION and each.value:
                tree.doc = each.value
            elif each.name != "ID":
                tree.attributes[each.said] = each.value
                slip = not each.space and each.name != DESCRIPTION
                near = nearest(each.name, ["ID", DESCRIPTION]) if slip else None
                if near is not None:
                    with self.problems.keeping():
                        report_unknown_attribute(
                            each, ["ID", DESCRIPTION], "<BehaviorTree>", self.problems
                        )

    def _model_others(self, outside: Mapping[str, Tree]) -> None:
        """Use models of trees in other files. An editor's project file has such models."""
        for name, ports in self.models.trees.items():
            tree = outside.get(name)
            if tree is not None and tree.open:
                tree.ports, tree.open = ports, False

    def _report_models_of_nothing(self, root: Element, known: Mapping[str, Tree]) -> None:
        """Report a model of an unknown tree: an error if a name is similar, or else a warning."""
        for section in root.children:
            for model in section.children if section.name == "TreeNodesModel" else ():
                identity = model.get("ID")
                if model.name == "SubTree" and identity and identity.value not in known:
                    message = f"no tree is called {identity.value!r}, of which this is a model"
                    hint = valid_names(identity.value, known, "trees")
                    slipped = nearest(identity.value, known) is not None
                    tell = self.problems.error if slipped else self.problems.warning
                    with self.problems.keeping():
                        tell("unknown-tree", identity.place, message, hint)


def _report_twice(problems: Problems, name: str, first: Place, second: Place) -> None:
    for place, other in ((first, second), (second, first)):
        message = f"the tree {name!r} stands in {other} too"
        problems.error("duplicate-tree", place, message, "rename one of them")


def _place(element: Element) -> Place:
    identity = element.get("ID")
    return element.place if identity is None else identity.place
