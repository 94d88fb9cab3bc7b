"""What a skill does, in a few words that faults use to choose their usual phase.

A skill names its activities (`Skill.activities`). A kind of fault names the activities that it
disturbs (`FaultKind.begins`). So a fault begins at the right moment with skills it does not know.
"""

from __future__ import annotations

from enum import StrEnum


class Activity(StrEnum):
    """Something that a skill does and that a fault can disturb; the value says it."""

    DRIVE = "drives somewhere"
    LOCALIZE = "finds out where the robot is"
    LOOK = "judges pictures"
    FIND_OBJECT = "looks for an object"
    FIND_MARKER = "looks for a marker"
    MEASURE_SURFACE = "measures a surface"
    GRASP = "grasps an object"
    REACH = "moves the arm towards an object"
    MOVE_ARM = "moves the arm into a pose"
    SET_DOWN = "sets down what is held"
    ANY = "runs: true of every skill, and not declared"
    ANSWER = "gives outputs: true of every skill that has some, and not declared"
