"""`key=value` from a command line, read as the same words in a tree file would be."""

from __future__ import annotations

from typing import Any

from momantu_bt.tree.yaml_source import YamlSyntaxError, compose, plain_value
from momantu_bt.tree.yaml_values import KEY


def setting(text: str) -> tuple[str, Any]:
    """A key and its value, raw as in a file: `height=66 mm` gives `("height", "66 mm")`.

    Raises:
        ValueError: there is no `=`, the key is no key, or the value is not YAML.
    """
    key, equals, value = text.partition("=")
    key = key.strip()
    if not equals:
        raise ValueError("expected key=value, such as from=table_b")
    if not KEY.fullmatch(key):
        raise ValueError(f"{key!r} is no key; a key is a word such as tag_id")
    try:
        return key, plain_value(compose(value.strip() or '""', "--set"))
    except YamlSyntaxError as error:
        raise ValueError(error.problem.message) from None
