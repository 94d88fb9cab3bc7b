"""What only XML says, in YAML: `attributes:`, `xml:`, and keys that begin with `_`."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from momantu_bt.formats.names import valid_names
from momantu_bt.formats.text import NOT_TEXT, Beside
from momantu_bt.formats.xml.elements import Attribute, Element
from momantu_bt.formats.yaml.values import Entries, Items, Raw, Scalar
from momantu_bt.formats.yaml.writer import scalar
from momantu_bt.tree.catalogue import EXPLICIT, XML_CONDITIONS
from momantu_bt.tree.files.port_values import drop_duplicates, mapping, words
from momantu_bt.tree.files.xml.attributes import is_name, xml_name
from momantu_bt.tree.files.xml.ports import DESCRIPTION
from momantu_bt.tree.files.xml.tags import Tags
from momantu_bt.tree.files.yaml.lines import STEP, WIDTH
from momantu_bt.tree.files.yaml.reading import Reading
from momantu_bt.tree.model import BROKEN, Node
from momantu_bt.tree.problems import Problems

ATTRIBUTES, XML = "attributes", "xml"
TAG, TEXT, TAIL = "tag", "text", "text_after"
BEFORE, BESIDE, INSIDE = "comments", "comments_beside", "comments_inside"
_KEYS = (TAG, TEXT, TAIL, BEFORE, BESIDE, INSIDE)
COMPACT = "type"
"""`tag: type`: the tag is the node's type, in a file whose tags are usually explicit."""


def is_kept(key: Scalar) -> bool:
    """Whether a key beside a node holds what only XML says."""
    return key.text in (ATTRIBUTES, XML) or key.text.startswith("_")


def read_kept(node: Node, entries: Sequence[tuple[Scalar, Raw]], reading: Reading) -> None:
    """Read all keys beside a node that hold what only XML says."""
    attributes = attributes_of(entries, reading.problems)
    if attributes and node.type != BROKEN:
        element = Element(node.type, "", node.type, node.place, attributes)
        reading.attributes.ports(node, element)
    node.attributes |= {each.said: each.value for each in attributes}
    for key, value in entries:
        if key.text == XML:
            _read_xml(node, value, reading.problems)


def attributes_of(entries: Iterable[tuple[Scalar, Raw]], problems: Problems) -> list[Attribute]:
    """The attributes under `attributes:`, and those that are keys of their own."""
    found: list[Attribute] = []
    for key, value in entries:
        if key.text == ATTRIBUTES:
            listed = mapping(value, ATTRIBUTES, "name: text", problems)
        else:
            listed = [(key, value)] if key.text.startswith("_") else []
        found += [each for pair in listed if (each := _attribute(*pair, problems)) is not None]
    return found


def _attribute(key: Scalar, value: Raw, problems: Problems) -> Attribute | None:
    prefix, _, name = key.text.rpartition(":")
    if not is_name(name) or (prefix and not is_name(prefix)):
        message, hint = f"{key.text!r} cannot be the name of an attribute", "such as `_uid: 5`"
        problems.error("bad-name", key.place, message, hint)
        return None
    if not isinstance(value, Scalar):
        message = f"the attribute {key.text!r} is a text"
        problems.error("wrong-value", value.place, message, "put it in quotes")
        return None
    text = plain_text(value, problems, f"the attribute {key.text!r}")
    return Attribute(name, prefix, text, key.place, value.place, key.text)


def plain_text(value: Scalar, problems: Problems, what: str) -> str:
    """The text of a scalar as it is written, `5` and `true` too; empty for no value."""
    return words(value, problems, what) if value.value is not None or value.quoted else ""


def _read_xml(node: Node, value: Raw, problems: Problems) -> None:
    having = fields(value, _KEYS, XML, problems)
    if TAG in having:
        raw = having[TAG]
        tag = raw.text if isinstance(raw, Scalar) else ""
        if tag not in (*EXPLICIT, COMPACT):
            hint = valid_names(tag, (*EXPLICIT, COMPACT), "tags")
            problems.error("wrong-value", having[TAG].place, f"no tag is {tag!r}", hint)
        elif node.type != BROKEN:
            node.tag = "" if tag == COMPACT else tag
    texts = {TEXT: "text", TAIL: "tail"}
    for key, name in texts.items():
        inside = having.get(key)
        if isinstance(inside, Scalar):
            setattr(node, name, plain_text(inside, problems, f"`{key}`"))
    node.comments_apart = any(key in having for key in (BEFORE, BESIDE, INSIDE))
    node.comments += comments_of(having)
    node.end_comments += tuple(text_list(having.get(INSIDE)))


def comments_of(having: Mapping[str, Raw]) -> tuple[str, ...]:
    """The comments before something, and those beside it."""
    beside = (Beside(text) for text in text_list(having.get(BESIDE)))
    return (*text_list(having.get(BEFORE)), *beside)


def text_list(raw: Raw | None) -> list[str]:
    """A list of texts."""
    items = raw.items if isinstance(raw, Items) else []
    return [item.text for item in items if isinstance(item, Scalar)]


def fields(raw: Raw, known: Collection[str], name: str, problems: Problems) -> dict[str, Raw]:
    """The entries of a mapping that may only have known keys."""
    if not isinstance(raw, Entries):
        problems.error("wrong-value", raw.place, f"`{name}` is a mapping", "write {key: value}")
        return {}
    drop_duplicates(raw, problems)
    for key, _ in raw.entries:
        if key.text not in known:
            hint = valid_names(key.text, list(known), "keys")
            problems.error("unknown-key", key.place, f"`{name}` has no {key.text!r}", hint)
    return {key.text: value for key, value in raw.entries if key.text in known}


