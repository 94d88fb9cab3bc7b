"""Tops are taken from what is drawn and what is touched; seats and walls are none."""

import pytest

GROUND = "<include><uri>model://ground_plane</uri></include>"
TABLE = """<model name='{name}'><static>1</static><link name='l'>
  <collision name='c'><pose>0 0 {touched} 0 0 0</pose><geometry><box><size>0.8 1.4 0.04</size></box>
  </geometry></collision><visual name='v'><pose>0 0 {drawn} 0 0 0</pose><geometry><box>
  <size>0.8 1.4 0.04</size></box></geometry></visual></link></model>"""
TAG = """<model name='tag'><static>1</static><pose>0.1 0 {} 0 0 0</pose><link name='l'>
  <visual name='v'><geometry><box><size>0.2 0.2 0.001</size></box></geometry></visual>
  </link></model>"""
CAN = """<model name='can'><pose>-0.1 0.3 {} 0 0 0</pose><link name='l'><inertial><mass>0.3</mass>
  </inertial><collision name='c'><geometry><cylinder><radius>0.03</radius><length>0.1</length>
  </cylinder></geometry></collision></link></model>"""


def bodies(found):
    return {body.name: body for body in found.world.bodies}


def touched_top(body):
    return max(float(hull[:, 2].max()) for hull in body.hulls())


@pytest.mark.parametrize(
    ("drawn", "words"),
    [
        (0.705, "touched where it is drawn"),
        (0.695, "drawn where it is touched"),
        (0.7, ""),
    ],
)
def test_a_top_is_touched_where_it_is_drawn_and_what_lies_on_it_is_seen(imported, drawn, words):
    """A table that is drawn 5 mm higher than it is touched would hide the tag that lies on it."""
    inside = TABLE.format(name="table", touched=0.7, drawn=drawn)
    found = imported(GROUND + inside + TAG.format(0.7205) + CAN.format(0.77))
    top = found.world.site.surfaces["table"].top
    assert top.height == pytest.approx(max(0.72, drawn + 0.02))
    assert (top.drawn, top.touched) == pytest.approx((drawn + 0.02, 0.72))
    own = bodies(found)
    assert touched_top(own["table"]) == pytest.approx(top.height)
    bottom = float(own["tag"].at.position[2]) - 0.0005
    assert top.height - 1e-6 <= bottom <= top.height + 0.001
    assert min(float(h[:, 2].min()) for h in own["can"].hulls()) == pytest.approx(
        top.height, abs=1e-3
    )
    assert [f.instead for f in found.deviations if "a top that is drawn" in f.what] == (
        [f"it is {words}"] if words else []
    )


def test_what_is_only_drawn_or_only_touched_is_no_top(imported):
    table = TABLE.format(name="table", touched=0.7, drawn=0.7)
    assert imported(GROUND + table).world.site.surfaces
    for tag in ("visual", "collision"):
        a, b = table.index(f"<{tag}"), table.index(f"</{tag}>") + len(f"</{tag}>")
        assert not imported(GROUND + table[:a] + table[b:]).world.site.surfaces


def test_seats_and_walls_are_no_tops_whatever_they_are_called(imported, box):
    inside = box("thing", "0.6 0.6 0.45", "0 0 0.225 0 0 0").replace(
        "</link>",
        "<collision name='back'><pose>-0.25 0 0.4 0 0 0</pose><geometry><box>"
        "<size>0.1 0.6 0.9</size>"
        "</box></geometry></collision></link>",
    )
    inside += box("low_wall", "3 0.3 1", "0 5 0.5 0 0 0") + box(
        "Sofa_2", "2 0.8 0.45", "5 0 0.225 0 0 0"
    )
    inside += box("plain", "0.6 0.6 0.45", "0 -4 0.225 0 0 0")
    assert list(imported(GROUND + inside).world.site.surfaces) == ["plain"]


