"""XML files as documents: every form of a node, the header, models, and what is refused."""

from collections.abc import Callable
from typing import Any

import pytest

from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import Problem, Severity
from momantu_bt.tree.catalogue import NODES, XML_CONDITIONS, is_ours
from momantu_bt.tree.files.xml.format import read
from momantu_bt.tree.files.xml.ports import names_key
from momantu_bt.tree.files.yaml.format import read as read_yaml
from momantu_bt.tree.model import (
    Document,
    Handler,
    Literal,
    Node,
    NodeModel,
    Reference,
    Scope,
    Template,
)
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.script import parse
from momantu_bt.values.kinds import ScriptText

Expect = Callable[..., None]
OPENING = '<root BTCPP_format="4" xmlns:momantu="urn:momantu-bt:1">\n'


@pytest.fixture
def document(registry: Registry) -> Callable[[str], Document]:
    def found(text: str) -> Document:
        document, problems = read(text, "t.xml", registry)
        assert problems.sorted() == []
        return document

    return found


@pytest.fixture
def root(document: Callable[[str], Document]) -> Callable[[str], Node]:
    """The root of the tree `Main`; the tree `Sub` is there too."""

    def found(node: str) -> Node:
        sub = '<BehaviorTree ID="Sub"><AlwaysSuccess/></BehaviorTree>'
        model = (
            '<TreeNodesModel><SubTree ID="Sub"><input_port name="at" type="text"/>'
            '<inout_port name="n"/></SubTree></TreeNodesModel>'
        )
        text = OPENING.replace(">", ' main_tree_to_execute="Main">')
        text += f'<BehaviorTree ID="Main">{node}</BehaviorTree>{sub}{model}</root>'
        return document(text).trees["Main"].root

    return found


Root = Callable[[str], Node]


def whole(body: str, main: str = "") -> str:
    return f'{OPENING[:-2]}{main}>\n<BehaviorTree ID="Main">\n{body}\n</BehaviorTree>\n</root>'


def test_the_same_model_as_in_yaml(document: Callable[[str], Document]) -> None:
    xml = document(
        """<root BTCPP_format="4" main_tree_to_execute="Main" momantu:world="rooms"
      xmlns:momantu="urn:momantu-bt:1" momantu:version="1">
  <momantu:Values>
    <momantu:Value key="can">{category: can, diameter: 66 mm}</momantu:Value>
    <momantu:Value key="n">3</momantu:Value>
  </momantu:Values>
  <BehaviorTree ID="Main" momantu:doc="Does it.">
    <Sequence name="all">
      <reset_pose pose="home" momantu:disabled="true"/>
      <momantu:Recover attempts="3">
        <RetryUntilSuccessful num_attempts="2">
          <detect_object object="{can}" on="table_a" found="{found}" _skipIf="n &gt; 2"/>
        </RetryUntilSuccessful>
        <momantu:Catch codes="OBJECT_NOT_FOUND"><reset_pose pose="carry"/></momantu:Catch>
        <momantu:Catch codes="any"/>
      </momantu:Recover>
      <Take object="{found}" at="5"/>
      <Sleep msec="1500" momantu:duration="1.5 s"/>
      <Sleep msec="200"/>
      <momantu:ForEach in="{@stops}" as="{stop}"><say momantu:text="at ${stop}" pace="2"/>
      </momantu:ForEach>
      <SetBlackboard output_key="x" value="1;2"/>
    </Sequence>
  </BehaviorTree>
  <BehaviorTree ID="Take"><pick object="{object}" momantu:note="now"/></BehaviorTree>
  <TreeNodesModel>
    <SubTree ID="Main"/>
    <SubTree ID="Take">
      <input_port name="object" type="detected_object"/>
      <input_port name="at" type="std::string" default="x">where</input_port>
    </SubTree>
  </TreeNodesModel>
</root>""".replace("<Take ", '<SubTree ID="Take" ').replace('output_key="x"', 'output_key="x"')
    )
    yaml, problems = read_yaml(
        """momantu_bt: 1
world: rooms
main: Main
values: {can: {category: can, diameter: 66 mm}, n: 3}
trees:
  Main:
    doc: Does it.
    sequence:
      - reset_pose: home
        disabled: true
      - recover:
          attempts: 3
          try:
            detect_object: {object: $can, on: table_a, found: $found}
            skip_if: $n > 2
            retry: 2
          catch:
            OBJECT_NOT_FOUND: {reset_pose: {pose: carry}}
            any: again
      - Take: {object: $found, at: "5"}
      - wait: 1.5 s
      - wait: {msec: 200}
      - for_each: {in: $@stops, as: $stop, child: {say: {text: "at ${stop}", pace: 2}}}
      - set: {key: $x, value: 1;2}
    name: all
  Take:
    inputs: {object: detected_object, at: {type: text, default: x, doc: where}}
    pick: {object: $object}
    note: now
""",
        "t.yaml",
    )
    assert problems.sorted() == []
    named = yaml.trees["Main"].root.children[0]
    named.ports = {"pose": named.ports[""]}
    assert xml == yaml


