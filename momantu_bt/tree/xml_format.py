"""An XML tree file as a Document: the header, values, models, and the trees with their ports."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from momantu_bt.tree.language import TREE_NAME, TREE_NAME_HINT, VERSION
from momantu_bt.tree.model import (
    Document,
    Include,
    Literal,
    Node,
    Place,
    PortDeclaration,
    Tree,
)
from momantu_bt.tree.problems import Problems, TooManyProblems, TreeError, errors, valid_names
from momantu_bt.tree.puts import into_tree
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.resolve import resolve
from momantu_bt.tree.xml_models import Models, read_models
from momantu_bt.tree.xml_nodes import NodeReader
from momantu_bt.tree.xml_source import OURS, Attribute, Element, Parsed, XmlSyntaxError, parse
from momantu_bt.tree.xml_values import flow_value
from momantu_bt.tree.yaml_values import KEY

FORMAT = "4"
"""What `BTCPP_format` says; version 3 of BehaviorTree.CPP means other things by the same words."""

_ROOT = "root"
_PARTS = ("BehaviorTree", "TreeNodesModel", "include")
_OF_ROOT = ("BTCPP_format", "main_tree_to_execute", "project_name")
_EDITORS = ("_fullpath", "_uid", "_description")
_SCHEMA = "http://www.w3.org/2001/XMLSchema-instance"


def read(text: str, file: str, registry: Registry | None = None) -> tuple[Document, Problems]:
    """Read a file by itself, without those that it includes.

    file: the name that places carry. registry: whose skills' port types tell texts from numbers;
    nothing is known without one.

    Raises:
        TreeError: the text is not XML, has no trees, or too many problems; nothing else can be
            said then.
    """
    problems = Problems()
    source = XmlSource.of(text, file, registry or Registry(), problems)
    try:
        document = source.document({})
    except TooManyProblems:
        document = None
    if document is None:
        raise TreeError(errors(problems.sorted()), {file: text})
    resolve(document, problems)
    return document, problems


@dataclass(slots=True)
class XmlSource:
    """A file that is XML; its trees are read when those that it includes are known."""

    text: str
    file: str
    parsed: Parsed
    registry: Registry
    problems: Problems
    models: Models = field(default_factory=Models)

    @classmethod
    def of(cls, text: str, file: str, registry: Registry, problems: Problems) -> XmlSource:
        """Parse a text; TreeError when it is not XML."""
        try:
            return cls(text, file, parse(text, file), registry, problems)
        except XmlSyntaxError as error:
            raise TreeError([error.problem], {file: text}) from None

    def includes(self) -> tuple[Include, ...]:
        """The files it includes; those that are not written well are reported."""
        found = []
        for element in self.parsed.root.children:
            if element.name == "include" and not element.space:
                path = self._include_path(element)
                if path is not None:
                    found.append(Include(path.value, path.place))
        return tuple(found)

    def _include_path(self, element: Element) -> Attribute | None:
        path = element.get("path")
        for each in element.attributes:
            if each.name == "ros_pkg":
                message = "files of ROS packages cannot be found here"
                hint = "copy the file beside this one and write path alone"
                self.problems.error("include", each.name_place, message, hint)
                return None
            if each is not path:
                self._unknown_attribute(each, ["path"], "<include>")
        if path is None:
            message, hint = "<include> without a path", 'write <include path="other.xml"/>'
            self.problems.error("include", element.place, message, hint)
        return path

    def document(self, outside: Mapping[str, Tree], *, included: bool = False) -> Document | None:
        """The file's own trees. outside: trees of the files that it includes.

        included: it need not say which tree to run. None, with what is wrong reported, where
        there is nothing to read.
        """
        root = self.parsed.root
        if root.name != _ROOT or root.space:
            message = f"a tree file begins with <root>, not with <{root.said}>"
            hint = f'write <root BTCPP_format="{FORMAT}">'
            self.problems.error("not-a-tree", root.place, message, hint)
            return None
        self._header(root)
        self.models = read_models(root, self.problems)
        trees = self._trees(root, outside)
        if not trees and not self.includes() and not outside:
            message, hint = "the file has no tree", 'write <BehaviorTree ID="Name">'
            self.problems.error("no-trees", root.place, message, hint)
            return None
        main = "" if included else self._main(root, trees, outside)
        document = Document(self.file, main, trees)
        document.includes = self.includes()
        document.models = tuple(self.models.leaves)
        self._world(document, root)
        self._values(document, root)
        self._comments(document, root)
        document.source = {self.file: self.text}
        return document

    def _comments(self, document: Document, root: Element) -> None:
        """Those that belong to no tree: to the header, to the last value, or to the end."""
        above, below = root.comments, tuple[str, ...]()
        for element in root.children:
            inside = [each.comments for each in element.children if each.name != "Value"]
            if element.name == "include":
                above += element.comments
            elif element.name == "Values":
                above += element.comments
                last = next(reversed(document.values), None)
                if last is not None:
                    before = document.value_comments.get(last, ())
                    document.value_comments[last] = before + element.end_comments
            elif element.name == "TreeNodesModel":
                models = [text for texts in inside for text in texts]
                below += (*element.comments, *models, *element.end_comments)
        document.header_comments = above
        document.comments = (*below, *root.end_comments, *self.parsed.comments)

    # the header

    def _header(self, root: Element) -> None:
        version = root.get("BTCPP_format")
        if version is None:
            message = "the file does not say which version of BehaviorTree.CPP it is for"
            hint = (
                f'write <root BTCPP_format="{FORMAT}">; files without it are of version 3, where '
            )
            self.problems.error("no-version", root.place, message, hint + _CHANGED)
        elif version.value != FORMAT:
            message = f"trees of BehaviorTree.CPP {version.value} are not read"
            hint = f"version 4 is; in version 3 {_CHANGED}"
            self.problems.error("wrong-version", version.place, message, hint)
        for each in root.attributes:
            if each.space == OURS:
                if each.name not in ("world", "version"):
                    self._unknown_attribute(each, ["world", "version"], "<root>")
            elif each.space != _SCHEMA and each.name not in _OF_ROOT:
                self._unknown_attribute(each, list(_OF_ROOT), "<root>")
        ours = root.get("version", OURS)
        if ours is not None and ours.value != str(VERSION):
            message = "this version of the language is not known"
            self.problems.error("wrong-version", ours.place, message, f"known: {VERSION}")
        for element in root.children:
            self._part(element)

    def _part(self, element: Element) -> None:
        if element.name in _PARTS and not element.space:
            return
        if element.name == "Values" and element.space == OURS:
            return
        hint = valid_names(element.name, [*_PARTS, "momantu:Values"], "parts of a tree file")
        message = f"a tree file has no <{element.said}>"
        self.problems.error("unknown-key", element.place, message, hint)

    def _unknown_attribute(self, attribute: Attribute, known: list[str], said: str) -> None:
        message = f"{said} has no attribute {attribute.name!r}"
        hint = valid_names(attribute.name, known, "attributes")
        self.problems.error("unknown-key", attribute.name_place, message, hint)

    def _main(self, root: Element, trees: Mapping[str, Tree], outside: Mapping[str, Tree]) -> str:
        known = {**trees, **outside}
        named = root.get("main_tree_to_execute")
        first = next(iter(known), "")
        if named is not None and named.value in known:
            return named.value
        if named is not None:
            hint = valid_names(named.value, known, "trees")
            message = f"no tree is called {named.value!r}"
            self.problems.error("unknown-tree", named.place, message, hint)
        elif len(trees or known) > 1:
            message = f"the file does not say which of {', '.join(trees or known)} to run"
            hint = f'write <root … main_tree_to_execute="{first}">'
            self.problems.error("no-main", root.place, message, hint)
        return first

    def _world(self, document: Document, root: Element) -> None:
        world = root.get("world", OURS)
        if world is not None:
            document.world, document.world_place = world.value, world.place

    def _values(self, document: Document, root: Element) -> None:
        for section in root.children:
            if section.name == "Values" and section.space == OURS:
                for element in section.children:
                    self._value(document, element)

    def _value(self, document: Document, element: Element) -> None:
        key = element.get("key")
        if element.name != "Value" or element.space != OURS or key is None:
            hint = 'write <momantu:Value key="name">value</momantu:Value>'
            message = f"<{element.said}> is no value of the board"
            self.problems.error("unknown-key", element.place, message, hint)
            return
        name = key.value
        if not KEY.fullmatch(name):
            hint = "letters, digits and underscores, no digit first"
            message = f"{name!r} cannot be the name of a key"
            self.problems.error("bad-name", key.place, message, hint)
            return
        if name in document.values:
            message = f"the key {name!r} stands here twice"
            self.problems.error("duplicate-key", key.place, message)
            return
        place = self._text_place(element)
        found = flow_value(element.text.strip(), "", place, self.problems)
        if isinstance(found, Literal):
            document.values[name] = found
            document.value_places[name] = place
            document.value_comments[name] = element.comments
        elif found is not None:
            message = "one of the values is written out; a wire has no place here"
            hint = "write the value; in a text, $$ is a dollar"
            self.problems.error("wire-inside", place, message, hint)

    def _text_place(self, element: Element) -> Place:
        place, text = element.text_place, element.text.strip()
        if place is None:
            return element.place
        return Place(place.file, place.line, place.column, max(1, len(text.split("\n")[0])))

    # trees

    def _trees(self, root: Element, outside: Mapping[str, Tree]) -> dict[str, Tree]:
        elements = [e for e in root.children if e.name == "BehaviorTree" and not e.space]
        named: list[tuple[str, Element]] = []
        for element in elements:
            name = self._tree_name(element)
            if name is not None:
                named.append((name, element))
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

    def _model_others(self, outside: Mapping[str, Tree]) -> None:
        """Models of trees in other files, as an editor's project file has them."""
        for name, ports in self.models.trees.items():
            tree = outside.get(name)
            if tree is not None and tree.open:
                tree.ports, tree.open = ports, False

    def _tree_name(self, element: Element) -> str | None:
        identity = element.get("ID")
        if identity is None:
            message, hint = "a tree needs a name", 'write <BehaviorTree ID="Name">'
            self.problems.error("bad-name", element.place, message, hint)
            return None
        if not TREE_NAME.fullmatch(identity.value):
            message = f"{identity.value!r} cannot be the name of a tree"
            self.problems.error("bad-name", identity.place, message, TREE_NAME_HINT)
            return None
        return identity.value

    def _tree(
        self, name: str, element: Element, reader: NodeReader, ports: dict[str, PortDeclaration]
    ) -> Tree:
        tree = Tree(name, Node("", element.place), _tree_place(element), ports)
        tree.open = name not in self.models.trees
        tree.comments = element.comments
        for each in element.attributes:
            if each.name == "doc" and each.space == OURS:
                tree.doc = each.value
            elif each.name != "ID" and (each.space or each.name not in _EDITORS):
                self._unknown_attribute(each, ["ID", "momantu:doc"], "<BehaviorTree>")
        if not element.children:
            message = f"the tree {name!r} has no node"
            self.problems.error("no-node", element.place, message)
            return tree
        for extra in element.children[1:]:
            message = f"the tree {name!r} has {len(element.children)} nodes at its root; it has one"
            self.problems.error("children", extra.place, message, "put them into a <Sequence>")
        reader.read(element.children[0], into_tree(tree))
        tree.root.end_comments += element.end_comments
        return tree

    def _report_models_of_nothing(self, root: Element, known: Mapping[str, Tree]) -> None:
        """A model of a tree that nobody has is a mistyped name, unless an editor lists it."""
        for section in root.children:
            for model in section.children if section.name == "TreeNodesModel" else ():
                identity = model.get("ID")
                if model.name == "SubTree" and identity and identity.value not in known:
                    message = f"no tree is called {identity.value!r}, of which this is a model"
                    hint = valid_names(identity.value, known, "trees")
                    self.problems.warning("unknown-tree", identity.place, message, hint)


_CHANGED = "words such as SubTree, `_autoremap` and `${key}` mean other things"


def _report_twice(problems: Problems, name: str, first: Place, second: Place) -> None:
    for place, other in ((first, second), (second, first)):
        message = f"the tree {name!r} stands in {other} too"
        problems.error("duplicate-tree", place, message, "rename one of them")


def _tree_place(element: Element) -> Place:
    identity = element.get("ID")
    return element.place if identity is None else identity.place
