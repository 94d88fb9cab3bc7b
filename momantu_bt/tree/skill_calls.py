"""Which skills a skill calls, and whether it may."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from momantu_bt.formats.names import valid_names
from momantu_bt.robot import RobotDescription
from momantu_bt.skill import Skill


def callees_of(kind: type[Skill], skill_of: Callable[[str], type[Skill]]) -> dict[str, type[Skill]]:
    """The skills that one calls, by their names.

    Raises:
        KeyError: no skill has one of the names. PluginError: it is broken.
    """
    found: dict[str, type[Skill]] = {}
    for each in kind.calls:
        if isinstance(each, str):
            found[each] = skill_of(each)
        else:
            found[each.__name__] = each
    return found


def callees(
    kinds: Iterable[type[Skill]], skill_of: Callable[[str], type[Skill]]
) -> dict[str, type[Skill]]:
    """The skills that these call, also indirectly, by their names; raises as `callees_of`."""
    found: dict[str, type[Skill]] = {}
    waiting = list(kinds)
    while waiting:
        new = callees_of(waiting.pop(0), skill_of)
        waiting += [kind for name, kind in new.items() if name not in found]
        found = {**new, **found}
    return found


def undeclared_uses(
    caller: type[Skill], called: type[Skill], description: RobotDescription
) -> tuple[str, ...]:
    """Actuators of a called skill that the caller's `uses` lacks, as `uses` writes them.

    Raises:
        KeyError: the robot has no such actuator.
    """
    having = {description.resolve_use(use) for use in caller.uses}
    wanted = ((use, description.resolve_use(use)) for use in sorted(called.uses))
    return tuple(use for use, actuator in wanted if actuator not in (None, *having))


def undeclared_uses_text(caller: str, called: str, uses: Sequence[str]) -> str:
    """What is wrong if a caller's `uses` lacks some, and what to do."""
    names = ", ".join(map(repr, uses))
    return f"{caller} calls {called}, which commands {names}: add {names} to its `uses`"


def wrong_calls(
    name: str,
    kind: type[Skill],
    skills: Mapping[str, type[Skill]],
    description: RobotDescription | None,
) -> Iterator[str]:
    """What is wrong with the calls of a skill, a sentence each.

    skills: the installed ones. description: of the robot; None: `uses` are not compared.

    Raises:
        PluginError: one of the called skills is broken.
    """
    for each in kind.calls:
        if isinstance(each, str) and each not in skills:
            hint = valid_names(each, sorted(skills), "installed skills")
            yield f"{name} calls {each!r}, which is not installed; {hint}"
            continue
        if description is None:
            continue
        called = skills[each] if isinstance(each, str) else each
        try:
            missing = undeclared_uses(kind, called, description)
        except KeyError:
            continue  # the robot lacks an actuator, which is told where the skill is checked
        if missing:
            word = each if isinstance(each, str) else each.__name__
            yield undeclared_uses_text(name, word, missing)
