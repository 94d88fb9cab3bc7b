"""What only XML says comes back from YAML, element by element."""

import random
from collections.abc import Iterator
from pathlib import Path

import pytest
from lxml import etree

from momantu_bt.cli import main
from momantu_bt.tree.convert import CannotWrite, Spelling, read_right, write
from momantu_bt.tree.problems import TreeError
from momantu_bt.tree.registry import Registry

NAMES = ["Main", "3Way", "A,B", "Pick (v2)", "two words", "sequence", "Ünder"]
TEXTS = ["", "{a}", "{=}", " {a} ", "1.500", "007", "true", "True", "1", "x y", "a\nb", "<&>", "é"]
TEXTS += ["{a.b}", "$x", "null", "# no comment", "[1, 2]", "{", "a: b", "-", "'", "1;2;3", "~"]
LEAVES = [
    "Go",
    "sequence",
    "wait",
    "retry",
    "node",
    "Foo.Bar",
    "AlwaysSuccess",
    "Sleep",
    "children",
]
AROUND = ["Sequence", "Fallback", "ForceSuccess", "RetryUntilSuccessful", "Parallel", "Theirs"]
AROUND += ["IfThenElse", "WhileDoElse", "Switch2", "ForEach", "ReactiveSequence", "Inverter"]
KINDS = ["Action", "Condition", "Control", "Decorator"]
ATTRIBUTES = [
    "_uid",
    "_favorite",
    "_collapsed",
    "_skipIf",
    "_description",
    "name",
    "to",
    "num_attempts",
]
ATTRIBUTES += ["msec", "code", "_onHalted", "theirs", "_x", "default"]
COMMENTS = ["one", "two\n     lines", "# a", "", "| b", "a: b", "-\\- c", "\u2028", "x " * 60]


