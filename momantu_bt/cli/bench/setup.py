"""What `bench` and `compare` share: arguments to a plan, an engine and an exit code."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import typer

from momantu_bt.bench.episodes.carry_out import Ended
from momantu_bt.bench.episodes.engine import Engine
from momantu_bt.bench.episodes.local_engine import LocalEngine
from momantu_bt.bench.episodes.ray_engine import RayEngine
from momantu_bt.bench.planning.made_of import made_of
from momantu_bt.bench.planning.plan import Plan, Wanted
from momantu_bt.bench.rows.store import Store
from momantu_bt.cli.shared.notices import notice
from momantu_bt.engine.build import skills_in
from momantu_bt.errors import InputError
from momantu_bt.faults.matrix import Row as Demand
from momantu_bt.faults.matrix import row_of, rows_like
from momantu_bt.faults.spec import parse_fault
from momantu_bt.faults.stage import plan
from momantu_bt.faults.tree_file import tree_faults
from momantu_bt.formats.names import valid_names
from momantu_bt.robots.plugins import ROBOTS
from momantu_bt.running.launch import check_world
from momantu_bt.running.prepare import refuse_missing
from momantu_bt.running.told import absolute_map, read_told, with_told
from momantu_bt.tree.check.named_world import world_of
from momantu_bt.tree.files.lookup import find
from momantu_bt.tree.files.settings import Given
from momantu_bt.tree.load import load, read_file
from momantu_bt.tree.model import Document
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.substitute.substitution import Substitution
from momantu_bt.world_plugins import WORLDS

ENGINES = ("local", "ray")


@dataclass(frozen=True, slots=True)
class HowToRun:
    """How to run episodes of any tree. values: of the root's blackboard."""

    world: str | None
    robot: str | None
    values: Given
    max_time: float
    referee: bool
    limit: float
    record: str
    faults: Sequence[str | None] = field(default=(None,))
    goal: Any = None
    map: str | None = None
    names: str | None = None


def plan_of(tree: str, seeds: Sequence[int], how: HowToRun) -> tuple[Plan, Document]:
    """Check a tree and say which of its episodes are wanted, and how.

    Raises:
        TreeNotFound, TreeError, LaunchError, PluginError: it cannot run.
    """
    registry = Registry.installed()
    place = str(find(tree))
    told: dict[str, Any] = {
        "world": WORLDS.absolute(how.world),
        "robot": ROBOTS.absolute(how.robot),
    }
    own_map, names = absolute_map(how.map), absolute_map(how.names)
    seen = read_told(own_map, names)
    telling = registry if seen is None else with_told(registry, seen)
    document = load(place, telling, values=how.values, goal=how.goal, **told).document
    refuse_missing(document, registry, Substitution())
    check_world(document, how.world, skills_in(document), registry)
    if WORLDS.is_path(document.world or ""):
        # on another machine, an episode has the tree in another folder
        told["world"] = told["world"] or WORLDS.absolute(world_of(document, None))
    told |= {"max_time": how.max_time, "referee": how.referee, "goal": how.goal}
    own: dict[str, Any] = {"map_": own_map, "names": names}
    made = made_of(document, registry, values=how.values, **own, **told)
    wanted = Wanted(tuple((seed, fault) for seed in seeds for fault in how.faults), made)
    values: Mapping[str, Any] = dict(how.values)
    told |= {"map": own_map, "names": names, "limit": how.limit, "record": how.record}
    return Plan(place, wanted, values=values, **told), document


def demands_of(tree: str, faults: Sequence[str], patterns: str | None) -> tuple[Demand, ...]:
    """The faults that `--fault` and `--faults` mean, each once and always written the same way.

    Raises:
        FaultError: a text is not a fault, or a pattern matches no fault.
        TreeNotFound, TreeError: the tree, or the file of faults beside it, is wrong.
    """
    like: tuple[Demand, ...] = ()
    if patterns is not None:
        like = rows_like(patterns, tree_faults(read_file(find(tree))[0]).rows)
    texts = [*faults, *(demand.fault for demand in like)]
    found = [row_of(parse_fault(text)) for text in texts]
    return tuple({demand.fault: demand for demand in found}.values())


def check_faults(faults: Sequence[str], document: Document, how: HowToRun) -> None:
    """Refuse faults that the tree cannot have; an episode checks what only the world knows.

    Raises:
        FaultError: the tree has nothing of the kind, or its phase occurs nowhere.
    """
    having = Registry.installed().skills
    skills = {name: having[name] for name in skills_in(document)}
    with_world = world_of(document, how.world) is not None
    wanted = [parse_fault(text) for text in faults]
    plan(wanted, document, skills, Substitution(), with_world=with_world)


def one_tree(words: Sequence[str]) -> str:
    """The tree that is given; InputError for several."""
    if len(words) == 1:
        return words[0]
    raise InputError(
        f"a bench is of one tree, not of {', '.join(words)}; several folders go with --merge, "
        "two trees with `momantu-bt compare`"
    )


def choose(value: str, valid: Sequence[str], option: str) -> str:
    """A value that is one of a few; InputError says which."""
    if value not in valid:
        raise InputError(f"{option} {value}: {valid_names(value, valid, 'valid values')}")
    return value


def shard_of(text: str | None) -> tuple[int, int]:
    """`2/4` as (2, 4); the whole is (1, 1)."""
    if text is None:
        return 1, 1
    number, _, of = text.partition("/")
    valid = number.isdecimal() and of.isdecimal() and 1 <= int(number) <= int(of)
    if not valid:
        raise InputError(f"--shard {text}: expected I/N with I from 1 to N, such as 2/4")
    return int(number), int(of)


def engine_of(name: str, jobs: int | None, address: str | None) -> Engine:
    """The engine of that name. address: of a Ray cluster that runs, None for one of our own."""
    choose(name, ENGINES, "--engine")
    if name == "ray":
        return RayEngine(jobs, address)
    if address is not None:
        raise InputError("--ray-address needs --engine ray")
    return LocalEngine(jobs or os.cpu_count() or 1)


def say_others(plan: Plan, store: Store) -> None:
    """Print how many rows of the folder are left out, and why."""
    for names, count in plan.wanted.others(store.rows.values()).items():
        rows = "1 row is" if count == 1 else f"{count} rows are"
        typer.echo(f"{rows} left out: {' and '.join(names)} changed since", err=True)


def keep_plan(plan: Plan, store: Store) -> None:
    """Note in the folder which episodes it is to hold, beside those that it already was."""
    plan.wanted.united(Wanted.read(store.folder)).write(store.folder)


def say_missing(missing: Sequence[str]) -> None:
    """Print which episodes have no row."""
    if missing:
        typer.echo(f"missing: {'; '.join(missing)}; the same command goes on there", err=True)


def say_refused(ended: Ended) -> None:
    """Print which episodes could not begin."""
    for row in ended.refused[-1:]:
        notice(
            f"{len(ended.refused)} episodes could not begin; of seed {row['seed']}: {row['output']}"
        )
