"""`momantu-bt worlds import` writes, lists and refuses as it says."""

import json

import pytest

from momantu_bt.cli import main

GROUND = "<include><uri>model://ground_plane</uri></include>"


@pytest.fixture
def run(sdf, tmp_path, capsys):
    """Import what stands in a <world>; returns exit code, output and errors."""

    def call(inside, *options, output="office.yaml"):
        file = sdf(inside)
        code = main(["worlds", "import", str(file), "-o", str(tmp_path / output), *options])
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return call


def test_a_world_is_written_and_can_be_shown(run, box, tmp_path, capsys):
    code, out, _ = run(GROUND + box("crate", "1 1 1", "2 0 0.5 0 0 0"))
    assert code == 0
    assert "1 bodies (0 loose), 0 meshes" in out
    assert main(["worlds", "show", str(tmp_path / "office.yaml")]) == 0
    assert "crate" in capsys.readouterr().out


def test_what_is_different_is_listed_once_for_each_model(run, box, tmp_path):
    sensor = "<sensor type='ray'/>"
    link = "<link name='link'>"
    twice = box("a", "1 1 1").replace(link, link + 2 * sensor)
    code, out, _ = run(GROUND + twice + "<plugin name='p'/>")
    assert code == 0
    lines = out.split("Left out\n")[1].splitlines()
    assert len(lines) == 2
    assert f"{tmp_path / 'room.sdf'}:3:" in lines[0]
    assert "a/link: <sensor type='ray'> (2 times): left out" in lines[0]
    assert "world: <plugin name='p'>: left out; no code is run" in lines[1]


def test_strict_says_so_by_its_exit_code(run, box):
    assert run(GROUND + box("a", "1 1 1"), "--strict")[0] == 0
    assert run(GROUND + box("a", "1 1 1") + "<plugin name='p'/>", "--strict", "--force")[0] == 1


def test_json_is_for_programs(run, box):
    code, out, _ = run(GROUND + box("a", "1 1 1") + "<plugin name='p'/>", "--json")
    said = json.loads(out)
    assert code == 0
    assert said["bodies"] == ["a"]
    (deviation,) = said["findings"]
    assert (deviation["line"], deviation["fate"], deviation["subject"]) == (3, "dropped", "world")


def test_nothing_is_overwritten_unasked(run, box, tmp_path):
    (tmp_path / "office.yaml").write_text("mine")
    code, _, err = run(GROUND + box("a", "1 1 1"))
    assert code == 2
    assert "--force overwrites it" in err
    assert (tmp_path / "office.yaml").read_text() == "mine"
    assert run(GROUND + box("a", "1 1 1"), "--force")[0] == 0


@pytest.mark.parametrize(
    ("output", "options", "words"),
    [
        ("office.txt", (), "neither .yaml nor .yml"),
        ("none/office.yaml", (), "there is no folder"),
        ("office.yaml", ("--models", "/nowhere"), "there is no such folder"),
    ],
)
def test_wrong_arguments_are_told(run, box, tmp_path, output, options, words):
    code, _, err = run(box("a", "1 1 1"), *options, output=output)
    assert code == 2
    assert words in err
    assert not (tmp_path / output).exists()


def test_a_broken_world_leaves_nothing_behind(run, tmp_path):
    code, _, err = run("<model name='m'><pose>1 2</pose></model>")
    assert code == 2
    assert f"{tmp_path / 'room.sdf'}:3:" in err
    assert "2 numbers; expected 6" in err
    assert [path.name for path in tmp_path.iterdir()] == ["room.sdf"]


LINK = "<link name='l'><collision name='c'><geometry>{}</geometry></collision></link>"
CUBE = "<box><size>1 1 1</size></box>"
BROKEN = {
    "a model.config that is no XML": (
        {"config": "<model><sdf>model.sdf"},
        "model.config",
        "no element",
    ),
    "a version that is not read": (
        {"version": "2.0", "config": "<model><sdf version='1.9'>model.sdf</sdf></model>"},
        "model.sdf",
        "SDF version '2.0'",
    ),
    "an impossible size": ({"inside": LINK.format("<sphere/>")}, "model.sdf", "needs a <radius>"),
    "a pose far away": (
        {"inside": "<pose>2e7 0 0 0 0 0</pose>" + LINK.format(CUBE)},
        "model.sdf",
        "more than 100000 m",
    ),
}
"""What is wrong with an included model, the file that says so, and words of the list."""


