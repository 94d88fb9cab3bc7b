"""Diagnoses for `momantu-bt doctor`: one value for each check, also from plug-ins.

A plug-in takes part with a function `diagnose() -> Iterable[Diagnosis]`. It is an attribute of the
object that the entry point names, or a function of the module or package that declares that
object. A function that is found in several ways is called once. It may take seconds and may import
heavy libraries.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """The result of one check.

    name: what was checked, in a word or two. ok: nothing is wrong. detail: what was found, one
    sentence. cure: how a person mends it, as a sentence or a command; empty if nothing is wrong.
    mend: does the cure, for `doctor --fix`; raises OSError or RuntimeError if it cannot.
    """

    name: str
    ok: bool
    detail: str
    cure: str = ""
    mend: Callable[[], object] | None = None

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON: name, ok, detail, cure, mendable."""
        return {
            "name": self.name,
            "ok": self.ok,
            "detail": self.detail,
            "cure": self.cure,
            "mendable": self.mend is not None,
        }
