"""Write the tables of files at the end of docs/architecture.md, from the files' docstrings.

After you add, move or rename a file, run `.venv/bin/python setup/file_tables.py`. A test says when
the tables are out of date.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "architecture.md"
PACKAGES = ("momantu_bt", "skills/momantu_skills", "worlds/momantu_worlds")
HEADING = "## Every file\n"
ABOUT = """
Each line is the first line of the file's docstring. `setup/file_tables.py` writes these tables.
"""


def main() -> None:
    """Write the tables into the page."""
    page = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(with_tables(page), encoding="utf-8")


def with_tables(page: str) -> str:
    """The page, its tables replaced by those of the files that exist now."""
    before = page.partition(HEADING)[0].rstrip()
    return f"{before}\n\n{HEADING}{ABOUT}{''.join(tables())}"


def tables() -> Iterator[str]:
    """A section for each folder that holds files."""
    for package in PACKAGES:
        base = ROOT / package
        for folder in sorted([base, *(path for path in base.rglob("*") if path.is_dir())]):
            if folder.name != "__pycache__":
                yield from _section(folder)


def _section(folder: Path) -> Iterator[str]:
    files = sorted(path for path in folder.iterdir() if path.is_file() and path.suffix != ".pyc")
    modules = [path for path in files if path.suffix == ".py" and path.name != "__init__.py"]
    data = [path.name for path in files if path.suffix != ".py" and path.name != "py.typed"]
    package = folder / "__init__.py"
    if not modules and not data and not package.exists():
        return
    yield f"\n### `{folder.relative_to(ROOT)}/`\n"
    if package.exists():
        yield f"\n{_summary(package)}\n"
    if modules:
        yield "\n| file | what it does |\n|---|---|\n"
        yield from (f"| `{path.name}` | {_summary(path)} |\n" for path in modules)
    if data:
        yield f"\nData: {', '.join(f'`{name}`' for name in data)}.\n"


def _summary(path: Path) -> str:
    """The first line of a file's docstring."""
    docstring = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))
    if not docstring:
        raise SystemExit(
            f"{path.relative_to(ROOT)} has no docstring; write one that says what it does"
        )
    return docstring.partition("\n")[0].replace("|", "\\|")


if __name__ == "__main__":
    main()
