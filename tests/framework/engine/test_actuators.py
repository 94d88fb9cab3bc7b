"""Who may command what, and that the end of ownership stops it."""

from __future__ import annotations

import pytest

from momantu_bt.engine.skills.actuators import Actuators, Issued
from momantu_bt.failure import Failure
from momantu_bt.messages import BaseVelocity, JointPositions
from momantu_bt.robot import CAMERA_CARRIER
from momantu_bt.testing import ScriptedRobot

FORWARD = BaseVelocity(0.1, 0.0)


@pytest.fixture
def book():
    return Actuators(ScriptedRobot())


def test_an_actuator_has_one_owner_until_that_ends(book):
    first, second = book.lease("first", {"base"}), book.lease("second", {"base"})
    first.command("base", FORWARD)
    with pytest.raises(Failure, match="belongs to first") as caught:
        second.command("base", FORWARD)
    assert caught.value.code == "ACTUATOR_BUSY"
    assert caught.value.value.data == {"actuator": "base", "owner": "first"}
    first.end()
    second.command("base", FORWARD)
    assert book.owner("base") == "second"


def test_a_refused_command_does_not_reach_the_robot(book):
    book.lease("first", {"base"}).command("base", FORWARD)
    with pytest.raises(Failure):
        book.lease("second", {"base"}).command("base", BaseVelocity(0.9, 0.0))
    assert [goal for _, _, goal in book.robot.commands] == [FORWARD]


def test_the_end_of_a_lease_stops_what_it_owned_once_and_nothing_else(book):
    lease = book.lease("both", {"base", "arm"})
    lease.command("base", FORWARD)
    lease.end()
    lease.end()
    assert book.issued == [Issued("base", FORWARD), Issued("base", None)]


def test_a_lease_reaches_only_what_is_declared(book):
    lease = book.lease("head", {CAMERA_CARRIER})
    lease.command("head", JointPositions(("pan",), (0.1,)))
    with pytest.raises(PermissionError, match="add 'base' to `uses`"):
        lease.command("base", FORWARD)
    with pytest.raises(PermissionError, match="declares nothing"):
        book.lease("service", ()).stop("base")


def test_an_actuator_that_the_robot_lacks_is_named(book):
    with pytest.raises(KeyError, match="wings"):
        book.lease("bird", {"wings"})
    with pytest.raises(KeyError, match="wings"):
        book.lease("bird", {"base"}).command("wings", FORWARD)


def test_stopping_all_stops_even_what_nobody_owns(book):
    book.lease("first", {"base"}).command("base", FORWARD)
    book.stop_all()
    assert book.owner("base") is None
    stopped = [issued.actuator for issued in book.issued if issued.goal is None]
    assert stopped == list(book.robot.description.actuators)
