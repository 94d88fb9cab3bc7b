"""What a world says is read whole; what is not carried over is listed with its place."""

import pytest
from momantu_worlds.sdf.errors import SdfError, TooMuch
from momantu_worlds.sdf.read import reading
from momantu_worlds.sdf.read.model import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    LightKind,
    Plane,
    Sphere,
)

GEOMETRIES = [
    ("<box><size>1 2 3</size></box>", Box((1, 2, 3))),
    ("<cylinder><radius>1</radius><length>2</length></cylinder>", Cylinder(1, 2)),
    ("<sphere><radius>1</radius></sphere>", Sphere(1)),
    ("<capsule><radius>1</radius><length>2</length></capsule>", Capsule(1, 2)),
    ("<cone><radius>1</radius><length>2</length></cone>", Cone(1, 2)),
    ("<ellipsoid><radii>1 2 3</radii></ellipsoid>", Ellipsoid((1, 2, 3))),
    ("<plane><normal>0 0 2</normal><size>4 5</size></plane>", Plane((0, 0, 2), (4, 5))),
    ("<plane/>", Plane((0, 0, 1), (1, 1))),
]


def visual(inside, more=""):
    return (
        f"<model name='m'><link name='l'><visual name='v'><geometry>{inside}</geometry>{more}"
        "</visual></link></model>"
    )


def shape_of(world):
    return world.models[0].links[0].visuals[0]


@pytest.mark.parametrize(("inside", "geometry"), GEOMETRIES, ids=lambda g: str(g)[:16])
def test_geometries(read, inside, geometry):
    world, deviations = read(visual(inside))
    assert shape_of(world).geometry == geometry
    assert not len(deviations)


@pytest.mark.parametrize(
    ("inside", "words"),
    [
        ("<box/>", "<box> needs a <size>"),
        ("<box><size>1 1 -1</size></box>", "expected a length above 0"),
        ("<sphere><radius>nan</radius></sphere>", "finite"),
        ("<plane><normal>0 0 0</normal></plane>", "normal without length"),
        ("<mesh/>", "<mesh> needs a <uri>"),
        ("<mesh><uri>model://../../etc/passwd</uri></mesh>", "leads out of its folder"),
    ],
)
def test_geometries_that_are_impossible_are_listed(read, inside, words):
    world, deviations = read(visual(inside))
    (found,) = deviations
    assert words in found.what
    assert (found.subject, found.instead) == ("m/l/v", "this visual is left out")
    assert world.models[0].links[0].visuals == ()


def test_a_visual_needs_a_geometry_and_everything_a_name(read, box):
    for inside, words in (
        ("<model name='m'><link name='l'><visual name='v'/></link></model>", "needs a <geometry>"),
        ("<model><link name='l'/></model>", "<model> needs a name"),
        ("<model name='m'><link/></model>", "<link> needs a name"),
        ("<model name='m'><link name='l'/><link name='l'/></model>", "two links 'l'"),
        ("<include/>", "<include> needs a <uri>"),
        ("<light name='x' type='laser'/>", "type 'laser'; expected: directional, point, spot"),
        (
            "<model name='m'><link name='l'/><joint name='j' type='glue'/></model>",
            "type 'glue'; expected: fixed",
        ),
        (
            "<model name='m'><link name='l'/><joint name='j' type='fixed'/></model>",
            "<joint> needs a <parent>",
        ),
    ):
        world, deviations = read(inside + box("whole", "1 1 1"))
        assert any(words in found.what for found in deviations), inside
        assert world.models[-1].name == "whole"
    with pytest.raises(SdfError, match="there is no <model>"):
        read("")


