"""Worlds that somebody else writes: every section alone, and what follows from it."""

import math
import re

import numpy as np
import pytest
from momantu_worlds.scenes.arrange.variation import vary
from momantu_worlds.scenes.geometry.solids import outline
from momantu_worlds.scenes.geometry.support import SupportTop
from momantu_worlds.scenes.loading import draw_episode, load_world, nominal_site
from momantu_worlds.scenes.site.floor_plan import FREE, OCCUPIED, UNKNOWN, cells_of, draw_plans

from momantu_bt.descriptions.reading import DescriptionError
from momantu_bt.geometry import Pose2D
from momantu_bt.world import WorldError

ROOM = {"hall": {"corner": [0, 0], "size": [6, 5]}}
DESK = {"kind": "desk", "at": [4, 4, "-90 deg"], "size": [0.8, 1.6, 0.72], "sides": ["180 deg"]}
RACK = {"kind": "shelf", "at": [5.6, 2, 3.14159], "size": [0.4, 1.2, 1.2], "boards": [0.1, 0.5, 1]}
SEEDS = range(12)


def names(episode):
    return [body.name for body in episode.bodies]


def test_the_least_world_is_a_floor_and_a_start(write):
    episode = draw_episode(write(), 0)
    assert names(episode) == ["floor"]
    assert episode.goal is None
    assert (episode.start.x, episode.start.y) == (1.0, 1.0)
    assert len(episode.suns) == 1


def test_the_floor_lies_under_everything_unless_it_is_told(write):
    around = load_world(write(rooms=ROOM))
    (floor,) = (b for b in draw_episode(around.file, 0).bodies if b.name == "floor")
    x, y, _ = floor.parts[0].geometry.size
    assert x > 6
    assert y > 5
    told = write(rooms=ROOM, floor={"center": [3, 2], "size": [20, 30]})
    (floor,) = (b for b in draw_episode(told, 0).bodies if b.name == "floor")
    assert floor.parts[0].geometry.size[:2] == (20, 30)


def test_a_board_is_a_surface_and_a_body_of_its_own(write):
    path = write(
        rooms=ROOM,
        furniture={"rack": RACK},
        tables={"middle": {"board_of": "rack", "board": 2, "sides": [0]}},
    )
    episode = draw_episode(path, 0)
    board, rack = episode.body("middle"), episode.body("rack")
    surface = episode.site.surfaces["middle"]
    top = SupportTop(board).surface(board.map_from_body)
    assert surface.height == pytest.approx(0.5)
    assert float(top.position[2]) == pytest.approx(0.5)
    assert top.position[:2] == pytest.approx(
        [surface.map_from_surface.x, surface.map_from_surface.y]
    )
    assert SupportTop(board).size == surface.size
    boards = [p for p in rack.parts if p.body_from_part.position[2] == pytest.approx(0.485)]
    assert not boards
    assert len(rack.parts) == 3 + 2


def test_boards_move_with_their_shelf(write):
    shelf = {**RACK, "shift": "10 cm", "turn": "5 deg"}
    path = write(
        furniture={"rack": shelf},
        tables={
            "low": {"board_of": "rack", "board": 1, "sides": [0]},
            "high": {"board_of": "rack", "board": 3, "sides": [0]},
        },
    )
    world, poses = load_world(path), set()
    for seed in SEEDS:
        drawn = vary(world, seed)
        (rack,) = drawn.pieces
        poses.add((rack.pose.x, rack.pose.y))
        assert math.dist((rack.pose.x, rack.pose.y), RACK["at"][:2]) <= 0.15
        own = rack.pose.inverse() @ drawn.tables["low"].pose
        assert (own.x, own.y, own.yaw) == pytest.approx((0.005, 0.0, 0.0), abs=1e-9)
        assert drawn.tables["low"].above == pytest.approx(0.5 - 0.03 - 0.1)
        assert drawn.tables["high"].above == math.inf
    assert len(poses) == len(SEEDS)