def test_explicit_tags(root: Root) -> None:
    node = root(
        '<Control ID="Sequence"><Action ID="pick"/><Condition ID="say" text="5"/></Control>'
    )
    assert (node.type, [c.type for c in node.children]) == ("Sequence", ["pick", "say"])
    assert node.children[1].ports == {"text": Literal("5")}
    assert root('<Decorator ID="Inverter"><AlwaysSuccess/></Decorator>').type == "Inverter"


@pytest.mark.parametrize("type_", sorted(NODES))
def test_every_node_of_the_catalogue_with_every_port(type_: str, root: Root) -> None:
    spec = NODES[type_]
    prefix = "momantu:" if is_ours(type_) else ""
    names = {port: spec.xml.get(port, port) or f"momantu:{port}" for port in spec.ports}
    once = [port for port in names if not any(port in group[1:] for group in spec.one_of)]
    given = {port: "x" if spec.ports[port].type is ScriptText else "{k}" for port in once}
    given = {p: "k" if names_key(spec, p) else v for p, v in given.items()}
    given = {p: "$k" if names[p].startswith("momantu:") else v for p, v in given.items()}
    inside = "<AlwaysSuccess/>" * spec.children[0]
    inside += '<momantu:Catch codes="any"/>' if spec.handlers and type_ == "Recover" else ""
    inside += '<momantu:Catch codes="A"><Wait/></momantu:Catch>' if type_ == "Handle" else ""
    attributes = "".join(f' {names[port]}="{value}"' for port, value in given.items())
    node = root(f"<{prefix}{type_}{attributes}>{inside}</{prefix}{type_}>")
    assert (node.type, set(node.ports)) == (type_, set(once))
    assert all(v in (Literal("x"), Reference("k")) for v in node.ports.values())
    assert len(node.children) == spec.children[0]


@pytest.mark.parametrize(("ours", "theirs"), XML_CONDITIONS.items())
def test_conditions_are_canonical_scripts(ours: str, theirs: str, root: Root) -> None:
    node = root(f'<AlwaysSuccess {theirs}="a &amp;&amp; b || !c"/>')
    assert node.conditions == {ours: "a && b || !c"}
    assert parse(node.conditions[ours]).reads


def test_wires_and_texts(root: Root) -> None:
    node = root('<SubTree ID="Sub" at="{=}" n="{@m}" _autoremap="1" name="s" _description="why"/>')
    assert node.ports == {
        "at": Reference("at"),
        "n": Reference("m", scope=Scope.ROOT),
        "_autoremap": Literal(True),
    }
    assert (node.target, node.name, node.note) == ("Sub", "s", "why")
    assert root('<SubTree ID="Sub" at="7" n="7"/>').ports == {"at": Literal("7"), "n": Literal(7)}
    value = root('<say momantu:text="${a} of $$5"/>').ports["text"]
    assert value == Template((Reference("a"), " of $5"))
    assert root('<nobody_knows port="7" other="{k}"/>').ports["port"] == Literal(7)


