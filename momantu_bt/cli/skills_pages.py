"""`momantu-bt skills pages`: a page of documentation per skill."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from momantu_bt import plugins
from momantu_bt.files import OutputError, write_whole
from momantu_bt.skill import Skill
from momantu_bt.tree.show.skill_page import pages as pages_of

EXIT_WRONG_INPUT = 2


def pages(
    folder: Annotated[Path, typer.Argument(help="Where they go; it is made if it is not there.")],
    names: Annotated[
        list[str] | None, typer.Argument(help="Skills, as in trees; all when none is named.")
    ] = None,
) -> int:
    """Write a page of Markdown per skill, and an index, from what `skills show` knows.

    Examples:
      momantu-bt skills pages docs/skills
    """
    chosen = names or list(plugins.installed(plugins.SKILLS))
    skills: dict[str, type[Skill]] = {name: plugins.load(plugins.SKILLS, name) for name in chosen}
    try:
        for file, text in pages_of(skills).items():
            write_whole(folder / file, text, folders=True)
    except OutputError as error:
        typer.echo(f"momantu-bt: {error}", err=True)
        return EXIT_WRONG_INPUT
    typer.echo(f"{len(skills)} pages and an index in {folder}")
    return 0
