"""What a record says before the first tick: the run, its files, its nodes."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from typing import Any

from momantu_bt.engine.executor import Executor
from momantu_bt.engine.node import TreeNode
from momantu_bt.record.codec import dumps, to_json
from momantu_bt.record.versions import versions
from momantu_bt.tree.files.settings import SET
from momantu_bt.tree.model import Document
from momantu_bt.world import WorldTexts

FORMAT = 1
"""The format of records; goes up by one when older readers would misread a record."""
SITE = "site.json"


def run_data(document: Document, options: Mapping[str, Any], run: Executor) -> dict[str, Any]:
    """`/run`. options: the other choices for the run, besides its seed and its files."""
    world = run.world
    return {
        "format": FORMAT,
        "tree": document.file,
        "main": document.main,
        "world": None if world is None else world.name,
        "robot": None if world is None else world.robot.description.name,
        "seed": run.context.seed,
        "options": {name: to_json(value) for name, value in options.items()},
        "values": {key: to_json(value.value) for key, value in document.values.items()},
        "versions": versions(),
        "unix_time": time.time(),
    }


def files_of(
    document: Document, substitution: Mapping[str, str], run: Executor
) -> Iterator[dict[str, str]]:
    """`/files`, one by one: the tree and its included files, then all others.

    substitution: texts, by name, of files that replace what nodes do.
    """
    given = {place.file for place in document.value_places.values()} - {document.file}
    for name, text in document.source.items():
        if name != SET or text:
            yield {"name": name, "kind": "values" if name in given else "tree", "text": text}
    for name, text in substitution.items():
        yield {"name": name, "kind": "substitution", "text": text}
    if run.context.body is not None:
        site = dumps(to_json(run.context.body.site))
        yield {"name": SITE, "kind": "site", "text": site}
    if isinstance(run.world, WorldTexts):
        for name, text in run.world.texts().items():
            yield {"name": name, "kind": "world", "text": text}
    if run.world is not None:
        for name, text in run.world.robot.description.texts().items():
            yield {"name": name, "kind": "robot", "text": text}


def nodes_data(run: Executor) -> dict[str, Any]:
    """`/nodes`."""
    return {"nodes": [_node(node) for node in run.built.nodes]}


def _node(node: TreeNode) -> Mapping[str, Any]:
    return {
        "index": node.index,
        "name": node.name,
        "type": node.model.target or node.model.type,
        "place": node.place,
        "depth": node.depth,
        "parent": None if node.above is None else node.above.index,
        "label": node.label,
        "role": node.role.value,
        **({"plan": node.shown_children} if node.shown_children else {}),
        **({"around": node.around} if node.around else {}),
    }