def test_places_are_those_of_the_attributes(root: Root) -> None:
    node = root('<say\n  text="hallo"\n  _while="n"/>')
    assert node.port_places["text"] == Place("t.xml", 3, 9, 5)
    assert node.port_name_places["text"] == Place("t.xml", 3, 3, 4)
    assert node.condition_places["while"] == Place("t.xml", 4, 11, 1)
    assert (node.place.line, node.place.length) == (2, 3)


def test_handlers_and_again(root: Root) -> None:
    node = root(
        '<momantu:Recover attempts="2"><pick/><momantu:Catch codes="A | pick.B"/>'
        '<momantu:Catch codes="any"><say/></momantu:Catch></momantu:Recover>'
    )
    assert [c.type for c in node.children] == ["pick"]
    first, second = node.handlers
    assert first == Handler(("A", "pick.B"), None, first.place)
    assert second.codes == ("any",)
    assert second.node is not None
    assert second.node.type == "say"


def test_models_of_leaves_are_kept(document: Callable[[str], Document]) -> None:
    found = document(
        OPENING
        + '<BehaviorTree ID="Main"><Go/></BehaviorTree><TreeNodesModel>'
        + '<Action ID="Go" editable="true"><input_port name="to" type="Pose" default="1;2">where'
        + '</input_port><MetadataFields><Metadata a="b"/><Metadata c="d"/></MetadataFields>'
        + "</Action>"
        + '<Condition ID="Is"><output_port name="x"/></Condition></TreeNodesModel></root>'
    )
    go, is_ = found.models
    assert (go.name, go.kind, go.editable, go.facts) == (
        "Go",
        "Action",
        True,
        {"a": "b", "c": "d"},
    )
    port = go.ports[0]
    assert (port.name, port.direction, port.type_name) == ("to", "in", "Pose")
    assert (port.default, port.doc) == (Literal("1;2"), "where")
    assert is_ == NodeModel("Is", "Condition", is_.ports)
    assert found.trees["Main"].open


def test_types_of_ports_in_our_words(document: Callable[[str], Document]) -> None:
    types = {
        "std::string": "text",
        "int": "int",
        "unsigned int": "int",
        "double": "number",
        "bool": "bool",
        "BT::AnyTypeAllowed": "any",
        "std::vector&lt;double&gt;": "list of number",
        "geometry_msgs::msg::Pose": "any",
        "list of pose2d": "list of pose2d",
    }
    ports = "".join(f'<inout_port name="p{i}" type="{type_}"/>' for i, type_ in enumerate(types))
    found = document(
        f'{OPENING}<BehaviorTree ID="Main"><AlwaysSuccess/></BehaviorTree><TreeNodesModel>'
        f'<SubTree ID="Main">{ports}</SubTree></TreeNodesModel></root>'
    ).trees["Main"]
    assert [port.type_name for port in found.ports.values()] == list(types.values())
    assert not found.open


def test_defaults_of_a_model(document: Callable[[str], Document]) -> None:
    ports = (
        document(
            f'{OPENING}<BehaviorTree ID="Main"><AlwaysSuccess/></BehaviorTree><TreeNodesModel>'
            '<SubTree ID="Main"><input_port name="a" type="text" default="5"/>'
            '<inout_port name="b" default="{k}"/><input_port name="c" momantu:default="[1, 2]"/>'
            "</SubTree></TreeNodesModel></root>"
        )
        .trees["Main"]
        .ports
    )
    defaults = [port.default for port in ports.values()]
    assert defaults == [Literal("5"), Reference("k"), Literal([1, 2])]


