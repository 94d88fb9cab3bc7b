"""A package for a new skill or service: one that works, entry points, a passing test, a README."""

from __future__ import annotations

import importlib.util
import keyword
import re
import shutil
import tempfile
import unicodedata
from collections.abc import Mapping
from pathlib import Path
from string import Template

from momantu_bt.errors import MomantuError
from momantu_bt.tree.plugins import SERVICES, SKILLS, bad_service_name
from momantu_bt.tree.skill_objection import bad_skill_name

FILES = {
    "pyproject.toml": "pyproject.toml",
    "README.md": "README.md",
    "src/${package}/__init__.py": "init.py",
    "src/${package}/${module}.py": "skill.py",
    "tests/test_${module}.py": "test_skill.py",
}
"""Files of a skill's package, and their templates beside this module."""
SERVICE_FILES = {
    "pyproject.toml": "service_pyproject.toml",
    "README.md": "service_README.md",
    "src/${package}/__init__.py": "init.py",
    "src/${package}/${module}.py": "service.py",
    "tests/test_${module}.py": "test_service.py",
}
"""The same of a service's."""

_IMPORTED = (
    *("Failure", "In", "Out", "Robot", "Run", "Skill"),
    *("Any", "Field", "Mapping", "Service", "ServiceContext", "Tunables"),
)
"""Names that the modules of skills and services import."""
_HERE = Path(__file__).parent
_BARE = re.compile(r"[A-Za-z0-9_-]+")
"""A key that TOML takes without quotes."""
_HUMP = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
"""Where a word begins inside a name such as `DockRobot`."""


class CannotCreate(MomantuError):
    """The package cannot be made; the message says why. Nothing was written."""


def new_skill(name: str, into: Path) -> Path:
    """Make the package of a skill called `name`; returns its folder, `into/name`.

    Raises:
        CannotCreate: the name is not allowed for a skill or is taken, or the folder cannot be made.
    """
    words = _words(name)
    _check_name(name, words["package"])
    return make_package(into / name, _filled(FILES, words))


def new_service(name: str, into: Path) -> Path:
    """Make the package of a service called `name`; returns its folder, `into/name`.

    Raises:
        CannotCreate: the name is not allowed for a service or is taken, or the folder cannot be
            made.
    """
    wrong = bad_service_name(name)
    if wrong is not None:
        raise CannotCreate(wrong.replace("; give the entry point another name", ""))
    words = _words(name, "service")
    taken = SERVICES.installed().get(name)
    if taken is not None:
        raise CannotCreate(f"a service called {name!r} is installed already: {taken.value}")
    _check_package(words["package"])
    return make_package(into / name, _filled(SERVICE_FILES, words))


def make_package(target: Path, files: Mapping[str, str]) -> Path:
    """Write a package whole, or nothing. files: texts by their paths in the folder.

    Raises:
        CannotCreate: the folder is there already, or cannot be made.
    """
    into = target.parent
    if target.exists():
        raise CannotCreate(f"{target} is there already; choose another name, or --into a folder")
    if not into.is_dir():
        raise CannotCreate(f"there is no folder {into}")
    draft: Path | None = None
    try:
        draft = Path(tempfile.mkdtemp(prefix=f".{target.name}-", dir=into))
        for path, text in files.items():
            file = draft / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")
        draft.chmod(0o755)
        draft.rename(target)
    except OSError as error:
        if draft is not None:
            shutil.rmtree(draft, ignore_errors=True)
        raise CannotCreate(f"{target} cannot be made: {error.strerror or error}") from None
    return target


def _check_name(name: str, package: str) -> None:
    wrong = bad_skill_name(name)
    if wrong is not None:
        raise CannotCreate(wrong.replace("; give the entry point another name", ""))
    taken = SKILLS.installed().get(name)
    if taken is not None:
        raise CannotCreate(f"a skill called {name!r} is installed already: {taken.value}")
    _check_package(package)


def _check_package(package: str) -> None:
    if importlib.util.find_spec(package) is not None:
        raise CannotCreate(f"a Python package called {package!r} is there already")


def toml_key(name: str) -> str:
    """A name as a key in TOML, in quotes where it must be."""
    return name if _BARE.fullmatch(name) else f'"{name}"'


def _filled(templates: Mapping[str, str], words: dict[str, str]) -> dict[str, str]:
    """The texts of a package's files by their paths. templates: the template of each path."""
    files = {}
    for path, template in templates.items():
        text = (_HERE / f"{template}.txt").read_text(encoding="utf-8")
        files[Template(path).substitute(words)] = Template(text).substitute(words)
    return files


def _words(name: str, what: str = "skill") -> dict[str, str]:
    """What the names in the templates stand for. what: the kind of plug-in."""
    module = module_name(name)
    package = f"{module.rstrip('_')}_{what}"
    return {
        "name": name,
        "entry": toml_key(name),
        "module": module,
        "package": package,
        "distribution": re.sub("_+", "-", package).strip("-"),
        "title": class_name(name),
    }


def module_name(name: str) -> str:
    """The name of a Python module for a plug-in of any name: `dock_robot` for `DockRobot`."""
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    snake = re.sub(r"\W+", "_", _HUMP.sub("_", plain)).lower()
    if not snake.strip("_") or snake[0].isdigit():
        return f"skill_{snake}".rstrip("_")
    return f"{snake}_" if keyword.iskeyword(snake) else snake


def class_name(name: str) -> str:
    """The name of a skill's class: `TurnRound` for `turn_round`, `DockRobot` for itself."""
    title = name
    if not (name.isidentifier() and name[0].isupper()):
        title = "".join(part.capitalize() for part in module_name(name).split("_"))
    return f"{title}Skill" if title in _IMPORTED or keyword.iskeyword(title) else title
