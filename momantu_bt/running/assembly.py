"""Puts a run together: the robot with its services, and a tree that is ready to be ticked."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from momantu_bt.engine.blackboard import Board, ReadOnlyCell
from momantu_bt.engine.build import build
from momantu_bt.engine.context import RunContext
from momantu_bt.engine.events import Events
from momantu_bt.engine.executor import Executor, Stepper
from momantu_bt.engine.skills.actuators import Actuators
from momantu_bt.engine.skills.body import Body
from momantu_bt.engine.skills.services import Services, each_once
from momantu_bt.engine.watchdog import Watchdog
from momantu_bt.errors import PLUGIN_ERRORS, words_of
from momantu_bt.faults.stage import Stage
from momantu_bt.frames import FrameBuffer
from momantu_bt.robot import Robot
from momantu_bt.running.needed import LaunchError
from momantu_bt.running.options import RunOptions
from momantu_bt.running.prepare import Prepared
from momantu_bt.service import Service
from momantu_bt.skill import Skill
from momantu_bt.tree.check.root_keys import ROBOT_KEY
from momantu_bt.tree.model import Document
from momantu_bt.values.convert import natural
from momantu_bt.world_plugins import NoWorld


@dataclass(frozen=True, slots=True)
class Setting:
    """What the trees of a run act in. services: not started until a tree begins."""

    context: RunContext
    services: Services
    stage: Stage
    stepper: Stepper


def set_up(
    options: RunOptions,
    stage: Stage,
    called: Mapping[str, type[Skill]],
    needed: Mapping[str, type[Service]],
    events: Events,
) -> Setting:
    """What all nodes of a run share.

    called: the skills that skills call, by name. needed: the services in their order.
    """
    stepper = stage.world if stage.world is not None else NoWorld()
    context = RunContext(
        stepper,
        seed=options.seed,
        person=options.person,
        watchdog=Watchdog(options.patience),
        events=events,
    )
    if stage.robot is None or stage.site is None:
        return Setting(context, Services({}, None), stage, stepper)
    actuators = Actuators(stage.robot, events)
    services = Services(each_once(needed, made), actuators)
    frames = FrameBuffer(stage.robot.description.kinematics())
    callable_skills = {name: stage.skill(kind) for name, kind in called.items()}
    site = stage.site.of_a_run()
    if any(kind.charts for kind in needed.values()):
        site = site.uncharted()
    context.body = Body(actuators, frames, site, services.running, callable_skills)
    return Setting(context, services, stage, stepper)


def program(prepared: Prepared, setting: Setting, kinds: Mapping[str, type[Skill]]) -> Executor:
    """A tree that is ready to be ticked. kinds: its skills by name."""
    document, options, substitution = prepared.document, prepared.options, prepared.substitution
    context, services, stage = setting.context, setting.services, setting.stage
    board = _board(context, document, services, stage.robot)
    for key, value in substitution.values.items():
        board.cell(key).store(natural(value))
    skills = {name: stage.skill(kind) for name, kind in kinds.items()}
    built = build(document, context, skills.__getitem__, board, substitution)
    stage.direct(built, context, document)
    return Executor(
        built,
        context,
        setting.stepper,
        world=stage.world,
        services=services,
        max_time=options.max_time,
        realtime=options.realtime,
    )


def made(name: str, kind: type[Service]) -> Service:
    """An instance of a service; LaunchError if its constructor raises."""
    try:
        return kind()
    except PLUGIN_ERRORS as error:  # a plug-in's code, which may raise anything
        raise LaunchError(
            f"the service {name!r} cannot be made: {words_of(error)}",
            hint="Tell its authors, or leave out the skills that need it.",
        ) from error


def _board(
    context: RunContext, document: Document, services: Services, robot: Robot | None
) -> Board:
    """The root's board as it is at the first tick."""
    board = Board(context.writes)
    for name in services.running:
        board.publish(ReadOnlyCell(name, _asking(context, name, partial(services.published, name))))
    if robot is not None:
        board.publish(ReadOnlyCell(ROBOT_KEY, _asking(context, ROBOT_KEY, robot.state)))
    for key, literal in document.values.items():
        board.cell(key).store(natural(literal.value))
    return board


def _asking(context: RunContext, key: str, ask: Callable[[], Any]) -> Callable[[], Any]:
    return lambda: context.ask(key, ask)
