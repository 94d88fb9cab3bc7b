"""The fixture `run_tree` for pytest, available wherever momantu-bt is installed."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Protocol

import pytest

from momantu_bt.lazy import lazily

with lazily():
    from momantu_bt import testing
    from momantu_bt.running import api
    from momantu_bt.tree import registry


if TYPE_CHECKING:
    from momantu_bt.record.report import Report
    from momantu_bt.skill import Skill
    from momantu_bt.testing import ScriptedRobot
    from momantu_bt.tree.files.given_text import AnyTree
    from momantu_bt.world import Site, World


class RunTree(Protocol):
    """The type of the fixture `run_tree`."""

    def __call__(
        self,
        tree: AnyTree,
        *,
        skills: Mapping[str, type[Skill]] | None = None,
        services: Mapping[str, Any] | None = None,
        robot: ScriptedRobot | None = None,
        site: Site | None = None,
        world: World | None = None,
        values: Mapping[str, Any] | None = None,
        seed: int = 0,
        max_time: float = 60.0,
    ) -> Report:
        """Run a tree; see `run_tree`."""
        ...


@pytest.fixture
def run_tree() -> Iterator[RunTree]:
    """`run_tree(tree, …)` runs a tree in a scripted world and returns its Report.

    tree: a text, a path, a bundled tree's name or a mapping, as for `momantu_bt.run`.
    skills, services: by name, in addition to the installed ones; they take precedence.
    robot: it stands in the room of `ExampleWorld`, unless `site` is given; or give `world`,
    which has both.
    values: keys of the root's board. max_time: simulated seconds.
    Raises TreeError when the tree is wrong.
    """
    opened: list[World] = []

    def start(
        tree: AnyTree,
        *,
        skills: Mapping[str, type[Skill]] | None = None,
        services: Mapping[str, Any] | None = None,
        robot: ScriptedRobot | None = None,
        site: Site | None = None,
        world: World | None = None,
        values: Mapping[str, Any] | None = None,
        seed: int = 0,
        max_time: float = 60.0,
    ) -> Report:
        having = registry.Registry.installed()
        chosen = registry.Registry(
            skills=_before(skills, having.skills),
            worlds=having.worlds,
            robots=having.robots,
            services=_before(services, having.services),
        )
        place = world
        if place is None:
            place = (
                testing.ExampleWorld(seed, robot)
                if site is None
                else testing.ScriptedWorld(robot, site)
            )
            opened.append(place)
        return api.run(
            tree, world=place, seed=seed, values=values, max_time=max_time, registry=chosen
        )

    yield start
    for each in opened:
        each.close()


def _before(mine: Mapping[str, Any] | None, installed: Mapping[str, Any]) -> Mapping[str, Any]:
    # ChainMap only writes to its first mapping, though its type asks that all can be written
    return ChainMap(dict(mine or {}), installed)  # type: ignore[arg-type]
