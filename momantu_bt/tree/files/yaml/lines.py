"""Lines of YAML: comments above and beside them, long values spread over several."""

from __future__ import annotations

from collections.abc import Sequence

from momantu_bt.formats.text import Beside
from momantu_bt.formats.yaml.writer import scalar
from momantu_bt.tree.files.scalars import literal
from momantu_bt.tree.model import Literal, PortValue

WIDTH = 100
"""The most columns of a line whose ports can move to lines of their own."""

STEP = "  "
"""One level of indentation."""


def above(comments: Sequence[str], pad: str, *, every: bool = False) -> list[str]:
    """Comments on lines of their own. every: include those that stand beside something."""
    own = [c for c in comments if every or not isinstance(c, Beside)]
    # if several stand beside one line, one of them stays there
    own += [] if every else [c for c in comments if isinstance(c, Beside)][1:]
    return [f"{pad}{line}" for comment in own for line in signed_lines(comment)]


def beside(comments: Sequence[str]) -> str:
    """The comment at the end of a line, with the space before it; empty if there is none."""
    first = next((c for c in comments if isinstance(c, Beside)), None)
    return "" if first is None else f"  {signed(first.replace(chr(10), ' '))}"


def spread(value: PortValue, lead: str, text: str, comments: Sequence[str]) -> list[str]:
    """A value after `key:`. A long list or mapping has one entry a line. text: it on one line."""
    line, pad = f"{lead} {text}", " " * (len(lead) - len(lead.lstrip()) + len(STEP))
    nested = value.value if isinstance(value, Literal) and is_nested(value) else None
    if len(line) <= WIDTH or not nested:
        return [line + beside(comments)]
    if isinstance(nested, dict):
        entries = [f"{scalar(k, typed=False)}: {literal(v)}" for k, v in nested.items()]
    else:
        entries = [f"- {literal(item)}" for item in nested]
    return [lead + beside(comments), *(pad + entry for entry in entries)]


def signed_lines(text: str) -> list[str]:
    """The lines of a comment. All but the first begin with `#|`, so that they stay one comment."""
    first, *others = text.split("\n")
    return [signed(first), *(f"#|{line}" for line in others)]


def signed(text: str) -> str:
    """A comment's text after its `#`."""
    return f"#{text}" if not text or text.startswith("#") else f"# {text}"


def is_nested(value: PortValue) -> bool:
    """Whether a value is a list or a mapping."""
    return isinstance(value, Literal) and isinstance(value.value, list | tuple | dict)
