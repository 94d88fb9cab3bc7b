"""How a document looks in XML: plain attributes where they say the same, ours elsewhere."""

import pytest

from momantu_bt.tree.convert import Spelling, meaning, write
from momantu_bt.tree.files.scalars import CannotWrite
from momantu_bt.tree.files.xml import format as xml_format
from momantu_bt.tree.files.xml import writer as xml_writer
from momantu_bt.tree.files.yaml import format as yaml_format
from momantu_bt.tree.files.yaml import writer as yaml_writer
from momantu_bt.tree.registry import Registry


def _xml(body: str, registry: Registry | None = None, head: str = "") -> str:
    text = f"momantu_bt: 1\n{head}trees:\n  Main:\n    - {body}\n"
    document, problems = yaml_format.read(text, "t.yaml")
    assert problems.sorted() == []
    written = xml_writer.write(document, registry)
    again, problems = xml_format.read(written, "t.yaml", registry)
    assert problems.sorted() == []
    assert meaning(again) == meaning(document)
    return written


@pytest.mark.parametrize(
    ("body", "element"),
    [
        ("go: {to: $a}", '<go to="{a}"/>'),
        ("go: {to: $@a, at: home}", '<go to="{@a}" at="home"/>'),
        ("go: {to: $a.b}", '<go momantu:to="$a.b"/>'),
        ("go: {to: 'at ${n}: $$5'}", '<go momantu:to="&quot;at ${n}: $$5&quot;"/>'),
        ("go: {n: 5, x: 0.5, b: true}", '<go n="5" x="0.5" b="true"/>'),
        ("go: {n: '5', b: 'true'}", '<go momantu:n="&quot;5&quot;" momantu:b="&quot;true&quot;"/>'),
        ("go: {n: '010', x: '2.50', b: '1;2'}", '<go n="010" x="2.50" b="1;2"/>'),
        ("go: {n: 1e-07, none: }", '<go n="1e-07" momantu:none="null"/>'),
        ("go: {to: '{a}'}", '<go momantu:to="&quot;{a}&quot;"/>'),
        ("go: {to: 'a\"<&>'}", '<go to="a&quot;&lt;&amp;&gt;"/>'),
        ('go: {to: "a\\nb", at: "\\a"}', '<go to="a&#10;b" momantu:at="&quot;\\x07&quot;"/>'),
        ("go: {to: [1, {a: 66 mm}]}", '<go momantu:to="[1, {a: 66 mm}]"/>'),
        ("go: {name: a, _x: 1}", '<go momantu:name="a" momantu:_x="1"/>'),
        (
            "set: {key: $a, value: '5'}",
            '<SetBlackboard output_key="a" momantu:value="&quot;5&quot;"/>',
        ),
        ("fail: {code: OH, message: '5'}", '<momantu:Fail code="OH" message="5"/>'),
        ("was_entry_updated: $a", '<WasEntryUpdated entry="{a}"/>'),
        ("was_entry_updated: a", '<WasEntryUpdated momantu:entry="a"/>'),
        ("script: $a := $b > 1", '<Script code="a := b &gt; 1"/>'),
        ("two words", '<Action ID="two words"/>'),
    ],
)
def test_an_attribute_is_plain_where_it_can_be(body: str, element: str) -> None:
    assert element in _xml(body)


def test_a_text_port_of_a_skill_takes_a_number_as_a_text(registry: Registry) -> None:
    assert '<say text="5"/>' in _xml("say: {text: '5'}", registry)
    assert '<say momantu:text="5"/>' in _xml("say: {text: 5}", registry)


@pytest.mark.parametrize(
    ("time", "attributes"),
    [
        ("1.5 s", 'msec="1500" momantu:duration="1.5 s"'),
        ("2", 'msec="2000" momantu:duration="2"'),
        ("1 min 30 s", 'msec="90000" momantu:duration="1 min 30 s"'),
        ("0.5 ms", 'momantu:duration="0.5 ms"'),
        ("$n", 'momantu:duration="$n"'),
        ("{msec: 1500}", 'msec="1500"'),
    ],
)
def test_a_time_has_its_milliseconds_beside_it(time: str, attributes: str) -> None:
    assert f"<Sleep {attributes}/>" in _xml(f"wait: {time}")
    delayed = attributes.replace("msec=", "delay_msec=")
    assert f"<Delay {delayed}>" in _xml(f"succeed:\n      delay: {time}")


def test_a_port_with_a_strange_name() -> None:
    written = _xml("go: {a b: 5, disabled: x}")
    assert '<momantu:Port name="a b">5</momantu:Port>' in written
    assert '<momantu:Port name="disabled">x</momantu:Port>' in written
    assert '<momantu:Port name="">home</momantu:Port>' in _xml("go: home")


