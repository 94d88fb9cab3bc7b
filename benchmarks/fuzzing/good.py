"""Good trees, which fuzzing damages."""

from __future__ import annotations

import json
import re
from pathlib import Path

from momantu_bt.tree.files.lookup import bundled

_ROOT = Path(__file__).resolve().parent.parent.parent
_CASES = _ROOT / "tests" / "framework" / "engine" / "conformance_cases.jsonl"
_EXAMPLE = re.compile(r"^```xml\n(<root.*?)^```", re.MULTILINE | re.DOTALL)


def good_trees() -> dict[str, list[str]]:
    """Texts by the suffix of their files: bundled trees, those of the docs, BehaviorTree.CPP's."""
    yaml = [path.read_text(encoding="utf-8") for path in sorted(bundled().values())]
    pages = [path.read_text(encoding="utf-8") for path in sorted(_ROOT.glob("docs/**/*.md"))]
    xml = [example for page in pages for example in _EXAMPLE.findall(page)]
    cases = _CASES.read_text(encoding="utf-8").splitlines()
    return {".yaml": yaml, ".xml": [*xml, *(str(json.loads(line)["xml"]) for line in cases)]}
