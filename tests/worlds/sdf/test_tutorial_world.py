"""A world in the style of the original tutorial's, with everything that its rooms are made of."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from momantu_worlds.robots import fetch
from momantu_worlds.scenes.catalogue.tags import tag_picture
from momantu_worlds.scenes.file.reader import read_world
from momantu_worlds.sdf.body.parts import MeshPart
from momantu_worlds.sdf.importing import Import, import_world
from momantu_worlds.worlds import world_from_file
from PIL import Image

from momantu_bt.cli import main
from momantu_bt.robot import read_laser

WALLS = [
    (22.07, -0.027, -7.550, 3.14159),
    (22.13, 0.0, 7.577, 0.0),
    (15.25, -10.989, 0.0, 1.5708),
    (15.25, 10.989, 0.0, -1.5708),
    (6.0, -2.626, -4.536, -1.5708),
]
WALL = """<link name='Wall_{n}'><pose frame=''>{x} {y} 0 0 0 {yaw}</pose>
  <collision name='Wall_{n}_Collision'><pose frame=''>0 0 1.25 0 0 0</pose>
    <geometry><box><size>{length} 0.15 2.5</size></box></geometry></collision>
  <visual name='Wall_{n}_Visual'><pose frame=''>0 0 1.25 0 0 0</pose>
    <geometry><box><size>{length} 0.15 2.5</size></box></geometry>
    <material><script><uri>file://media/materials/scripts/gazebo.material</uri>
      <name>Gazebo/Grey</name></script><ambient>1 1 1 1</ambient></material></visual></link>"""
WORLD = """<sdf version='1.6'><world name='tutorial'>
  <include><uri>model://sun</uri></include><include><uri>model://ground_plane</uri></include>
  <model name='rooms'><static>1</static><pose frame=''>-0.219 0.573 0 0 0 0</pose>{walls}</model>
  <include><uri>model://desk</uri><name>desk_a</name><pose>-0.98 -4.57 0 0 0 1.5708</pose></include>
  <include><uri>model://desk</uri><name>desk_b</name><pose>-8.87 4 0 0 0 0</pose></include>
  <include><uri>model://tag</uri><pose>-8.8 4 0.7205 0 0 0</pose></include>
  <include><uri>model://fetch</uri><pose>-4.7 -3.44 0 0 0 3.14</pose></include>
  <model name='can'><link name='link'><inertial><mass>0.4</mass></inertial>
    <collision name='c'><geometry><cylinder><radius>0.035</radius><length>0.13</length></cylinder>
      </geometry><surface><friction><ode><mu>100</mu><mu2>100</mu2></ode></friction></surface>
    </collision>
    <visual name='v'><geometry><cylinder><radius>0.035</radius><length>0.13</length></cylinder>
      </geometry><material><diffuse>0.8 0.1 0.1 1</diffuse></material></visual></link></model>
  <state world_name='tutorial'><model name='can'><pose>-0.354 -4.306 0.785 0 0 0</pose>
    <scale>1 1 1</scale><link name='link'><pose>-0.354 -4.306 0.785 0 0 0</pose></link></model>
  </state></world></sdf>"""
DESK = """<static>1</static><link name='l'><collision name='c'><geometry><mesh>
  <uri>model://desk/meshes/desk.dae</uri></mesh></geometry></collision><visual name='v'><geometry>
  <mesh><uri>model://desk/meshes/desk.dae</uri></mesh></geometry></visual></link>"""
TAG = """<static>1</static><link name='l'><visual name='v'><geometry><box><size>0.2 0.2 0.001</size>
  </box></geometry><material><script><uri>model://tag/materials/scripts</uri>
  <uri>model://tag/materials/textures</uri><name>Tag/One</name></script></material></visual></link>"""
FETCH = """<link name='base_link'><sensor name='laser' type='ray'/></link><link name='torso'/>
  <link name='head'/>
  <joint name='a' type='prismatic'><parent>base_link</parent><child>torso</child></joint>
  <joint name='b' type='revolute'><parent>torso</parent><child>head</child></joint>"""
SCRIPT = "material Tag/One { technique { pass {\n texture_unit {\n texture tag.png\n} } } }\n"


def write_desk(file: Path) -> None:
    """A desk of 0.8 x 1.4 x 0.72 m with a top and four legs of other colours, in centimetres."""
    parts = []
    legs = [((5, 5, 68), (x, y, 34)) for x in (-37, 37) for y in (-67, 67)]
    for size, at in [((80, 140, 4), (0, 0, 70)), *legs]:
        part = trimesh.creation.box(size)
        part.apply_translation(at)
        color = [153, 102, 51, 255] if size[0] == 80 else [51, 51, 51, 255]
        part.visual = trimesh.visual.TextureVisuals(
            material=trimesh.visual.material.PBRMaterial(baseColorFactor=color)
        )
        parts.append(part)
    text = trimesh.exchange.dae.export_collada(parts).decode()
    asset = '<unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis>'
    file.parent.mkdir()
    file.write_text(text.replace("<up_axis>Y_UP</up_axis>", asset))