# writing


def attribute_lines(attributes: Mapping[str, str], pad: str) -> list[str]:
    """Lines for attributes: those that begin with `_` as keys of their own."""
    own = {name: text for name, text in attributes.items() if _is_key(name)}
    lines = [f"{pad}{name}: {scalar(text, typed=False)}" for name, text in own.items()]
    rest = {name: text for name, text in attributes.items() if name not in own}
    return lines + mapping_lines(ATTRIBUTES, rest, pad)


def mapping_lines(key: str, texts: Mapping[str, str], pad: str) -> list[str]:
    """A mapping of texts under a key, on one line if there is room."""
    if not texts:
        return []
    line = f"{pad}{key}: {{{', '.join(flow_pairs(texts))}}}"
    if len(line) <= WIDTH:
        return [line]
    pairs = (f"{scalar(n, typed=False)}: {scalar(t, typed=False)}" for n, t in texts.items())
    return [f"{pad}{key}:", *(pad + STEP + pair for pair in pairs)]


def flow_pairs(texts: Mapping[str, str]) -> list[str]:
    """Texts by name, as they stand inside braces."""
    return [
        f"{scalar(name, flow=True, typed=False)}: {scalar(text, flow=True, typed=False)}"
        for name, text in texts.items()
    ]


def _is_key(name: str) -> bool:
    return name.startswith("_") and is_name(name)


def comment_pairs(comments: Sequence[str], inside: Sequence[str] = ()) -> list[tuple[str, str]]:
    """Comments as keys and lists of texts, for those that have no place of their own in YAML."""
    above = [text for text in comments if not isinstance(text, Beside)]
    beside = [text for text in comments if isinstance(text, Beside)]
    lists = ((BEFORE, above), (BESIDE, beside), (INSIDE, inside))
    return [(key, f"[{_texts(texts)}]") for key, texts in lists if texts]


def _texts(texts: Sequence[str]) -> str:
    return ", ".join(scalar(NOT_TEXT.sub("\ufffd", text), flow=True, typed=False) for text in texts)


def xml_lines(pairs: Sequence[tuple[str, str]], pad: str, key: str = XML) -> list[str]:
    """The key `xml:` with its entries, whose values are YAML already."""
    if not pairs:
        return []
    line = f"{pad}{key}: {{{', '.join(f'{name}: {text}' for name, text in pairs)}}}"
    if len(line) <= WIDTH:
        return [line]
    return [f"{pad}{key}:", *(f"{pad}{STEP}{name}: {text}" for name, text in pairs)]


def node_xml(node: Node, tag: str | None) -> list[tuple[str, str]]:
    """The entries of a node's `xml:`. tag: its tag, if it has to be named."""
    pairs = [] if tag is None else [(TAG, tag or COMPACT)]
    for key, text in ((TEXT, node.text), (TAIL, node.tail)):
        pairs += [(key, scalar(text, flow=True, typed=False))] if text else []
    remarks = comment_pairs(node.comments, node.end_comments) if node.comments_apart else []
    return pairs + remarks


@dataclass(slots=True)
class Shown:
    """Nodes without what is written under `attributes:` and `xml:`.

    By the identity of the shown node, xml: the entries of its key `xml:`; ids: the ID of a broken
    node with an explicit tag.
    """

    tags: Tags
    xml: dict[int, list[tuple[str, str]]] = field(default_factory=dict)
    ids: dict[int, str] = field(default_factory=dict)
    _kept: list[Node] = field(default_factory=list)

    def of(self, root: Node) -> Node:
        """A copy of a node and of all below it, made from below and not by recursion."""
        copies: dict[int, Node] = {}
        for node in reversed(list(root.walk())):
            copy = copies[id(node)] = self._copy(node)
            copy.children = [copies[id(child)] for child in node.children]
            copy.handlers = [
                each if each.node is None else replace(each, node=copies[id(each.node)])
                for each in node.handlers
            ]
        self._kept.append(copies[id(root)])
        return copies[id(root)]

    def says_xml(self, node: Node) -> bool:
        """Whether a shown node has keys for what only XML says."""
        return bool(self.xml.get(id(node)) or node.attributes)

    def _copy(self, node: Node) -> Node:
        copy = replace(node)
        if node.attributes:
            copy.ports = {
                name: value
                for name, value in node.ports.items()
                if xml_name(node, name) not in node.attributes
            }
            copy.conditions = {
                name: script
                for name, script in node.conditions.items()
                if XML_CONDITIONS[name] not in node.attributes
            }
            copy.name = None if "name" in node.attributes else node.name
            copy.note = None if DESCRIPTION in node.attributes else node.note
        tag = node.tag
        if node.type == BROKEN:
            explicit = node.tag in EXPLICIT and node.attributes.get("ID")
            tag = node.tag if explicit else "" if self.tags.explicit else None
            copy.attributes = {
                n: t for n, t in node.attributes.items() if n != "ID" or not explicit
            }
        elif tag is None and self.tags.is_taken(node.type):
            tag = self.tags.usual(node)
        self.ids[id(copy)] = node.attributes.get("ID", "")
        self.xml[id(copy)] = node_xml(node, tag)
        if node.comments_apart:
            copy.comments, copy.end_comments = (), ()
        return copy
