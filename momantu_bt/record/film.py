"""Subscribers that show a run in pictures: a film, and a view in a browser."""

from __future__ import annotations

from momantu_bt.engine.context import RunContext
from momantu_bt.engine.executor import Executor
from momantu_bt.engine.outside import Drawn
from momantu_bt.failure import Failure
from momantu_bt.frames import MAP
from momantu_bt.geometry import Transform
from momantu_bt.record.text.lines import running_text, tree_lines
from momantu_bt.world import MarkerView, Video, View

FRAME_EVERY = 2
"""Ticks between two frames of a film: 10 frames a second."""


class FilmObserver:
    """Adds a frame to a video every FRAME_EVERY ticks."""

    def __init__(self, video: Video) -> None:
        self._video = video
        self._ticks = 0

    def ticked(self, run: Executor) -> None:
        """Take a picture when one is due."""
        self._ticks += 1
        if self._ticks % FRAME_EVERY == 1:
            root = run.built.root
            headline = f"{run.context.now:.1f} s  {running_text(root)}"
            self._video.add(tree_lines(root), headline)

    def close(self) -> None:
        """Finish the file."""
        self._video.close()


class ViewObserver:
    """Keeps a browser's view up to date. run: whose markers it shows, if the view can."""

    def __init__(self, view: View, run: Executor | None = None) -> None:
        self._view = view
        self._ticks = 0
        self._drawn: list[Drawn] = []
        self._until: dict[str, float] = {}
        if run is not None and isinstance(view, MarkerView):
            run.context.events.subscribe(Drawn, self._drawn.append)

    def ticked(self, run: Executor) -> None:
        """Show the current world, and what skills have drawn."""
        self._ticks += 1
        if isinstance(self._view, MarkerView) and (self._drawn or self._until):
            self._draw(self._view, run.context)
        if self._ticks % FRAME_EVERY == 1:
            self._view.update()

    def _draw(self, view: MarkerView, context: RunContext) -> None:
        for leaf, markers in self._drawn:
            for marker in markers:
                map_from_frame = _map_from(marker.frame, context)
                name = f"{leaf.index} {leaf.name}/{marker.name}"
                if map_from_frame is None:
                    continue
                view.draw(name, marker, map_from_frame)
                self._until.pop(name, None)
                if marker.seconds:
                    self._until[name] = context.now + marker.seconds
        self._drawn.clear()
        for name in [name for name, until in self._until.items() if until < context.now]:
            view.erase(name)
            del self._until[name]

    def close(self) -> None:
        """Stop serving."""
        self._view.close()


def _map_from(frame: str, context: RunContext) -> Transform | None:
    """Where the robot believes a frame to be; None where it does not know."""
    if context.body is None:
        return None
    try:
        return context.body.frames.lookup(MAP, frame)
    except Failure:
        return None