def test_comments(document: Callable[[str], Document]) -> None:
    found = document(
        f'<!-- top -->{OPENING}<!-- main -->\n<BehaviorTree ID="Main">\n<!-- a --><Sequence>\n'
        "<say/> <!-- beside -->\n<!-- last --></Sequence></BehaviorTree>\n<!-- end -->\n</root>\n"
        "<!-- after -->"
    )
    tree = found.trees["Main"]
    assert (found.header_comments, tree.comments) == (("top",), ("main",))
    assert tree.root.comments == ("a",)
    assert tree.root.children[0].comments == ("beside",)
    assert tree.root.end_comments == ("last",)
    assert (found.comments, found.after_comments) == (("end",), ("after",))


GROOT = '<root BTCPP_format="4" project_name="P" main_tree_to_execute="A">\n'


def test_a_file_as_an_editor_writes_it(document: Callable[[str], Document]) -> None:
    found = document(
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        + GROOT
        + """  <!-- ////////// -->
  <BehaviorTree ID="A" _fullpath="doors/A">
    <Fallback _uid="3">
      <Inverter>
        <Condition ID="IsOpen" name="" door="{door}"/>
      </Inverter>
      <SubTree ID="B B" _fullpath="B" door="{door}" _autoremap="false"/>
      <Action ID="Smash" _onHalted="tries += 1"/>
    </Fallback>
  </BehaviorTree>
  <!-- ////////// -->
  <BehaviorTree ID="B B">
    <Timeout msec="1000"><Delay delay_msec="{ms}"><Parallel success_count="-1">
      <KeepRunningUntilFailure><Repeat num_cycles="-1"><Open door="{=}"/></Repeat>
      </KeepRunningUntilFailure>
    </Parallel></Delay></Timeout>
  </BehaviorTree>
  <!-- Description of Node Models (used by Groot) -->
  <TreeNodesModel>
    <Condition ID="IsOpen" editable="true"><input_port name="door" default="1"/></Condition>
    <Action ID="Open" editable="true"><inout_port name="door"/></Action>
    <Action ID="Smash" editable="true"/>
  </TreeNodesModel>
</root>
"""
    )
    assert (found.main, list(found.trees)) == ("A", ["A", "B B"])
    assert [model.name for model in found.models] == ["IsOpen", "Open", "Smash"]
    inner = found.trees["B B"].root
    assert (inner.type, inner.ports) == ("Timeout", {"msec": Literal(1000)})
    assert found.trees["A"].root.children[1].target == "B B"


def test_one_tree_is_the_main_one(document: Callable[[str], Document]) -> None:
    assert document(whole("<say/>")).main == "Main"


