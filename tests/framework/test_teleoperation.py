"""Commands of a person: they grow old, and a service brings them to skills."""

from __future__ import annotations

import pytest

from momantu_bt.teleoperation import DEAD_MAN, STANDING, Command, OperatorService, operated_by
from momantu_bt.testing import ScriptedRobot, assert_service


@pytest.mark.parametrize(
    ("age", "counts"), [(0.0, True), (DEAD_MAN, True), (DEAD_MAN + 0.05, False), (60.0, False)]
)
def test_a_command_counts_for_a_moment(age, counts):
    given = Command(3.0, 0.5, 0.2, (0.1, 0, 0, 0, 0, 0), {"lift": 0.1}, 0.0, stop=True)
    then = given.at(3.0 + age)
    assert (then == given) is counts
    if not counts:
        assert (then.linear, then.angular, then.hand) == (0.0, 0.0, STANDING)
        assert (dict(then.joints), then.opening, then.stop) == ({}, None, False)


def test_who_has_left_has_left_for_ever():
    assert Command(3.0, ended=True).at(99.0).ended


def test_as_installed_nobody_is_at_the_controls():
    service = OperatorService()
    service.update(ScriptedRobot(), 0.0)
    assert service.command is None
    assert_service(OperatorService)


def test_the_service_asks_its_source_at_each_update():
    class Clockwork:
        def command(self, now):
            return Command(now, linear=now)

    service = operated_by(Clockwork())()
    for now in (0.05, 0.1):
        service.update(ScriptedRobot(), now)
        assert service.command == Command(now, linear=now)
