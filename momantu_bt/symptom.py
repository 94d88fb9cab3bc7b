"""Symptoms: the words that link a skill's failure codes with the faults that explain them.

A skill names the symptoms of each of its failure codes (`Skill.symptoms`). A kind of fault names
its symptoms too (`FaultKind.symptoms`). A code is a true reason to give up because of
a fault when the two share a symptom. So a new skill works with every fault, and a new fault with
every skill.
"""

from __future__ import annotations

from enum import StrEnum


class Symptom(StrEnum):
    """What has gone wrong, as far as the robot can tell, in words."""

    NOT_SEEN = "what should be there is not seen"
    OBJECT_GONE = "the object that is looked for is not where it should be"
    MARKER_NOT_SEEN = "the marker that is looked for is not seen"
    OUTDATED = "what was measured is not true any more"
    NOT_LOCALIZED = "the robot does not know where it is"
    WAY_BLOCKED = "the base cannot get to where it should"
    ARM_OFF_COURSE = "the arm, or the camera that is moved, does not get to where it should"
    ARM_WAY_BLOCKED = "no way for the arm leads there"
    HAND_STUCK = "the hand does not open or close as it is told"
    NOT_HELD = "what should be in the hand is not"
    NO_GRASP = "the object cannot be grasped as it stands"
    NO_ROOM = "there is no free spot for what is to be set down"
    CANNOT_SET_DOWN = "what is held cannot be set down on any free spot"
    NO_CONTACT = "nothing is felt where something should be"
    TOPPLED = "what was set down does not stand"
    SLOW = "what should happen takes too long"
