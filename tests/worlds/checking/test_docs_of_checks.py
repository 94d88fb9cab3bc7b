"""The page about `worlds check` names every code that can be found, and no other."""

import re
from pathlib import Path

import momantu_worlds.checking

ROOT = Path(__file__).parents[3]
CODE = re.compile(r'"([a-z]+(?:-[a-z]+)+|overlap)"')


def test_every_code_is_in_the_table() -> None:
    sources = Path(momantu_worlds.checking.__file__).parent.glob("*.py")
    found = {code for source in sources for code in CODE.findall(source.read_text("utf-8"))}
    page = (ROOT / "docs" / "worlds_check.md").read_text("utf-8")
    rows = [line.split("|")[1] for line in page.splitlines() if line.startswith("| `")]
    told = {code for row in rows for code in re.findall(r"`([a-z-]+)`", row)}
    assert found == told
