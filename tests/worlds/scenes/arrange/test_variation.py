"""What `reset` draws stays within what is allowed, and leaves the job possible."""

import math
from functools import cache
from itertools import combinations
from pathlib import Path

import pytest
from momantu_worlds.scenes.arrange.floor import around, stand_pose, stand_zone
from momantu_worlds.scenes.arrange.layout import Layout
from momantu_worlds.scenes.arrange.obstacles import fixed_rectangles, footprint, wall_rectangles
from momantu_worlds.scenes.arrange.spots import (
    Disc,
    SetDown,
    free_spots,
    lane,
    seen_share,
    tag_points,
)
from momantu_worlds.scenes.arrange.spots import outline_points as body_points
from momantu_worlds.scenes.arrange.variation import vary
from momantu_worlds.scenes.catalogue.tags import picture_edge
from momantu_worlds.scenes.file.reader import parse_world
from momantu_worlds.scenes.geometry.plane import Rectangle, gap, passages
from momantu_worlds.scenes.loading import draw_episode, load_world

from momantu_bt.geometry import Pose2D, wrap_angle
from momantu_bt.world import WorldError

WORLD = load_world("four_rooms")
SEEDS = range(30)
ROUNDING = 1e-9


@cache
def layout(seed: int) -> Layout:
    return vary(WORLD, seed)


def discs(drawn: Layout, table: str) -> list[Disc]:
    return [
        Disc(t.at.x, t.at.y, t.thing.reach, t.thing.height)
        for t in drawn.things
        if t.table == table
    ]


def between(a: Disc, b: Disc) -> float:
    return math.hypot(a.x - b.x, a.y - b.y) - a.radius - b.radius


def item_disc(drawn: Layout) -> Disc:
    at = drawn.object("can").at
    return Disc(at.x, at.y, WORLD.item.radius, WORLD.item.height)


def obstacles(drawn: Layout) -> list[Rectangle]:
    return [
        *wall_rectangles(WORLD),
        *(footprint(WORLD, p.piece, p.pose) for p in drawn.pieces),
        *(Rectangle(t.pose, t.size) for t in drawn.tables.values()),
    ]


@pytest.mark.parametrize("seed", [0, 7, 123456])
def test_a_seed_gives_the_same_layout_again(seed):
    assert vary(WORLD, seed) == vary(WORLD, seed)


def test_seeds_differ():
    assert len({(layout(s).object("can").at.x, layout(s).start.yaw) for s in SEEDS}) == len(SEEDS)


@pytest.mark.parametrize("seed", SEEDS)
def test_tables_stay_within_their_shift_turn_and_lift(seed):
    for name, placed in layout(seed).tables.items():
        told, nominal = WORLD.tables[name], Pose2D(*WORLD.tables[name].at)
        assert abs(placed.pose.x - nominal.x) <= 0.10 + ROUNDING
        assert abs(placed.pose.y - nominal.y) <= 0.10 + ROUNDING
        assert abs(wrap_angle(placed.pose.yaw - nominal.yaw)) <= math.radians(5) + ROUNDING
        assert abs(placed.height - told.size[2]) <= 0.03 + ROUNDING


@pytest.mark.parametrize("seed", SEEDS)
def test_item_and_tag_stay_whole_on_their_tables(seed):
    drawn = layout(seed)
    corner = picture_edge(WORLD.tag.edge) / math.sqrt(2)
    for told, at, radius in (
        (WORLD.item, drawn.object("can").at, WORLD.item.radius),
        (WORLD.tag, drawn.tag("tag").at, corner),
    ):
        half_x, half_y = (edge / 2 for edge in WORLD.tables[told.on].size[:2])
        assert abs(at.x) + radius <= half_x + ROUNDING
        assert abs(at.y) + radius <= half_y + ROUNDING
        assert abs(at.x - told.at[0]) <= told.shift + ROUNDING
        assert abs(at.y - told.at[1]) <= told.shift + ROUNDING


@pytest.mark.parametrize("seed", SEEDS)
def test_things_keep_their_gaps(seed):
    drawn = layout(seed)
    for table, told in WORLD.tables.items():
        here = discs(drawn, table)
        assert len(here) <= WORLD.distractors.most
        assert all(between(a, b) >= WORLD.distractors.gap for a, b in combinations(here, 2))
        for disc in here:
            assert abs(disc.x) + disc.radius < told.size[0] / 2
            assert abs(disc.y) + disc.radius < told.size[1] / 2
    item = item_disc(drawn)
    assert all(between(item, d) >= WORLD.distractors.gap_to_item for d in discs(drawn, "table_a"))


