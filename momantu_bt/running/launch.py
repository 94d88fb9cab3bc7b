"""Runs a checked document: opens the world, builds the tree, runs it, closes everything."""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from typing import TextIO, TypeAlias

from momantu_bt import collector
from momantu_bt.engine.build import skills_in
from momantu_bt.engine.context import Remarked
from momantu_bt.engine.ending import ERROR
from momantu_bt.engine.events import Events
from momantu_bt.engine.executor import Executor, Observer
from momantu_bt.engine.interrupts import Interrupts
from momantu_bt.errors import PLUGIN_ERRORS, MomantuError, words_of
from momantu_bt.faults.stage import Planned, Stage, plan
from momantu_bt.lacking import lacking, lacks_text
from momantu_bt.record.recorder import Recorder
from momantu_bt.record.report import Report
from momantu_bt.robot import RobotDescription
from momantu_bt.running.assembly import program, set_up
from momantu_bt.running.audit import Auditor
from momantu_bt.running.calls import called_skills, check_calls
from momantu_bt.running.goal import give_goal, undenied
from momantu_bt.running.leftovers import Leftovers
from momantu_bt.running.needed import LaunchError, check_parameters, check_sensors, services_of
from momantu_bt.running.options import RunOptions
from momantu_bt.running.prepare import Prepared
from momantu_bt.running.reporting import report_of
from momantu_bt.running.told import off_the_map
from momantu_bt.service import Service
from momantu_bt.skill import Skill
from momantu_bt.tree.check.named_world import world_of
from momantu_bt.tree.model import Document
from momantu_bt.tree.registry import Registry
from momantu_bt.world import MeasuredWorld, Site, World, WorldError

Watch: TypeAlias = Callable[[Executor], Sequence[Observer]]


def launch(
    prepared: Prepared,
    watch: Watch | None = None,
    streams: tuple[TextIO, TextIO] | None = None,
) -> Report:
    """Run a checked tree to its end.

    watch: makes the observers after the world was opened; they are closed at the end. streams:
    standard output and error as they should be after the run, if a display replaces them now.

    Raises:
        LaunchError: a tree with skills has no world, a service is not installed, the robot lacks
            something that a skill uses, or the patience is not above 0.
        FaultError: the tree, the robot or the world cannot have a requested fault.
        OutputError: the record's folder cannot be written, or holds a record already.
        WorldError: the world could not start.
        KeyboardInterrupt: Ctrl-C before the first tick.
    """
    begun = time.perf_counter()
    document, options = prepared.document, prepared.options
    if not options.patience > 0.0:
        raise LaunchError(f"a patience of {options.patience} s; expected more than 0, or inf")
    with collector.paused(), ExitStack() as stack:
        interrupts = stack.enter_context(Interrupts())
        executor, stage, recorder = _assembled(prepared, stack)
        remarks: list[str] = []
        executor.context.events.subscribe(Remarked, lambda event: remarks.append(event.text))
        leftovers = Leftovers(streams)
        auditor = Auditor(executor.context, executor.world) if options.audit else None
        observers = [] if watch is None else list(watch(executor))
        leftovers.expect_threads()
        if recorder is not None:
            recorder.begin(document, executor, options.recorded(), prepared.substitution.source)
        for observer in observers:
            executor.show_to(observer)
        if executor.services.running:
            options.stage(f"starting the services {', '.join(executor.services.running)}")
        started = time.perf_counter() - begun
        with executor.context.watchdog:
            ending = executor.run(interrupts)
        if executor.world is not options.world:
            ending = undenied(ending, document)
        interrupts.begin_again()
        trouble = _close(observers)
        for left in leftovers.told():
            executor.context.remark(left)
        if trouble is not None:
            ending = replace(ending, status=ERROR, error=ending.error or trouble)
        report = report_of(document.file, executor, ending, started, stage.reports())
        if auditor is not None:
            report = replace(report, claims=auditor.claims())
        report = replace(report, remarks=tuple(remarks))
        return report if recorder is None else _recorded(report, recorder, options)


def _recorded(report: Report, recorder: Recorder, options: RunOptions) -> Report:
    """Write the report into the record; its `lost` names a record that broke off."""
    whole = report
    broken = replace(report, lost=(*report.lost, str(options.record)))
    recorder.finish(broken if recorder.broken else whole)
    return broken if recorder.broken else whole


def assemble(prepared: Prepared, stack: ExitStack) -> Executor:
    """Build a run that the caller ticks: call `begin`, then `tick` until it ends, or `stop`.

    stack: everything that is opened here is closed with it.

    Raises:
        LaunchError, FaultError, OutputError, WorldError: as `launch` does.
    """
    return _assembled(prepared, stack)[0]


