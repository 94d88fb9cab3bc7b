"""Numbers of mapping in three dimensions, each with its unit and where it comes from."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class CloudConfig:
    """Settings of `CloudMapper`, measured by `benchmarks/mapping_3d.py`. Lengths in m."""

    nearest: float = 0.5
    """Points nearer to the lidar are left out: a robot's own parts, and mixed returns."""
    farthest: float = 25.0
    """Points farther away are left out: an error of 1 mrad moves them by 2.5 cm."""
    voxel: float = 0.15
    """Edge of the voxels of which one point each is matched: half the gap between rings at 8 m."""
    neighbours: int = 12
    """Points that tell how a surface lies around a point; rings are sparse, so not many fewer."""
    keyframe_way: float = 0.5
    """Way after which a turn is kept."""
    keyframe_turn: float = 0.35
    """Turning after which a turn is kept, rad."""
    local_keyframes: int = 10
    """Kept turns with which a new turn is matched: 5 m of way, so that a room is seen whole."""
    match_distance: float = 0.4
    """Distance within which points are paired: odometry is off by less within a turn."""
    match_share: float = 0.5
    """Share of paired points below which a match does not count; odometry then does."""
    match_correction: float = 0.025
    """Correction of odometry, m and rad, above which a match does not count: on a bare floor rings
    lie on rings, and a base that drives seems to stand. `match_slip` more per metre, or radian,
    since the last match: wheels slip."""
    match_slip: float = 0.25
    loop_way: float = 8.0
    """Way between two places of one loop, at least: nearer ones share a local map."""
    loop_near: float = 3.0
    """Distance between two places of one loop, at most: they see each other's surfaces."""
    loop_every: float = 1.5
    """Way between two loops that are looked for."""
    loop_uncertainty: float = 0.3
    """How far off a place may be without drift, and `loop_drift` more per metre driven."""
    loop_drift: float = 0.01
    loop_widest: float = 2.0
    """How far off a place is looked for at most."""
    loop_around: int = 3
    """Kept turns before and after a place with which a new one is compared."""
    loop_distance: float = 0.2
    """Distance within which points are paired in the end."""
    loop_share: float = 0.8
    """Least share of points paired then: the other side of a wall gives far fewer."""
    floor_reach: float = 6.0
    """Distance from the base within which the floor is fitted: farther rings meet it too flat."""
    floor_height: float = 0.1
    """Height above and below the base's origin within which points may be the floor's."""
    floor_points: int = 200
    """Fewest points that tell how the floor lies."""
    cloud_voxel: float = 0.05
    """Edge of the voxels of the cloud; each holds the mean of its points."""
    cloud_seen: int = 2
    """Kept turns that must have seen a voxel: what only one saw has passed by, or is noise."""
