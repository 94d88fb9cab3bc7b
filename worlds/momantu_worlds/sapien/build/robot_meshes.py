"""A robot's mesh files in SAPIEN: those that cannot be read are told, with their links."""

from __future__ import annotations

from typing import Any

import sapien

from momantu_bt.world import WorldError

CURE = (
    "write it anew as STL, OBJ, DAE or GLB, or take it out of the robot's URDF; `momantu-bt robots "
    "check` says what else is wrong"
)


def built(builder: Any) -> Any:
    """The articulation of a builder whose base stands still.

    Its visual meshes are read now: SAPIEN would read them for the first picture, and fail there.

    Raises:
        WorldError: the file of a mesh cannot be read.
    """
    try:
        articulation = builder.build(fix_root_link=True)
    except RuntimeError as error:
        raise _named(builder, str(error)) or error from None
    for link in builder.link_builders:
        made = articulation.find_link_by_name(link.name)
        meshes = [record.filename for record in link.collision_records if record.filename]
        if meshes and len(made.get_collision_shapes()) < len(link.collision_records):
            raise _unreadable("collision", meshes[0], link.name)
        for shape in _drawn(made):
            try:
                shape.parts  # noqa: B018  # reads the file
            except RuntimeError:
                raise _unreadable("visual", shape.filename, link.name) from None
    return articulation


def _named(builder: Any, words: str) -> WorldError | None:
    """What is wrong, where SAPIEN's own words name the file of a visual mesh."""
    for link in builder.link_builders:
        for record in link.visual_records:
            if record.filename and record.filename in words:
                return _unreadable("visual", record.filename, link.name)
    return None


def _drawn(link: Any) -> list[Any]:
    """The render shapes of a link that come from files; none in a scene without a renderer."""
    body = link.entity.find_component_by_type(sapien.render.RenderBodyComponent)
    return [shape for shape in body.render_shapes if hasattr(shape, "filename")] if body else []


def _unreadable(role: str, file: str, link: str) -> WorldError:
    return WorldError(
        f"the {role} mesh {file} of the link {link!r} cannot be read as a mesh; {CURE}"
    )