def _assembled(prepared: Prepared, stack: ExitStack) -> tuple[Executor, Stage, Recorder | None]:
    document, options, registry = prepared.document, prepared.options, prepared.registry
    options.stage("loading the skills")
    kinds = {name: registry.skills[name] for name in skills_in(document, prepared.substitution)}
    called = called_skills(kinds, registry)
    needed = services_of(prepared, {**called, **kinds})
    planned = _planned(prepared, kinds)
    events = Events()
    recorder = _recorder(options, events, stack)
    events.subscribe(Remarked, lambda event: options.remark(event.text))
    world = open_world(prepared, kinds, called, needed)
    if world is not None:
        if world is not options.world:
            stack.callback(_close_world, world, options.remark)
        check_parameters(needed, world.site)
    stage = Stage(planned, world, options.seed, stack, site_of(prepared, world))
    setting = set_up(options, stage, called, needed, events)
    return program(prepared, setting, kinds), stage, recorder


def site_of(prepared: Prepared, world: World | None) -> Site | None:
    """What the robot is told; None without a world."""
    if world is None:
        return None
    site = world.site
    if prepared.options.measured_start and isinstance(world, MeasuredWorld):
        site = replace(site, start=world.start, start_sigma=(0.0, 0.0))
    if prepared.told is None:
        return site
    site = prepared.told.of(site)
    if (doubt := off_the_map(prepared.told, site.start)) is not None:
        prepared.options.remark(doubt)
    return site


def _close_world(world: World, remark: Callable[[str], None]) -> None:
    """Close a world; its own errors no longer change how the run ended."""
    try:
        world.close()
    except PLUGIN_ERRORS as error:
        remark(f"the world {world.name} could not be closed: {words_of(error)}")


def _recorder(options: RunOptions, events: Events, stack: ExitStack) -> Recorder | None:
    if options.record is None:
        return None
    recorder = Recorder(options.record, events, lambda text: events.publish(Remarked(text)))
    stack.callback(recorder.release)
    return recorder


def _planned(prepared: Prepared, kinds: Mapping[str, type[Skill]]) -> tuple[Planned, ...]:
    document, options = prepared.document, prepared.options
    with_world = world_of(document, options.world_name) is not None
    return plan(options.faults, document, kinds, prepared.substitution, with_world=with_world)


def _close(observers: Sequence[Observer]) -> str | None:
    """Close all observers, even if one raises; return the first traceback."""
    troubles: list[str] = []
    for observer in observers:
        try:
            observer.close()
        except BaseException:  # a signal too: the run is over, its report is still to be written
            troubles.append(traceback.format_exc())
    return troubles[0] if troubles else None


def open_world(
    prepared: Prepared,
    kinds: Mapping[str, type[Skill]],
    called: Mapping[str, type[Skill]],
    needed: Mapping[str, type[Service]],
) -> World | None:
    """Open a run's world; None for a tree without one.

    Raises:
        LaunchError, CallError: the robot lacks what skills or services need, or there is no world.
        WorldError: the world could not start.
    """
    options, registry = prepared.options, prepared.registry
    check_world(prepared.document, options.world_name, kinds, registry)
    name = world_of(prepared.document, options.world_name)
    if name is None:
        return None
    entry = registry.worlds[name]
    description = registry.description(options.robot or entry.default_robot)
    options.stage(f"opening the world {name} with the robot {description.name}")
    _check_robot({**called, **kinds}, registry, description)
    check_calls({**called, **kinds}, registry, description)
    check_sensors(needed, description)
    try:
        world = entry.open(description, options.seed, referee=options.referee)
        if options.referee:
            give_goal(world, prepared.document)
        return world
    except MomantuError:
        raise
    except PLUGIN_ERRORS as error:  # a plug-in's code, which may raise anything
        message = f"the world {name!r} could not start: {words_of(error)}"
        raise WorldError(message, hint="Tell its authors, or choose another world.") from error


def check_world(
    document: Document, asked: str | None, skills: Iterable[str], registry: Registry
) -> None:
    """Check that a tree with skills has a world to run in.

    asked: the world to use instead of the tree's own. skills: names of the tree's skills.

    Raises:
        LaunchError: the tree has skills but no world.
    """
    names = ", ".join(skills)
    if names and world_of(document, asked) is None:
        raise LaunchError(
            f"{document.main} needs a world for {names}; worlds: "
            f"{', '.join(registry.worlds) or 'none'}; give one with --world"
        )


def _check_robot(
    kinds: Mapping[str, type[Skill]], registry: Registry, description: RobotDescription
) -> None:
    for name, kind in kinds.items():
        lacks = tuple(lacking(kind, registry.services, description))
        if lacks:
            raise LaunchError(lacks_text(name, lacks, description))