def test_things_on_boards_fit_below_the_next_board(write):
    path = write(
        furniture={"rack": {**RACK, "boards": [0.1, 0.35, 1.0]}},
        tables={"low": {"board_of": "rack", "board": 1, "sides": [0]}},
        distractors={"most": 4},
    )
    world = load_world(path)
    things = [t.thing.height for seed in range(30) for t in vary(world, seed).things]
    assert things
    assert max(things) < 0.35 - 0.03 - 0.1


def test_objects_stand_on_one_of_their_tables_and_apart(write):
    other = {**DESK, "at": [2, 4, "-90 deg"]}
    cup = {"kind": "mug", "on": ["desk", "other"]}
    path = write(
        rooms=ROOM,
        tables={"desk": DESK, "other": other},
        objects={f"cup_{i}": cup for i in range(4)},
    )
    world, used = load_world(path), set()
    for seed in SEEDS:
        drawn = vary(world, seed)
        used |= {o.table for o in drawn.objects}
        for a in drawn.objects:
            assert abs(a.at.x) + a.thing.reach <= 0.4
            assert abs(a.at.y) + a.thing.reach <= 0.8
            for b in drawn.objects:
                if a is not b and a.table == b.table:
                    apart = a.at.distance_to(b.at) - a.thing.reach - b.thing.reach
                    assert apart >= 0.01
    assert used == {"desk", "other"}


def test_what_is_not_told_of_an_object_is_drawn_and_the_rest_kept(write):
    told = {"kind": "can", "on": "desk", "at": [0, 0.2], "radius": "30 mm", "height": "10 cm"}
    path = write(
        tables={"desk": DESK},
        objects={
            "told": {**told, "mass": "200 g", "yaw": "90 deg", "turn": 0, "color": [0.1, 0.2, 0.3]},
            "drawn": {"kind": "box", "on": "desk", "at": [0, -0.4]},
        },
    )
    world = load_world(path)
    first, second = vary(world, 1), vary(world, 2)
    kept = first.object("told")
    assert kept.thing.size == pytest.approx((0.06, 0.06, 0.1))
    assert (kept.thing.mass, kept.thing.color) == (0.2, (0.1, 0.2, 0.3))
    assert kept.at == Pose2D(0.0, 0.2, math.pi / 2)
    assert second.object("told").at == kept.at
    assert first.object("drawn").thing.size != second.object("drawn").thing.size
    assert vary(world, 1) == first


def test_a_hung_tag_looks_where_it_is_told(write):
    path = write(tags={"sign": {"id": 4, "edge": "20 cm", "hung": [1, 2, 1.5, "90 deg"]}})
    tag = draw_episode(path, 3).body("sign")
    x, y, z = tag.map_from_body.rotation.T
    assert z == pytest.approx([0, 1, 0], abs=1e-9)
    assert y == pytest.approx([0, 0, 1], abs=1e-9)
    # seen from before it, with its face looking along y, right is towards -x
    assert x == pytest.approx([-1, 0, 0], abs=1e-9)
    assert tag.map_from_body.position == pytest.approx([1, 2, 1.5], abs=1e-3)


def test_bodies_have_their_parts_where_they_are_told(write):
    path = write(
        bodies={
            "post": {
                "at": [2, 1, 0, 0, 0, "90 deg"],
                "parts": [
                    {"box": [1, 2, 3], "at": [0.5, 0, 1.5]},
                    {"cylinder": {"radius": "10 cm", "height": 1}, "visual": False},
                    {"sphere": 0.2, "at": [0, 0, 2], "collision": False},
                ],
            },
            "ball": {"static": False, "mass": "1 kg", "parts": [{"sphere": 0.1}], "at": [0, 0, 1]},
        },
        start={"at": [-3, 0, 0]},
    )
    episode = draw_episode(path, 0)
    post = episode.body("post")
    box = post.parts[0]
    middle = post.map_from_body @ box.body_from_part
    assert middle.position == pytest.approx([2, 1.5, 1.5])
    assert [(p.visual, p.collision) for p in post.parts] == [
        (True, True),
        (False, True),
        (True, False),
    ]
    assert not episode.body("ball").static
    points = outline(episode.body("ball").parts[0])
    assert np.linalg.norm(points, axis=1) == pytest.approx(np.full(len(points), 0.1))


