"""The limits of tree files in both spellings, and their words in messages."""

from __future__ import annotations

from types import MappingProxyType

from momantu_bt.formats.xml import reader as xml
from momantu_bt.formats.xml.elements import Parsed
from momantu_bt.formats.xml.errors import XmlRules
from momantu_bt.formats.yaml import reader as yaml
from momantu_bt.formats.yaml.comments import Comment
from momantu_bt.formats.yaml.errors import YamlRules
from momantu_bt.formats.yaml.values import Raw
from momantu_bt.tree.catalogue import XML_CONDITIONS

OURS = "urn:momantu-bt:1"
"""Namespace of everything that only this language has."""

WHAT = "tree file"
MAX_BYTES = 500_000

YAML_RULES = YamlRules(
    WHAT,
    most_bytes=MAX_BYTES,
    most_depth=100,
    most_values=10_000,
    beginning="begin with `momantu_bt: 1`",
    tag_hint='write `not`, or put the whole value in quotes: "!$key"',
    braces_hint="did you mean $key?",
    scripts=("script", "condition", "if", *XML_CONDITIONS),
)
XML_RULES = XmlRules(
    WHAT,
    most_bytes=MAX_BYTES,
    most_depth=200,
    most_nodes=10_000,
    beginning='begin with <root BTCPP_format="4">',
    prefixes=MappingProxyType({"momantu": OURS}),
)


def compose(text: str, file: str) -> Raw:
    """Read YAML.

    Raises:
        YamlSyntaxError: with one problem, in our words.
    """
    return yaml.compose(text, file, YAML_RULES)


def compose_with_comments(text: str, file: str) -> tuple[Raw, list[Comment]]:
    """Read YAML and its comments; raises as `compose`."""
    return yaml.compose_with_comments(text, file, YAML_RULES)


def parse(text: str, file: str) -> Parsed:
    """Read XML.

    Raises:
        XmlSyntaxError: with one problem, in our words.
    """
    return xml.parse(text, file, XML_RULES)
