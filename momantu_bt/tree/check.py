"""The checker: everything that is wrong with a document, at once, before the first tick."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import replace

from momantu_bt.descriptions.reading import DescriptionError
from momantu_bt.messages import RobotState
from momantu_bt.plugin_files import near_file
from momantu_bt.plugins import ROBOTS, WORLDS, PluginError
from momantu_bt.tree.catalogue import ScriptText
from momantu_bt.tree.check_codes import check_handlers
from momantu_bt.tree.check_guards import check_guards
from momantu_bt.tree.check_keys import check_keys
from momantu_bt.tree.check_nodes import check_node, check_tree_ports
from momantu_bt.tree.check_trees import (
    callees_first,
    check_given_names,
    check_nesting,
    check_parallel,
    check_unused,
    reached,
)
from momantu_bt.tree.keys import Key, literal_type
from momantu_bt.tree.model import Document, Literal, Node, Place, Reference, Scope, Tree
from momantu_bt.tree.named_world import world_of
from momantu_bt.tree.problems import Problem, Problems, TooManyProblems, valid_names
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.script import parse
from momantu_bt.tree.signatures import Context
from momantu_bt.world import WorldError

ROBOT_KEY = "robot"
"""`$@robot.…`: what every run publishes of its robot."""


def check(
    document: Document,
    registry: Registry,
    *,
    world: str | None = None,
    robot: str | None = None,
    reading: Problems | None = None,
) -> list[Problem]:
    """Check a document; on the way names the ports of bare values (`reset_pose: home`).

    world, robot: named on the command line, instead of the file's and the world's own.
    reading: problems that reading the file has found; they come back with the rest.

    Returns: errors, warnings and hints in the order of the file.
    """
    problems = reading if reading is not None else Problems()
    with suppress(TooManyProblems):  # the last of them says that there are more
        _check(Context(_concerned(document), registry, problems), world, robot)
    return problems.sorted()


def _concerned(document: Document) -> Document:
    """The document without included trees that neither its main tree nor an own one runs.

    They are checked where they are run, and with the file that they stand in.
    """
    trees, file = document.trees, document.file
    starts = [n for n, tree in trees.items() if n == document.main or tree.place.file == file]
    kept = reached(document, starts)
    return replace(document, trees={name: tree for name, tree in trees.items() if name in kept})


def _check(context: Context, world: str | None, robot: str | None) -> None:
    document = context.document
    if document.main not in document.trees:
        message = "no tree is left to run: those that there are cannot be read"
        context.problems.error("no-trees", _start(document), message, "see the other problems")
        return
    _look_up(context, world, robot)
    for tree in document.trees.values():
        check_tree_ports(context, tree)
        _check_tree_name(context, tree)
        for node in tree.root.walk():
            check_node(context, node)
        check_given_names(context, tree)
    check_unused(context)
    shallow = [check_nesting(context, tree) for tree in document.trees.values()]
    order = callees_first(context)
    if order is not None and all(shallow):
        check_parallel(context, order)
        check_handlers(context, order)
        check_guards(context, order, frozenset({ROBOT_KEY, *context.registry.services}))
        check_keys(context, order, _root_keys(context))


def _look_up(context: Context, world: str | None, robot: str | None) -> None:
    """The world's site and the robot's description; reports where there are none."""
    name = world_of(context.document, world)
    if name is not None:
        place = context.document.world_place if world is None else None
        default = _look_up_world(context, name, place or _start(context.document))
        robot = robot or default
    if robot is not None:
        _look_up_robot(context, robot)


def _look_up_world(context: Context, name: str, place: Place) -> str | None:
    """Sets the context's site; returns the robot that the world is meant for."""
    worlds = context.registry.worlds
    if name not in worlds:
        hint = near_file(WORLDS, name) or valid_names(name, worlds, "worlds")
        context.problems.error("unknown-world", place, f"no world is called {name!r}", hint)
        return None
    try:
        entry = worlds[name]
        context.site = entry.site()
        return entry.default_robot
    except (PluginError, DescriptionError) as error:
        context.problems.error("broken-world", place, str(error))
        return None
    except Exception as error:  # a plug-in's code, which may raise anything
        message = f"the world {name!r} cannot be read: {type(error).__name__}: {error}"
        context.problems.error("broken-world", place, message)
        return None


def _look_up_robot(context: Context, name: str) -> None:
    robots, place = context.registry.robots, _start(context.document)
    if name not in robots:
        hint = near_file(ROBOTS, name) or valid_names(name, robots, "robots")
        context.problems.error("unknown-robot", place, f"no robot is called {name!r}", hint)
        return
    try:
        context.description = context.registry.description(name)
    except (PluginError, DescriptionError) as error:
        context.problems.error("broken-robot", place, str(error))
    except WorldError as error:
        # its files are not installed, as without the extra [worlds]; trees are checked all the same
        message = f"poses and actuators of {name!r} are not checked: {error}"
        context.problems.warning("robot-not-installed", place, message)
    except Exception as error:  # a plug-in's code, which may raise anything
        message = f"the robot {name!r} cannot be read: {type(error).__name__}: {error}"
        context.problems.error("broken-robot", place, message)


def _start(document: Document) -> Place:
    return Place(document.file, 1, 1)


def _check_tree_name(context: Context, tree: Tree) -> None:
    if tree.name in context.registry.skills:
        message = f"{tree.name!r} is the name of a skill"
        context.problems.error("bad-name", tree.place, message, "give the tree another name")


def _root_keys(context: Context) -> Mapping[str, Key | None]:
    """Every name that `$@name` can mean; what is known of a value that nothing overwrites."""
    document = context.document
    names: dict[str, Key | None] = dict.fromkeys(context.registry.services)
    names[ROBOT_KEY] = Key(RobotState, _start(document))
    for name, value in document.values.items():
        place = document.value_places.get(name, _start(document))
        names[name] = Key(literal_type(value), place, (value,))
    for tree in document.trees.values():
        for node in tree.root.walk():
            for scope, key, makes in _written_by(context, node):
                on_root = scope is Scope.ROOT or tree.name == document.main
                if on_root and (makes or key in names):
                    names[key] = None
    return names


def _written_by(context: Context, node: Node) -> Iterator[tuple[Scope, str, bool]]:
    """Keys that a node's outputs and scripts write: board, key, whether it may be a new one."""
    signature = context.signature(node)
    ports = signature.ports if signature is not None else {}
    scripts = list(node.conditions.values())
    for name, value in node.ports.items():
        port = ports.get(name)
        if port is not None and port.direction != "in" and isinstance(value, Reference):
            yield value.scope, value.key, True
        elif port is not None and port.type is ScriptText and isinstance(value, Literal):
            scripts.append(str(value.value))
    for script in scripts:
        parsed = parse(script)
        needed = {variable.key for variable in parsed.needs}
        for variable in parsed.writes:
            scope = Scope.ROOT if variable.key.startswith("@") else Scope.LOCAL
            yield scope, variable.key.removeprefix("@"), variable.key not in needed


__all__ = ["ROBOT_KEY", "check"]