class Writer:
    """Writes random documents in the dialect."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.explicit = self.random.random() < 0.4

    def document(self) -> bytes:
        r = self.random
        root = etree.Element("root", BTCPP_format="4")
        for name in r.sample(
            ["project_name", "_favorite", "main_tree_to_execute"], r.randint(0, 3)
        ):
            root.set(name, r.choice(NAMES))
        trees = r.sample(NAMES, r.randint(0, 3))
        parts = ["include"] * r.randint(0, 2) + ["tree"] * len(trees) + ["models"] * r.randint(0, 1)
        if r.random() < 0.3:
            r.shuffle(parts)
        for part in parts:
            self.comment(root)
            if part == "include":
                etree.SubElement(root, "include", path=r.choice(["a.xml", "b c.xml"]))
                if r.random() < 0.3:
                    root[-1].set("ros_pkg", "nav")
            elif part == "tree":
                self.tree(etree.SubElement(root, "BehaviorTree", ID=trees.pop()))
            else:
                self.models(etree.SubElement(root, "TreeNodesModel"))
        self.comment(root)
        for add in (root.addprevious, root.addnext):
            if r.random() < 0.2:
                add(etree.Comment(r.choice(COMMENTS)))
        return etree.tostring(root.getroottree(), encoding="utf-8", pretty_print=r.random() < 0.7)

    def comment(self, into: etree._Element) -> None:
        if self.random.random() < 0.2:
            into.append(etree.Comment(self.random.choice(COMMENTS)))

    def attributes(self, element: etree._Element, most: int) -> None:
        for name in self.random.sample(ATTRIBUTES, self.random.randint(0, most)):
            element.set(name, self.random.choice(TEXTS))

    def tree(self, element: etree._Element) -> None:
        self.attributes(element, 2)
        self.comment(element)
        for _ in range(self.random.choice([0, 1, 1, 1, 1, 1, 2])):
            self.node(element, 3)
            self.comment(element)

    def node(self, into: etree._Element, depth: int) -> None:
        r = self.random
        if r.random() < 0.2:
            element = etree.SubElement(into, "SubTree", ID=r.choice(NAMES))
        else:
            name = r.choice(LEAVES if not depth or r.random() < 0.4 else AROUND)
            if self.explicit != (r.random() < 0.1):
                element = etree.SubElement(into, r.choice(KINDS), ID=name)
            else:
                element = etree.SubElement(into, name)
        self.attributes(element, 4)
        if r.random() < 0.1:
            element.text = r.choice(["words", "a < b", "two\nlines"])
        if depth and r.random() < 0.8:
            for _ in range(r.randint(0, 3)):
                self.comment(element)
                self.node(element, depth - 1)
        self.comment(element)

    def models(self, section: etree._Element) -> None:
        r = self.random
        for name in r.sample([*NAMES, "Go"], r.randint(0, 3)):
            self.comment(section)
            model = etree.SubElement(section, r.choice([*KINDS, "SubTree", "SubTree"]), ID=name)
            for port in r.sample(["a", "b", "c d"], r.randint(0, 3)):
                tag = r.choice(["input_port", "output_port", "inout_port", "bidirectional_port"])
                element = etree.SubElement(model, tag, name=port)
                for attribute in r.sample(["type", "default", "_x"], r.randint(0, 3)):
                    element.set(attribute, r.choice([*TEXTS, "std::string", "double"]))
                element.text = r.choice([None, None, "what it is", "two\n  lines"])
            for _ in range(r.choice([0, 0, 1, 1, 2])):
                fields = etree.Element("MetadataFields")
                model.insert(r.randint(0, len(model)), fields)
                for key in r.sample(["runnable", "subcategory"], r.randint(0, 2)):
                    self.comment(fields)
                    etree.SubElement(fields, "Metadata", {key: r.choice(TEXTS)})


def _events(text: bytes) -> Iterator[object]:
    """Everything in an XML text in its order: elements, attributes, texts, comments."""
    parser = etree.XMLParser(remove_pis=True)
    root = etree.fromstring(text, parser)
    tree = root.getroottree()
    yield [(each.text or "").strip() for each in root.itersiblings(preceding=True)]
    for element in root.iter():
        yield tree.getpath(element)
        yield dict(element.attrib)
        yield ((element.text or "").strip(), (element.tail or "").strip())
    yield [(each.text or "").strip() for each in root.itersiblings()]


def _there_and_back(path: Path) -> bytes:
    registry = Registry()
    text = write(read_right(path, registry)[0], Spelling.YAML, registry)
    back = path.with_suffix(".yaml")
    back.write_text(text, encoding="utf-8")
    return write(read_right(back, registry)[0], Spelling.XML, registry).encode()


def test_random_documents_come_back_element_by_element(tmp_path: Path) -> None:
    path = tmp_path / "t.xml"
    for seed in range(150):
        text = Writer(seed).document()
        path.write_bytes(text)
        assert list(_events(_there_and_back(path))) == list(_events(text)), f"seed {seed}"


def test_damaged_documents_come_back_or_are_refused_with_a_line(tmp_path: Path) -> None:
    path, came_back = tmp_path / "t.xml", 0
    for seed in range(150):
        writer = Writer(seed)
        root = etree.fromstring(writer.document())
        for _ in range(3):
            _damage(root, writer.random)
        text = etree.tostring(root)
        path.write_bytes(text)
        back = _refused_or_back(path)
        if back is None:
            continue
        came_back += 1
        assert list(_events(back)) == list(_events(text)), f"seed {seed}"
    assert came_back > 60


def _refused_or_back(path: Path) -> bytes | None:
    """The document from YAML; None if it is refused, with a line for each reason."""
    try:
        return _there_and_back(path)
    except (TreeError, CannotWrite) as error:
        refused = error
    if isinstance(refused, TreeError):
        assert all(problem.place.line for problem in refused.problems)
    else:
        assert refused.place is not None, refused
    return None


def _damage(root: etree._Element, r: random.Random) -> None:
    element = r.choice(list(root.iter("*")))
    kind = r.randint(0, 5)
    parent = element.getparent()
    if kind == 0 and element.attrib:
        del element.attrib[r.choice(list(element.attrib))]
    elif kind == 1 and parent is not None:
        parent.remove(element)
    elif kind == 2:
        element.insert(0, etree.Element(r.choice([*LEAVES, *AROUND, "SubTreePlus", "root"])))
    elif kind == 3:
        element.set(r.choice(ATTRIBUTES), r.choice(TEXTS))
    elif kind == 4 and parent is not None:
        element.tail = r.choice(["words", ">"])
    elif parent is not None:
        element.tag = r.choice([*KINDS, *AROUND, "SubTree"])


@pytest.mark.parametrize("inside", ["", "<ForceSuccess/>", "<Retry><Go/><Go/></Retry>"])
def test_decorators_with_any_number_of_children(tmp_path: Path, inside: str) -> None:
    text = f'<root BTCPP_format="4"><BehaviorTree ID="M">{inside}</BehaviorTree></root>'
    path = tmp_path / "t.xml"
    path.write_text(text, encoding="utf-8")
    assert list(_events(_there_and_back(path))) == list(_events(text.encode()))


def test_how_it_looks_in_yaml(tmp_path: Path) -> None:
    path = tmp_path / "t.xml"
    path.write_text(
        """\
