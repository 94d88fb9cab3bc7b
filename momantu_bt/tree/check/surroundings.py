"""Finds the world and the robot with which a tree is checked."""

from __future__ import annotations

from momantu_bt.descriptions.reading import DescriptionError
from momantu_bt.errors import PLUGIN_ERRORS, words_of
from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import Place
from momantu_bt.importing import output_aside
from momantu_bt.plugins import PluginError
from momantu_bt.robots.plugins import ROBOTS
from momantu_bt.tree.catalogue import NODES
from momantu_bt.tree.check.goal import check_goal
from momantu_bt.tree.check.named_world import world_of
from momantu_bt.tree.check.root_keys import services_read
from momantu_bt.tree.check.signatures import Context
from momantu_bt.world import WorldError
from momantu_bt.world_plugins import WORLDS

WORLD_OPTION, ROBOT_OPTION = "--world", "--robot"
"""The file name that problems have if the command line is wrong."""


def look_up_surroundings(context: Context, world: str | None, robot: str | None) -> None:
    """Set the world's site and the robot's description; report if they cannot be found.

    world, robot: names or paths that replace the document's world and the world's default robot.
    """
    document = context.document
    name, start = world_of(document, world), Place(document.file, 1, 1)
    if name is not None:
        place = document.world_place or start
        default = _look_up_world(
            context, name, place if world is None else _told(WORLD_OPTION, world)
        )
        robot_place = start if robot is None else _told(ROBOT_OPTION, robot)
        robot = robot or default
    else:
        check_goal(context, None)
    if name is None and robot is not None:
        robot_place = _told(ROBOT_OPTION, robot)
    if robot is not None:
        _look_up_robot(context, robot, robot_place)


def _told(option: str, name: str) -> Place:
    """A place on the command line, for problems that are not in a file."""
    return Place(option, 1, 1, len(name))


def _look_up_world(context: Context, name: str, place: Place) -> str | None:
    """Set the context's site; return the world's default robot."""
    worlds = context.registry.worlds
    if name not in worlds:
        hint = WORLDS.near_file(name) or valid_names(name, worlds, "worlds")
        _error("unknown-world", context, place, name, f"no world is called {name!r}", hint)
        return None
    try:
        entry = worlds[name]
        with output_aside():
            context.site, context.entry = entry.site(), entry
            check_goal(context, entry)
            if _charts(context):
                context.site, context.entry = context.site.uncharted(), None
        return entry.default_robot
    except DescriptionError as error:
        _broken("broken-world", context, error)
    except PluginError as error:
        _error("broken-world", context, place, name, str(error))
    except PLUGIN_ERRORS as error:  # a plug-in's code, which may raise anything
        message = f"the world {name!r} cannot be read: {words_of(error)}"
        _error("broken-world", context, place, name, message)
    return None


def _charts(context: Context) -> bool:
    """Whether one of the services that skills need or the document reads makes its own map."""
    nodes = [node for tree in context.document.trees.values() for node in tree.root.walk()]
    kinds = [context.skill(node.type) for node in nodes if node.type not in NODES]
    asked = {need for kind in kinds if kind is not None for need in kind.needs}
    asked |= services_read(context, ((node, False) for node in nodes)).keys()
    for name in asked:
        try:
            if context.registry.services[name].charts:
                return True
        except (KeyError, PluginError, AttributeError):
            continue  # it is told elsewhere
    return False


def _look_up_robot(context: Context, name: str, place: Place) -> None:
    robots = context.registry.robots
    if name not in robots:
        hint = ROBOTS.near_file(name) or valid_names(name, robots, "robots")
        _error("unknown-robot", context, place, name, f"no robot is called {name!r}", hint)
        return
    try:
        context.description = context.registry.description(name)
    except DescriptionError as error:
        _broken("broken-robot", context, error)
    except PluginError as error:
        _error("broken-robot", context, place, name, str(error))
    except WorldError as error:
        # Its files are not installed, for example without the extra [worlds]; check the rest.
        message = f"poses and actuators of {name!r} are not checked: {error}"
        context.problems.warning("robot-not-installed", place, message)
    except PLUGIN_ERRORS as error:  # a plug-in's code, which may raise anything
        message = f"the robot {name!r} cannot be read: {words_of(error)}"
        _error("broken-robot", context, place, name, message)


def _error(
    code: str, context: Context, place: Place, name: str, message: str, hint: str = ""
) -> None:
    """Report a problem of a world or robot, in the file or on the command line that names it."""
    if place.file in (WORLD_OPTION, ROBOT_OPTION):
        context.document.source[place.file] = name
    context.problems.error(code, place, message, hint)


def _broken(code: str, context: Context, error: DescriptionError) -> None:
    """Report the problems of a file that describes a world or a robot, at their lines there."""
    file = str(error.path)
    context.document.source[file] = error.text
    for problem in error.problems:
        context.problems.error(code, problem.place, problem.message, problem.hint)
