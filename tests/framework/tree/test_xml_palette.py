"""The models of our skills and nodes: read back, they say what the skills say."""

import pytest

from momantu_bt.cli import main
from momantu_bt.skill import MISSING, Port
from momantu_bt.tree.catalogue import NODES, Dialect, of_dialect
from momantu_bt.tree.files.xml.format import read
from momantu_bt.tree.files.xml.palette import palette
from momantu_bt.tree.model import Literal, NodeModel
from momantu_bt.tree.plugins import SKILLS
from momantu_bt.tree.registry import Registry
from momantu_bt.values.convert import convert
from momantu_bt.values.cpp_types import our_type
from momantu_bt.values.types import label, parse_type

TREE = '<BehaviorTree ID="Main"><AlwaysSuccess/></BehaviorTree></root>'


def models(text: str) -> dict[str, NodeModel]:
    document, problems = read(text.replace("</root>", TREE), "palette.xml")
    assert problems.sorted() == []
    return {model.name: model for model in document.models}


def test_each_skill_with_each_port(registry: Registry) -> None:
    found = models(palette(registry.skills))
    for name, skill in registry.skills.items():
        model = found[name]
        assert (model.kind, [*model.facts]) == ("Action", ["doc"])
        shown = {port.name: port for port in model.ports}
        assert set(shown) == set(skill.ports)
        for port in skill.ports.values():
            declared = shown[port.name]
            assert (declared.direction, declared.doc[: len(port.doc)]) == (port.direction, port.doc)
            assert ("required" in declared.doc) == port.required
            type_ = our_type(declared.type_name)
            assert type_ in (label(port.type), "text", "any") or "or" in label(port.type)
            if declared.default is not None:
                assert same_default(port, declared.default)


def same_default(port: Port, default: object) -> bool:
    assert isinstance(default, Literal)
    words = {True: "true", False: "false"}
    if isinstance(port.default, bool):
        return default.value == words[port.default]
    value = default.value if isinstance(port.default, str) else float(default.value)
    return bool(convert(value, port) == port.default)


def test_defaults_that_fit_an_attribute_are_there(registry: Registry) -> None:
    found = models(palette(registry.skills))
    for name, skill in registry.skills.items():
        shown = {port.name: port.default for port in found[name].ports}
        for port in skill.ports.values():
            simple = port.default is not MISSING and isinstance(port.default, str | int | float)
            assert (shown[port.name] is not None) == simple


def test_our_own_nodes_nav2s_and_handlers() -> None:
    found = models(palette({}))
    ours = {f"momantu:{name}" for name in of_dialect(Dialect.OURS)}
    assert set(found) == {*ours, "momantu:Catch", *of_dialect(Dialect.NAV2)}
    assert found["RecoveryNode"].kind == "Control"
    assert [port.name for port in found["RateController"].ports] == ["hz"]
    for name in of_dialect(Dialect.OURS):
        assert {port.name for port in found[f"momantu:{name}"].ports} == set(NODES[name].ports)
    assert parse_type(our_type(found["momantu:ForEach"].ports[0].type_name)) == tuple[object, ...]


def test_a_node_of_the_palette_in_a_tree() -> None:
    recover = (
        '<Control ID="momantu:Recover" attempts="2"><AlwaysFailure/>'
        '<Decorator ID="momantu:Catch" codes="any"><AlwaysSuccess/></Decorator></Control>'
    )
    text = '<root BTCPP_format="4">' + TREE.replace("<AlwaysSuccess/>", recover)
    document, problems = read(text, "t.xml")
    assert problems.sorted() == []
    root = document.trees["Main"].root
    assert (root.type, root.ports, root.handlers[0].codes) == (
        "Recover",
        {"attempts": Literal(2)},
        ("any",),
    )


def test_the_command_prints_every_installed_skill(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["skills", "--xml-model"]) == 0
    assert set(SKILLS) <= set(models(capsys.readouterr().out))