@pytest.mark.parametrize("seed", SEEDS)
def test_no_other_can_is_like_the_item(seed):
    item = WORLD.item
    for placed in layout(seed).things:
        if placed.thing.kind == "can":
            width, _, height = placed.thing.size
            off = max(abs(width / (2 * item.radius) - 1), abs(height / item.height - 1))
            assert off > 0.20


@pytest.mark.parametrize("seed", SEEDS)
def test_the_item_is_seen_and_a_hand_gets_to_it(seed):
    drawn, side = layout(seed), WORLD.tables["table_a"].sides[0]
    item, here = item_disc(drawn), discs(drawn, "table_a")
    assert seen_share(body_points(item), here, drawn.tables["table_a"], side, item) >= 0.5
    assert lane(item, here, side)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_tag_is_seen_whole_and_a_spot_remains_beside_it(seed):
    drawn, side = layout(seed), WORLD.tables["table_b"].sides[0]
    here, corner = discs(drawn, "table_b"), picture_edge(WORLD.tag.edge) / math.sqrt(2)
    tag_at = drawn.tag("tag").at
    tag = Disc(tag_at.x, tag_at.y, corner, 0.0)
    assert all(between(tag, disc) >= 0 for disc in here)
    table = drawn.tables["table_b"]
    assert seen_share(tag_points(tag_at, corner), here, table, side, tag) == 1.0
    item = WORLD.item
    wanted = SetDown(item.radius, item.height, WORLD.goal.distance, side)
    assert free_spots(wanted, table, here, tag_at)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_start_is_near_free_and_told_roughly(seed):
    drawn, told = layout(seed), WORLD.start
    assert abs(drawn.start.x - told.at[0]) <= 0.5
    assert abs(drawn.start.y - told.at[1]) <= 0.5
    assert all(gap(around(drawn.start, told.clear), o) > 0 for o in obstacles(drawn))
    assert drawn.believed_start.distance_to(drawn.start) <= 0.3 + ROUNDING
    turned = wrap_angle(drawn.believed_start.yaw - drawn.start.yaw)
    assert abs(turned) <= math.radians(15) + ROUNDING


@pytest.mark.parametrize("seed", SEEDS)
def test_furniture_moves_a_little_and_extras_keep_out_of_the_way(seed):
    drawn = layout(seed)
    known = {p.name: p for p in drawn.pieces if p.known}
    assert set(known) == set(WORLD.furniture)
    moved = [n for n, p in known.items() if p.pose != WORLD.furniture[n].pose]
    assert len(moved) <= WORLD.unknown.moved.most
    for name in moved:
        assert WORLD.furniture[name].moves
        assert abs(known[name].pose.x - WORLD.furniture[name].pose.x) <= 0.2
        assert abs(known[name].pose.y - WORLD.furniture[name].pose.y) <= 0.2
    extras = [p for p in drawn.pieces if not p.known]
    assert WORLD.unknown.extra.least <= len(extras) <= WORLD.unknown.extra.most
    for extra in extras:
        own = footprint(WORLD, extra.piece, extra.pose)
        others = [o for o in obstacles(drawn) if o.pose != extra.pose]
        assert all(gap(own, other) >= 0.15 for other in others)
        for table in drawn.tables.values():
            assert gap(own, stand_zone(table, WORLD.unknown.stand)) > 0


@pytest.mark.parametrize("seed", SEEDS)
def test_a_disc_still_gets_everywhere(seed):
    drawn = layout(seed)
    floor = WORLD.floor
    grid = passages(obstacles(drawn), floor.center, floor.size, 0.45, cell=0.05)
    reached = grid.reachable((drawn.start.x, drawn.start.y))
    stops = [door.at for door in WORLD.doorways.values()]
    for table in drawn.tables.values():
        stand = stand_pose(table)
        stops.append((stand.x, stand.y))
    assert all(reached[grid.index(stop)] for stop in stops)


def test_over_many_seeds_everything_that_may_vary_does():
    drawn = [layout(seed) for seed in SEEDS]
    counts = {len(discs(d, "table_a")) for d in drawn}
    assert counts == {0, 1, 2, 3, 4}
    kinds = {t.thing.kind for d in drawn for t in d.things}
    assert kinds == {"can", "bottle", "box", "mug", "bowl"}
    assert {len([p for p in d.pieces if not p.known]) for d in drawn} >= {1, 2, 3}
    assert any(p.pose != WORLD.furniture[p.name].pose for d in drawn for p in d.pieces if p.known)
    assert len({d.light.ambient for d in drawn}) == len(drawn)