def test_the_top_of_a_body_is_a_surface_where_the_file_says(write):
    path = write(
        bodies={
            "bench": {
                "at": [3, 2, 0, 0, 0, "30 deg"],
                "parts": [{"cylinder": {"radius": 0.5, "height": 0.6}, "at": [0, 0, 0.3]}],
                "surface": {"at": [3, 2, 0], "size": [0.6, 0.6], "height": 0.6, "sides": [0]},
            }
        },
        objects={"cup": {"kind": "mug", "on": "bench", "at": [0.1, 0]}},
    )
    episode = draw_episode(path, 0)
    bench = episode.body("bench")
    top = SupportTop(bench).surface(bench.map_from_body)
    assert top.position == pytest.approx([3, 2, 0.6])
    assert top.yaw == pytest.approx(0.0)
    assert episode.body("cup").map_from_body.position == pytest.approx([3.1, 2, 0.6])
    assert episode.site.surfaces["bench"].height == 0.6


def test_fixed_lights_are_as_they_are(write):
    sun = {"direction": [0, 0, -1], "color": [1, 1, 0.9]}
    path = write(light={"suns": [sun], "bulbs": [{"at": [1, 2, 3], "color": [5, 5, 5]}]})
    first, second = draw_episode(path, 0), draw_episode(path, 1)
    assert first.suns == second.suns
    assert len(first.suns) == 1
    assert first.lamps == second.lamps
    assert first.lamps[0].position == (1, 2, 3)


def test_a_start_may_be_turned_little_and_a_tight_one_is_refused(write):
    turned = [draw_episode(write(start={"at": [1, 1, 1], "turn": 0.2}), s).start for s in SEEDS]
    assert all(abs(start.yaw - 1) <= 0.2 for start in turned)
    assert len({start.yaw for start in turned}) == len(SEEDS)
    crowded = write(rooms={"cell": {"corner": [0, 0], "size": [1, 1]}}, start={"at": [0.5, 0.5, 0]})
    with pytest.raises(WorldError, match=r"no free place to start .* start\.clear"):
        draw_episode(crowded, 0)
    small = {"at": [0.5, 0.5, 0], "clear": 0.3}
    draw_episode(write(rooms={"cell": {"corner": [0, 0], "size": [1, 1]}}, start=small), 0)


def test_a_goal_may_be_beside_nothing(write):
    path = write(
        tables={"desk": DESK, "other": {**DESK, "at": [4, 1, 0]}},
        objects={"cola": {"kind": "can", "on": "desk"}},
        goal={"item": "cola", "on": "other"},
        distractors={"most": 3},
    )
    goal = draw_episode(path, 0).goal
    assert (goal.item, goal.support, goal.marker) == ("cola", "other", None)
    assert goal.max_tilt == pytest.approx(math.radians(5))


def at(plan, x, y):
    return plan.levels[cells_of(plan, x, y)]


