"""A YAML tree file as a Document: the header, the values and the trees."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import errors
from momantu_bt.formats.yaml.comments import Comment
from momantu_bt.formats.yaml.reader import YamlSyntaxError
from momantu_bt.formats.yaml.values import Entries, Items, Raw, Scalar
from momantu_bt.tree.catalogue import SPELLED
from momantu_bt.tree.files.port_values import drop_duplicates, is_key, mapping, port_value
from momantu_bt.tree.files.syntax import compose_with_comments
from momantu_bt.tree.files.yaml.comments import attach
from momantu_bt.tree.files.yaml.misplaced import Trees, indent_top
from momantu_bt.tree.files.yaml.models import read_models
from momantu_bt.tree.files.yaml.parts import read_document_xml, read_include, settle_order
from momantu_bt.tree.files.yaml.trees import read_trees
from momantu_bt.tree.language import VERSION
from momantu_bt.tree.model import Document, Include, Literal, Tree
from momantu_bt.tree.problems import Problems, TooManyProblems, TreeError
from momantu_bt.tree.registry import Registry

_TOP = ("momantu_bt", "include", "world", "goal", "main", "values", "trees", "models", "xml")


def read(text: str, file: str, registry: Registry | None = None) -> tuple[Document, Problems]:
    """Read one tree file, without the files that it includes.

    The document holds BROKEN nodes where problems were found. file: the file name in places.
    registry: the skills; the types of their ports are needed for attributes in XML's spelling.

    Raises:
        TreeError: the text is not YAML, has no trees, or has too many problems. Nothing else is
            reported then.
    """
    problems = Problems()
    try:
        document = YamlSource.of(text, file, registry or Registry(), problems).document({})
    except TooManyProblems:
        document = None
    if document is None or not (document.trees or document.includes):
        raise TreeError(errors(problems.sorted()), {file: text})
    return document, problems


@dataclass(slots=True)
class YamlSource:
    """A file in YAML. Its trees are read once the trees of its includes are known."""

    text: str
    file: str
    raw: Raw
    remarks: list[Comment]
    registry: Registry
    problems: Problems

    @classmethod
    def of(cls, text: str, file: str, registry: Registry, problems: Problems) -> YamlSource:
        """Parse a text; TreeError when it is not YAML."""
        try:
            return cls(text, file, *compose_with_comments(text, file), registry, problems)
        except YamlSyntaxError as error:
            raise TreeError([error.problem], {file: text}) from None

    def includes(self) -> tuple[Include, ...]:
        """The files it includes. Includes that are written wrongly are reported."""
        raw = self.raw
        listed = (
            [value for key, value in raw.entries if key.text == "include"]
            if isinstance(raw, Entries)
            else []
        )
        found: list[Include] = []
        for value in listed[:1]:
            for item in value.items if isinstance(value, Items) else [value]:
                include = read_include(item, self.problems)
                found += [] if include is None else [include]
        return tuple(found)

    def document(self, outside: Mapping[str, Tree], *, included: bool = False) -> Document | None:
        """The file's own trees. outside: trees of the files that it includes.

        included: whether another file includes this one; then it need not name a tree to run.
        Returns None, with the problem reported, if there is nothing to read.
        """
        reader = _Reader(self.file, self.registry, self.problems, outside, included)
        document = reader.document(self.raw)
        if document is not None:
            document.includes = self.includes()
            document.source = {self.file: self.text}
            models = isinstance(self.raw, Entries) and self.raw.entries
            named = {key.text for key, _ in models} if models else set()
            settle_order(document, has_models="models" in named)
            if self.remarks:
                attach(document, self.raw, self.text, self.remarks)
        return document


@dataclass(slots=True)
class _Reader:
    file: str
    registry: Registry
    problems: Problems
    outside: Mapping[str, Tree]
    included: bool

    def document(self, raw: Raw) -> Document | None:
        if not isinstance(raw, Entries):
            self.problems.error(
                "not-a-tree", raw.place, "a tree file is a mapping", "begin with `momantu_bt: 1`"
            )
            return None
        moved = indent_top(raw, _TOP, self.problems)
        drop_duplicates(raw, self.problems)
        having = {key.text: (key, value) for key, value in raw.entries}
        self.version(having.get("momantu_bt"), raw.place)
        if self.unknown_keys(raw):
            return None
        document = Document(self.file, "", {})
        if "xml" in having:
            read_document_xml(document, having["xml"][1], self.problems)
        if "models" in having:
            document.models = read_models(having["models"][1], self.problems)
        entry = self.as_mapping(having.get("trees"))
        if entry is not None:
            Trees(self.registry.skills, moved, self.problems).settle(entry[1])
        read_trees(entry, document, self.outside, self.registry, self.problems)
        self.report_no_tree(document, entry, raw.place)
        if not self.included:
            self.main(document, having.get("main"))
        self.world(document, having.get("world"))
        self.goal(document, having.get("goal"))
        self.values(document, having.get("values"))
        return document

    def as_mapping(self, entry: tuple[Scalar, Raw] | None) -> tuple[Scalar, Raw] | None:
        """`trees:` with a list of trees (`- Name: …`) or of nodes, reported, as what it means."""
        if entry is None or not isinstance(entry[1], Items) or not entry[1].items:
            return entry
        raw = entry[1]
        trees = [tree for item in raw.items if isinstance(item, Entries) for tree in item.entries]
        nodes = [key.text for key, _ in trees if key.text in (*SPELLED, *self.registry.skills)]
        message = "`trees` is a mapping from names to trees, not a list"
        if nodes or len(trees) < len(raw.items):
            hint = "write a name such as `Main:` above the list, and indent the list"
            trees = [(Scalar("Main", "Main", False, entry[0].place), raw)]
        else:
            hint = f"write `{trees[0][0].text}:` without `- ` before it"
        self.problems.error("wrong-value", raw.place, message, hint)
        return entry[0], Entries(trees, raw.place)

    def report_no_tree(
        self, document: Document, entry: tuple[Scalar, Raw] | None, place: Place
    ) -> None:
        """Report a file without a tree, unless it has includes, or is an included palette."""
        palette = bool(document.models) and self.included
        if document.trees or (entry is None and (self.outside or palette)):
            return
        if entry is not None and isinstance(entry[1], Scalar) and entry[1].value is not None:
            return  # what stands there instead is reported
        where = entry[0].place if entry is not None else Place(place.file, place.line, 1)
        hint = "write `trees:` and under it `Name:`"
        with self.problems.keeping():
            self.problems.error("no-trees", where, "the file has no tree", hint)

    def unknown_keys(self, raw: Entries) -> bool:
        """Report unknown keys; whether one of them holds a part of the file.

        All else would then be told again where that part is used. Of several, the first is told.
        """
        for key, value in raw.entries:
            if key.text in _TOP:
                continue
            hint = valid_names(key.text, _TOP, "keys of a tree file")
            holds = isinstance(value, Entries | Items)
            self.problems.error("unknown-key", key.place, f"a tree file has no {key.text!r}", hint)
            if holds:
                return True
        return False

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

    def main(self, document: Document, entry: tuple[Scalar, Raw] | None) -> None:
        trees = document.trees
        known = {**trees, **self.outside}
        first = document.main = next(iter(known), "")
        document.main_named = entry is not None
        if entry is None:
            if len(trees or known) > 1:
                message = "the file does not say which tree to run"
                with self.problems.keeping():
                    self.problems.error(
                        "no-main", known[first].place, message, f"write `main: {first}`"
                    )
            return
        raw = entry[1]
        name = raw.text if isinstance(raw, Scalar) else ""
        if name not in known:
            hint = valid_names(name, known, "trees")
            with self.problems.keeping():
                self.problems.error("unknown-tree", raw.place, f"no tree is called {name!r}", hint)
            document.missing_main = name
        else:
            document.main = name

    def world(self, document: Document, entry: tuple[Scalar, Raw] | None) -> None:
        if entry is None:
            return
        raw = entry[1]
        if isinstance(raw, Scalar) and isinstance(raw.value, str):
            document.world, document.world_place = raw.value, raw.place
        else:
            self.problems.error("wrong-value", raw.place, "`world` is the name of a world")

    def goal(self, document: Document, entry: tuple[Scalar, Raw] | None) -> None:
        if entry is not None:
            document.goal = self.written_out(entry[1], "the goal")
            document.goal_place = entry[1].place

    def values(self, document: Document, entry: tuple[Scalar, Raw] | None) -> None:
        if entry is None:
            return
        for key, raw in mapping(entry[1], "values", "key: value", self.problems):
            if not is_key(key, self.problems):
                continue
            found = self.written_out(raw, "one of `values`")
            if found is not None:
                document.values[key.text] = found
                document.value_places[key.text] = raw.place

    def written_out(self, raw: Raw, what: str) -> Literal | None:
        """A value without wires; None if a problem was reported."""
        found = port_value(raw, "", self.problems)
        if found is None or isinstance(found, Literal):
            return found
        hint = "write the value; in a text, $$ is a dollar"
        message = f"{what} is written out; a wire has no place here"
        self.problems.error("wire-inside", raw.place, message, hint)
        return None
