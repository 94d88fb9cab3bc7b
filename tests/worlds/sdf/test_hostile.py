"""Whatever is done to a world's text: it is imported, or refused with a place; nothing else."""

import random
import re
from pathlib import Path

import pytest
from momantu_worlds.sdf.errors import SdfError
from momantu_worlds.sdf.importing import import_world

WORLD = """<sdf version='1.9'>
<world name='w'>
<include><uri>model://sun</uri></include>
<frame name='f'><pose>1 0 0 0 0 0</pose></frame>
<model name='a' placement_frame='g'><pose relative_to='f'>0 0 1 0 0 0</pose>
  <frame name='g' attached_to='l'/>
  <link name='l'><inertial><mass>1</mass></inertial>
    <collision name='c'><geometry><box><size>1 1 1</size></box></geometry>
      <surface><friction><ode><mu>1</mu></ode></friction></surface></collision>
    <visual name='v'><geometry><sphere><radius>.1</radius></sphere></geometry>
      <material><diffuse>1 0 0 1</diffuse></material></visual>
    <light name='lt' type='point'><diffuse>1 1 1 1</diffuse></light></link>
  <link name='m'><pose relative_to='l'>0 0 1 0 0 0</pose></link>
  <joint name='j' type='revolute'><parent>l</parent><child>m</child></joint>
  <model name='n'><static>1</static><link name='x'><visual name='v'><geometry>
    <plane><normal>0 0 1</normal></plane></geometry></visual></link></model></model>
<include><uri>model://t</uri><name>t</name><pose>1 1 1 0 0 0</pose></include>
<state><model name='a'><pose>0 0 1 0 0 0</pose><link name='m'><pose>0 0 2 0 0 0</pose></link>
</model></state>
</world></sdf>"""
WORDS = [
    *("nan", "inf", "-1", "0", "1e308", "1e-320", "", "true", "world", "__model__", "a::b", "::"),
    *("model://", "model://t", "model://../x", "../../etc/passwd", "file:///etc/passwd", "%00"),
    *("\u00e9", "9" * 400, "1 2", "1 2 3 4 5 6 7", "Gazebo/Wood", "fixed", "__root__"),
]
TEXT = re.compile(r">([^<>\n]+)<")
ATTRIBUTE = re.compile(r"='([^']*)'")
LEAF = re.compile(r"<(\w+)[^<>]*>[^<>]*</\1>")
TAGS = sorted(set(re.findall(r"<(\w+)", WORLD)))


def spoilt(text: str, draw: random.Random) -> str:
    """The text with one thing in it changed."""
    how = draw.randrange(6)
    if how < 2:
        found = draw.choice(list((TEXT, ATTRIBUTE)[how].finditer(text)))
        return text[: found.start(1)] + draw.choice(WORDS) + text[found.end(1) :]
    if how == 2:
        return re.sub(rf"<(/?){draw.choice(TAGS)}\b", rf"<\1{draw.choice(TAGS)}", text)
    if how < 5:
        leaf = draw.choice(list(LEAF.finditer(text)))
        return text[: leaf.start()] + leaf[0] * (0 if how == 3 else 2) + text[leaf.end() :]
    at = draw.randrange(len(text))
    return text[:at] + draw.choice("<>&' x\x00") + text[at + 1 :]


@pytest.mark.parametrize("seed", range(0, 300, 60))
def test_a_spoilt_world_is_imported_or_refused(tmp_path, model, seed):
    model("t", "<link name='k'><visual name='v'><geometry><empty/></geometry></visual></link>")
    file = tmp_path / "w.sdf"
    read = 0
    for number in range(seed, seed + 60):
        draw = random.Random(number)
        text = WORLD
        for _ in range(draw.randint(1, 3)):
            text = spoilt(text, draw)
        file.write_text(text, encoding="utf-8")
        said = refusal(file)
        read += said is None
        assert said is None or said.startswith(str(tmp_path)), number
    assert 5 < read < 55


def refusal(file: Path) -> str | None:
    """Why a world is refused; None when it is imported and what is written can be read."""
    output = file.with_suffix(".yaml")
    try:
        import_world(file, output).write(output)
    except SdfError as error:
        return str(error)
    return None
