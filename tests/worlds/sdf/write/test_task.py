"""`worlds import --bring` writes all that the main task needs, and tells what is not there."""

import pytest
from momantu_worlds.checking.run import check_world
from momantu_worlds.robots import fetch
from momantu_worlds.scenes.file.reader import read_world
from momantu_worlds.worlds import world_from_file

from momantu_bt.cli import main

GROUND = "<include><uri>model://ground_plane</uri></include>"
CAN = """<model name='Coke'><pose>{} 0 0 0</pose><link name='l'>
  <inertial><mass>0.3</mass></inertial>
  <collision name='c'><geometry><cylinder><radius>0.033</radius><length>0.12</length></cylinder>
  </geometry></collision><visual name='v'><geometry><cylinder><radius>0.033</radius>
  <length>0.12</length></cylinder></geometry><material><diffuse>0.7 0 0 1</diffuse></material>
  </visual></link></model>"""
TAG = """<model name='Apriltag36_11_00005'><static>1</static><pose>3.2 3 0.7205 0 0 0.4</pose>
  <link name='l'><visual name='v'><geometry><box><size>0.2 0.2 0.001</size></box></geometry>
  </visual></link></model>"""


@pytest.fixture
def run(sdf, box, tmp_path, capsys):
    def call(*options, can="0 0 0.78", more=""):
        inside = GROUND + CAN.format(can) + more
        inside += box("desk", "0.8 1.4 0.72", "0 0 0.36 0 0 0")
        inside += box("table", "0.8 1.2 0.72", "3 3 0.36 0 0 0")
        code = main(
            ["worlds", "import", str(sdf(inside)), "-o", str(tmp_path / "r.yaml"), *options]
        )
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return call


BRING = ("--bring", "coke", "--from", "desk", "--to", "table")


@pytest.mark.parametrize("can", ["0 0 0.78", "-3 1 0.06", "0.2 0.3 0.785"])
def test_one_command_makes_a_world_for_the_main_task(run, tmp_path, can):
    """Wherever the can stood: it stands on the desk, and nothing is left to be edited."""
    code, out, _ = run(*BRING, can=can)
    assert code == 0
    file = tmp_path / "r.yaml"
    world = read_world(file)
    (demand,) = world.demands
    assert (demand.item, demand.on, demand.beside) == ("coke", "table", "tag")
    own = world.bodies["coke"]
    assert (own.category, own.static, own.mass) == ("can", False, 0.3)
    assert own.parts[0].color == (0.7, 0, 0)
    assert own.at[2] == pytest.approx(0.72)  # its frame lies in its base, as the referee judges
    assert own.parts[0].at[2] == pytest.approx(0.06)
    assert world.site.objects["coke"].diameter == pytest.approx(0.066)
    assert "momantu-bt run bring_object --world" in out
    assert "--set from=desk --set to=table --set tag_id=1" in out
    entry = world_from_file(file)
    assert check_world(file, entry.draw, fetch(), [0]) == []


def test_the_picture_of_a_tag_becomes_a_tag_where_it_lies(run, tmp_path):
    assert run(*BRING, more=TAG)[0] == 0
    world = read_world(tmp_path / "r.yaml")
    assert set(world.bodies) == {"coke", "desk", "table"}
    tag = world.tag
    assert (tag.id, tag.on, tag.turn) == (5, "table", 0)
    assert tag.edge == pytest.approx(0.16)
    surface = world.bodies["table"].surface
    assert tag.at[0] + surface.at[0] == pytest.approx(3.2, abs=1e-3)


def test_a_tag_alone(run, tmp_path):
    assert run("--tag", "desk")[0] == 0
    world = read_world(tmp_path / "r.yaml")
    assert world.tag.on == "desk"
    assert world.goal is None


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--bring", "coke", "--from", "desk"), "--bring coke needs --to SURFACE; surfaces: desk"),
        (
            ("--bring", "coke", "--from", "dsk", "--to", "table"),
            "--from dsk: there is no such surface; did you mean desk?",
        ),
        (
            ("--bring", "cok", "--from", "desk", "--to", "table"),
            "--bring cok: there is no such thing; did you mean coke?",
        ),
        (("--bring", "desk", "--from", "desk", "--to", "table"), "small things: coke"),
        (("--tag", "wall"), "--tag wall: there is no such surface; surfaces: desk, table"),
        (("--from", "desk"), "--from needs --bring"),
    ],
)  # fmt: skip
def test_what_is_not_there_is_told_and_nothing_is_written(run, tmp_path, options, words):
    code, _, err = run(*options)
    assert code == 2
    assert words in err
    assert not (tmp_path / "r.yaml").exists()


def test_a_turned_box_is_told_as_it_is(run, box, tmp_path):
    packet = box("packet", "0.06 0.1 0.15", "0.1 0.1 0.795 0 0 0.7").replace(
        "<static>1</static>", ""
    )
    assert run("--bring", "packet", *BRING[2:], more=packet)[0] == 0
    world = read_world(tmp_path / "r.yaml")
    sizes = world.site.objects["packet"]
    assert (sizes.category, sizes.width, sizes.depth, sizes.height) == ("box", 0.06, 0.1, 0.15)
    assert world.bodies["packet"].at[2:] == pytest.approx((0.72, 0, 0, 0.7))
