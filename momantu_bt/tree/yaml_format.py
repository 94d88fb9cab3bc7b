"""A YAML tree file as a Document: the header, values, and the trees with their inputs."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from momantu_bt.tree.catalogue import MODIFIERS, SPELLED
from momantu_bt.tree.model import (
    Document,
    Include,
    Literal,
    Node,
    Place,
    PortDeclaration,
    Reference,
    Template,
    Tree,
)
from momantu_bt.tree.problems import (
    Problems,
    TooManyProblems,
    TreeError,
    errors,
    nearest,
    valid_names,
)
from momantu_bt.tree.yaml_comments import attach
from momantu_bt.tree.yaml_models import read_models
from momantu_bt.tree.yaml_nodes import AGAIN, NodeReader
from momantu_bt.tree.yaml_source import (
    Entries,
    Items,
    Raw,
    Remark,
    Scalar,
    YamlSyntaxError,
    compose_with_remarks,
)
from momantu_bt.tree.yaml_values import KEY, drop_duplicates, port_value, words

VERSION = 1
"""What `momantu_bt:` says; a later one may read differently."""

TREE_NAME = re.compile(r"[^\W\d][\w.-]*(?: [\w.-]+)*")
"""Names that a tree can have; BehaviorTree.CPP's may hold more than letters."""
TREE_NAME_HINT = "letters, digits, `_`, `-`, `.` and single spaces, a letter first"

_TOP = ("momantu_bt", "include", "world", "main", "values", "trees", "models")
PORTS = {"inputs": "in", "outputs": "out", "inouts": "inout"}
HEADER = (*PORTS, "open", "doc")
_DECLARATION = ("type", "default", "doc")


def read(text: str, file: str) -> tuple[Document, Problems]:
    """Read a tree file by itself, without those that it includes.

    The document holds BROKEN nodes where problems were found. file: the name that places carry.

    Raises:
        TreeError: the text is not YAML, has no trees, or too many problems; nothing else can be
            said then.
    """
    problems = Problems()
    try:
        document = YamlSource.of(text, file, problems).document({})
    except TooManyProblems:
        document = None
    if document is None:
        raise TreeError(errors(problems.sorted()), {file: text})
    return document, problems


@dataclass(slots=True)
class YamlSource:
    """A file that is YAML; its trees are read when those that it includes are known."""

    text: str
    file: str
    raw: Raw
    remarks: list[Remark]
    problems: Problems

    @classmethod
    def of(cls, text: str, file: str, problems: Problems) -> YamlSource:
        """Parse a text; TreeError when it is not YAML."""
        try:
            return cls(text, file, *compose_with_remarks(text, file), problems)
        except YamlSyntaxError as error:
            raise TreeError([error.problem], {file: text}) from None

    def includes(self) -> tuple[Include, ...]:
        """The files it includes; those that are not written well are reported."""
        raw = self.raw
        listed = (
            [value for key, value in raw.entries if key.text == "include"]
            if isinstance(raw, Entries)
            else []
        )
        found: list[Include] = []
        for value in listed[:1]:
            for item in value.items if isinstance(value, Items) else [value]:
                if isinstance(item, Scalar) and item.text and isinstance(item.value, str):
                    found.append(Include(item.text, item.place))
                else:
                    hint = "write `include: [other.yaml]`"
                    self.problems.error("include", item.place, "a file's name is expected", hint)
        return tuple(found)

    def document(self, outside: Mapping[str, Tree], *, included: bool = False) -> Document | None:
        """The file's own trees. outside: trees of the files that it includes.

        included: it need not say which tree to run. None, with what is wrong reported, where
        there is nothing to read.
        """
        document = _Reader(self.file, self.problems, outside, included).document(self.raw)
        if document is not None:
            document.includes = self.includes()
            document.source = {self.file: self.text}
            if self.remarks:
                attach(document, self.raw, self.text, self.remarks)
        return document