<root BTCPP_format="4" main_tree_to_execute="3Way" project_name="P">
  <BehaviorTree ID="3Way" _description="goes" _favorite="true">
    <Control ID="Sequence">
      <Action ID="Go" to="{=}" speed="1.500" _collapsed="true"/>
      <!-- the next one
           stands elsewhere -->
      <SubTree ID="Home" n="{n}"/>
      <Action ID="sequence" n="{n}"/>
    </Control>
  </BehaviorTree>
  <TreeNodesModel>
    <SubTree ID="3Way"><MetadataFields><Metadata runnable="true"/></MetadataFields></SubTree>
  </TreeNodesModel>
</root>
""",
        encoding="utf-8",
    )
    registry = Registry()
    assert (
        write(read_right(path, registry)[0], Spelling.YAML, registry)
        == """\
momantu_bt: 1
main: 3Way
xml: {tags: explicit, attributes: {project_name: P}}

trees:
  3Way:
    doc: goes
    metadata: {runnable: true}
    tree: {_favorite: true}
    sequence:
      - Go: {speed: "1.500"}
        _collapsed: true
        attributes: {to: "{=}"}
      # the next one
      #|           stands elsewhere
      - subtree: Home
        ports: {n: $n}
      - node: sequence
        ports: {n: $n}
"""
    )


def test_attributes_in_yaml_mean_what_they_mean_in_xml(tmp_path: Path) -> None:
    path = tmp_path / "t.yaml"
    path.write_text(
        "momantu_bt: 1\ntrees:\n  M:\n    - set: {key: $a, value: 1}\n"
        "    - node: ScriptCondition\n      attributes: {code: a == 1, _skipIf: a > 3}\n",
        encoding="utf-8",
    )
    assert main(["check", str(path)]) == 0
    text = path.read_text(encoding="utf-8").replace("a > 3", "a >")
    path.write_text(text, encoding="utf-8")
    assert main(["check", str(path)]) == 2


OLD = """\
<root main_tree_to_execute="Main">
  <BehaviorTree ID="Main">
    <SequenceStar>
      <SubTree ID="Sub" target="goal" __shared_blackboard="true"/>
      <SubTreePlus ID="Sub" __autoremap="1" target="{goal}"/>
      <BlackboardCheckInt value_A="{n}" value_B="3" return_on_mismatch="SUCCESS">
        <Go to="${goal}"/>
      </BlackboardCheckInt>
      <Parallel success_threshold="1" failure_threshold="2"><Go to="a"/></Parallel>
    </SequenceStar>
  </BehaviorTree>
  <BehaviorTree ID="Sub">
    <RetryUntilSuccesful num_attempts="2"><Go/></RetryUntilSuccesful>
  </BehaviorTree>
</root>
"""


def test_a_file_of_format_3(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old, new = tmp_path / "old.xml", tmp_path / "new.xml"
    old.write_text(OLD, encoding="utf-8")
    for verb in ("check", "convert"):
        assert main([verb, str(old)]) == 2
        shown = capsys.readouterr().err
        assert "format 3" in shown
        assert f"momantu-bt convert --from 3 {old} -o NEW.xml" in shown
    assert main(["convert", "--from", "3", str(old), "-o", str(new)]) == 0
    shown = capsys.readouterr().err
    assert f"{old}:4:1: __shared_blackboard has become _autoremap" in shown
    assert f"{old}:6:1: BlackboardCheckInt has become a Precondition" in shown
    text = new.read_text(encoding="utf-8")
    for line in (
        "<SequenceWithMemory>",
        '<SubTree ID="Sub" target="{goal}" _autoremap="true"/>',
        '<SubTree ID="Sub" target="{goal}" _autoremap="1"/>',
        '<Precondition if="n == 3" else="SUCCESS">',
        '<Go to="{goal}"/>',
        '<Parallel success_count="1" failure_count="2">',
        '<RetryUntilSuccessful num_attempts="2">',
    ):
        assert line in text
    assert main(["convert", "--from", "3", str(new)]) == 2
    assert "leave --from out" in capsys.readouterr().err
    assert main(["convert", "--from", "2", str(old)]) == 2
