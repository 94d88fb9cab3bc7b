"""What a skill does, in a few words that faults use to choose their usual phase.

A skill says what it does (`Skill.activities`), and a kind of fault which activities it disturbs
(`FaultKind.begins`). So a fault begins at the right moment with skills that it does not know.
"""

from __future__ import annotations

from enum import StrEnum


class Activity(StrEnum):
    """Something that a robot does and that a fault can disturb."""

    DRIVE = "drive"
    """drives somewhere"""
    LOCALIZE = "localize"
    """finds out where the robot is"""
    LOOK = "see"
    """judges pictures, of whatever"""
    FIND_OBJECT = "find object"
    """looks for an object"""
    FIND_MARKER = "find marker"
    """looks for a marker"""
    MEASURE_SURFACE = "measure surface"
    """measures a surface"""
    GRASP = "grasp"
    """grasps an object"""
    REACH = "reach"
    """moves the arm towards an object"""
    MOVE_ARM = "move arm"
    """moves the arm into a pose"""
    SET_DOWN = "set down"
    """sets down what is held"""
    ANY = "any"
    """any skill does that; no skill declares it"""
    ANSWER = "answer"
    """any skill with outputs does that; no skill declares it"""