def test_an_episode_names_every_body_once_and_holds_the_goal():
    for seed in (0, 1, 2):
        episode = draw_episode("four_rooms", seed)
        names = [body.name for body in episode.bodies]
        assert len(set(names)) == len(names)
        assert {"can", "tag", "table_a", "table_b", "floor"} <= set(names)
        assert episode.goal is not None
        assert episode.body("can").friction <= 1.0
        with pytest.raises(KeyError, match="no body 'cup'; bodies: floor"):
            episode.body("cup")


def test_the_site_of_an_episode_tells_nothing_but_the_file_and_a_rough_start():
    first, second = (draw_episode("four_rooms", seed).site for seed in (0, 1))
    assert first.surfaces == second.surfaces
    assert first.places == second.places
    assert first.start != second.start
    assert first.surfaces["table_a"].map_from_surface == Pose2D(*WORLD.tables["table_a"].at)


def test_a_world_that_a_robot_cannot_pass_is_refused():
    narrow = WORLD.model_copy(update={"unknown": WORLD.unknown.model_copy(update={"passage": 0.9})})
    with pytest.raises(WorldError) as told:
        vary(narrow, 0)
    assert "a disc of 0.9 m radius does not get from the start through the doorway" in str(
        told.value
    )
    assert "to the front of 'table_b'" in str(told.value)
    assert "write passage: 40 cm in `unknown`, or move what stands in the way" in str(told.value)


BLOCKED = """
momantu_world: 1
name: study
rooms: {study: {corner: [0, 0], size: [5, 4]}}
tables:
  desk: {kind: desk, at: [2.5, 3.5, -90 deg], size: [0.8, 1.6, 0.72], sides: [0 deg]}
furniture:
  seat: {kind: chair, at: [2.3, 2.7, 90 deg]}
  plant: {kind: plant, at: [0.5, 0.5, 0 deg], moves: true}
start: {at: [2.5, 1.2, 90 deg]}
unknown: {moved: {most: 1}}
site: {places: {home: [2.5, 1.2, 90 deg]}}
"""


def test_what_stands_in_the_way_is_named():
    with pytest.raises(WorldError) as told:
        vary(parse_world(BLOCKED, Path("study.yaml")), 0)
    assert "to the front of 'desk'" in str(told.value)
    assert str(told.value).endswith("move what stands in the way: seat")
    vary(parse_world(BLOCKED.replace("[2.3, 2.7", "[4.3, 2.7"), Path("study.yaml")), 0)


@pytest.mark.parametrize(("door", "disc"), [(1.0, 0.4), (0.8, 0.35), (0.7, 0.3), (0.3, None)])
def test_a_world_that_names_no_disc_keeps_the_widest_that_its_doors_let_through(write, door, disc):
    rooms = {name: {"corner": [x, 0], "size": [4, 4]} for name, x in (("a", 0), ("b", 4))}
    sofa = {"kind": "sofa", "at": [2, 3.3, "-90 deg"], "moves": True}
    path = write(
        rooms=rooms,
        doors={"middle": {"at": [4, 2], "width": door, "clear": 0.5}},
        furniture={"sofa": sofa},
        unknown={"moved": {"least": 1, "most": 1}, "shift": 1.5},
    )
    if disc is None:
        with pytest.raises(WorldError, match=r"0\.2 m radius .* 'middle'; move what stands"):
            vary(load_world(path), 0)
        return
    layouts = [vary(load_world(path), seed) for seed in range(10)]
    assert any(drawn.pieces[0].pose != Pose2D(*drawn.pieces[0].piece.at) for drawn in layouts)
    world = load_world(path)
    for (sofa,) in (drawn.pieces for drawn in layouts):
        blocks = [*fixed_rectangles(world), footprint(world, sofa.piece, sofa.pose)]
        grid = passages(blocks, (4, 2), (9, 5), disc, cell=0.05)
        assert grid.reachable((1, 1))[grid.index((4, 2))]


def test_a_start_inside_a_sofa_is_refused():
    at = WORLD.furniture["sofa_south_west"].at
    inside = WORLD.model_copy(
        update={"start": WORLD.start.model_copy(update={"at": at, "shift": 0.0})}
    )
    with pytest.raises(WorldError, match="no free place to start"):
        vary(inside, 0)