def test_the_map_has_rooms_doors_and_bodies_at_the_height_of_the_laser(write):
    door = {"at": [3, 0], "width": 1}
    path = write(
        rooms={**ROOM, "annexe": {"corner": [0, 5], "size": [2, 2]}},
        doors={"out": door, "shut": {"at": [1, 5], "closed": True}},
        bodies={
            "low": {"parts": [{"box": [0.5, 0.5, 0.2]}], "at": [1.5, 2.5, 0.1]},
            "tilted": {"parts": [{"box": [0.1, 0.1, 2]}], "at": [4, 2, 0.7, "45 deg", 0, 0]},
            "hanging": {"parts": [{"sphere": 0.3}], "at": [5, 4, 1.2]},
            "loose": {
                "static": False,
                "mass": 1,
                "parts": [{"box": [0.4, 0.4, 1]}],
                "at": [3, 4, 0.5],
            },
        },
    )
    plan, overhang = draw_plans(load_world(path), (0.3, 0.3), 1.4)
    assert at(plan, 3, 0) == FREE
    assert at(plan, 1, 5) == OCCUPIED
    assert at(plan, 1, 6) == FREE
    assert at(plan, 4, 6) == UNKNOWN
    assert at(plan, 1.5, 2.5) == FREE
    assert at(overhang, 1.5, 2.5) == OCCUPIED
    # turned by 45 deg about x, its part at 0.3 m lies 0.4 m towards +y
    assert at(plan, 4, 2.4) == OCCUPIED
    assert at(plan, 4, 2) == FREE
    assert at(overhang, 4, 2) == OCCUPIED
    assert at(overhang, 5, 4) == OCCUPIED
    assert at(plan, 3, 4) == FREE
    assert at(overhang, 3, 4) == FREE


def test_a_band_of_heights_meets_what_reaches_into_it(write):
    box = {"parts": [{"box": [0.5, 0.5, 0.2]}], "at": [2.5, 2.5, 0.7]}
    world = load_world(write(rooms=ROOM, bodies={"shelf": box}))
    assert at(draw_plans(world, (0.3, 0.3), 1.4)[0], 2.5, 2.5) == FREE
    assert at(draw_plans(world, (0.3, 0.65), 1.4)[0], 2.5, 2.5) == OCCUPIED
    assert at(draw_plans(world, (0.1, 0.55), 1.4)[0], 2.5, 2.5) == FREE


def test_a_map_without_end_is_refused(write):
    wide = {"far": {"corner": [0, 0], "size": [500, 500]}}
    world = load_world(write(rooms=wide, site={"resolution": "2 cm"}))
    with pytest.raises(WorldError, match=r"make site.resolution coarser"):
        draw_plans(world, (0.3, 0.3), 1.4)


def test_a_floor_without_end_is_refused(write):
    far = {"post": {"parts": [{"sphere": 0.1}], "at": [9000, 0, 0.1]}}
    with pytest.raises(WorldError, match="m wide; at most 500 m"):
        draw_episode(write(bodies=far), 0)


def test_the_site_has_services_and_its_kept_form_keeps_them(write):
    told = {"localization": {"particles": [300, 3000], "beams": 40}}
    site = nominal_site(load_world(write(site={"services": told, "places": {"home": [1, 1, 0]}})))
    assert site.services == told
    assert site.places["home"] == Pose2D(1, 1, 0)


MAP = """image: {}
resolution: 0.05
origin: [-1, -1, 0]
occupied_thresh: 0.65
free_thresh: 0.196
"""


@pytest.mark.parametrize(
    ("picture", "said"),
    [
        (None, "there is no file 'plan.yaml' beside the world file"),
        (b"", "plan.pgm"),
        (b"P5\n2 2\n255\n" + bytes(4), "the map 'plan.yaml' has no free cell"),
        (b"P5\n2 2\n255\n" + bytes([205] * 4), "the map 'plan.yaml' has no free cell"),
    ],
)
def test_a_map_that_tells_no_free_floor_is_refused_at_its_line(write, tmp_path, picture, said):
    path = write(site={"map": "plan.yaml"})
    if picture is not None:
        (tmp_path / "plan.yaml").write_text(MAP.format("plan.pgm"))
        (tmp_path / "plan.pgm").write_bytes(picture)
    with pytest.raises(DescriptionError, match=said) as told:
        load_world(path)
    assert re.search(r"world\.yaml:\d+:\d+", str(told.value))
    (tmp_path / "plan.yaml").write_text(MAP.format("plan.pgm"))
    (tmp_path / "plan.pgm").write_bytes(b"P5\n2 2\n255\n" + bytes([254] * 4))
    path.write_text(path.read_text() + "\n")
    assert load_world(path).site.map == "plan.yaml"
