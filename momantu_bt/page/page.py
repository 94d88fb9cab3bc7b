"""Write one HTML file of a run: markup, style, scripts and data."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from momantu_bt.formats.files import write_whole
from momantu_bt.page.data import page_data
from momantu_bt.record.recording import Recording

SCRIPTS = (
    "dom",
    "tip",
    "record",
    "journal",
    "playhead",
    "head",
    "controls",
    "timeline",
    "tree",
    "tree_keys",
    "floor",
    "camera",
    "board",
    "failures",
    "source",
    "start",
)
"""The page's scripts, each after those that it needs; they are joined into one."""
_FIELD = re.compile(r"@(\w+)@")
_UNSAFE = str.maketrans({"<": "\\u003c", ">": "\\u003e", "&": "\\u0026"})
"""Characters that could end a script element or begin a comment inside a text."""


def write_page(recording: Recording, path: Path) -> None:
    """Write the page of a run.

    Raises:
        OutputError: the file cannot be written.
    """
    write_whole(path, page_text(recording))


def page_text(recording: Recording) -> str:
    """The page, as text. It is the same text for the same record."""
    data = page_data(recording)
    style = _asset("page.css")
    script = _script()
    fields = {
        "policy": _policy(style, script),
        "title": _as_title(data["about"]["title"]),
        "style": style,
        "record": as_json(data),
        "script": script,
    }
    return _FIELD.sub(lambda match: fields[match[1]], _asset("page.html"))


def as_json(data: Mapping[str, Any]) -> str:
    """Compact JSON in ASCII that can stand in a script element, whatever its texts hold."""
    return json.dumps(data, separators=(",", ":"), allow_nan=False).translate(_UNSAFE)


def _as_title(text: str) -> str:
    return html.escape(text).encode("ascii", "xmlcharrefreplace").decode("ascii")


def _asset(name: str) -> str:
    return files("momantu_bt.page").joinpath("assets", name).read_text(encoding="utf-8")


def _script() -> str:
    """All scripts in one function, so that nothing is global."""
    parts = (_asset(f"{name}.js") for name in SCRIPTS)
    return '"use strict";\n(() => {\n' + "\n".join(parts) + "})();\n"


def _policy(style: str, script: str) -> str:
    """The content policy: show the page's own pictures, run its script, use no network."""
    return (
        f"default-src 'none'; img-src data:; style-src {_digest(style)}; "
        f"script-src {_digest(script)}"
    )


def _digest(text: str) -> str:
    digest = base64.b64encode(hashlib.sha256(text.encode("utf-8")).digest())
    return f"'sha256-{digest.decode('ascii')}'"