@pytest.mark.parametrize("case", BROKEN)
def test_one_bad_model_is_listed_and_everything_else_is_imported(run, box, model, tmp_path, case):
    how, file, words = BROKEN[case]
    model("bad", how.get("inside", LINK.format(CUBE)), **{k: how[k] for k in how if k != "inside"})
    code, out, _ = run(
        GROUND + box("a", "1 1 1") + "<include><uri>model://bad</uri></include>" + box("b", "1 1 1")
    )
    assert code == 0
    assert "2 bodies" in out
    (line,) = (line for line in out.splitlines() if words in line)
    assert f"{tmp_path}/models/bad/{file}:" in line


def test_what_gazebo_reads_though_it_is_no_xml_is_read(run, model, tmp_path):
    config = (
        "\n\n<?xml version='1.0'?><model><name>A & B -- C</name><!-- a -- b --><author>Zoë &nbsp;"
    )
    config += "</author><sdf version='1.3'>model.sdf</sdf></model>"
    model("odd", LINK.format(CUBE), version="1.3", config=config)
    (tmp_path / "models/odd/model.config").write_bytes(config.encode("latin-1"))
    code, out, _ = run(GROUND + "<include><uri>model://odd</uri></include>")
    assert code == 0
    assert "1 bodies" in out
    assert "Left out" not in out


def test_nothing_but_a_floor_is_left_of_broken_models(run):
    code, _, err = run(GROUND + "<model name='m'><pose>1 2</pose></model>")
    assert code == 2
    assert "nothing is left of this world" in err


def test_a_broken_mesh_leaves_the_rest(run, box, tmp_path):
    (tmp_path / "bad.stl").write_bytes(b"solid nothing")
    mesh = "<geometry><mesh><uri>bad.stl</uri></mesh></geometry>"
    inside = box("a", "1 1 1").replace("</link>", f"<visual name='w'>{mesh}</visual></link>")
    code, out, _ = run(GROUND + inside)
    assert code == 0
    assert "a/link/w" in out
    assert "bad.stl" in out


def test_collada_can_be_turned_upright(run, tmp_path):
    import trimesh

    (tmp_path / "box.dae").write_bytes(trimesh.creation.box((1, 2, 3)).export(file_type="dae"))
    mesh = "<geometry><mesh><uri>box.dae</uri></mesh></geometry>"
    inside = f"{GROUND}<model name='m'><static>1</static><link name='l'><visual name='v'>{mesh}"
    inside += "</visual></link></model>"
    assert "says Y_UP: its z is up, as in Gazebo" in run(inside)[1]
    assert "says Y_UP: it is turned upright" in run(inside, "--heed-up-axis", "--force")[1]


def test_an_empty_world_is_a_bare_floor(run, tmp_path):
    assert run(GROUND)[0] == 0
    assert "size: [20, 20]" in (tmp_path / "office.yaml").read_text()


def test_a_world_of_which_nothing_is_left_says_why(run):
    code, _, err = run("<include><uri>model://none</uri></include>" * 2)
    assert code == 2
    assert "nothing is left of this world: what it has is left out" in err
    assert "model://none" in err


def test_what_a_server_has_is_to_be_fetched_and_told_first(run):
    plugins = "<plugin name='p' filename='p.so'/>" * 12
    code, _, err = run(plugins + "<include><uri>https://fuel.org/1.0/O/models/Hall</uri></include>")
    assert code == 2
    assert "gz fuel download -u 'https://fuel.org/1.0/O/models/Hall'" in err.splitlines()[1]
    assert "by --models" in err.splitlines()[1]
