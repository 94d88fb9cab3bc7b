"""The codes of problems, and the page that explains each one with a wrong and a right example.

The pages are the one list of codes: `docs/problems/<code>.md` in a checkout, bundled with the
installed package.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

from momantu_bt.errors import MomantuError
from momantu_bt.formats.names import valid_names

_PACKAGE = Path(__file__).resolve().parents[2]


class UnknownCode(MomantuError):
    """No problem has this code; the message names the nearest ones."""


def pages_folder() -> Path:
    """The folder of the pages: in the installed package, or in the checkout's docs."""
    bundled = _PACKAGE / "problems"
    return bundled if bundled.is_dir() else _PACKAGE.parent / "docs" / "problems"


@cache
def codes() -> dict[str, str]:
    """Every code in alphabetical order, with the sentence that says what it means."""
    pages = sorted(path for path in pages_folder().glob("*.md") if path.stem != "index")
    return {page.stem: _sentence(page.read_text(encoding="utf-8")) for page in pages}


def explanation(code: str) -> str:
    """The page of a code, as Markdown.

    Raises:
        UnknownCode: there is no such code.
    """
    if code not in codes():
        raise UnknownCode(
            f"no problem has the code {code!r}; {valid_names(code, codes(), 'codes')}"
        )
    return (pages_folder() / f"{code}.md").read_text(encoding="utf-8")


def _sentence(page: str) -> str:
    """The first paragraph below the heading."""
    return " ".join(page.split("\n\n")[1].split())
