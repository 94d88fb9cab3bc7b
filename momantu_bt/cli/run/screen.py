"""What a person sees of a run, from before the world is open to after its end."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING

import typer

from momantu_bt.cli.run.terminal import Terminal
from momantu_bt.engine.executor import Executor, Observer
from momantu_bt.errors import InputError, MomantuError
from momantu_bt.lazy import lazily
from momantu_bt.record.text.changes import ChangeLines
from momantu_bt.running.prepare import Prepared
from momantu_bt.tree.check.named_world import world_of
from momantu_bt.tree.show.printing import tree_lines
from momantu_bt.world import TreeLine, TreeView, View, World

with lazily():
    from rich import console as consoles

    from momantu_bt.cli.run import live, waiting_page
    from momantu_bt.record import view as views

if TYPE_CHECKING:
    from momantu_bt.cli.run.live import LiveTree
    from momantu_bt.cli.run.waiting_page import WaitingPage

POLL = 0.2
"""Seconds of wall time between two looks at whether the view was closed in the browser."""


class Screen:
    """The terminal's display, the page while the run is prepared, and the view.

    display: an observer of the run; None: nothing is displayed. tree: the same, if it draws the
    tree on a terminal.
    """

    def __init__(
        self, display: Observer | None, page: WaitingPage | None, tree: LiveTree | None = None
    ) -> None:
        self.display, self._page, self._live = display, page, tree
        self._view: View | None = None

    def stage(self, text: str) -> None:
        """Say what is being prepared now."""
        if self._page is not None:
            self._page.stage(text)
        if self._live is not None:
            self._live.stage(text)

    def open_view(self, world: World, port: int, run: Executor) -> Observer:
        """Open the view in the place of the page, and return what keeps it up to date."""
        if self._page is not None:
            self._page.close()
        self._view = world.open_view(port)
        return views.ViewObserver(self._view, run, stays=True)

    def keep_view(self, ending: str) -> None:
        """Leave the view open until Ctrl-C, or until a person closes it in the browser."""
        view = self._view
        if view is None or not isinstance(view, TreeView):
            return
        try:
            view.end(ending)
            typer.echo(f"the view stays open at {view.url}; Ctrl-C, or its button, closes it")
            while not view.dismissed:
                time.sleep(POLL)
        except KeyboardInterrupt:
            typer.echo()

    def close(self) -> None:
        """Close everything that is still open."""
        if self._live is not None:
            self._live.close()
        if self._page is not None:
            self._page.close()
        if self._view is not None:
            self._view.close()


def open_screen(
    prepared: Prepared, terminal: Terminal | None, view_port: int | None, *, quiet: bool
) -> Screen:
    """Show at once what is about to run: a tree on a terminal, a line elsewhere.

    Raises:
        InputError: a view was asked for, and there is no world.
        WorldError: something else listens at the view's port.
    """
    document = prepared.document
    world = world_of(document, prepared.options.world_name)
    planned = [
        TreeLine(line.depth, line.text, "IDLE")
        for line in tree_lines(document.trees[document.main].root)
    ]
    page = None
    if view_port is not None:
        if world is None:
            raise InputError("--video and --view need a world; this run has none")
        text = "\n".join(f"{'  ' * line.depth}{line.text}" for line in planned)
        page = waiting_page.WaitingPage(view_port, f"{document.main} in {world}", text)
        typer.echo(f"view: {page.url}")
    if quiet:
        return Screen(None, page)
    out = sys.stdout  # a skill may redirect it
    console = consoles.Console(file=out)
    if console.is_terminal and not console.is_dumb_terminal:
        display = live.LiveTree(console, planned)
        if terminal is not None:
            terminal.display = display
        return Screen(display, page, display)
    if world is not None:
        typer.echo(f"preparing: world {world}{_robot(prepared, world)}", file=out)
    return Screen(ChangeLines(lambda line: typer.echo(line, file=out)), page)


def _robot(prepared: Prepared, world: str) -> str:
    """`, robot fetch`; empty if the world does not say which one it takes."""
    named = prepared.options.robot
    try:
        return f", robot {named or prepared.registry.worlds[world].default_robot}"
    except (MomantuError, KeyError):  # the run's start says it better
        return ""
