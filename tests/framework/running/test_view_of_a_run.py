"""A view in a browser, of a run that a program starts."""

from __future__ import annotations

import pytest

from momantu_bt import run
from momantu_bt.errors import InputError
from momantu_bt.testing import ScriptedWorld

TREE = "momantu_bt: 1\ntrees: {Main: [{wait: 1 s}]}\n"


class _View:
    url = "http://localhost:1"

    def __init__(self) -> None:
        self.updates, self.closed = 0, False

    def update(self) -> None:
        self.updates += 1

    def close(self) -> None:
        self.closed = True


def test_the_view_follows_the_run_and_closes_with_it(monkeypatch: pytest.MonkeyPatch) -> None:
    view, world, asked = _View(), ScriptedWorld(), []
    monkeypatch.setattr(world, "open_view", lambda port: asked.append(port) or view)
    seen: list[object] = []

    def watch(executor: object) -> list[object]:
        seen.append(executor)
        return []

    report = run(TREE, world=world, view_port=8123, watch=watch)
    assert report.status == "SUCCESS"
    assert asked == [8123]
    assert view.updates > 0
    assert view.closed
    assert len(seen) == 1


def test_a_run_without_a_world_has_nothing_to_show() -> None:
    with pytest.raises(InputError, match="a view needs a world"):
        run(TREE, world="none", view_port=8123)
