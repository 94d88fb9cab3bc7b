"""Services are found by what they offer, whatever they are called."""

from __future__ import annotations

from momantu_bt.service import KnowsHeld, Localization, PlanningScene, offers


class Hand:
    """Knows what is held, and refuses to say so."""

    @property
    def held(self) -> None:
        raise RuntimeError("nothing may be asked yet")


class Empty:
    def __init__(self) -> None:
        self.held = None


def test_what_a_service_offers_is_told_without_asking_it() -> None:
    assert offers(Hand(), KnowsHeld)
    assert offers(Empty(), KnowsHeld)
    assert not offers(Hand(), PlanningScene)
    assert not offers(object(), Localization)
