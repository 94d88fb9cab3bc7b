"""`momantu-bt skills --xml-model`: the installed skills for the palette of an editor."""

from __future__ import annotations

import typer

from momantu_bt.cli.shared.notices import notice
from momantu_bt.plugins import PluginError
from momantu_bt.skill import Skill
from momantu_bt.tree.files.xml.palette import palette
from momantu_bt.tree.registry import Registry


def print_palette() -> None:
    """Print a TreeNodesModel of every skill that can be loaded; say of the others why not."""
    registry = Registry.installed()
    found: dict[str, type[Skill]] = {}
    for name in registry.skills:
        try:
            found[name] = registry.skills[name]
        except PluginError as error:
            notice(f"left out: {error}")
    typer.echo(palette(found), nl=False)
