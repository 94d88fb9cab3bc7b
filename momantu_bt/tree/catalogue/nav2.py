"""Nav2's control nodes, decorators and the condition that its trees are built with.

Names and ports are those of Nav2's behavior-tree plug-ins, so that its trees load once their
leaves are registered.
"""

from __future__ import annotations

from momantu_bt.tree.catalogue.spec import control, decorator, input_port, leaf, output_port

_GOALS = (
    input_port("goal", object, "the goal that is watched; $goal unless given", None),
    input_port("goals", object, "the goals that are watched; $goals unless given", None),
)
_GOAL_NAMES = ("goal", "goals")
SLOWEST = 0.001
"""Hz: the least of a rate, which one is divided by."""

_CONTROLS = (
    control(
        "RecoveryNode",
        "recovery_node",
        "Runs the first child; when it fails the second one, and then the first one again.",
        input_port(
            "number_of_retries", int, "how often the first child runs once more", 1, least=0
        ),
        least=2,
        most=2,
    ),
    control(
        "RoundRobin",
        "round_robin",
        "Starts with the next child each time; a child that fails hands on to the one after it.",
        input_port("wrap_around", bool, "after the last child comes the first", True),
    ),
    control(
        "PipelineSequence",
        "pipeline_sequence",
        "A sequence that goes on ticking the children it has passed, and waits for them no more.",
        concurrent=True,
    ),
    control(
        "NonblockingSequence",
        "nonblocking_sequence",
        "Ticks all children on each tick until all succeed in one.",
        concurrent=True,
    ),
    control(
        "PersistentSequence",
        "persistent_sequence",
        "A sequence that keeps its place on the blackboard.",
        input_port("current_child_idx", int, "the key that holds the place, from 0"),
        keys=("current_child_idx",),
    ),
)

_DECORATORS = (
    decorator(
        "RateController",
        "rate_controller",
        "Starts the child at most so often.",
        input_port("hz", float, "starts per second", 10.0, "Hz", least=SLOWEST),
    ),
    decorator(
        "DistanceController",
        "distance_controller",
        "Starts the child each time the robot has come so far.",
        input_port("distance", float, "how far", 1.0, "m", least=0),
        input_port("global_frame", str, "where it is measured", "odom"),
        input_port("robot_base_frame", str | None, "what is measured; the robot's base", None),
    ),
    decorator(
        "SpeedController",
        "speed_controller",
        "Starts the child the more often the faster the robot drives, and at a new goal.",
        input_port(
            "min_rate", float, "starts per second at the lowest speed", 0.1, "Hz", least=SLOWEST
        ),
        input_port(
            "max_rate", float, "starts per second at the highest speed", 1.0, "Hz", least=SLOWEST
        ),
        input_port("min_speed", float, "the lowest speed", 0.0, "m/s", least=0),
        input_port("max_speed", float, "the highest speed", 0.5, "m/s", least=0),
        *_GOALS,
        may_be_empty=_GOAL_NAMES,
    ),
    decorator(
        "SingleTrigger",
        "single_trigger",
        "Runs the child once, then fails until it is started anew.",
    ),
    decorator(
        "GoalUpdatedController",
        "goal_updated_controller",
        "Starts the child first and at each new goal.",
        *_GOALS,
        may_be_empty=_GOAL_NAMES,
    ),
    decorator(
        "GoalUpdater",
        "goal_updater",
        "Hands a goal on to the child; a goal from elsewhere would take its place.",
        input_port("input_goal", object, "the goal", None),
        input_port("input_goals", object, "the goals", None),
        output_port("output_goal", object, "the key that the child reads", None),
        output_port("output_goals", object, "the key that the child reads", None),
        may_be_empty=("input_goal", "input_goals"),
    ),
    decorator(
        "PathLongerOnApproach",
        "path_longer_on_approach",
        "Runs the child when a new path is much longer than the last, near its end.",
        input_port("path", tuple, "the path: a list of poses"),
        input_port("prox_len", float, "how near: the length of the last path", 3.0, "m", least=0),
        input_port("length_factor", float, "how much longer", 2.0, least=0),
    ),
)

_LEAVES = (
    leaf(
        "GoalUpdated",
        ("goal_updated",),
        "Succeeds when the goal has changed since the last time, fails when it has not.",
        *_GOALS,
        may_be_empty=_GOAL_NAMES,
    ),
)

NAV2 = (*_CONTROLS, *_DECORATORS, *_LEAVES)
"""All of them."""
