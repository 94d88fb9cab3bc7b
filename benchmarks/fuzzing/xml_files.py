"""Well-formed XML of the language's own words, in all the wrong places."""

from __future__ import annotations

import random
import re

from fuzzing.words import Words
from momantu_bt.tree.catalogue import SPELLED

_WIRES = ("{a}", "{@b}", "{=}", "{a.x}", "1;2;3")
_ENTITIES = ("&amp;", "&#x41;", "&#0;", "&no;")


def xml_file(r: random.Random, words: Words) -> str:
    """A tree file with a main tree and perhaps another one, and its model."""
    spaces = ' xmlns:momantu="urn:momantu-bt:1"' if r.random() < 0.8 else ""
    main = ' main_tree_to_execute="Main"' if r.random() < 0.8 else ""
    root = f'<root BTCPP_format="{r.choice(["4", "4", "4", "3", ""])}"{main}{spaces}>'
    trees = f'<BehaviorTree ID="Main">{_node(r, words, r.randint(1, 5))}</BehaviorTree>'
    if r.random() < 0.5:
        trees += f'<BehaviorTree ID="Sub">{_node(r, words, 2)}</BehaviorTree>'
    if r.random() < 0.3:
        model = f'<SubTree ID="Sub">{_model(r, words)}</SubTree>'
        trees += f"<TreeNodesModel>{model}</TreeNodesModel>"
    return f"{root}{trees}</root>"


def _model(r: random.Random, words: Words) -> str:
    kinds = ["input_port", "output_port", "inout_port", "port"]
    return "".join(
        f'<{r.choice(kinds)} name="{_text(r, words)}" type="{_text(r, words)}"/>'
        for _ in range(r.randint(0, 3))
    )


def _node(r: random.Random, words: Words, depth: int) -> str:
    spec = r.choice([None, *SPELLED.values()])
    name = spec.type if spec is not None else r.choice(words.nodes)
    spelled = r.choice([name, name, name, f"momantu:{name}", "Action", "Decorator", "SubTree"])
    ports = [*(spec.ports if spec is not None else ()), "ID", "name", "_skipIf", "_while"]
    given = r.sample(ports, r.randint(0, min(4, len(ports))))
    attributes = "".join(
        f' {r.choice(["", "", "momantu:"])}{key}="{_text(r, words)}"' for key in given
    )
    count = 0 if depth == 0 else r.randint(0, 3)
    below = "".join(_node(r, words, depth - 1) for _ in range(count))
    return f"<{spelled}{attributes}>{below}</{spelled}>"


def _text(r: random.Random, words: Words) -> str:
    word = r.choice([*words.all, *_WIRES, *_ENTITIES])
    return word if word in _ENTITIES else re.sub(r'[<&"]', "", word)
