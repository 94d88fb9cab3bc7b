"""The model of a tree file, the same for YAML and XML.

Two documents are equal if they mean the same; places, comments and source texts are not compared.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, TypeAlias

from momantu_bt.formats.places import Place
from momantu_bt.skill import MISSING, Port
from momantu_bt.values.types import parse_type


class Scope(Enum):
    """The board that a reference looks at."""

    LOCAL = "local"
    ROOT = "root"
    """`$@key`, `{@key}`"""


@dataclass(frozen=True, slots=True)
class Literal:
    """A value in the file. value: text, bool, int, float, list or mapping.

    A quantity stays a text ("66 mm"); it is converted later to the port's type and unit.
    """

    value: Any


@dataclass(frozen=True, slots=True)
class Reference:
    """A reference to a blackboard key: `$key.field`, `$@key`. fields: the part of the value."""

    key: str
    fields: tuple[str, ...] = ()
    scope: Scope = Scope.LOCAL


@dataclass(frozen=True, slots=True)
class Template:
    """Text with keys inside: parts in order, `"at ${n} of ${total}"`."""

    parts: tuple[str | Reference, ...]


PortValue: TypeAlias = Literal | Reference | Template


FIRST_INPUT = ""
"""Name of a port whose value is written without one (`dock: bay_a`); the checker fills it in."""

BROKEN = ""
"""Type of a node that could not be read; the problem was reported already."""


@dataclass(slots=True)
class Handler:
    """One entry of `catch:`. codes: codes such as `TOO_FAR` or `grip.TOO_FAR`; `("any",)`: others.

    node: the node to run; None for `again`.
    """

    codes: tuple[str, ...]
    node: Node | None
    place: Place = field(compare=False)
    comments: tuple[str, ...] = field(default=(), compare=False)


@dataclass(slots=True)
class Node:
    """One node.

    `type` is the canonical name: that of BehaviorTree.CPP if it has the node ("Sequence",
    "RetryUntilSuccessful", "SubTree"), otherwise Momantu's ("Recover"), or a skill's ("navigate").
    A decorator that the file writes as a modifier is a node of its own around the other node, with
    `written_as_modifier` set. conditions: by modifier name ("skip_if", "while", "on_success", …),
    a script in canonical form (`&& || !`).

    For a SubTree, `ports` are its inputs and outputs, and `target` is the name of the tree.

    port_places: of the ports' values; port_name_places: of their names. condition_places: of the
    conditions' scripts, and of `name`, `note` and `disabled`; of `ID`, which names a target.

    What only XML says, and BehaviorTree.CPP's programs do not need to run the tree:
    attributes: texts of attributes, by name, that are kept as they are: those without a meaning
    (`_collapsed`), and those whose text says something in another way than our tools would write
    it; then `ports`, `conditions`, `name` and `note` have the meaning. tag: "Action", "Condition",
    "Control" or "Decorator" if an explicit tag with an ID is written, "" if not, None for the
    document's usual way; for a BROKEN node, the tag as written. text, tail: words inside its
    element and after it. comments_apart: YAML has no place for its comments, so they are values of
    its key `xml:` there; trees and documents have this too.
    comments: those written before the node or at the end of its line (`Beside`), without their
    signs; port_comments: the same of its ports; end_comments: those after all that is inside it.
    """

    type: str
    place: Place = field(compare=False)
    ports: dict[str, PortValue] = field(default_factory=dict)
    children: list[Node] = field(default_factory=list)
    handlers: list[Handler] = field(default_factory=list)
    conditions: dict[str, str] = field(default_factory=dict)
    name: str | None = None
    note: str | None = None
    disabled: bool = False
    target: str | None = None
    written_as_modifier: bool = field(default=False, compare=False)
    port_places: dict[str, Place] = field(default_factory=dict, compare=False)
    port_name_places: dict[str, Place] = field(default_factory=dict, compare=False)
    condition_places: dict[str, Place] = field(default_factory=dict, compare=False)
    comments: tuple[str, ...] = field(default=(), compare=False)
    port_comments: dict[str, tuple[str, ...]] = field(default_factory=dict, compare=False)
    end_comments: tuple[str, ...] = field(default=(), compare=False)
    attributes: dict[str, str] = field(default_factory=dict, compare=False)
    tag: str | None = field(default=None, compare=False)
    text: str = field(default="", compare=False)
    tail: str = field(default="", compare=False)
    comments_apart: bool = field(default=False, compare=False)

    def walk(self) -> Iterator[Node]:
        """The node and all nodes below it, in file order, without recursion."""
        stack = [self]
        while stack:
            node = stack.pop()
            yield node
            below = [
                *node.children,
                *(h.node for h in node.handlers if h.node is not None),
            ]
            stack.extend(reversed(below))


@dataclass(frozen=True, slots=True)
class PortDeclaration:
    """An input or output of a subtree.

    direction: "in", "out" or "inout" (a key that the subtree may read and write). type_name:
    "text", "list of pose2d", … or "any". default: a value, or the outer key to use if a node does
    not give the port. doc: of a port of a model, with its line breaks.

    written_type: the name of the type in the file, if it is C++'s (`std::string`). tag: the element
    in XML, if it is not the direction's usual one (`bidirectional_port`, which is an inout).
    attributes: further attributes in XML.
    """

    name: str
    direction: str
    type_name: str
    place: Place = field(compare=False)
    default: Literal | Reference | None = None
    doc: str = ""
    comments: tuple[str, ...] = field(default=(), compare=False)
    written_type: str = field(default="", compare=False)
    tag: str = field(default="", compare=False)
    attributes: tuple[tuple[str, str], ...] = field(default=(), compare=False)

    def port(self) -> Port:
        """The port as a skill would declare it; KeyError when no type has its name."""
        default: Any = MISSING if self.default is None else None
        if isinstance(self.default, Literal):
            default = self.default.value
        return Port(self.name, self.direction, parse_type(self.type_name), self.doc, default)


@dataclass(slots=True)
class Tree:
    """One named tree of a document.

    open: it declares no ports and accepts any, as in BehaviorTree.CPP.

    attributes: further attributes of its element in XML. unnamed: it has no ID there; then `name`
    is the one that BehaviorTree.CPP gives it. further: nodes beside the root, which are an error.
    metadata: of its model, see `NodeModel`. end_comments: those after its root node.
    misread: what it declares could not all be read; errors that only follow from it are not told.
    """

    name: str
    root: Node
    place: Place = field(compare=False)
    ports: dict[str, PortDeclaration] = field(default_factory=dict)
    doc: str = ""
    open: bool = False
    comments: tuple[str, ...] = field(default=(), compare=False)
    end_comments: tuple[str, ...] = field(default=(), compare=False)
    attributes: dict[str, str] = field(default_factory=dict, compare=False)
    unnamed: bool = field(default=False, compare=False)
    further: list[Node] = field(default_factory=list, compare=False)
    comments_apart: bool = field(default=False, compare=False)
    metadata: tuple[MetadataFields, ...] = field(default=(), compare=False)
    misread: bool = field(default=False, compare=False)

    def nodes(self) -> Iterator[Node]:
        """All its nodes in file order, without recursion, with those that are an error."""
        for root in (self.root, *self.further):
            yield from root.walk()


@dataclass(frozen=True, slots=True)
class Include:
    """A file whose trees the document includes. path: as written.

    package: the ROS package that has the file (`ros_pkg`), if not the including file's folder.
    attributes: further attributes in XML. comments: those before it in XML.
    """

    path: str
    place: Place = field(compare=False)
    package: str | None = None
    attributes: tuple[tuple[str, str], ...] = field(default=(), compare=False)
    comments: tuple[str, ...] = field(default=(), compare=False)


@dataclass(frozen=True, slots=True)
class MetadataFields:
    """What `<MetadataFields>` in a model says.

    entries: of each `<Metadata …/>`, its attributes as pairs of name and value. at: the number of
    ports before it. comments: each with the number of the entry that it stands before; -1: before
    the element.
    """

    entries: tuple[tuple[tuple[str, str], ...], ...]
    at: int = 0
    comments: tuple[tuple[int, str], ...] = field(default=(), compare=False)


@dataclass(frozen=True, slots=True)
class NodeModel:
    """A file's model of a kind of node: what `<TreeNodesModel>` says of it.

    kind: "Action", "Condition", "Control", "Decorator" or "SubTree". ports: with names of types as
    written, and defaults as texts. editable: as an editor wrote it; None if it did not. metadata:
    its `<MetadataFields>`. attributes: further ones.
    """

    name: str
    kind: str
    ports: tuple[PortDeclaration, ...] = ()
    editable: bool | None = None
    metadata: tuple[MetadataFields, ...] = ()
    place: Place | None = field(default=None, compare=False)
    attributes: tuple[tuple[str, str], ...] = field(default=(), compare=False)
    comments: tuple[str, ...] = field(default=(), compare=False)
    end_comments: tuple[str, ...] = field(default=(), compare=False)

    @property
    def facts(self) -> dict[str, str]:
        """All metadata by name."""
        return {
            name: text for each in self.metadata for entry in each.entries for name, text in entry
        }


@dataclass(slots=True)
class Document:
    """A tree file with everything it includes.

    trees: the file's own and those of the files it includes; `Tree.place.file` tells them apart.
    goal: what the referee is to demand, as written: a text, a mapping, or a list of them.
    values: initial keys of the root's board. models: as the file has them; without those of its
    trees that `Tree.ports` and `Tree.metadata` say whole. further_models: those of the files that
    it includes. source: the text, by file, for error
    displays.
    header_comments: those above and beside the first keys of the file; value_comments: those of
    `values`, by key; comments: those after the last tree; after_comments: those after the root's
    end in XML; models_comments, models_end_comments: before `models` and at their end.

    What only XML says: attributes: further attributes of the root. main_named: whether the file
    names its main tree; missing_main: the name, if the file has no such tree. explicit: whether
    tags are usually explicit (`<Action ID="Go"/>`). order: the parts of the file, "include",
    "values", "tree" or "models" for each, if the order is not the usual one. models_attributes: of
    `<TreeNodesModel>`.
    """

    file: str = field(compare=False)
    main: str
    trees: dict[str, Tree]
    world: str | None = None
    values: dict[str, Literal] = field(default_factory=dict)
    goal: Literal | None = None
    includes: tuple[Include, ...] = ()
    models: tuple[NodeModel, ...] = ()
    further_models: tuple[NodeModel, ...] = field(default=(), compare=False)
    value_places: dict[str, Place] = field(default_factory=dict, compare=False)
    world_place: Place | None = field(default=None, compare=False)
    goal_place: Place | None = field(default=None, compare=False)
    source: dict[str, str] = field(default_factory=dict, compare=False)
    header_comments: tuple[str, ...] = field(default=(), compare=False)
    value_comments: dict[str, tuple[str, ...]] = field(default_factory=dict, compare=False)
    comments: tuple[str, ...] = field(default=(), compare=False)
    after_comments: tuple[str, ...] = field(default=(), compare=False)
    models_comments: tuple[str, ...] = field(default=(), compare=False)
    models_end_comments: tuple[str, ...] = field(default=(), compare=False)
    attributes: dict[str, str] = field(default_factory=dict, compare=False)
    models_attributes: dict[str, str] = field(default_factory=dict, compare=False)
    main_named: bool = field(default=True, compare=False)
    missing_main: str = field(default="", compare=False)
    explicit: bool = field(default=False, compare=False)
    comments_apart: bool = field(default=False, compare=False)
    order: tuple[str, ...] = field(default=(), compare=False)
