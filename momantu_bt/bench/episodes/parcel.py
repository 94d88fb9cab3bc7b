"""A tree's files as data, to send them to the machine that runs an episode."""

from __future__ import annotations

import json
import os.path
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from momantu_bt.bench.rows.spec import Row
from momantu_bt.faults.tree_file import faults_source
from momantu_bt.tree.load import read_file

_PROJECT = "pyproject.toml"
"""Marks the folder that included files must lie in; see `tree.includes.project_folder`."""


@dataclass(frozen=True, slots=True)
class Parcel:
    """A tree file, all that it includes, and the file of faults beside it.

    main: the tree's own file. texts: the text of each file, by its path below one folder, with `/`.
    shown: the names of the files on the machine that they come from.
    """

    main: str
    texts: Mapping[str, str]
    shown: Mapping[str, str]

    @classmethod
    def of(cls, tree: str) -> Parcel:
        """The files of a tree on this machine, where their names say, whatever links lead to.

        Raises:
            TreeNotFound, TreeError: it cannot be read.
        """
        document, _ = read_file(Path(tree))
        source = {**document.source, **faults_source(document)}
        paths = {shown: Path(os.path.normpath(Path.cwd() / shown)) for shown in source}
        folder = os.path.commonpath([path.parent for path in paths.values()])
        names = {shown: path.relative_to(folder).as_posix() for shown, path in paths.items()}
        texts = {names[shown]: text for shown, text in source.items()}
        return cls(names[document.file], texts, {name: shown for shown, name in names.items()})

    def unpack(self, folder: Path) -> Path:
        """Write the files into an empty folder; returns the path of the main one."""
        (folder / _PROJECT).touch()
        for name, text in self.texts.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(text.encode())
        return folder / self.main

    def as_shown(self, row: Row, folder: Path) -> Row:
        """A row of files that were unpacked there, as one of the files that they are copies of."""
        text = json.dumps(row, ensure_ascii=False)
        for name in sorted(self.shown, key=len, reverse=True):
            text = text.replace(_quoted(str(folder / name)), _quoted(self.shown[name]))
        shown: Row = json.loads(text)
        return shown


def _quoted(path: str) -> str:
    """A text as it is written inside a JSON string."""
    return json.dumps(path, ensure_ascii=False)[1:-1]
