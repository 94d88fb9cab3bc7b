"""Build the API reference from docstrings: `make docs` runs it. Needs no network.

It has one page for each public module and no other: what `PUBLIC` does not name is private.
docs/api.md says what public means.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

import pdoc
import pdoc.render

import momantu_bt

PUBLIC = (
    "momantu_bt",
    "momantu_bt.activity",
    "momantu_bt.claim",
    "momantu_bt.descriptions.quantities",
    "momantu_bt.descriptions.tunables",
    "momantu_bt.diagnosis",
    "momantu_bt.errors",
    "momantu_bt.failure",
    "momantu_bt.fault",
    "momantu_bt.fault_kind",
    "momantu_bt.goal",
    "momantu_bt.frames",
    "momantu_bt.geometry",
    "momantu_bt.labelled",
    "momantu_bt.lazy",
    "momantu_bt.marker",
    "momantu_bt.messages",
    "momantu_bt.nodes",
    "momantu_bt.nodes.behaviour",
    "momantu_bt.py_trees_bridge.view",
    "momantu_bt.record.codec",
    "momantu_bt.record.reader",
    "momantu_bt.robot",
    "momantu_bt.robot_parts",
    "momantu_bt.robot_simulation",
    "momantu_bt.robots",
    "momantu_bt.detector",
    "momantu_bt.service",
    "momantu_bt.session",
    "momantu_bt.skill",
    "momantu_bt.symptom",
    "momantu_bt.teleoperation",
    "momantu_bt.testing",
    "momantu_bt.world",
    "momantu_skills.toolbox",
)
"""Modules whose names plug-ins may import; every other module is private."""
ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "build" / "docs"
TEMPLATES = Path(__file__).with_name("reference_templates")


def build(folder: Path) -> None:
    """Write the pages, as HTML, into a folder.

    Raises:
        RuntimeError: a public module cannot be imported.
    """
    # pdoc looks into a module's namespace, where the package puts a name only when somebody asks.
    vars(momantu_bt).update({name: getattr(momantu_bt, name) for name in momantu_bt.__all__})
    pdoc.render.configure(
        docformat="google",
        show_source=False,
        footer_text=f"momantu-bt {momantu_bt.__version__}",
        template_directory=TEMPLATES,
    )
    pdoc.pdoc(*_specifications(), output_directory=folder)


def _specifications() -> Iterator[str]:
    """Each public module without its submodules, as pdoc wants them written."""
    for module in PUBLIC:
        yield module
        yield f"!{re.escape(module)}[.].*"


if __name__ == "__main__":
    build(FOLDER)
    sys.stdout.write(f"{FOLDER.relative_to(ROOT)}/index.html\n")
