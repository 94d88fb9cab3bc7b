"""The panel of a browser's view: what runs, the tree, the layers, following, closing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from html import escape
from typing import Any

from momantu_bt.folding import fitted
from momantu_bt.world import Layer, TreeLine

ROWS = 40
"""Most lines of the tree."""
COLORS = {
    "RUNNING": "#b26a00",
    "SUCCESS": "#2e7d32",
    "FAILURE": "#c62828",
    "SKIPPED": "#8a93a5",
}
"""The colour of a status; any other status is grey."""
GREY = "#868e96"
MARKS = {"RUNNING": "▸", "SUCCESS": "✓", "FAILURE": "✗", "SKIPPED": "-"}
_STYLE = (
    "font: 12px/1.45 'DejaVu Sans Mono', monospace; white-space: pre; overflow-x: auto; "
    "margin: 0 0.75em 0.5em; padding: 0"
)


class Panel:
    """The controls beside the scene.

    show_layer: called with a layer and whether a person wants to see it.
    """

    def __init__(self, gui: Any, show_layer: Callable[[Layer, bool], None]) -> None:
        gui.configure_theme(
            control_width="large",
            show_logo=False,
            show_share_button=False,
        )
        gui.main_panel.dock_right()
        gui.set_panel_label("momantu-bt")
        self._gui = gui
        self._text = ""
        self._tree = gui.add_html("")
        self._follow = gui.add_checkbox(
            "follow the robot", True, hint="Move the camera along with the robot"
        )
        with gui.add_folder("layers"):
            for layer in Layer:
                box = gui.add_checkbox(layer.value, True)
                box.on_update(lambda _, box=box, layer=layer: show_layer(layer, box.value))
        self.dismissed = False

    @property
    def follows(self) -> bool:
        """Whether the camera is to follow the robot."""
        return bool(self._follow.value)

    @property
    def text(self) -> str:
        """What runs and the tree, as HTML."""
        return self._text

    def tell(self, headline: str, lines: Sequence[TreeLine]) -> None:
        """Show what runs, and the tree's lines."""
        rows = [f"<b>{escape(headline)}</b>", *map(_row, fitted(lines, ROWS))]
        text = f'<div style="{_STYLE}">{"<br>".join(rows)}</div>'
        if text != self._text:
            self._text = self._tree.content = text

    def end(self, text: str) -> None:
        """Say how the run ended, and offer to close the view."""
        self._gui.add_markdown(f"**The run is over.** {_plain(text)}")
        button = self._gui.add_button("Close the view", hint="Ends momantu-bt in its terminal")
        button.on_click(self._dismiss)

    def _dismiss(self, _: Any) -> None:
        self.dismissed = True


def _row(line: TreeLine) -> str:
    mark = MARKS.get(line.status, " ")
    words = f"{'  ' * line.depth}{mark} {line.text}"
    color = COLORS.get(line.status, GREY)
    weight = "; font-weight: bold" if line.status == "RUNNING" else ""
    return f'<span style="color: {color}{weight}">{escape(words)}</span>'


def _plain(text: str) -> str:
    """A text in Markdown without its marks' meaning."""
    return "".join(f"\\{each}" if each in "\\`*_{}[]<>#+-.!|" else each for each in text)
