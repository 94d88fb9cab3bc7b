"""Write a failure in one line, the outermost node first.

`my_tree failed: TOO_FAR, a chair in the doorway <- Serve (my_tree.yaml:22) <- dock (:41), 3 of 3
tries`
"""

from __future__ import annotations

from pathlib import PurePath

from momantu_bt.failure import FailureValue


def failure_line(failure: FailureValue) -> str:
    """Code and sentence, then each node it came through; another code in a cause is shown."""
    words: list[str] = [str(failure)]
    code, file = failure.code, ""
    for link in failure.chain():
        where = link.node or "the tree"
        name, _, line = link.place.rpartition(":")
        if line:
            where += f" (:{line})" if name == file else f" ({PurePath(name).name}:{line})"
            file = name
        if link.most_tries:
            where += f", {tries_text(link)}"
        if link.code != code:
            where += f": {link}"
            code = link.code
        words.append(where)
    return " <- ".join(words)


def tries_text(failure: FailureValue) -> str:
    """`3 of 3 tries`, or `3 tries` without a limit."""
    if failure.most_tries < 0:
        return f"{failure.tries} tries"
    return f"{failure.tries} of {failure.most_tries} tries"
