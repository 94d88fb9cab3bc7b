"""What a tick costs: our engine beside bare py_trees, interleaved in one process.

    python benchmarks/tick.py
    python benchmarks/tick.py --nodes 10 100 1000 --rounds 30

Both sides tick trees of one shape: a sequence of groups of nine leaves each. On the bare side a
leaf is a py_trees behaviour whose `update` returns a constant, and the groups are py_trees'
sequences and selectors. On our side a leaf has ports: it reads one key and writes another, or
fails with a code and a sentence that its group looks at. Recording is what `run --record` does on
each tick: the fingerprint over statuses and written keys, and both in the run's log.

walk      groups are sequences; every leaf is ticked and succeeds
fallback  groups are fallbacks; of nine leaves eight fail, with their reasons, and one succeeds
running   every leaf but the last is done; the last runs on and is all that has work to do

The cost is that of a tick of the whole tree, divided by its nodes; of several rounds in turn the
median counts. The demands: ours at most half of bare py_trees, ours with recording at most as much.

A second table says what it costs to run a skill from its start to its end, in the same trees. On
its left stand a py_trees behaviour and our built-in leaf with the same ports, which do as much.

ends       it has no ports and ends at once; the built-in leaf is AlwaysSuccess
ports      it reads a key and a literal, both with bounds, and writes a key; SetBlackboard
fails      it fails at once with a code; Fail
two ticks  it ends in its second tick; Sleep

The cost is that of all ticks from the starts to the ends, divided by the leaves. The demand: a
skill costs at most twice a bare py_trees leaf.
"""

from __future__ import annotations

import argparse
import gc
import logging
import statistics
import tempfile
from pathlib import Path

import py_trees
from ticking import shapes, starts
from ticking.measuring import measured, ratio


def compare(shape: str, nodes: int, rounds: int) -> None:
    """One line of the first table."""
    with tempfile.TemporaryDirectory() as folder:
        found = measured(shapes.sides(shape, nodes, Path(folder)), rounds)
    count = shapes.groups_of(nodes) * (shapes.GROUP + 1) + 1
    cost = {name: statistics.median(each) / count * 1e6 for name, each in found.items()}
    ratios = [ratio(found[name], found["bare"]) for name in ("ours", "recorded")]
    print(
        f"{shape:9} {count:6d} {cost['bare']:10.2f} {cost['ours']:10.2f} {cost['recorded']:10.2f}"
        f" {ratios[0]:12.2f} {ratios[1]:15.2f}"
    )


def compare_starts(case: starts.Case, rounds: int) -> None:
    """One line of the second table."""
    with tempfile.TemporaryDirectory() as folder:
        found = measured(starts.sides(case, Path(folder)), rounds)
    cost = {name: statistics.median(each) / starts.LEAVES * 1e6 for name, each in found.items()}
    print(
        f"{case.title:9} {cost['bare']:10.2f} {cost['leaf']:10.2f} {cost['skill']:10.2f}"
        f" {cost['recorded']:10.2f} {ratio(found['skill'], found['leaf']):12.2f}"
        f" {ratio(found['skill'], found['bare']):15.2f}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--nodes", type=int, nargs="+", default=[10, 100, 1000])
    parser.add_argument("--shapes", nargs="*", choices=shapes.SHAPES, default=list(shapes.SHAPES))
    parser.add_argument("--rounds", type=int, default=15)
    asked = parser.parse_args()
    py_trees.logging.level = py_trees.logging.Level.WARN
    logging.disable()
    gc.disable()
    print("microseconds per node and tick               ratio to bare py_trees")
    print("shape      nodes       bare       ours   recorded         ours        recorded")
    for shape in asked.shapes:
        for nodes in asked.nodes:
            compare(shape, nodes, asked.rounds)
            gc.collect()
    print("demanded: at most                                           0.50            1.00\n")
    print("microseconds from a start to its end                  ratio of the skill to")
    print("skill           bare   our leaf      skill   recorded     our leaf   bare py_trees")
    for case in starts.CASES:
        compare_starts(case, asked.rounds)
        gc.collect()
    print("demanded: at most                                                             2.00")


if __name__ == "__main__":
    main()
