"""What all readers of one import share: folders, open files, deviations, limits."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from momantu_bt.formats.places import Place
from momantu_worlds.sdf.deviations import Deviations
from momantu_worlds.sdf.errors import SdfError, TooMuch
from momantu_worlds.sdf.read.document import Element, read_document
from momantu_worlds.sdf.read.material_scripts import MaterialScripts
from momantu_worlds.sdf.read.uris import Library, MissingFile

Read = TypeVar("Read")

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

    def each(
        self,
        elements: Iterable[Element],
        around: str,
        read: Callable[[Element], Read],
        *,
        what: str = "",
    ) -> list[Read]:
        """What `read` makes of some elements. One that is broken is listed and left out.

        around: the names of the models that they are in. what: what they are, for the list; else
        their tag says it.

        Raises:
            TooMuch: a limit of the whole import is exceeded.
        """
        found = []
        for element in elements:
            try:
                found.append(read(element))
            except TooMuch:
                raise
            except SdfError as error:
                self._broken(element, around, what or element.tag, error)
        return found

    def _broken(self, element: Element, around: str, what: str, error: SdfError) -> None:
        own = element.attributes.get("name", "") or element.tag
        subject = f"{around}/{own}" if around else own
        if what in ("model", "include"):
            self.deviations.lost(error.place, subject, error.reason)
        else:
            self.deviations.dropped(error.place, subject, error.reason, f"this {what} is left out")

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
        """One more visual or collision; raises TooMuch when there are too many."""
        self._shapes += 1
        if self._shapes > MOST_SHAPES:
            raise TooMuch(place, f"more than {MOST_SHAPES} visuals and collisions in one world")

    @contextmanager
    def within_model(self, place: Place) -> Iterator[None]:
        """One more model, while it is read.

        Raises:
            TooMuch: there are too many.
            SdfError: there are too many within each other.
        """
        self._models, self._depth = self._models + 1, self._depth + 1
        if self._models > MOST_MODELS:
            raise TooMuch(place, f"more than {MOST_MODELS} models in one world")
        if self._depth > MOST_MODELS_DEEP:
            raise SdfError(place, f"more than {MOST_MODELS_DEEP} models within each other")
        try:
            yield
        finally:
            self._depth -= 1