@pytest.mark.parametrize(
    ("text", "code", "message", "hint"),
    [
        ("<«tree» a='1'/>", "not-a-tree", "begins with <root>", 'BTCPP_format="4"'),
        (
            "<«root»><BehaviorTree ID='A'><say text='x'/></BehaviorTree></root>",
            "no-version",
            "",
            "",
        ),
        (whole("<say text='x'/>").replace('"4"', '"«3»"'), "wrong-version", "format 3", "--from 3"),
        (whole("<say text='x'/>", " main_tree_to_execute='«Man»'"), "unknown-tree", "", "Main?"),
        (whole("<say text='x'/>", " «main_tre»='Main'"), "unknown-key", "", "main_tree_to_execute"),
        (whole("<say text='x'/>", " «momantu:wrld»='rooms'"), "unknown-key", "", "world?"),
        (whole("<say text='x'/>", " momantu:world='«romms»'"), "unknown-world", "", "rooms?"),
        (whole("<say text='x'/>", " momantu:version='«2»'"), "wrong-version", "", "known: 1"),
        (whole("").replace("<BehaviorTree", "<«BehaviorTree»"), "no-node", "'Main'", ""),
        (whole("<say text='x'/><«say» text='x'/>"), "children", "2 nodes at its root", "Sequence"),
        ('<«root» BTCPP_format="4"/>', "no-trees", "no tree", "<BehaviorTree"),
        (whole("<«Sequenc»/>"), "unknown-node", "", "did you mean Sequence?"),
        (whole("<«sequence»/>"), "unknown-node", "", "did you mean Sequence?"),
        (whole("<«retry_until_succesful»/>"), "unknown-node", "", "RetryUntilSuccessful?"),
        (whole("<«Recover»/>"), "unknown-node", "", "did you mean momantu:Recover?"),
        (whole("<«momantu:Recoverr»/>"), "unknown-node", "", "did you mean momantu:Recover?"),
        (whole("<«momantu:Sequence»/>"), "unknown-node", "", "did you mean Sequence?"),
        (whole("<«Main»/>"), "unknown-node", "", '<SubTree ID="Main"/>'),
        (whole("<«SubTreePlus» ID='Main'/>"), "unknown-node", "", "did you mean SubTree?"),
        (whole("<SubTree ID='«Mian»'/>"), "unknown-tree", "'Mian'", "did you mean Main?"),
        (whole("<«SubTree»/>"), "not-a-node", "which tree", ""),
        (whole("<«Action»/>"), "not-a-node", "which node", ""),
        (whole("<say text='x'>«h»ello</say>"), "not-a-node", "means nothing", ""),
        (whole("<say text='x'><«say» text='y'/></say>"), "children", "takes no children", ""),
        (whole("<«IfThenElse»><say text='x'/></IfThenElse>"), "missing-child", "`then`", ""),
        (whole("<«Inverter»/>"), "children", "no child", "put one node inside"),
        (whole("<«RecoveryNode»><say text='x'/></RecoveryNode>"), "children", "has 1 child;", ""),
        (whole("<say text='x' «_skipif»='true'/>"), "unknown-modifier", "", "_skipIf?"),
        (whole("<say text='x' «ID»='y'/>"), "unknown-modifier", "'ID'", ""),
        (whole("<say text='x' _skipIf='1 + «;» 2'/>"), "script", "", ""),
        (whole("<say text='«{a b}»'/>"), "not-a-key", "names no key", "momantu:text"),
        (whole("<say text='x' «txt»='y'/>"), "unknown-port", "", "text?"),
        (whole("<Sleep «mesc»='1'/>"), "unknown-port", "", "msec?"),
        (whole("<Sleep «duration»='1 s'/>"), "unknown-port", "", "momantu:duration"),
        (
            whole("<RetryUntilSuccessful «attempts»='1'><say text='x'/></RetryUntilSuccessful>"),
            "unknown-port",
            "",
            "did you mean num_attempts?",
        ),
        (whole("<Sleep msec='«1s»'/>"), "wrong-value", "has a unit", ""),
        (whole("<Sleep msec='«1600»' momantu:duration='1.5 s'/>"), "wrong-value", "1600 ms", ""),
        (whole("<say text='x' «momantu:text»='y'/>"), "duplicate-key", "twice", "remove one"),
        (whole("<count number='«n»' poses='{p}'/>"), "not-a-key", "", "did you mean {n}?"),
        (whole("<«say»/>"), "missing-input", "'text'", ""),
        (whole("<say text='x' momantu:disabled='«yes»'/>"), "wrong-value", "true or false", ""),
        (whole("<«momantu:Catch» codes='any'/>"), "unknown-node", "", ""),
    ],
)
def test_what_is_refused(
    text: str,
    code: str,
    message: str,
    hint: str,
    check: Callable[[str], list[Problem]],
) -> None:
    start, length = text.index("«"), text.index("»") - text.index("«") - 1
    clean = text.replace("«", "").replace("»", "")
    line = clean.count("\n", 0, start) + 1
    column = start - (clean.rfind("\n", 0, start) + 1) + 1
    errors = [p for p in check(clean) if p.code not in ("unread-output",)]
    assert [p.code for p in errors] == [code], errors
    place = errors[0].place
    assert (place.line, place.column, place.length) == (line, column, length)
    assert message in errors[0].message
    assert hint in errors[0].hint


