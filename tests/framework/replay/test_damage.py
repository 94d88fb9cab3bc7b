"""Damaged records: whatever is in the file, there is an answer and never an internal error."""

from __future__ import annotations

import random
import re
import struct
from dataclasses import replace

import pytest

from momantu_bt.cli import main
from momantu_bt.record.recording import ChangeRecord
from momantu_bt.record.soundness import check_sound

TREE = """
values: {n: 0}
trees:
  Main:
    - recover:
        attempts: 2
        try: [{work: {script: RRS, to: $at}}, {condition: $n > 0}]
        catch: {any: [{script: "$n := 1"}]}
    - work: {script: RF}
"""


MAGIC = 8
"""Bytes of the mark at the beginning and at the end of a file."""


@pytest.fixture(scope="module")
def whole(recorded):
    return recorded(TREE)


def cut(data, random):
    return data[: random.randrange(len(data))]


def flipped(data, random):
    found = bytearray(data)
    for _ in range(random.randint(1, 6)):
        found[random.randrange(len(found))] = random.randrange(256)
    return bytes(found)


def renumbered(data, random):
    """Still JSON, but with other numbers in it."""
    found = bytearray(data)
    places = [match.start() for match in re.finditer(rb"[0-9]", data)]
    for _ in range(random.randint(1, 3)):
        found[random.choice(places)] = ord(random.choice("0123456789"))
    return bytes(found)


def shortened(data, random):
    """One record of the file says a length that it has not."""
    places, at = [], MAGIC
    while at < len(data) - MAGIC:
        places.append(at + 1)
        at += 9 + struct.unpack_from("<Q", data, at + 1)[0]
    found = bytearray(data)
    length = random.choice([random.randrange(30), random.randrange(2**64)])
    struct.pack_into("<Q", found, random.choice(places), length)
    return bytes(found)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("damage", [cut, flipped, renumbered, shortened])
def test_damage_is_told_and_never_an_internal_error(whole, tmp_path, capsys, damage, seed):
    data = (whole.folder / "run.mcap").read_bytes()
    (tmp_path / "run.mcap").write_bytes(damage(data, random.Random(seed)))
    for words in (["replay"], ["replay", "--check"], ["replay", "--json"], ["diff", whole.folder]):
        code = main([words[0], str(tmp_path), *map(str, words[1:])])
        err = capsys.readouterr().err
        assert code in (0, 1, 2), err
        assert (code != 2) or str(tmp_path) in err


def test_what_leads_nowhere_is_named(whole):
    check_sound(whole)
    nodes, ticks = whole.nodes, whole.ticks
    for node, said in (
        (replace(nodes[1], parent=5), "below"),
        (replace(nodes[1], index=9), "stand"),
    ):
        with pytest.raises(ValueError, match=said):
            check_sound(replace(whole, nodes=(nodes[0], node, *nodes[2:])))
    for change, said in (
        (ChangeRecord(99, "RUNNING", "", None), "names node 99"),
        (ChangeRecord(0, "WALKING", "", None), "the status 'WALKING'"),
    ):
        tick = replace(ticks[1], changes=(change,))
        with pytest.raises(ValueError, match=said):
            check_sound(replace(whole, ticks=(ticks[0], tick)))


def test_what_is_missing_is_named(whole):
    report = dict(whole.report)
    counts = {name: value for name, value in report["nodes"][1].items() if name != "failures"}
    nodes = [report["nodes"][0], counts, *report["nodes"][2:]]
    for wrong, said in (
        ({"about": {"tree": "t.yaml"}}, "the run lacks world, robot, seed"),
        ({"report": {**report, "nodes": nodes}}, "node 1 of the report lacks failures"),
        ({"report": {**report, "failure": {"code": "LOST"}}}, "failure lacks message"),
        ({"report": {"status": "SUCCESS"}}, "the report lacks success"),
    ):
        with pytest.raises(ValueError, match=said):
            check_sound(replace(whole, **wrong))
