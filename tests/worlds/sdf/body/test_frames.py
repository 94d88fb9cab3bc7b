"""Poses compose as SDF says, whatever hangs on what."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from momantu_worlds.sdf.body.placing import placed_models
from momantu_worlds.sdf.deviations import Deviations

from momantu_bt.geometry import Transform

SIX = st.tuples(*[st.floats(-3, 3)] * 6)
LINK = "<link name='{name}'>{pose}</link>"


def text(pose):
    return " ".join(f"{value:.12f}" for value in pose)


def matrix(pose):
    x, y, z, roll, pitch, yaw = pose
    c, s = np.cos([roll, pitch, yaw]), np.sin([roll, pitch, yaw])
    about_x = np.array([[1, 0, 0], [0, c[0], -s[0]], [0, s[0], c[0]]])
    about_y = np.array([[c[1], 0, s[1]], [0, 1, 0], [-s[1], 0, c[1]]])
    about_z = np.array([[c[2], -s[2], 0], [s[2], c[2], 0], [0, 0, 1]])
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = about_z @ about_y @ about_x, (x, y, z)
    return found


def links(world):
    """Pose in the world of every link, by its path."""
    models = placed_models(world, Deviations())
    inner = (one for model in models for one in model.everything())
    return {placed.subject: placed.world_from_link for one in inner for placed in one.links}


def only(found):
    (pose,) = found.values()
    return pose


@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_random_trees_of_frames_compose_as_matrices_do(read, data):
    """Models within models; in each, frames and links that hang on any earlier one."""
    expected, lines = {}, []
    world, depth = np.eye(4), data.draw(st.integers(1, 4))
    for level in range(depth):
        pose = data.draw(SIX)
        lines.append(f"<model name='m{level}'><pose>{text(pose)}</pose>")
        world = world @ matrix(pose)
        here = {"__model__": world}
        for number in range(data.draw(st.integers(1, 5))):
            kind = "link" if number == 0 else data.draw(st.sampled_from(["link", "frame"]))
            parent, pose = data.draw(st.sampled_from(sorted(here))), data.draw(SIX)
            name = f"x{number}"
            here[name] = here[parent] @ matrix(pose)
            attached = f" attached_to='{parent}'" if kind == "frame" else ""
            relative = "" if kind == "frame" else f" relative_to='{parent}'"
            lines.append(
                f"<{kind} name='{name}'{attached}><pose{relative}>{text(pose)}</pose></{kind}>"
            )
            if kind == "link":
                path = "/".join([*(f"m{n}" for n in range(level + 1)), name])
                expected[path] = here[name]
    lines += ["</model>"] * depth
    found = links(read("\n".join(lines))[0])
    assert found.keys() == expected.keys()
    for path, pose in found.items():
        assert pose.matrix == pytest.approx(expected[path], abs=1e-7), path


@settings(max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(SIX, SIX, SIX)
def test_a_placement_frame_lies_where_the_model_is_put(read, model, frame, link):
    inside = f"""<model name='m' placement_frame='f'><pose>{text(model)}</pose>
        <frame name='f'><pose>{text(frame)}</pose></frame>
        <link name='l'><pose relative_to='f'>{text(link)}</pose></link></model>"""
    found = only(links(read(inside)[0]))
    assert found.matrix == pytest.approx(matrix(model) @ matrix(link), abs=1e-7)


@settings(max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(SIX, SIX, SIX)
def test_names_reach_into_models_and_joints_are_frames(read, arm, child, tip):
    inside = f"""<model name='m'>
        <model name='arm'><pose>{text(arm)}</pose>
          <link name='a'/><link name='b'><pose>{text(child)}</pose></link>
          <joint name='j' type='revolute'><parent>a</parent><child>b</child></joint></model>
        <link name='tip'><pose relative_to='arm::j'>{text(tip)}</pose></link></model>"""
    found = links(read(inside)[0])["m/tip"]
    assert found.matrix == pytest.approx(matrix(arm) @ matrix(child) @ matrix(tip), abs=1e-7)


def test_frames_of_the_world_carry_models(read):
    inside = """<frame name='f'><pose>1 2 0 0 0 1.5707963267948966</pose></frame>
        <frame name='g' attached_to='f'><pose>1 0 0 0 0 0</pose></frame>
        <model name='m'><pose relative_to='g'>0 0 3 0 0 0</pose><link name='l'/></model>"""
    assert only(links(read(inside)[0])).position == pytest.approx([1, 3, 3])


def test_a_merged_model_gives_its_names_to_the_one_around_it(read, model):
    model("part", "<link name='inner'><pose>1 0 0 0 0 0</pose></link>")
    inside = """<model name='m'><include merge='true'><uri>model://part</uri>
        <pose>0 1 0 0 0 0</pose></include>
        <link name='outer'><pose relative_to='inner'>0 0 1 0 0 0</pose></link></model>"""
    assert links(read(inside)[0])["m/outer"].position == pytest.approx([1, 1, 1])


def test_old_files_may_name_frames_that_are_not_there(read):
    inside = "<model name='m'><pose frame='map'>1 0 0 0 0 0</pose><link name='l'/></model>"
    assert only(links(read(inside, "1.6")[0])).position == pytest.approx([1, 0, 0])


@pytest.mark.parametrize(
    ("inside", "words"),
    [
        ("<link name='l'><pose relative_to='nobody'/></link>", "no frame 'nobody'"),
        (
            "<link name='a'><pose relative_to='b'/></link>"
            "<link name='b'><pose relative_to='a'/></link>",
            "a -> b -> a hang on each other",
        ),
        ("<link name='l'><pose relative_to='l'/></link>", "l -> l hang on each other"),
        (
            "<frame name='f' attached_to='f'/><link name='l'><pose relative_to='f'/></link>",
            "f -> f",
        ),
        ("<link name='l'><pose relative_to='arm::tip'/></link>", "no frame 'arm::tip'"),
    ],
)
def test_a_model_whose_frames_hang_nowhere_is_listed_and_the_rest_is_placed(read, inside, words):
    world, deviations = read(
        f"<model name='m'>{inside}</model><model name='n'><link name='l'/></model>"
    )
    assert [model.model.name for model in placed_models(world, deviations)] == ["n"]
    (found,) = deviations
    assert words in found.what
    assert (found.subject, found.place.line) == ("m", 3)
    assert deviations.models_lost == 1


def test_a_chain_of_thousands_of_frames_is_no_trouble(read):
    frames = "".join(
        f"<frame name='f{n}' attached_to='f{n - 1}'><pose>0.001 0 0 0 0 0</pose></frame>"
        for n in range(1, 4000)
    )
    inside = f"<model name='m'><frame name='f0'/>{frames}<link name='l'>"
    inside += "<pose relative_to='f3999'/></link></model>"
    assert only(links(read(inside)[0])).position[0] == pytest.approx(3.999)


STATE = """<model name='m'><pose>9 9 9 0 0 0</pose>
    <link name='a'><pose>1 0 0 0 0 0</pose></link><link name='b'><pose>2 0 0 0 0 0</pose></link>
    <model name='n'><pose>0 5 0 0 0 0</pose><link name='c'/></model></model>
  <light name='lamp' type='point'><pose>0 0 2 0 0 0</pose></light>
  <state world_name='room'><sim_time>1 0</sim_time>
    <model name='m'><pose>0 0 1 0 0 0</pose><link name='b'><pose>7 7 7 0 0 0</pose></link></model>
    <light name='lamp'><pose>0 0 3 0 0 0</pose></light>
    <model name='gone'><pose>0 0 0 0 0 0</pose></model></state>"""


def test_a_saved_state_says_where_models_and_links_are(read):
    world, _ = read(STATE)
    deviations = Deviations()
    models = placed_models(world, deviations)
    inner = [one for model in models for one in model.everything()]
    found = {p.subject: p.world_from_link.position.tolist() for one in inner for p in one.links}
    assert found == {"m/a": [1, 0, 1], "m/b": [7, 7, 7], "m/n/c": [0, 5, 1]}
    assert world.light_states["lamp"] == Transform((0, 0, 3))
    assert [deviation.subject for deviation in deviations] == ["gone"]