def test_every_error_at_once(check: Callable[[str], Any]) -> None:
    text = whole(
        '<Sequence bad="1"><say text="{" pace="1 kg"/><Sleep msec="1s"/><Nobody/>'
        '<SubTree ID="No"/><AlwaysSuccess _skipif="1" _while="("/></Sequence>'
    )
    assert {p.code for p in check(text)} == {
        "unknown-port",
        "wrong-value",
        "unknown-node",
        "unknown-tree",
        "unknown-modifier",
        "script",
    }


@pytest.mark.parametrize(
    ("parts", "code"),
    [
        ('<BehaviorTree ID="A"><say text="x"/></BehaviorTree>' * 2, "duplicate-tree"),
        ('<BehaviorTree ID="A"/><BehaviorTree ID="B"/>', "no-main"),
        ("<BehaviorTree/>", "bad-name"),
        ('<BehaviorTree ID="$a"/>', "bad-name"),
        ("<BehaviourTree/>", "unknown-key"),
        ("<momantu:Value/>", "unknown-key"),
        ("<momantu:Values><x/></momantu:Values>", "unknown-key"),
        ('<momantu:Values><momantu:Value key="1a">1</momantu:Value></momantu:Values>', "bad-name"),
        (
            '<momantu:Values><momantu:Value key="a">$b</momantu:Value></momantu:Values>',
            "wire-inside",
        ),
        ('<include/><BehaviorTree ID="A"/>', "include"),
        ('<include path="a" ros_pkg="b"/>', "include"),
        ("<TreeNodesModel><Aktion/></TreeNodesModel>", "unknown-key"),
        ("<TreeNodesModel><Action/></TreeNodesModel>", "bad-name"),
        ('<TreeNodesModel><Action ID="a"><port/></Action></TreeNodesModel>', "unknown-key"),
        ('<TreeNodesModel><SubTree ID="Z"/></TreeNodesModel>', "unknown-tree"),
    ],
)
def test_parts_of_a_file_that_are_refused(
    parts: str, code: str, check: Callable[[str], list[Problem]]
) -> None:
    tree = "" if "BehaviorTree" in parts else '<BehaviorTree ID="A"><AlwaysSuccess/></BehaviorTree>'
    assert code in {p.code for p in check(f"{OPENING}{parts}{tree}</root>")}


MODEL = """<root BTCPP_format="4" main_tree_to_execute="Main">
<BehaviorTree ID="Main"><SubTree ID="Take" at="here"/></BehaviorTree>
<BehaviorTree ID="Take"><ScriptCondition code="at == 'here'"/></BehaviorTree>
<TreeNodesModel>
<SubTree ID="Take">
<input_port name="at" type="text"/>
</SubTree>
</TreeNodesModel>
</root>
"""


@pytest.mark.parametrize(
    ("right", "slip", "code", "hint"),
    [
        ('<SubTree ID="Take">', '<SubTree ID="Taek">', "unknown-tree", "did you mean Take?"),
        ('type="text"', 'tyep="text"', "unknown-key", "did you mean type?"),
        ("<input_port", "input_port", "unknown-key", "a `<` may be missing"),
    ],
)
def test_slips_in_the_model_of_a_tree(right: str, slip: str, code: str, hint: str) -> None:
    assert read(MODEL, "t.xml")[1].sorted() == []
    found = read(MODEL.replace(right, slip), "t.xml")[1].sorted()
    line = MODEL[: MODEL.index(right)].count("\n") + 1
    assert (code, line, hint) in {(p.code, p.place.line, p.hint) for p in found}


def test_a_model_of_another_files_tree_is_a_warning() -> None:
    other = '<SubTree ID="SomethingElse"/></TreeNodesModel>'
    (found,) = read(MODEL.replace("</TreeNodesModel>", other), "t.xml")[1].sorted()
    assert (found.code, found.severity) == ("unknown-tree", Severity.WARNING)