def test_what_is_not_carried_over_is_listed(read):
    inside = """<physics type='ode'><max_step_size>1</max_step_size></physics>
      <gravity>0 0 -1.62</gravity>
      <scene><ambient>.4 .4 .4 1</ambient><sky/><fog><color>1 1 1 1</color></fog></scene>
      <wind><linear_velocity>1 0 0</linear_velocity></wind>
      <plugin name='p' filename='p.so'/>
      <actor name='walker'><pose>0 0 0 0 0 0</pose></actor>
      <novelty>1</novelty>
      <model name='m'><plugin name='q' filename='q.so'/><enable_wind>true</enable_wind>
        <link name='l'><sensor name='eye' type='camera'/><inertial><mass>2</mass>
          <inertia><ixx>1</ixx></inertia></inertial>
          <collision name='c'><geometry><heightmap><uri>x</uri></heightmap></geometry></collision>
          <visual name='v'><geometry><sphere><radius>1</radius></sphere></geometry>
            <transparency>0.5</transparency></visual>
        </link></model>"""
    _, deviations = read(inside)
    listed = {(deviation.subject, deviation.what) for deviation in deviations}
    assert listed == {
        ("world", "<physics>"),
        ("world", "<gravity>"),
        ("world/scene", "<fog>"),
        ("world", "<wind>"),
        ("world", "<plugin name='p'>"),
        ("world", "<actor name='walker'>"),
        ("world", "<novelty>"),
        ("m", "<plugin name='q'>"),
        ("m", "<enable_wind>"),
        ("m/l", "<sensor name='eye' type='camera'>"),
        ("m/l", "<inertia>"),
        ("m/l/c", "a heightmap"),
        ("m/l/v", "50% transparent"),
    }
    assert all(deviation.instead for deviation in deviations)
    physics = next(deviation for deviation in deviations if deviation.what == "<physics>")
    assert (physics.place.line, physics.place.column) == (3, 1)


def test_what_says_nothing_is_not_listed(read):
    inside = """<gravity>0 0 -9.8</gravity><scene><shadows>1</shadows></scene><wind/>
      <model name='m'><self_collide>0</self_collide><allow_auto_disable>1</allow_auto_disable>
        <link name='l'><gravity>1</gravity><velocity_decay/><collision name='c'>
          <max_contacts>10</max_contacts><surface><contact><ode/></contact><bounce/>
            <friction><ode><mu>1</mu></ode></friction></surface>
          <geometry><sphere><radius>1</radius></sphere></geometry></collision>
        <visual name='v'><cast_shadows>1</cast_shadows><material><specular>0 0 0 1</specular>
          <emissive>0 0 0 1</emissive></material>
          <geometry><sphere><radius>1</radius></sphere></geometry></visual></link></model>"""
    _, deviations = read(inside)
    assert list(deviations) == []


def test_includes_are_found_and_overridden(read, model):
    model("table", "<pose>9 9 9 0 0 0</pose><link name='top'/>")
    world, _ = read(
        """<include><uri>model://table</uri></include>
        <include><uri>model://table</uri><name>second</name><pose>1 2 3 0 0 0</pose>
          <static>true</static></include>
        <include><uri>model://table</uri></include>"""
    )
    assert [m.name for m in world.models] == ["table", "second", "table_0"]
    assert world.models[0].pose.transform.position.tolist() == [9, 9, 9]
    assert world.models[1].pose.transform.position.tolist() == [1, 2, 3]
    assert (world.models[0].static, world.models[1].static) == (False, True)


def test_a_missing_model_is_listed_and_the_rest_is_read(read, box):
    world, deviations = read(
        "<include><uri>model://none</uri><name>n</name></include>" + box("b", "1 1 1")
    )
    (deviation,) = deviations
    assert (deviation.subject, deviation.instead) == ("n", "this model is left out")
    assert [m.name for m in world.models] == ["b"]


def test_the_sun_and_the_ground_need_no_files(read):
    inside = """<include><uri>model://sun</uri></include>
      <include><uri>https://fuel.gazebosim.org/1.0/o/models/Ground Plane</uri></include>"""
    world, deviations = read(inside)
    assert [light.kind for light in world.lights] == [LightKind.SUN]
    assert isinstance(world.models[0].links[0].collisions[0].geometry, Plane)
    assert list(deviations) == []