def test_a_bare_value_of_a_skill_gets_its_port(registry: Registry) -> None:
    document, _ = yaml_format.read("momantu_bt: 1\ntrees: {Main: [reset_pose: home]}", "t.yaml")
    assert '<reset_pose pose="home"/>' in write(document, Spelling.XML, registry)
    assert "- reset_pose: home\n" in write(document, Spelling.YAML, registry)


def test_conditions_modifiers_and_handlers() -> None:
    written = _xml(
        "pick: {at: $a}\n      name: it\n      note: a\n      disabled: true\n"
        "      skip_if: not $b\n      retry: 3\n      timeout: 2 s\n"
        "    - recover:\n        attempts: 2\n        try: succeed\n        catch:\n"
        "          A | go.B: again\n          any: {wait: 1 s}"
    )
    lines = [line.strip() for line in written.splitlines()]
    start = lines.index('<Timeout msec="2000" momantu:duration="2 s">')
    assert lines[start : start + 3] == [
        '<Timeout msec="2000" momantu:duration="2 s">',
        '<RetryUntilSuccessful num_attempts="3">',
        '<pick name="it" at="{a}" _skipIf="!b" _description="a" momantu:disabled="true"/>',
    ]
    assert '<momantu:Catch codes="A | go.B"/>' in lines
    assert '<momantu:Catch codes="any">' in lines


def test_the_header_and_values() -> None:
    head = "world: rooms\nmain: Main\nvalues: {a: {b: 66 mm}, c: '<5'}\n"
    written = _xml("succeed", head=head)
    assert 'main_tree_to_execute="Main" xmlns:momantu="urn:momantu-bt:1"' in written
    assert 'momantu:world="rooms"' in written
    assert '<momantu:Value key="a">{b: 66 mm}</momantu:Value>' in written
    assert '<momantu:Value key="c">&lt;5</momantu:Value>' in written
    assert "momantu" not in _xml("go: {to: home}")


GROOT = """\
<root BTCPP_format="4" main_tree_to_execute="Main">
  <BehaviorTree ID="Main">
    <Theirs rate="5">
      <Go to="{a}"/>
      <SubTree ID="Sub" n="{a}" _autoremap="true"/>
    </Theirs>
  </BehaviorTree>
  <BehaviorTree ID="Sub">
    <Go/>
  </BehaviorTree>
  <TreeNodesModel>
    <Action ID="Go" editable="true">
      <input_port name="to" type="Pose" default="{p}">where: to</input_port>
      <MetadataFields>
        <Metadata a="b"/>
        <Metadata c="d"/>
      </MetadataFields>
    </Action>
    <SubTree ID="Main">
      <inout_port name="a" default="{out}"/>
    </SubTree>
  </TreeNodesModel>
</root>
"""


def _there_and_back(text: str) -> str:
    document, problems = xml_format.read(text, "t.xml")
    assert problems.sorted() == []
    again, problems = yaml_format.read(yaml_writer.write(document), "t.xml")
    assert problems.sorted() == []
    assert meaning(again) == meaning(document)
    return xml_writer.write(again)


def test_models() -> None:
    back = [line.strip() for line in _there_and_back(GROOT).splitlines()]
    for line in GROOT.splitlines():
        assert line.strip() in back, line


def test_an_unknown_node_keeps_its_children() -> None:
    document, _ = xml_format.read(GROOT, "t.xml")
    written = yaml_writer.write(document)
    assert "theirs" not in written
    assert "    Theirs:\n      rate: 5\n      children:\n        - Go: {to: $a}\n" in written


COMMENTS = """\
<!-- 1 --><root BTCPP_format="4">
  <!-- 2 --><include path="other.xml"/>
  <!-- 3 -->
  <BehaviorTree ID="Main"> <!-- 4 -->
    <!-- 5
         6 -->
    <Sequence> <!-- 7 -->
      <A/> <!-- 8 -->
      <!-- 9 -->
    </Sequence>
    <!-- 10 -->
  </BehaviorTree>
  <!-- 11 -->
  <TreeNodesModel>
    <!-- 12 -->
    <Action ID="A"/>
    <!-- 13 -->
  </TreeNodesModel>
  <!-- 14 -->
</root>
<!-- 15 -->
"""


def test_every_comment_of_an_xml_file_survives() -> None:
    text = COMMENTS.replace('<!-- 2 --><include path="other.xml"/>', "<!-- 2 -->")
    for source in (text, _there_and_back(text)):
        written = _there_and_back(source)
        found = [int(part.split()[0]) for part in written.split("<!--")[1:]]
        assert found == [number for number in range(1, 16) if number != 6]
        assert "5\n         6 -->" in written


@pytest.mark.parametrize("text", ["\x07", "\ufffe"])
def test_what_xml_cannot_hold_is_refused(text: str) -> None:
    document, _ = yaml_format.read("momantu_bt: 1\ntrees: {Main: [succeed]}", "t.yaml")
    document.trees["Main"].root.children[0].name = text
    with pytest.raises(CannotWrite) as caught:
        xml_writer.write(document)
    assert caught.value.place is not None
