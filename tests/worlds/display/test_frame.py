"""One picture of a film holds the scene, the head camera and the tree."""

import numpy as np
import pytest
from momantu_worlds.display.frame import HEAD, HEIGHT, SCENE, WIDTH, compose

from momantu_bt.world import TreeLine

RED, BLUE = (200, 10, 10), (10, 10, 200)


def plain(rows: int, columns: int, color) -> np.ndarray:
    return np.full((rows, columns, 3), color, dtype=np.uint8)


@pytest.mark.parametrize("size", [(720, 800), (480, 640), (90, 300)])
def test_both_pictures_fill_their_places_whatever_their_size(size):
    picture = compose(plain(*size, RED), plain(*size, BLUE), [], "")
    assert picture.shape == (HEIGHT, WIDTH, 3)
    assert np.all(picture[:, : SCENE[0]] == RED)
    assert np.all(picture[: HEAD[1], SCENE[0] :] == BLUE)


def test_each_line_of_the_tree_is_written():
    lines = [TreeLine(0, "Bring", "RUNNING"), TreeLine(1, "pick → lift", "FAILURE")]
    images = (plain(9, 9, RED), plain(9, 9, BLUE))
    panels = [compose(*images, lines[:n], "1.0 s")[HEAD[1] :, SCENE[0] :] for n in (0, 1, 2)]
    inks = [int((panel.max(axis=2) > 60).sum()) for panel in panels]
    assert inks[0] < inks[1] < inks[2]
