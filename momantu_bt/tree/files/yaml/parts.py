"""What only XML says of a file and of a tree, in YAML: `xml:` at the top, `tree:` in a tree."""

from __future__ import annotations

from momantu_bt.formats.yaml.values import Entries, Raw, Scalar
from momantu_bt.formats.yaml.writer import scalar
from momantu_bt.tree.files.port_values import drop_duplicates
from momantu_bt.tree.files.xml.parts import PARTS, usual_order
from momantu_bt.tree.files.yaml.kept import (
    BEFORE,
    BESIDE,
    INSIDE,
    XML,
    attributes_of,
    comment_pairs,
    comments_of,
    fields,
    flow_pairs,
    text_list,
    xml_lines,
)
from momantu_bt.tree.model import Document, Include, Tree
from momantu_bt.tree.problems import Problems

_AFTER = "comments_after"
_TOP = ("tags", "attributes", "order", "models", BEFORE, INSIDE, _AFTER)
_MODELS = ("attributes", BEFORE, BESIDE, INSIDE)
_TREE = ("unnamed", BEFORE, BESIDE, INSIDE)
EXPLICIT = "explicit"


def read_document_xml(document: Document, raw: Raw, problems: Problems) -> None:
    """Give a document what the key `xml:` at the top says."""
    having = fields(raw, _TOP, XML, problems)
    tags = having.get("tags")
    document.explicit = isinstance(tags, Scalar) and tags.text == EXPLICIT
    if tags is not None and not document.explicit:
        problems.error("wrong-value", tags.place, "`tags` is `explicit`", "or leave it out")
    document.attributes = _attributes(having, problems)
    document.order = tuple(text_list(having.get("order")))
    wrong = next((each for each in document.order if each not in PARTS.values()), None)
    if wrong is not None:
        hint = f"known: {', '.join(PARTS.values())}"
        problems.error("wrong-value", having["order"].place, f"no part is called {wrong!r}", hint)
        document.order = ()
    document.header_comments += tuple(text_list(having.get(BEFORE)))
    document.comments += tuple(text_list(having.get(INSIDE)))
    document.after_comments = tuple(text_list(having.get(_AFTER)))
    if "models" in having:
        inside = fields(having["models"], _MODELS, "models", problems)
        document.models_attributes = _attributes(inside, problems)
        document.models_comments += comments_of(inside)
        document.models_end_comments += tuple(text_list(inside.get(INSIDE)))


def read_tree_attributes(tree: Tree, raw: Raw, problems: Problems) -> None:
    """Give a tree what the key `tree:` says: attributes, and comments without another place."""
    if not isinstance(raw, Entries):
        hint = "such as `tree: {_favorite: true}`"
        problems.error("wrong-value", raw.place, "`tree` is a mapping of attributes", hint)
        return
    drop_duplicates(raw, problems)
    own = [(key, value) for key, value in raw.entries if key.text not in _TREE]
    every = [(key, value) for key, value in own if key.text == "attributes"]
    listed = Entries([pair for pair in own if pair not in every], raw.place)
    if listed.entries:
        every.append((Scalar("attributes", "attributes", False, raw.place), listed))
    tree.attributes = {each.said: each.value for each in attributes_of(every, problems)}
    having = {key.text: value for key, value in raw.entries}
    unnamed = having.get("unnamed")
    tree.unnamed = isinstance(unnamed, Scalar) and unnamed.value is True
    tree.comments += comments_of(having)
    tree.end_comments += tuple(text_list(having.get(INSIDE)))


