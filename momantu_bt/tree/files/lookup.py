"""Finding a tree file by path, or a bundled tree by name."""

from __future__ import annotations

from pathlib import Path

from momantu_bt.errors import MomantuError
from momantu_bt.formats.names import nearest

SUFFIX = ".yaml"
"""The suffix of bundled trees."""
SUFFIXES = (SUFFIX, ".yml", ".xml", ".btproj")
"""The suffixes of tree files, in YAML and in XML."""
FAULTS_SUFFIX = ".faults.yaml"
"""The suffix of a file of faults beside a tree file. It replaces the tree's own suffix."""
VALUES = "values"
"""The folder of values for `--values`, beside the bundled trees."""
_PACKAGE = Path(__file__).resolve().parents[2]


class TreeNotFound(MomantuError):
    """No file and no bundled tree has this name. The message lists those that exist."""


def bundled_folder() -> Path | None:
    """The folder of the bundled trees: in the installed package, or in the checkout."""
    for folder in (_PACKAGE / "trees", _PACKAGE.parent / "trees"):
        if folder.is_dir():
            return folder
    return None


def bundled() -> dict[str, Path]:
    """Bundled trees by name. A tree in a folder of its own has the folder's name in front."""
    folder = bundled_folder()
    if folder is None:
        return {}
    paths = [*sorted(folder.glob(f"*{SUFFIX}")), *sorted(folder.glob(f"*/*{SUFFIX}"))]
    trees = [path for path in paths if path.parent != folder / VALUES and not is_faults_file(path)]
    return {path.relative_to(folder).with_suffix("").as_posix(): path for path in trees}


def tree_files(folder: Path) -> list[Path]:
    """The files in a folder that have a tree's suffix, by name."""
    try:
        files = [each for each in folder.iterdir() if each.suffix.lower() in SUFFIXES]
    except OSError:
        return []
    return sorted(each for each in files if not is_faults_file(each))


def is_faults_file(path: Path) -> bool:
    """Whether a file describes faults in the tree beside it."""
    return path.name.endswith(FAULTS_SUFFIX)


def faults_file(tree: Path) -> Path:
    """The path of a tree's file of faults; it need not exist."""
    return tree.with_suffix(FAULTS_SUFFIX)


def find(name: str) -> Path:
    """The file that a tree argument means: a path, or the name of a bundled tree.

    Raises:
        TreeNotFound: there is no such tree; the message gives the nearest name.
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
        inside = ", ".join(p.name for p in tree_files(path)) or "none"
        raise TreeNotFound(f"{name} is a folder; tree files in it: {inside}")
    raise TreeNotFound(_not_found(path, having))


def _not_found(path: Path, having: dict[str, Path]) -> str:
    inner = {name.rpartition("/")[2]: name for name in having}
    near = nearest(path.name, inner)
    if not path.suffix and near is not None:
        return f"no tree is called {str(path)!r}; did you mean {inner[near]}?"
    if path.suffix or len(path.parts) > 1:
        folder = path.parent
        if not folder.is_dir():
            return f"there is no folder {folder} for the tree file {path.name}"
        beside = {p.name: str(p) for p in tree_files(folder)}
        near = nearest(path.name, beside)
        if near is not None:
            return f"there is no file {path}; did you mean {beside[near]}?"
        near = nearest(path.stem, inner)
        if near is not None:
            return f"there is no file {path}; did you mean the bundled tree {inner[near]}?"
        return f"there is no file {path}; tree files there: {', '.join(beside) or 'none'}"
    return f"no tree is called {path.name!r}; bundled trees: {', '.join(having) or 'none'}"