def test_a_table_that_is_laid_is_a_table(imported, box):
    inside = box("plain", "0.8 1.4 0.72", "0 0 0.36 0 0 0")
    plates = "".join(
        box(f"plate{n}", "0.2 0.2 0.04", f"0 {n / 3 - 0.5} 0.74 0 0 0") for n in range(4)
    )
    assert "plain" in imported(GROUND + inside + plates).world.site.surfaces
    full = box("heap", "0.8 1.2 0.2", "0 0 0.82 0 0 0")
    assert "plain" not in imported(GROUND + inside + full).world.site.surfaces


@pytest.mark.parametrize(
    ("depth", "still", "bottom"), [(0.0, False, 0.0), (0.01, False, 0.0), (0.05, True, -0.05)]
)
def test_what_begins_in_the_floor_is_not_thrown_out_of_it(imported, box, depth, still, bottom):
    found = imported(GROUND + box("b", "1 1 1", "3 0 0.5 0 0 0") + CAN.format(0.05 - depth))
    can = bodies(found)["can"]
    assert can.still == still
    assert min(float(h[:, 2].min()) for h in can.hulls()) == pytest.approx(bottom, abs=1e-6)
    assert len([f for f in found.deviations if "in the floor" in f.what]) == (depth > 0)


@pytest.mark.parametrize(("above", "bottom"), [(0.012, 0.0), (0.1, 0.1)])
def test_what_begins_a_little_above_the_floor_is_set_on_it(imported, box, above, bottom):
    found = imported(GROUND + box("b", "1 1 1", "3 0 0.5 0 0 0") + CAN.format(0.05 + above))
    can = bodies(found)["can"]
    assert not can.still
    assert min(float(h[:, 2].min()) for h in can.hulls()) == pytest.approx(bottom, abs=1e-6)
    said = [f for f in found.deviations if "above the floor" in f.what]
    assert len(said) == (bottom == 0.0)


@pytest.mark.parametrize(("gravity", "still"), [("0", True), ("false", True), ("1", False)])
def test_what_no_gravity_pulls_stays_where_it_hangs(imported, box, gravity, still):
    hung = CAN.format(1.5).replace(
        "<link name='l'>", f"<link name='l'><gravity>{gravity}</gravity>"
    )
    found = imported(GROUND + box("b", "1 1 1", "3 0 0.5 0 0 0") + hung)
    assert bodies(found)["can"].still == still
    assert len([f for f in found.deviations if f.what == "no gravity pulls it"]) == still
    assert not [f for f in found.deviations if "<gravity>" in f.what]


@pytest.mark.parametrize(
    ("name", "is_table"), [("bench", False), ("workbench", True), ("work_bench_2", True)]
)
def test_a_bench_with_a_back_is_a_seat_and_a_workbench_a_table(imported, box, name, is_table):
    parts = (("1.5 0.5 0.46", "0 0 0.23"), ("1.5 0.04 0.9", "0 0.27 0.45"))
    shape = "<geometry><box><size>{}</size></box></geometry>"
    inside = "".join(
        f"<{kind} name='{kind}{n}'><pose>{at} 0 0 0</pose>{shape.format(size)}</{kind}>"
        for n, (size, at) in enumerate(parts)
        for kind in ("visual", "collision")
    )
    model = f"<model name='{name}'><static>1</static><link name='l'>{inside}</link></model>"
    found = imported(GROUND + box("far", "1 1 1", "4 0 0.5 0 0 0") + model)
    assert (name in found.world.site.surfaces) == is_table


@pytest.mark.parametrize(("into", "still"), [(0.01, False), (0.08, True)])
def test_what_begins_deep_in_a_wall_stays_there(imported, box, into, still):
    wall = box("wall", "1 0.1 2", f"-0.1 {0.3 + 0.05 + 0.03 - into} 1 0 0 0")
    found = imported(GROUND + wall + CAN.format(0.05))
    can = bodies(found)["can"]
    assert can.still == still
    said = [f.what for f in found.deviations if "in wall" in f.what]
    assert said == ([f"it begins {into:.3f} m in wall/link"] if still else [])


def test_what_lies_on_a_table_is_not_wedged(imported, box):
    found = imported(GROUND + box("b", "1 1 0.7", "-0.1 0.3 0.35 0 0 0") + CAN.format(0.745))
    assert not bodies(found)["can"].still
