"""An XML tree file as a Document: the header, includes, values, models and trees."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from momantu_bt.formats.problems import errors
from momantu_bt.formats.xml.elements import Element, Parsed
from momantu_bt.formats.xml.reader import XmlSyntaxError
from momantu_bt.tree.files.resolve import resolve
from momantu_bt.tree.files.syntax import OURS, parse
from momantu_bt.tree.files.xml.board import read_values
from momantu_bt.tree.files.xml.header import (
    check_header,
    is_root,
    main_tree,
    report_unknown_attribute,
)
from momantu_bt.tree.files.xml.models import read_models
from momantu_bt.tree.files.xml.parts import give_models, keep_parts
from momantu_bt.tree.files.xml.tags import settle_tags
from momantu_bt.tree.files.xml.trees import TreesReader
from momantu_bt.tree.files.xml.values import flow_value
from momantu_bt.tree.model import Document, Include, Literal, Tree
from momantu_bt.tree.problems import Problems, TooManyProblems, TreeError
from momantu_bt.tree.registry import Registry


def read(text: str, file: str, registry: Registry | None = None) -> tuple[Document, Problems]:
    """Read one file, without the files that it includes.

    file: the file name in places. registry: its skills' port types tell texts from numbers;
    without a registry nothing is known of skills.

    Raises:
        TreeError: the text is not XML, has no trees, or has too many problems. Nothing else is
            reported then.
    """
    problems = Problems()
    source = XmlSource.of(text, file, registry or Registry(), problems)
    try:
        document = source.document({})
    except TooManyProblems:
        document = None
    if document is None or not (document.trees or document.includes):
        raise TreeError(errors(problems.sorted()), {file: text})
    resolve(document)
    return document, problems


@dataclass(slots=True)
class XmlSource:
    """A file in XML. Its trees are read once the trees of its includes are known."""

    text: str
    file: str
    parsed: Parsed
    registry: Registry
    problems: Problems

    @classmethod
    def of(cls, text: str, file: str, registry: Registry, problems: Problems) -> XmlSource:
        """Parse a text; TreeError when it is not XML."""
        try:
            return cls(text, file, parse(text, file), registry, problems)
        except XmlSyntaxError as error:
            raise TreeError([error.problem], {file: text}) from None

    def includes(self) -> tuple[Include, ...]:
        """The files it includes. Includes that are written wrongly are reported."""
        found = []
        for element in self.parsed.root.children:
            if element.name == "include" and not element.space:
                found.append(self._include(element))
        return tuple(found)

    def _include(self, element: Element) -> Include:
        path, package = element.get("path"), element.get("ros_pkg")
        kept = [each for each in element.attributes if each not in (path, package)]
        with self.problems.keeping():
            for each in kept:
                report_unknown_attribute(each, ["path", "ros_pkg"], "<include>", self.problems)
            if package is not None:
                message = "files of ROS packages cannot be found here"
                hint = "copy the file beside this one and write path alone"
                self.problems.error("include", package.name_place, message, hint)
            elif path is None:
                message, hint = "<include> without a path", 'write <include path="other.xml"/>'
                self.problems.error("include", element.place, message, hint)
        return Include(
            "" if path is None else path.value,
            element.place if path is None else path.place,
            None if package is None else package.value,
            tuple((each.said, each.value) for each in kept),
            element.comments,
        )

    def document(self, outside: Mapping[str, Tree], *, included: bool = False) -> Document | None:
        """The file's own trees. outside: trees of the files that it includes.

        included: whether another file includes this one; then it need not name a tree to run.
        Returns None, with the problem reported, if there is nothing to read.
        """
        root = self.parsed.root
        if not is_root(root, self.problems):
            return None
        check_header(root, self.problems)
        models = read_models(root, self.problems)
        trees = TreesReader(models, self.registry, self.problems).trees(root, outside)
        if not trees and not self.includes() and not outside:
            message, hint = "the file has no tree", 'write <BehaviorTree ID="Name">'
            with self.problems.keeping():
                self.problems.error("no-trees", root.place, message, hint)
        main = "" if included else main_tree(root, trees, outside, self.problems)
        document = Document(self.file, main, trees)
        named = root.get("main_tree_to_execute")
        document.main_named = named is not None
        if named is not None and named.value != main:
            document.missing_main = named.value
        document.includes = self.includes()
        give_models(document, models)
        world = root.get("world", OURS)
        if world is not None:
            document.world, document.world_place = world.value, world.place
        self._goal(document, root)
        read_values(document, root, self.problems)
        settle_tags(document)
        keep_parts(document, self.parsed)
        document.source = {self.file: self.text}
        return document

    def _goal(self, document: Document, root: Element) -> None:
        """What the referee is to demand: YAML in `momantu:goal`."""
        goal = root.get("goal", OURS)
        if goal is None:
            return
        found = flow_value(goal.value, "", goal.place, self.problems)
        if isinstance(found, Literal):
            document.goal, document.goal_place = found, goal.place
        elif found is not None:
            message = "the goal is written out; a wire has no place here"
            self.problems.error("wire-inside", goal.place, message)
