"""What all readers of one import share: folders, open files, deviations, limits."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from momantu_bt.formats.places import Place
from momantu_worlds.sdf.deviations import Deviations
from momantu_worlds.sdf.errors import SdfError
from momantu_worlds.sdf.read.document import Element, read_document
from momantu_worlds.sdf.read.material_scripts import MaterialScripts
from momantu_worlds.sdf.read.uris import Library, MissingFile

MOST_SHAPES = 50_000
"""Most visuals and collisions of an import; nested includes multiply quickly."""
MOST_MODELS = 20_000
MOST_MODELS_DEEP = 40
MOST_INCLUDES_DEEP = 20


@dataclass(slots=True)
class Reading:
    """The state of one import."""

    library: Library
    deviations: Deviations
    scripts: MaterialScripts = field(init=False)
    _documents: dict[Path, Element] = field(default_factory=dict)
    _open: list[Path] = field(default_factory=list)
    _shapes: int = 0
    _models: int = 0
    _depth: int = 0

    def __post_init__(self) -> None:
        self.scripts = MaterialScripts(self.library)

    def file_of(self, uri: Element, subject: str, instead: str) -> Path | None:
        """The file that a URI names; None, and a deviation, when it is not there."""
        try:
            found = self.library.resolve(uri.text, uri.place)
            if found.is_file():
                return found
            reason = f"{found} is a folder"
        except MissingFile as error:
            reason = str(error)
        self.deviations.dropped(uri.place, subject, reason, instead)
        return None

    @contextmanager
    def including(self, file: Path, place: Place) -> Iterator[Element]:
        """The root of an included file, while what it holds is read.

        Raises:
            SdfError: it includes itself, or includes go too deep.
        """
        real = file.resolve()
        if real in self._open:
            raise SdfError(place, f"{file} includes itself, directly or through others")
        if len(self._open) >= MOST_INCLUDES_DEEP:
            raise SdfError(place, f"more than {MOST_INCLUDES_DEEP} includes within each other")
        if real not in self._documents:
            self._documents[real] = read_document(file, place)
        self._open.append(real)
        try:
            yield self._documents[real]
        finally:
            self._open.pop()

    def count_shape(self, place: Place) -> None:
        """One more visual or collision; raises SdfError when there are too many."""
        self._shapes += 1
        if self._shapes > MOST_SHAPES:
            raise SdfError(place, f"more than {MOST_SHAPES} visuals and collisions in one world")

    @contextmanager
    def within_model(self, place: Place) -> Iterator[None]:
        """One more model, while it is read.

        Raises:
            SdfError: there are too many, or too many within each other.
        """
        self._models, self._depth = self._models + 1, self._depth + 1
        if self._models > MOST_MODELS:
            raise SdfError(place, f"more than {MOST_MODELS} models in one world")
        if self._depth > MOST_MODELS_DEEP:
            raise SdfError(place, f"more than {MOST_MODELS_DEEP} models within each other")
        try:
            yield
        finally:
            self._depth -= 1
