"""The tree of a record, read again from the texts in it."""

from __future__ import annotations

import json
import os.path
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NoReturn

from momantu_bt.errors import MomantuError
from momantu_bt.formats.problems import errors
from momantu_bt.record.codec import from_json
from momantu_bt.record.recording import Recording
from momantu_bt.robot import RobotDescription
from momantu_bt.tree.check.named_world import WITHOUT_WORLD
from momantu_bt.tree.load import load
from momantu_bt.tree.model import Document
from momantu_bt.tree.problems import TreeError
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.substitute.substitution import Substitution, load_substitution
from momantu_bt.world import Site, World, WorldError

_FOLDER = "files"
_MOST = 3
"""The most problems of a tree that a message lists."""


class RebuildError(MomantuError):
    """The tree of a record cannot be rebuilt here; the message says why."""


@dataclass(frozen=True, slots=True)
class Rebuilt:
    """The tree of a run: the checked document and its substitutions."""

    document: Document
    substitution: Substitution


def rebuild(recording: Recording, registry: Registry) -> Rebuilt:
    """Read and check a record's tree as the run did.

    The run's world and robot are not opened: the record has the site.

    Raises:
        RebuildError: a text is missing, or the tree is wrong with the installed skills.
        PluginError: one of the skills cannot be loaded.
    """
    try:
        return _rebuild(recording, registry)
    except TreeError as error:
        wrong = errors(error.problems)
        told = [f"{Path(p.place.file).name}:{p.place.line}: {p.message}" for p in wrong[:_MOST]]
        more = f"; and {len(wrong) - _MOST} more" if len(wrong) > _MOST else ""
        message = f"its tree is wrong with what is installed here: {'; '.join(told)}{more}"
        raise RebuildError(message) from None


def _rebuild(recording: Recording, registry: Registry) -> Rebuilt:
    about = recording.about
    having = replace(registry, worlds=_worlds(recording), robots=_Robots())
    values = {key: from_json(value) for key, value in about["values"].items()}
    world = about["world"] or WITHOUT_WORLD
    with _written(recording) as paths:
        tree = paths.get(about["tree"])
        if tree is None:
            texts = ", ".join(recording.files) or "none"
            raise RebuildError(f"it has no text of its tree {about['tree']}; its texts: {texts}")
        substituted = "substitution" in recording.kinds.values()
        others = [paths[name] for name, kind in recording.kinds.items() if kind == "tree"]
        document = load(
            str(tree),
            having,
            world=world,
            values=values,
            include=[each for each in others if each != tree],
            tolerant=substituted,
        ).document
        substitution = Substitution()
        for name, kind in recording.kinds.items():
            if kind == "substitution":
                substitution = load_substitution(paths[name], document, having, world)
    return Rebuilt(document, substitution)


@contextmanager
def _written(recording: Recording) -> Iterator[Mapping[str, Path]]:
    """Write the texts to a temporary folder. Their paths relative to each other stay the same."""
    names = [name for name, kind in recording.kinds.items() if kind in ("tree", "substitution")]
    with TemporaryDirectory() as made:
        top = Path(made).resolve()
        # so that files in folders above the main file are in its project
        (top / "pyproject.toml").touch()
        deep = top.joinpath(*[_FOLDER] * (1 + max(map(_ups, names), default=0)))
        paths = {name: Path(os.path.normpath(deep / name.lstrip("/"))) for name in names}
        for name, path in paths.items():
            if not path.is_relative_to(top):
                raise RebuildError(f"a text of it has the impossible name {name!r}")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(recording.files[name], encoding="utf-8")
        yield paths


def _ups(name: str) -> int:
    """How many folders up a file lies, by the number of `..` in its name."""
    return Path(name).parts.count("..")


def _worlds(recording: Recording) -> Mapping[str, Any]:
    name = recording.about["world"]
    if name is None:
        return {}
    texts = [recording.files[each] for each, kind in recording.kinds.items() if kind == "site"]
    site = from_json(json.loads(texts[0])) if texts else None
    if not isinstance(site, Site):
        raise RebuildError(f"it has no site of its world {name}")
    return {name: _RecordedWorld(name, recording.about["robot"], site)}


class _RecordedWorld:
    """A world entry that knows its site and cannot be opened."""

    def __init__(self, name: str, robot: str, site: Site) -> None:
        self.name = name
        self.default_robot = robot
        self._site = site

    def site(self) -> Site:
        """The site of the run."""
        return self._site

    def open(self, description: RobotDescription, seed: int, *, referee: bool = True) -> World:
        """Always raises WorldError: the world cannot be opened."""
        raise WorldError(f"{self.name} is a record's and cannot be opened")


class _Robots(Mapping[str, Any]):
    """Has every robot by name, without a description: the tree was checked before the run."""

    def __getitem__(self, name: str) -> Any:
        def absent() -> NoReturn:
            raise WorldError(f"the record does not hold the robot {name}")

        return absent

    def __iter__(self) -> Iterator[str]:
        return iter(())

    def __len__(self) -> int:
        return 0

    def __contains__(self, name: object) -> bool:
        return True
