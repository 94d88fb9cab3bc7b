"""What becomes of a world: bodies, masses, joints, the floor, lights, a robot, a site."""

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from momantu_worlds.scenes.file.reader import parse_world
from momantu_worlds.sdf.body.parts import MeshPart
from momantu_worlds.sdf.body.settling import DEEP, FLUSH
from momantu_worlds.sdf.deviations import Outcome
from momantu_worlds.sdf.errors import SdfError
from momantu_worlds.sdf.importing import import_world
from momantu_worlds.sdf.read.model import Box, Cylinder

GROUND = "<include><uri>model://ground_plane</uri></include>"
BALL = "<geometry><sphere><radius>0.05</radius></sphere></geometry>"
CAN = """<inertial><mass>{mass}</mass></inertial><collision name='c'><geometry><cylinder>
  <radius>0.03</radius><length>0.1</length></cylinder></geometry></collision>"""


def by_name(found):
    return {body.name: body for body in found.world.bodies}


def whats(found):
    return [deviation.what for deviation in found.deviations]


def read_back(found, tmp_path):
    """The world as the reader of world files has it."""
    found.write(tmp_path / "room.yaml")
    return parse_world((tmp_path / "room.yaml").read_text(), tmp_path / "room.yaml")


def test_a_visual_and_a_collision_that_fit_are_one_part(imported, box):
    found = imported(GROUND + box("crate", "1 2 3", "4 5 1.5 0 0 0.5"))
    (body,) = found.world.bodies
    (part,) = body.parts
    assert part.solid == Box((1, 2, 3))
    assert part.visual
    assert part.collision
    assert body.still
    assert body.at.position == pytest.approx([4, 5, 1.5])
    assert body.at.yaw == pytest.approx(0.5)
    assert len(found.deviations) == 0


POSE = st.tuples(*[st.floats(-5, 5)] * 3, *[st.floats(-3, 3)] * 3)