@pytest.fixture
def room(tmp_path: Path, model) -> Path:
    """The world file of the import, written with its assets."""
    write_desk(model("desk", DESK, "1.6") / "meshes" / "desk.dae")
    materials = model("tag", TAG, "1.6") / "materials"
    for folder in ("scripts", "textures"):
        (materials / folder).mkdir(parents=True)
    (materials / "scripts" / "tag.material").write_text(SCRIPT)
    Image.fromarray(tag_picture(1)).save(materials / "textures" / "tag.png")
    model("fetch", FETCH, "1.6")
    walls = "".join(
        WALL.format(n=n, length=length, x=x, y=y, yaw=yaw)
        for n, (length, x, y, yaw) in enumerate(WALLS)
    )
    (tmp_path / "tutorial.world").write_text(WORLD.format(walls=walls))
    found = imported(tmp_path)
    found.write(tmp_path / "tutorial.yaml")
    return tmp_path / "tutorial.yaml"


def imported(folder: Path) -> Import:
    return import_world(folder / "tutorial.world", folder / "tutorial.yaml")


def test_everything_is_there(room: Path):
    world = read_world(room)
    assert set(world.bodies) == {"rooms", "desk_a", "desk_b", "tag", "can"}
    assert len(world.bodies["rooms"].parts) == len(WALLS)
    can = world.bodies["can"]
    assert (can.static, can.mass, can.friction) == (False, 0.4, 1.0)
    assert can.at[:3] == pytest.approx((-0.354, -4.306, 0.785))
    assert world.start.at == pytest.approx((-4.7, -3.44, 3.14))
    desk = world.bodies["desk_b"].surface
    assert desk.height == pytest.approx(0.72)
    assert desk.size == pytest.approx((0.8, 1.4))


def test_the_list_says_what_is_different(room: Path):
    listed = {(f.subject, f.what) for f in imported(room.parent).deviations}
    assert listed == {
        ("can/link", "friction 100"),
        ("desk_a/l/c", "the triangles of desk.dae"),
        ("desk_b/l/c", "the triangles of desk.dae"),
        ("fetch", "a robot: its joints move, and it has sensors or plugins"),
        ("fetch/base_link", "<sensor name='laser' type='ray'>"),
    }


def test_the_tag_keeps_its_picture_and_the_desk_its_colours(room: Path):
    bodies = {body.name: body for body in imported(room.parent).world.bodies}
    (path,) = (p.solid.path for p in bodies["tag"].parts if isinstance(p.solid, MeshPart))
    scene = trimesh.load_scene(room.parent / path)
    picture = next(iter(scene.geometry.values())).visual.material.baseColorTexture
    assert np.array_equal(np.asarray(picture.convert("RGB")), tag_picture(1))
    look = next(p.solid.path for p in bodies["desk_a"].parts if p.visual)
    desk = trimesh.load_scene(room.parent / look)
    colors = {tuple(mesh.visual.material.main_color[:3]) for mesh in desk.geometry.values()}
    assert colors == {(153, 102, 51), (51, 51, 51)}
    assert desk.extents == pytest.approx([0.8, 1.4, 0.72])


def test_fetch_stands_in_it(room: Path):
    """Built in the simulator: nothing falls, nothing pushes, the laser sees walls and desk."""
    entry = world_from_file(room)
    assert list(entry.site().surfaces) == ["desk_a", "desk_b"]
    world = entry.open(fetch(), 3)
    try:
        for _ in range(20):
            world.step()
        drift = world.robot.state().odom_from_base
        assert np.abs(drift.position).max() < 0.005
        assert not world.verdict() or not world.verdict().incidents
        ranges = np.asarray(read_laser(world.robot).ranges)
        # to the wall of the rooms' middle line, 2.845 m east of the origin, seen backwards
        assert 1.5 < np.nanmin(ranges) < 4.5
    finally:
        world.close()


@pytest.mark.slow
def test_the_main_job_is_done_in_it(room: Path):
    """The same tree as in our own rooms; the tag is seen by the picture that came with it."""
    tree = Path(__file__).parents[3] / "trees" / "bring_object.yaml"
    values = {"from": "desk_a", "to": "desk_b", "tag_edge": "160 mm"}
    given = [word for key, value in values.items() for word in ("--set", f"{key}={value}")]
    assert main(["run", str(tree), "--world", str(room), "--seed", "3", *given]) == 0
