"""The checker: everything that is wrong with a document, at once, before the first tick."""

from __future__ import annotations

from momantu_bt.tree.check_codes import check_handlers
from momantu_bt.tree.check_keys import check_keys
from momantu_bt.tree.check_nodes import check_node, check_tree_ports
from momantu_bt.tree.check_trees import (
    callees_first,
    check_given_names,
    check_nesting,
    check_parallel,
    check_unused,
)
from momantu_bt.tree.model import Document, Place, Reference, Scope, Tree
from momantu_bt.tree.problems import Problem, Problems, valid_names
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.signatures import Context
from momantu_bt.world import WorldError

NO_WORLD = "none"
"""As a world's name: run without one."""
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
    context = Context(document, registry, problems)
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
        check_keys(context, order, _root_keys(context))
    return problems.sorted()


def _look_up(context: Context, world: str | None, robot: str | None) -> None:
    """The world's site and the robot's description; reports where there are none."""
    document, registry = context.document, context.registry
    name = world or document.world
    place = document.world_place if world is None else None
    if name is not None and name != NO_WORLD:
        if name not in registry.worlds:
            hint = valid_names(name, registry.worlds, "worlds")
            message = f"no world is called {name!r}"
            context.problems.error("unknown-world", place or _start(document), message, hint)
        else:
            try:
                entry = registry.worlds[name]
                context.site = entry.site()
                robot = robot or entry.default_robot
            except Exception as error:  # a plug-in's code, which may raise anything
                message = f"the world {name!r} cannot be read: {type(error).__name__}: {error}"
                context.problems.error("broken-world", place or _start(document), message)
    if robot is None:
        return
    if robot not in registry.robots:
        hint = valid_names(robot, registry.robots, "robots")
        message = f"no robot is called {robot!r}"
        context.problems.error("unknown-robot", _start(document), message, hint)
        return
    try:
        context.description = registry.description(robot)
    except WorldError as error:
        # its files are not installed, as without the extra [worlds]; trees are checked all the same
        message = f"poses and actuators of {robot!r} are not checked: {error}"
        context.problems.warning("robot-not-installed", _start(document), message)
    except Exception as error:  # a plug-in's code, which may raise anything
        message = f"the robot {robot!r} cannot be read: {type(error).__name__}: {error}"
        context.problems.error("broken-robot", _start(document), message)


def _start(document: Document) -> Place:
    return Place(document.file, 1, 1)


def _check_tree_name(context: Context, tree: Tree) -> None:
    if tree.name in context.registry.skills:
        message = f"{tree.name!r} is the name of a skill"
        context.problems.error("bad-name", tree.place, message, "give the tree another name")


def _root_keys(context: Context) -> frozenset[str]:
    """Every name that `$@name` can mean."""
    document = context.document
    names = {*document.values, *context.registry.services, ROBOT_KEY}
    for tree in document.trees.values():
        for node in tree.root.walk():
            signature = context.signature(node)
            for port, value in node.ports.items():
                known = signature.ports.get(port) if signature is not None else None
                if not isinstance(value, Reference) or known is None or known.direction != "out":
                    continue
                if value.scope is Scope.ROOT or tree.name == document.main:
                    names.add(value.key)
    return frozenset(names)


__all__ = ["NO_WORLD", "ROBOT_KEY", "check"]
