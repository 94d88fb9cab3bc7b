"""What a mesh with a picture looks like where its coordinates leave the picture."""

import numpy as np
import pytest
from momantu_worlds.sapien.build.render_shapes import render_shape
from momantu_worlds.scenes.geometry.bodies import Mesh, Part

CORNERS = np.array([(0.0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
TRIANGLES = np.array([(0, 1, 2), (0, 2, 3)], dtype=np.int32)
PIXELS = np.zeros((4, 4, 3), dtype=np.uint8)


@pytest.mark.parametrize(("times", "mode"), [(1.0, "edge"), (3.0, "repeat"), (-1.0, "repeat")])
def test_a_picture_is_laid_again_and_again_like_tiles(times, mode):
    mesh = Mesh(CORNERS, TRIANGLES, times * CORNERS[:, :2], PIXELS)
    shape = render_shape(Part(mesh))
    assert shape.parts[0].material.base_color_texture.address_mode == mode