def read_include(raw: Raw, problems: Problems) -> Include | None:
    """A file's name, or a mapping with the ROS package that has it."""
    if isinstance(raw, Scalar) and raw.text and isinstance(raw.value, str):
        return Include(raw.text, raw.place)
    if not isinstance(raw, Entries):
        hint = "write `include: [other.yaml]`"
        problems.error("include", raw.place, "a file's name is expected", hint)
        return None
    having = fields(raw, ("path", "package", "attributes", BEFORE), "include", problems)
    path, package = having.get("path"), having.get("package")
    if package is not None:
        message = "files of ROS packages cannot be found here"
        hint = "copy the file beside this one and write its path alone"
        with problems.keeping():
            problems.error("include", package.place, message, hint)
    elif not isinstance(path, Scalar) or not path.text:
        with problems.keeping():
            problems.error("include", raw.place, "an include without a path", "write `path:`")
    place = raw.place if path is None else path.place
    return Include(
        path.text if isinstance(path, Scalar) else "",
        place,
        package.text if isinstance(package, Scalar) else None,
        tuple(_attributes(having, problems).items()),
        tuple(text_list(having.get(BEFORE))),
    )


def _attributes(having: dict[str, Raw], problems: Problems) -> dict[str, str]:
    raw = having.get("attributes")
    if raw is None:
        return {}
    key = Scalar("attributes", "attributes", False, raw.place)
    return {each.said: each.value for each in attributes_of([(key, raw)], problems)}


# writing


def document_xml(document: Document, *, comments: bool) -> list[str]:
    """The key `xml:` at the top. comments: whether it has the comments at the file's ends too."""
    pairs = [("tags", EXPLICIT)] if document.explicit else []
    if document.attributes:
        pairs.append(("attributes", f"{{{', '.join(flow_pairs(document.attributes))}}}"))
    if document.order:
        pairs.append(("order", f"[{', '.join(document.order)}]"))
    models = [*_models_attributes(document)]
    if comments:
        pairs += comment_pairs(document.header_comments, document.comments)
    if comments or not document.models:
        models += comment_pairs(document.models_comments)
    models += comment_pairs((), document.models_end_comments)
    if models:
        pairs.append(("models", f"{{{', '.join(f'{name}: {text}' for name, text in models)}}}"))
    after = comment_pairs(document.after_comments)
    pairs += [(_AFTER, text) for _, text in after]
    return xml_lines(pairs, "")


def _models_attributes(document: Document) -> list[tuple[str, str]]:
    found = flow_pairs(document.models_attributes)
    return [("attributes", f"{{{', '.join(found)}}}")] if found else []


def tree_lines(tree: Tree, *, comments: bool) -> list[str]:
    """The key `tree:` of a tree. comments: whether it has the tree's comments too."""
    pairs = [("unnamed", "true")] if tree.unnamed else []
    attributes = dict(tree.attributes)
    clash = {name: text for name, text in attributes.items() if name in (*_TREE, "attributes")}
    if clash:
        pairs.append(("attributes", f"{{{', '.join(flow_pairs(clash))}}}"))
    rest = {name: text for name, text in attributes.items() if name not in clash}
    pairs += [
        (scalar(name, flow=True, typed=False), scalar(text, flow=True, typed=False))
        for name, text in rest.items()
    ]
    if comments:
        pairs += comment_pairs(tree.comments, tree.end_comments)
    return xml_lines(pairs, "    ", "tree")


def include_text(include: Include) -> str:
    """One included file."""
    if include.package is None and not include.attributes and not include.comments and include.path:
        return scalar(include.path, flow=True)
    pairs = [] if include.package is None else [f"package: {scalar(include.package, flow=True)}"]
    pairs += [f"path: {scalar(include.path, flow=True)}"] if include.path else []
    if include.attributes:
        pairs.append(f"attributes: {{{', '.join(flow_pairs(dict(include.attributes)))}}}")
    pairs += [f"{name}: {text}" for name, text in comment_pairs(include.comments)]
    return f"{{{', '.join(pairs)}}}"


def settle_order(document: Document, *, has_models: bool) -> None:
    """Give a document that has `models: []` the part that XML has for it."""
    usual = usual_order(document)
    if has_models and not document.order and "models" not in usual:
        document.order = (*usual, "models")
