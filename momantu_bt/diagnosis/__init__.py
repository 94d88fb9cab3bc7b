"""Diagnoses for `momantu-bt doctor`: one value for each check, also from plug-ins.

A plug-in takes part by a function `diagnose() -> Iterable[Diagnosis]`: an attribute of what its
entry point names, or a function of the module or of the package that declares it. One function
reached in several ways is called once. It may take seconds and may import heavy libraries.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """One thing that was looked at.

    name: what, in a word or two. ok: nothing is wrong. detail: what was found, one sentence.
    cure: what a person does when it is wrong, as a sentence or a command; empty when it is right.
    mend: does the cure, for `doctor --fix`; raises OSError or RuntimeError when it cannot.
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
