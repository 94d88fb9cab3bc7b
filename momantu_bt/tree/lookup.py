"""Finding a tree file by path, or a bundled tree by name."""

from __future__ import annotations

from pathlib import Path

from momantu_bt.tree.problems import nearest

SUFFIX = ".yaml"
_PACKAGE = Path(__file__).resolve().parent.parent


class TreeNotFound(Exception):
    """No file and no bundled tree of that name; the message says what there is."""


def bundled_folder() -> Path | None:
    """Where the bundled trees lie: in the installed package, or in the checkout beside it."""
    for folder in (_PACKAGE / "trees", _PACKAGE.parent / "trees"):
        if folder.is_dir():
            return folder
    return None


def bundled() -> dict[str, Path]:
    """Bundled trees by name."""
    folder = bundled_folder()
    return {} if folder is None else {p.stem: p for p in sorted(folder.glob(f"*{SUFFIX}"))}


def find(name: str) -> Path:
    """The file that a tree argument means: a path, or the name of a bundled tree.

    Raises:
        TreeNotFound: with the nearest name there is.
    """
    path = Path(name)
    try:
        if path.is_file():
            return path
    except OSError as error:
        raise TreeNotFound(f"{name} cannot be read: {error.strerror}") from None
    having = bundled()
    if name in having:
        return having[name]
    if path.is_dir():
        inside = ", ".join(p.name for p in sorted(path.glob(f"*{SUFFIX}"))) or "none"
        raise TreeNotFound(f"{name} is a folder; tree files in it: {inside}")
    raise TreeNotFound(_not_found(path, having))


def _not_found(path: Path, having: dict[str, Path]) -> str:
    if path.suffix or len(path.parts) > 1:
        folder = path.parent
        if not folder.is_dir():
            return f"there is no folder {folder} for the tree file {path.name}"
        beside = {p.name: str(p) for p in sorted(folder.glob(f"*{SUFFIX}"))}
        near = nearest(path.name, beside)
        if near is not None:
            return f"there is no file {path}; did you mean {beside[near]}?"
        near = nearest(path.stem, having)
        if near is not None:
            return f"there is no file {path}; did you mean the bundled tree {near}?"
        return f"there is no file {path}; tree files there: {', '.join(beside) or 'none'}"
    near = nearest(path.name, having)
    hint = f"did you mean {near}?" if near else f"bundled trees: {', '.join(having) or 'none'}"
    return f"no tree is called {path.name!r}; {hint}"