@pytest.mark.parametrize(("name", "height"), [("cafe_table", 0.775), ("table", 1.015)])
def test_tables_of_gazebo_need_no_files(imported, name, height):
    found = imported(f"<include><uri>model://{name}</uri></include>")
    (body,) = found.world.bodies
    assert max(float(hull[:, 2].max()) for hull in body.hulls()) == pytest.approx(height)
    assert all(part.visual and part.collision for part in body.parts)
    (said,) = found.deviations
    assert "drawn in plain" in said.instead


def test_includes_that_never_end_end_where_they_begin_again(read, model):
    model("a", "<include><uri>model://b</uri></include>")
    model("b", "<include><uri>model://a</uri></include>")
    _, deviations = read("<include><uri>model://a</uri></include>")
    (found,) = deviations
    assert "includes itself" in found.what
    assert found.place.file.endswith("b/model.sdf")


def test_includes_that_multiply_are_refused(read, model, monkeypatch):
    monkeypatch.setattr(reading, "MOST_MODELS", 500)
    for level in range(12):
        inner = f"<uri>model://m{level + 1}</uri>"
        twice = "".join(f"<include><name>{n}</name>{inner}</include>" for n in "ab")
        model(f"m{level}", twice)
    model("m12", "<link name='l'/>")
    with pytest.raises(TooMuch, match="more than 500 models"):
        read("<include><uri>model://m0</uri></include>")


def test_models_within_models_without_end_are_refused(read):
    deep = "<model name='m'>" * 45 + "<link name='l'/>" + "</model>" * 45
    _, deviations = read(deep)
    assert ["more than 40 models within each other" in found.what for found in deviations] == [True]


def test_colours_come_from_the_best_source(read, model, tmp_path):
    folder = model("thing", "<link name='l'/>") / "materials" / "scripts"
    folder.mkdir(parents=True)
    (folder / "own.material").write_text(
        "material Own/Red : Base\n{\n technique { pass {\n  ambient 0.5 0 0\n  diffuse 1 0 0 1\n"
        " } }\n}\n// material Own/Hidden\nmaterial Own/Dark { technique { pass {\n"
        "ambient 0.1 0.1 0.1 1\n} } }\n"
    )
    sphere = "<sphere><radius>1</radius></sphere>"
    own = "<uri>model://thing/materials/scripts</uri>"
    for material, color in (
        ("<diffuse>.1 .2 .3 1</diffuse><ambient>1 1 1 1</ambient>", (0.1, 0.2, 0.3, 1)),
        ("<ambient>.4 .4 .4</ambient>", (0.4, 0.4, 0.4, 1)),
        (f"<script>{own}<name>Own/Red</name></script>", (1, 0, 0, 1)),
        (f"<script>{own}<name>Own/Dark</name></script>", (0.1, 0.1, 0.1, 1)),
        (f"<script>{own}<name>Own/Hidden</name></script>", None),
        ("<script><name>Gazebo/GREY</name></script><ambient>1 1 1 1</ambient>", (0.62,) * 3 + (1,)),
    ):
        world, deviations = read(visual(sphere, f"<material>{material}</material>"))
        assert shape_of(world).material.color == color, material
        assert len(deviations) == (color is None)


def test_friction_is_the_least_of_two_directions(read):
    inside = """<model name='m'><link name='l'><collision name='c'>
      <geometry><sphere><radius>1</radius></sphere></geometry>
      <surface><friction><ode><mu>0.9</mu><mu2>0.5</mu2></ode></friction></surface>
      </collision></link></model>"""
    world, deviations = read(inside)
    assert world.models[0].links[0].collisions[0].friction == 0.5
    assert "0.9 along, 0.5 across" in next(iter(deviations)).what


def test_a_state_brings_models_and_takes_some_away(read, box):
    inside = box("a", "1 1 1") + box("b", "1 1 1")
    inside += f"<state><insertions>{box('c', '1 1 1')}</insertions>"
    inside += "<deletions><name>a</name></deletions></state>"
    world, _ = read(inside)
    assert [m.name for m in world.models] == ["b", "c"]
