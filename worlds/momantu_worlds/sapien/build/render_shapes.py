"""The visual shapes of parts, in SAPIEN."""

from __future__ import annotations

from typing import Any

import numpy as np
import sapien
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_worlds.sapien.build.meshes import collision_mesh
from momantu_worlds.sapien.poses import transform_of
from momantu_worlds.scenes.geometry.bodies import Box, Cylinder, Hull, Mesh, Part, Picture, Sphere

SLACK = 0.01
"""How far outside a picture texture coordinates may lie, in pictures, before the texture is
repeated as tiles."""
GAMMA = 2.2
"""Gamma of given colours, which are screen colours; the shader computes with linear light."""


def render_shape(part: Part) -> Any:
    """The render shape of a part, around its own origin."""
    geometry = part.geometry
    if isinstance(geometry, Box):
        half = [edge / 2 for edge in geometry.size]
        return sapien.render.RenderShapeBox(half, _plain(part))
    if isinstance(geometry, Cylinder):
        return sapien.render.RenderShapeCylinder(geometry.radius, geometry.height / 2, _plain(part))
    if isinstance(geometry, Sphere):
        return sapien.render.RenderShapeSphere(geometry.radius, _plain(part))
    if isinstance(geometry, Picture):
        return _picture(geometry)
    if isinstance(geometry, Mesh):
        return _mesh(geometry, part)
    if isinstance(geometry, Hull):
        return _mesh(Mesh(*collision_mesh(geometry)), part)
    raise TypeError(f"a {type(geometry).__name__} cannot be shown")


def drawn_vertices(shape: Any) -> list[Array]:
    """Vertices (n, 3) of each part of a render shape, in the frame that it is attached to, m.

    SAPIEN stores boxes, cylinders and spheres as unit shapes.
    """
    from_shape = transform_of(shape.local_pose)
    scale = _scale(shape)
    return [from_shape.apply(np.asarray(part.vertices) * scale) for part in shape.parts]


def _scale(shape: Any) -> Array:
    render = sapien.render
    if isinstance(shape, render.RenderShapeBox):
        return np.asarray(shape.half_size, dtype=np.float64)
    if isinstance(shape, render.RenderShapeCylinder):
        return np.array([shape.half_length, shape.radius, shape.radius])
    if isinstance(shape, render.RenderShapeSphere):
        return np.full(3, float(shape.radius))
    return np.asarray(getattr(shape, "scale", (1.0, 1.0, 1.0)))


def _plain(part: Part) -> Any:
    color = [channel**GAMMA for channel in part.color]
    return sapien.render.RenderMaterial(base_color=[*color, 1.0])


def _textured(pixels: NDArray[np.uint8], beyond: str = "edge") -> Any:
    """A material with a texture (h, w, 3) of screen colours.

    beyond: colour outside the picture, "edge" (its last row or column) or "repeat".
    """
    alpha = np.full((*pixels.shape[:2], 1), 255, dtype=np.uint8)
    texture = sapien.render.RenderTexture2D(
        np.ascontiguousarray(np.concatenate([pixels, alpha], axis=2)),
        "r8g8b8a8unorm",
        mipmap_levels=1,
        filter_mode="linear",
        address_mode=beyond,
        srgb=True,
    )
    material = sapien.render.RenderMaterial()
    material.set_base_color_texture(texture)
    return material


def _picture(picture: Picture) -> Any:
    """Two triangles that carry a texture; the picture's first row lies at +y."""
    x, y = picture.size[0] / 2, picture.size[1] / 2
    vertices = np.array([[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]], dtype=np.float32)
    normals = np.tile(np.array([0, 0, 1], dtype=np.float32), (4, 1))
    uvs = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], dtype=np.float32)
    triangles = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.uint32)
    return sapien.render.RenderShapeTriangleMesh(
        vertices, triangles, normals, uvs, _textured(picture.pixels)
    )


def _mesh(mesh: Mesh, part: Part) -> Any:
    """A mesh with its texture or the part's colour; shared vertices are shaded smoothly."""
    vertices = np.asarray(mesh.vertices, dtype=np.float64)
    uv, material = np.zeros((len(vertices), 2)), _plain(part)
    if mesh.uv is not None and mesh.texture is not None:
        # a mesh's v counts from its picture's last row, the renderer's from the first
        tiled = mesh.uv.min() < -SLACK or mesh.uv.max() > 1.0 + SLACK
        uv = np.array([0.0, 1.0]) + mesh.uv * (1.0, -1.0)
        material = _textured(mesh.texture, "repeat" if tiled else "edge")
    return sapien.render.RenderShapeTriangleMesh(
        vertices.astype(np.float32),
        np.asarray(mesh.triangles).astype(np.uint32),
        _smooth_normals(vertices, np.asarray(mesh.triangles)).astype(np.float32),
        uv.astype(np.float32),
        material,
    )


def _smooth_normals(vertices: Array, triangles: NDArray[Any]) -> Array:
    """Unit normal of each vertex: the area-weighted mean of its triangles' normals."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    faces = np.cross(b - a, c - a)
    normals = np.zeros_like(vertices)
    for i in range(3):
        np.add.at(normals, triangles[:, i], faces)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.asarray(normals / np.maximum(lengths, 1e-12))