@dataclass(slots=True)
class _Reader:
    file: str
    problems: Problems
    outside: Mapping[str, Tree]
    included: bool

    def document(self, raw: Raw) -> Document | None:
        if not isinstance(raw, Entries):
            self.problems.error(
                "not-a-tree", raw.place, "a tree file is a mapping", "begin with `momantu_bt: 1`"
            )
            return None
        drop_duplicates(raw, self.problems)
        having = {key.text: (key, value) for key, value in raw.entries}
        for key, _ in raw.entries:
            if key.text not in _TOP:
                hint = valid_names(key.text, _TOP, "keys of a tree file")
                self.problems.error(
                    "unknown-key", key.place, f"a tree file has no {key.text!r}", hint
                )
        self.version(having.get("momantu_bt"), raw.place)
        trees = self.trees(having.get("trees"), raw.place)
        if trees is None:
            return None
        main = "" if self.included else self.main(having.get("main"), trees)
        document = Document(self.file, main, trees)
        self.world(document, having.get("world"))
        self.values(document, having.get("values"))
        if "models" in having:
            document.models = read_models(having["models"][1], self.problems)
        return document

    def version(self, entry: tuple[Scalar, Raw] | None, place: Place) -> None:
        if entry is None:
            self.problems.error(
                "no-version",
                Place(place.file, place.line, 1),
                "the file does not say which language it is in",
                f"begin with `momantu_bt: {VERSION}`",
            )
        elif not isinstance(entry[1], Scalar) or entry[1].text != str(VERSION):
            self.problems.error(
                "wrong-version",
                entry[1].place,
                "this version of the language is not known",
                f"known: {VERSION}",
            )

    def main(self, entry: tuple[Scalar, Raw] | None, trees: dict[str, Tree]) -> str:
        known = {**trees, **self.outside}
        first = next(iter(known))
        if entry is None:
            if len(trees or known) > 1:
                self.problems.error(
                    "no-main",
                    known[first].place,
                    "the file does not say which tree to run",
                    f"write `main: {first}`",
                )
            return first
        raw = entry[1]
        name = raw.text if isinstance(raw, Scalar) else ""
        if name not in known:
            hint = valid_names(name, known, "trees")
            self.problems.error("unknown-tree", raw.place, f"no tree is called {name!r}", hint)
            return first
        return name

    def world(self, document: Document, entry: tuple[Scalar, Raw] | None) -> None:
        if entry is None:
            return
        raw = entry[1]
        if isinstance(raw, Scalar) and isinstance(raw.value, str):
            document.world, document.world_place = raw.value, raw.place
        else:
            self.problems.error("wrong-value", raw.place, "`world` is the name of a world")

    def values(self, document: Document, entry: tuple[Scalar, Raw] | None) -> None:
        if entry is None:
            return
        for key, raw in self.mapping(entry[1], "values", "key: value"):
            if not self.is_key(key):
                continue
            found = self.written_out(raw, "one of `values`")
            if found is not None:
                document.values[key.text] = found
                document.value_places[key.text] = raw.place

    def written_out(self, raw: Raw, what: str) -> Literal | None:
        """A value without wires; None where a problem was reported."""
        found = port_value(raw, "", self.problems)
        if found is None or isinstance(found, Literal):
            return found
        hint = "write the value; in a text, $$ is a dollar"
        message = f"{what} is written out; a wire has no place here"
        self.problems.error("wire-inside", raw.place, message, hint)
        return None

    def is_key(self, key: Scalar) -> bool:
        if isinstance(key.value, str) and KEY.fullmatch(key.text):
            return True
        hint = "letters, digits and underscores, no digit first"
        if key.text.startswith("$"):
            hint = f"did you mean {key.text[1:]}?"
        self.problems.error(
            "bad-name", key.place, f"{key.text!r} cannot be the name of a key", hint
        )
        return False

    def mapping(self, raw: Raw, name: str, example: str) -> list[tuple[Scalar, Raw]]:
        if isinstance(raw, Entries):
            drop_duplicates(raw, self.problems)
            return raw.entries
        if not (isinstance(raw, Scalar) and raw.value is None):
            self.problems.error(
                "wrong-value", raw.place, f"`{name}` is a mapping", f"write {{{example}}}"
            )
        return []

    # trees

    def trees(self, entry: tuple[Scalar, Raw] | None, place: Place) -> dict[str, Tree] | None:
        having: list[tuple[Scalar, Raw]] = []
        if entry is not None:
            having = self.mapping(entry[1], "trees", "Name: [node, node]")
        if not having and entry is None and self.outside:
            return {}
        if not having:
            where = entry[0].place if entry is not None else Place(place.file, place.line, 1)
            self.problems.error(
                "no-trees", where, "the file has no tree", "write `trees:` and under it `Name:`"
            )
            return None
        names = {*(key.text for key, _ in having), *self.outside}
        reader = NodeReader(names, self.problems)
        trees: dict[str, Tree] = {}
        for key, raw in having:
            self.tree_name(key)
            if key.text not in trees:
                trees[key.text] = self.tree(key, raw, reader)
        return trees

    def tree_name(self, key: Scalar) -> None:
        if not isinstance(key.value, str) or not TREE_NAME.fullmatch(key.text):
            message = f"{key.text!r} cannot be the name of a tree"
            self.problems.error("bad-name", key.place, message, TREE_NAME_HINT)
        elif key.text in SPELLED or key.text in MODIFIERS or key.text == AGAIN:
            message = f"{key.text!r} is a word of the language"
            self.problems.error("bad-name", key.place, message, "give the tree another name")

    def tree(self, key: Scalar, raw: Raw, reader: NodeReader) -> Tree:
        tree = Tree(key.text, Node("", key.place), key.place)
        body = raw
        if isinstance(raw, Entries):
            drop_duplicates(raw, self.problems)
            header = {k.text: v for k, v in raw.entries if k.text in HEADER}
            body = Entries(
                [(k, v) for k, v in raw.entries if k.text not in HEADER], raw.place, raw.flow
            )
            for name, direction in PORTS.items():
                if name in header:
                    self.declarations(tree, header[name], name, direction)
            if "open" in header:
                self.open(tree, header["open"])
            if "doc" in header:
                tree.doc = words(header["doc"], self.problems, "`doc`")
            if not body.entries:
                self.problems.error("no-node", key.place, f"the tree {key.text!r} has no node")
                return tree
        reader.read(body, _root_setter(tree))
        return tree

    def open(self, tree: Tree, raw: Raw) -> None:
        if isinstance(raw, Scalar) and isinstance(raw.value, bool):
            tree.open = raw.value
        else:
            hint = "an open tree takes any key as a port"
            self.problems.error("wrong-value", raw.place, "`open` is true or false", hint)

    def declarations(self, tree: Tree, raw: Raw, name: str, direction: str) -> None:
        if isinstance(raw, Items):
            raw = self.untyped(raw, name)
        for key, value in self.mapping(raw, name, "name: type"):
            if not self.is_key(key):
                continue
            if key.text in tree.ports and tree.ports[key.text].direction != direction:
                message = f"{key.text!r} is an input or output already"
                hint = "a key that comes in and goes out stands under `inouts:`"
                self.problems.error("duplicate-key", key.place, message, hint)
            found = self.declaration(key, value, direction)
            if found is not None:
                tree.ports[key.text] = found

    def untyped(self, raw: Items, name: str) -> Entries:
        """`[a, b]` as `{a: any, b: any}`."""
        entries: list[tuple[Scalar, Raw]] = []
        for item in raw.items:
            if isinstance(item, Scalar):
                entries.append((item, Scalar("any", "any", False, item.place)))
            else:
                hint = f"write `{name}: {{name: type}}`"
                self.problems.error("wrong-value", item.place, f"`{name}` lists names", hint)
        return Entries(entries, raw.place)

    def declaration(self, key: Scalar, raw: Raw, direction: str) -> PortDeclaration | None:
        if isinstance(raw, Scalar) and isinstance(raw.value, str):
            return PortDeclaration(key.text, direction, raw.value, raw.place)
        if not isinstance(raw, Entries):
            hint = "write `name: text` or `name: {type: text, default: …}`"
            self.problems.error("wrong-value", raw.place, f"{key.text!r} needs a type", hint)
            return None
        drop_duplicates(raw, self.problems)
        having = {k.text: v for k, v in raw.entries}
        for name, _ in raw.entries:
            if name.text not in _DECLARATION:
                near = nearest(name.text, _DECLARATION)
                hint = f"did you mean {near}?" if near else f"keys: {', '.join(_DECLARATION)}"
                message = f"an input or output has no {name.text!r}"
                self.problems.error("unknown-key", name.place, message, hint)
        type_ = having.get("type")
        if type_ is not None and not isinstance(type_, Scalar):
            hint = "such as `type: text` or `type: list of int`"
            self.problems.error("wrong-value", type_.place, "`type` is the name of a type", hint)
        default = having.get("default")
        found = None if default is None else self.default(default)
        return PortDeclaration(
            key.text,
            direction,
            type_.text if isinstance(type_, Scalar) else "any",
            type_.place if type_ is not None else raw.place,
            found,
            words(having["doc"], self.problems, "`doc`") if "doc" in having else "",
        )

    def default(self, raw: Raw) -> Literal | Reference | None:
        found = port_value(raw, "", self.problems)
        if isinstance(found, Template) or (isinstance(found, Reference) and found.fields):
            message = "a default is a value, or one key of whoever runs the tree"
            self.problems.error("wire-inside", raw.place, message, "write the value, or $key")
            return None
        return found


def _root_setter(tree: Tree) -> Callable[[Node], None]:
    def put(node: Node) -> None:
        tree.root = node

    return put
