"""Bodies whose origin is not in their foot, as the files of others have it."""

from __future__ import annotations

from dataclasses import replace

from momantu_worlds.scenes.geometry.bodies import Body

from momantu_bt.geometry import Transform


def with_foot(body: Body, body_from_foot: Transform) -> Body:
    """The same body, whose origin was its foot, with its origin elsewhere."""
    parts = tuple(
        replace(part, body_from_part=body_from_foot @ part.body_from_part) for part in body.parts
    )
    at = body.map_from_body @ body_from_foot.inverse()
    return replace(body, map_from_body=at, parts=parts, foot=body_from_foot)
