"""`momantu-bt skills pages`: a page of documentation per skill."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from momantu_bt.cli.shared.notices import notice
from momantu_bt.errors import ExitCode
from momantu_bt.formats.files import write_whole
from momantu_bt.plugins import PluginError
from momantu_bt.skill import Skill
from momantu_bt.tree.catalogue import NODES, plugged_in
from momantu_bt.tree.plugins import SKILLS
from momantu_bt.tree.show.node_page import node_markdown
from momantu_bt.tree.show.skill_page import pages as pages_of


def pages(
    folder: Annotated[
        Path, typer.Argument(help="The folder for the pages; it is created if needed.")
    ],
    names: Annotated[
        list[str] | None, typer.Argument(help="Names of skills. Default: all.")
    ] = None,
) -> ExitCode:
    """Write a page of Markdown per skill, and an index, from what `skills show` knows.

    Nodes of other packages get a page each as well. A skill that is broken is left out, with the
    reason; the exit code is then 1.

    Examples:
      momantu-bt skills pages docs/skills
    """
    skills: dict[str, type[Skill]] = {}
    broken = 0
    for name in names or SKILLS:
        try:
            skills[name] = SKILLS.load(name)
        except PluginError as error:
            if name not in SKILLS:
                raise
            notice(f"left out: {error}")
            broken += 1
    for file, text in pages_of(skills).items():
        write_whole(folder / file, text, folders=True)
    specs = [NODES[type_] for type_ in plugged_in() if names is None]
    for spec in specs:
        write_whole(folder / f"{spec.yaml[0]}.md", node_markdown(spec), folders=True)
    typer.echo(f"{len(skills) + len(specs)} pages and an index in {folder}")
    return ExitCode.FAILURE if broken else ExitCode.SUCCESS
