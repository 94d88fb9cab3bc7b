"""Symptoms: the words that link a skill's failure codes with the faults that explain them.

A skill says of each of its failure codes what it is a symptom of (`Skill.symptoms`), and a kind of
fault which symptoms it has (`FaultKind.symptoms`). A code is a true reason to give up because of
a fault when the two share a symptom. So a new skill works with every fault, and a new fault with
every skill.
"""

from __future__ import annotations

from enum import StrEnum


class Symptom(StrEnum):
    """What has gone wrong, as far as the robot can tell."""

    NOT_SEEN = "not seen"
    """what should be there is not seen"""
    OBJECT_GONE = "object gone"
    """the object that is looked for is not where it should be"""
    MARKER_NOT_SEEN = "marker not seen"
    """the marker that is looked for is not seen"""
    OUTDATED = "outdated"
    """what was measured is not true any more"""
    NOT_LOCALIZED = "not localized"
    """the robot does not know where it is"""
    WAY_BLOCKED = "way blocked"
    """the base cannot get to where it should"""
    ARM_OFF_COURSE = "arm off course"
    """the arm, or the camera that is moved, does not get to where it should"""
    ARM_WAY_BLOCKED = "arm way blocked"
    """no way for the arm leads there"""
    HAND_STUCK = "hand stuck"
    """the hand does not open or close as it is told"""
    NOT_HELD = "not held"
    """what should be in the hand is not"""
    NO_GRASP = "no grasp"
    """the object cannot be grasped as it stands"""
    NO_ROOM = "no room"
    """there is no free spot for what is to be set down"""
    CANNOT_SET_DOWN = "cannot set down"
    """what is held cannot be set down on any free spot"""
    NO_CONTACT = "no contact"
    """nothing is felt where something should be"""
    TOPPLED = "toppled"
    """what was set down does not stand"""
    SLOW = "slow"
    """what should happen takes too long"""