@settings(
    max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(st.lists(st.tuples(POSE, POSE, POSE), min_size=1, max_size=4), st.data())
def test_shapes_stand_where_they_stood_and_none_is_lost(sdf, tmp_path, shapes, data):
    """Model, link and shape have poses of their own; the written file has the same points.

    Only what is loose and begins a little in the floor is set on it.
    """
    models, expected = [], []
    tall = ((9, 9, 1, 0, 0, 0), (0,) * 6, (0,) * 6)
    shapes = [tall, *shapes]  # all others may lie below the floor
    for number, poses in enumerate(shapes):
        texts = [" ".join(f"{v:.9f}" for v in pose) for pose in poses]
        size = [data.draw(st.floats(0.1, 2)) for _ in range(3)]
        still = data.draw(st.booleans())
        models.append(
            f"<model name='m{number}'><static>{int(still)}</static><pose>{texts[0]}</pose>"
            f"<link name='l'><pose>{texts[1]}</pose><collision name='c'><pose>{texts[2]}</pose>"
            f"<geometry><box><size>{' '.join(map(str, size))}</size></box></geometry></collision>"
            "</link></model>"
        )
        points = corners(poses, size)
        low = float(points[:, 2].min())
        on_floor = not still and -DEEP < low <= -FLUSH
        expected.append(points - (0.0, 0.0, low) if on_floor else points)
    file = sdf("".join(models))
    found = import_world(file, tmp_path / "room.yaml")
    gone = sum(deviation.outcome is Outcome.DROPPED for deviation in found.deviations)
    world = read_back(found, tmp_path)
    written = [
        corners((note.at, part.at), part.box)
        for note in world.bodies.values()
        for part in note.parts
    ]
    assert len(written) + gone == len(expected)
    for points in written:
        assert any(np.abs(points - other).max() < 2e-5 for other in expected)


def corners(poses, size):
    from momantu_bt.geometry import Transform

    found = Transform()
    for pose in poses:
        found = found @ Transform.from_rpy(pose[:3], pose[3:])
    signs = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    return found.apply(np.array(signs) * size)


def test_masses_are_kept_and_joined_links_are_one_body(imported):
    found = imported(
        f"""{GROUND}<model name='tool'><pose>0 0 0.05 0 0 0</pose>
        <link name='a'>{CAN.format(mass=0.25)}</link>
        <link name='b'><pose>0 0 0.1 0 0 0</pose>{CAN.format(mass=0.5)}</link>
        <joint name='j' type='fixed'><parent>a</parent><child>b</child></joint></model>
        <model name='pair'><pose>1 0 0.05 0 0 0</pose><link name='a'>{CAN.format(mass=0.1)}</link>
        <link name='b'><pose>1 0 0 0 0 0</pose>{CAN.format(mass=0.2)}</link></model>"""
    )
    masses = {name: body.mass for name, body in by_name(found).items()}
    assert masses == {"tool": 0.75, "pair_a": 0.1, "pair_b": 0.2}
    assert len(by_name(found)["tool"].parts) == 2


DOOR = """<model name='cupboard'><pose>0 0 0.05 0 0 0</pose>
  <link name='box'>{}</link><link name='door'>{}</link>
  <joint name='hinge' type='revolute'><parent>box</parent><child>door</child></joint>{}</model>"""


def test_what_a_joint_moves_stays_where_it_is(imported):
    can = CAN.format(mass=1)
    found = imported(GROUND + DOOR.format(can, can, ""))
    (body,) = found.world.bodies
    assert body.still
    assert body.mass is None
    assert "a revolute joint" in whats(found)


def test_a_joint_to_the_world_holds_a_body(imported):
    inside = f"""{GROUND}<model name='sign'><link name='l'>{CAN.format(mass=1)}</link>
      <joint name='j' type='fixed'><parent>world</parent><child>l</child></joint></model>"""
    assert imported(inside).world.bodies[0].still


def test_joints_reach_through_frames_and_models(imported):
    inside = f"""{GROUND}<model name='m'><pose>0 0 0.05 0 0 0</pose>
      <frame name='f' attached_to='a'/>
      <link name='a'>{CAN.format(mass=1)}</link>
      <model name='n'><link name='b'>{CAN.format(mass=2)}</link></model>
      <joint name='j' type='fixed'><parent>f</parent><child>n::b</child></joint>
      <joint name='k' type='fixed'><parent>a</parent><child>nobody</child></joint></model>"""
    found = imported(inside)
    assert [body.mass for body in found.world.bodies] == [3]
    assert any("'nobody', which are not both there" in what for what in whats(found))


def test_what_cannot_be_touched_does_not_fall(imported):
    link = f"<link name='l'><visual name='v'>{BALL}</visual></link>"
    found = imported(f"{GROUND}<model name='ghost'>{link}</model>")
    assert found.world.bodies[0].still
    assert "it can move but not be touched" in whats(found)


ROBOT = """<model name='rover'><pose>3 2 0.1 0 0 1</pose><link name='base'>{}
  <sensor name='s' type='ray'/></link><link name='left'>{}</link><link name='right'>{}</link>
  <joint name='a' type='revolute'><parent>base</parent><child>left</child></joint>
  <joint name='b' type='revolute'><parent>base</parent><child>right</child></joint></model>"""


def test_a_robot_is_the_start(imported, box):
    found = imported(GROUND + box("crate", "1 1 1") + ROBOT.format(*[CAN.format(mass=1)] * 3))
    assert [body.name for body in found.world.bodies] == ["crate"]
    start = found.world.site.start
    assert (start.x, start.y, start.yaw) == pytest.approx((3, 2, 1))
    assert any("a robot" in what for what in whats(found))
    assert "where rover stood" in found.text


def test_a_moved_robot_starts_where_it_was_moved_to(imported, box):
    state = """<state><model name='rover'><pose>0 0 0 0 0 0</pose>
      <link name='base'><pose>5 6 0 0 0 -1</pose></link></model></state>"""
    robot = ROBOT.format(*[CAN.format(mass=1)] * 3)
    start = imported(GROUND + box("crate", "1 1 1") + robot + state).world.site.start
    assert (start.x, start.y, start.yaw) == pytest.approx((5, 6, -1))


@pytest.mark.parametrize(("mu", "kept"), [("0.5", 0.5), ("100", 1.0), ("0", 0.01), ("-1", 0.01)])
def test_friction_is_kept_within_what_is_possible(imported, box, mu, kept):
    surface = f"<surface><friction><ode><mu>{mu}</mu><mu2>{mu}</mu2></ode></friction></surface>"
    found = imported(GROUND + box("b", "1 1 1", "0 0 0.5 0 0 0", extra=surface))
    assert found.world.bodies[0].friction == kept
    assert bool(len(found.deviations)) == (mu != "0.5")


def test_the_floor_becomes_z_0(imported, box):
    plane = "<model name='g'><static>1</static><pose>0 0 0.7 0 0 0</pose>{}</model>"
    shape = "<geometry><plane/></geometry>"
    link = f"<link name='l'><collision name='c'>{shape}</collision><visual name='v'>{shape}"
    link += "<material><diffuse>0.1 0.2 0.3 1</diffuse></material></visual></link>"
    found = imported(plane.format(link) + box("b", "1 1 1", "0 0 1.2 0 0 0"))
    (body,) = found.world.bodies
    assert body.at.position == pytest.approx([0, 0, 0.5])
    assert found.world.ground.color == (0.1, 0.2, 0.3)
    assert "becomes z = 0" in next(iter(found.deviations)).instead


def test_a_wide_slab_is_the_floor_and_a_narrow_one_stands_on_it(imported, box):
    room = box("slab", "8 6 0.2", "0 0 0 0 0 0") + box("stage", "2 2 0.2", "1 1 0.2 0 0 0")
    found = imported(GROUND + room + box("wall", "8 0.1 2", "0 3 1.1 0 0 0"))
    bodies = by_name(found)
    assert set(bodies) == {"stage", "wall"}
    assert found.world.ground.height == pytest.approx(0.1)
    assert bodies["stage"].at.position[2] == pytest.approx(0.1)


def test_what_lies_flat_is_driven_over(imported, box):
    found = imported(
        GROUND + box("carpet", "2 1 0.02", "0 0 0.01 0 0 0") + box("b", "1 1 1", "3 0 0.5 0 0 0")
    )
    carpet = by_name(found)["carpet"].parts[0]
    assert carpet.visual
    assert not carpet.collision
    assert any("lies flat" in what for what in whats(found))


def test_planes_that_are_no_floor_end_somewhere(imported, tmp_path):
    shape = "<geometry><plane><normal>1 0 0</normal><size>2 3</size></plane></geometry>"
    inside = f"{GROUND}<model name='w'><static>1</static><pose>0 0 1.5 0 0 0</pose><link name='l'>"
    found = imported(f"{inside}<collision name='c'>{shape}</collision></link></model>")
    points = np.concatenate(list(found.world.bodies[0].hulls()))
    assert points[:, 0].max() == pytest.approx(0, abs=1e-9)
    assert points[:, 0].min() == pytest.approx(-0.01)
    assert any("plane that is not the floor" in what for what in whats(found))


def test_lights_are_carried_over(imported, box, tmp_path):
    lights = """<scene><ambient>0.5 0.5 0.5 1</ambient></scene>
      <light name='sun' type='directional'><pose>0 0 9 0 3.141592653589793 0</pose>
        <diffuse>0.5 0.6 0.7 1</diffuse><direction>0 0 1</direction></light>
      <light name='lamp' type='point'><pose>1 2 3 0 0 0</pose></light>
      <light name='off' type='point'><light_on>0</light_on></light>
      <light name='cone' type='spot'><pose>4 5 6 0 0 0</pose></light>"""
    found = imported(GROUND + lights + box("b", "1 1 1"))
    light = found.world.light
    ((direction, color),) = light.suns
    assert direction == pytest.approx((0, 0, -1), abs=1e-9)
    assert color == (0.5, 0.6, 0.7)
    assert [at for at, _ in light.bulbs] == [(1, 2, 3), (4, 5, 6)]
    assert sorted(whats(found)) == ["a light that is off", "a spot light"]
    assert read_back(found, tmp_path).light.ambient == (0.5, 0.5)


TABLE = """<model name='table'><static>1</static><pose>{} 0 0 0 0 0.3</pose><link name='l'>
  <collision name='c'><pose>0 0 0.7 0 0 0</pose><geometry><box><size>0.8 1.4 0.04</size></box>
  </geometry></collision><visual name='v'><pose>0 0 0.7 0 0 0</pose><geometry><box>
  <size>0.8 1.4 0.04</size></box></geometry></visual></link></model>"""


def walls(box):
    pieces = [(0, -3, 0), (0, 3, 0), (-4, 0, math.pi / 2), (4, 0, math.pi / 2)]
    return "".join(
        box(f"wall{n}", "8 0.1 2.5", f"{x} {y} 1.25 0 0 {yaw}")
        for n, (x, y, yaw) in enumerate(pieces)
    )


def test_a_site_is_proposed(imported, box, tmp_path):
    link = f"<link name='l'>{CAN.format(mass=0.4)}</link>"
    can = f"<model name='can'><pose>1 0.1 0.77 0 0 0</pose>{link}</model>"
    found = imported(GROUND + walls(box) + TABLE.format(1) + can)
    site = found.world.site
    assert list(site.surfaces) == ["table"]
    top = site.surfaces["table"].top
    assert top.height == pytest.approx(0.72)
    assert top.size == pytest.approx((0.8, 1.4), abs=1e-3)
    assert (top.pose.x, top.pose.y, top.pose.yaw) == pytest.approx((1, 0, 0.3), abs=1e-3)
    assert set(np.round(site.surfaces["table"].sides[:2], 2)) == {0.0, 3.14}
    assert site.objects == {"can": {"category": "can", "diameter": 0.06, "height": 0.1}}
    for pose in (site.start, *site.places.values()):
        assert abs(pose.x) < 3.6
        assert abs(pose.y) < 2.6
    assert math.hypot(site.start.x - 1, site.start.y) > 0.8
    world = read_back(found, tmp_path)
    assert world.bodies["table"].surface.height == pytest.approx(0.72)


def test_tops_that_nobody_can_use_are_not_proposed(imported, box):
    low, high = box("low", "1 1 0.2", "2 0 0.1 0 0 0"), box("high", "1 1 0.1", "0 2 1.5 0 0 0")
    thin = box("thin", "0.1 1 0.7", "2 2 0.35 0 0 0")
    shut = box("shut", "0.6 0.6 0.7", "-3.6 -2.6 0.35 0 0 0") + box(
        "lid", "0.6 0.6 0.2", "-3.6 -2.6 0.8 0 0 0"
    )
    found = imported(GROUND + walls(box) + low + high + thin + shut)
    assert set(found.world.site.surfaces) <= {"lid"}


def test_names_are_made_to_fit_and_never_meet(imported, box):
    inside = GROUND + box("Table (1)", "1 1 1") + box("table_1", "1 1 1", "3 0 0 0 0 0")
    inside += box("3rd", "1 1 1", "6 0 0 0 0 0") + box("Ü", "1 1 1", "9 0 0 0 0 0")
    assert [b.name for b in imported(inside).world.bodies] == [
        "table_1",
        "table_1_2",
        "body_3rd",
        "body",
    ]


def test_a_name_cannot_write_into_the_file(imported, box, tmp_path):
    found = imported(GROUND + box("a&#10;momantu_world: 7&#10;", "1 1 1"))
    assert read_back(found, tmp_path).momantu_world == 1


def test_a_scaled_state_scales_shapes(imported, box):
    state = "<state><model name='b'><pose>0 0 1 0 0 0</pose><scale>2 3 4</scale></model></state>"
    found = imported(GROUND + box("b", "1 1 1") + state)
    assert found.world.bodies[0].parts[0].solid == Box((2, 3, 4))
    assert any("scale 2 3 4" in what for what in whats(found))


@pytest.mark.parametrize(
    ("shape", "height"),
    [
        ("<capsule><radius>0.2</radius><length>0.6</length></capsule>", 1.0),
        ("<cone><radius>0.2</radius><length>0.6</length></cone>", 0.6),
        ("<ellipsoid><radii>0.2 0.3 0.4</radii></ellipsoid>", 0.8),
    ],
)
def test_round_shapes_become_meshes_around_their_middle(imported, tmp_path, shape, height):
    shape = f"<geometry>{shape}</geometry>"
    inside = f"{GROUND}<model name='m'><static>1</static><pose>0 0 1 0 0 0</pose><link name='l'>"
    inside += (
        f"<collision name='c'>{shape}</collision><visual name='v'>{shape}</visual></link></model>"
    )
    found = imported(inside)
    (body,) = found.world.bodies
    assert all(isinstance(part.solid, MeshPart) for part in body.parts)
    points = np.concatenate(list(body.hulls()))
    assert (points[:, 2].min(), points[:, 2].max()) == pytest.approx(
        (1 - height / 2, 1 + height / 2), abs=0.01
    )
    assert len(read_back(found, tmp_path).bodies["m"].parts) == 2


def test_a_world_of_nothing_is_refused(imported):
    with pytest.raises(SdfError, match="nothing is left of this world"):
        imported("<model name='m'><link name='l'/></model>")


def test_a_joint_without_way_is_fixed(imported):
    axis = "<axis><limit><lower>{}</lower><upper>{}</upper></limit></axis>"
    for limits, still in (((0, 0), False), ((-1, 1), True)):
        can = CAN.format(mass=1)
        door = DOOR.format(can, can, "").replace("</joint>", axis.format(*limits) + "</joint>")
        assert imported(GROUND + door).world.bodies[0].still == still


def test_an_import_is_the_same_twice(imported, box):
    inside = GROUND + walls(box) + TABLE.format(1)
    first, second = imported(inside), imported(inside)
    assert first.text == second.text
    assert first.assets == second.assets


def test_cylinders_keep_their_axis(imported, tmp_path):
    inside = f"{GROUND}<model name='m'><pose>0 0 1 1.57079632679 0 0</pose><link name='l'>"
    found = imported(inside + CAN.format(mass=1) + "</link></model>")
    assert found.world.bodies[0].parts[0].solid == Cylinder(0.03, 0.1)
    points = np.concatenate(list(found.world.bodies[0].hulls()))
    assert np.ptp(points[:, 1]) == pytest.approx(0.1)


def test_what_is_flush_with_the_floor_is_lifted_to_be_seen(imported, box):
    carpet = box("carpet", "2 1 0.02", "0 0 -0.01 0 0 0")
    boards = box("boards", "8 4 0.02", "0 5 -0.0105 0 0 0")
    found = imported(GROUND + carpet + boards + box("b", "1 1 1", "3 0 0.5 0 0 0"))
    tops = {
        name: float((body.at @ body.parts[0].body_from_part).position[2]) + 0.01
        for name, body in by_name(found).items()
    }
    assert tops["carpet"] == pytest.approx(0.003)
    assert tops["boards"] == pytest.approx(0.001)


def test_bodies_of_nested_models_have_short_names(imported):
    inner = f"<link name='link'>{CAN.format(mass=1)}</link>"
    shelf = f"<model name='shelf'><static>1</static>{inner}</model>"
    pair = f"<model name='pair'><link name='a'>{CAN.format(mass=1)}</link>"
    pair += f"<link name='b'>{CAN.format(mass=1)}</link></model>"
    found = imported(
        f"{GROUND}<model name='house'>{shelf}{pair}</model><model name='box_7'>{shelf}</model>"
    )
    assert [b.name for b in found.world.bodies] == ["shelf", "pair_a", "pair_b", "box_7"]


def test_a_still_body_stands_where_its_own_model_does(imported, box):
    """So that a person moves it by moving its `at`."""
    inside = box("shelf", "1 1 1", "0 3 0 0 0 0") + box("desk", "1 1 1", "0 6 0 0 0 0")
    house = f"<model name='house'><static>1</static><pose>2 0 1 0 0 0</pose>{inside}</model>"
    bodies = by_name(imported(GROUND + house))
    assert bodies["shelf"].at.position == pytest.approx([2, 3, 1])
    assert bodies["desk"].at.position == pytest.approx([2, 6, 1])
    points = np.concatenate(list(bodies["shelf"].hulls()))
    assert points.mean(axis=0) == pytest.approx([2, 3, 1])


def test_a_top_of_several_pieces_is_one_surface(imported, box):
    """Two boards side by side are a table; two far apart are not."""
    board = """<collision name='{n}'><pose>{x} 0 0.7 0 0 0</pose><geometry><box>
      <size>0.6 1 0.04</size></box></geometry></collision>"""
    board += board.replace("collision", "visual")
    for apart, width in ((0.6, 1.2), (2.0, 0.6)):
        boards = board.format(n="a", x=0) + board.format(n="b", x=apart)
        inside = f"<model name='m'><static>1</static><link name='l'>{boards}</link></model>"
        (surface,) = imported(GROUND + inside).world.site.surfaces.values()
        assert sorted(surface.top.size) == pytest.approx(sorted((width, 1.0)), abs=1e-3)


def test_a_machine_on_a_wall_is_no_robot(imported):
    joint = "<joint name='w' type='fixed'><parent>world</parent><child>base</child></joint>"
    rover = ROBOT.format(*[CAN.format(mass=1)] * 3).replace("</model>", joint + "</model>")
    assert [body.name for body in imported(GROUND + rover).world.bodies] == ["rover"]


SHAPES = "<collision name='c'><geometry>{}</geometry></collision><visual name='v'><geometry>{}"
SHAPES += "</geometry></visual>"
LOST = "<mesh><uri>model://none/none.dae</uri></mesh>"
CUBE = "<box><size>0.4 0.4 0.8</size></box>"
BROKEN = "<mesh><uri>broken.stl</uri></mesh>"


@pytest.mark.parametrize("lost", [LOST, BROKEN, "<box><size>0 1 1</size></box>"])
@pytest.mark.parametrize("static", ["<static>1</static>", ""])
def test_what_is_lost_of_a_body_is_replaced_by_what_is_known_of_it(
    imported, tmp_path, lost, static
):
    """A missing file makes no invisible obstacle, and no table that nothing can stand on."""
    (tmp_path / "broken.stl").write_text("solid nothing")
    for shapes, said in (
        (SHAPES.format(CUBE, lost), "its collision shape is drawn"),
        (SHAPES.format(lost, CUBE), "what is seen of it is touched"),
    ):
        found = imported(f"{GROUND}<model name='m'>{static}<link name='l'>{shapes}</link></model>")
        (part,) = found.world.bodies[0].parts
        assert (part.solid, part.visual, part.collision) == (Box((0.4, 0.4, 0.8)), True, True)
        assert [f.subject for f in found.deviations if f.instead == said] == ["m/l"]
        assert len(part.hulls) == 1


def test_what_is_meant_to_be_invisible_stays_so(imported):
    hidden = SHAPES.format(CUBE, CUBE).replace("<visual name='v'>", "<visual name='v'>{}")
    for inside in (
        hidden.format("<transparency>1</transparency>"),
        SHAPES.format(CUBE, "<empty/>"),
        f"<collision name='c'><geometry>{CUBE}</geometry></collision>",
    ):
        found = imported(f"{GROUND}<model name='m'><link name='l'>{inside}</link></model>")
        assert [part.visual for part in found.world.bodies[0].parts] == [False]
