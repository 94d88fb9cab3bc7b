"""Behaviours of py_trees as leaves of our trees.

An entry point of the group `momantu_bt.behaviours` names a `py_trees.behaviour.Behaviour` class. If
the behaviour has ports, it names the result of `behaviour(…)` instead. The result of each tick is
recorded; a replay takes it from the record and does not run the behaviour.
"""

from __future__ import annotations

import inspect
import traceback
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, ClassVar

from py_trees.behaviour import Behaviour
from py_trees.blackboard import Blackboard
from py_trees.common import Status as PyTreesStatus

from momantu_bt.engine.label import ShowsValues
from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.role import Role
from momantu_bt.engine.status import RUNNING, SUCCESS, Status
from momantu_bt.engine.watchdog import Hung
from momantu_bt.errors import StopRequested, words_of
from momantu_bt.failure import CODE, FAILED, HUNG, Failure
from momantu_bt.skill import Port
from momantu_bt.tree.catalogue.codes import and_also
from momantu_bt.tree.catalogue.objection import bad_name, bad_port
from momantu_bt.tree.catalogue.spec import leaf
from momantu_bt.values.admit import admit_output

BEHAVIOUR_ERROR = "BEHAVIOUR_ERROR"
"""A behaviour raised an exception; `data["traceback"]` holds the traceback."""


class Through(StrEnum):
    """How a behaviour gets its inputs and returns its outputs."""

    CONSTRUCTOR = "constructor"
    """Each start makes a behaviour, with inputs as keyword arguments; outputs are attributes."""
    ATTRIBUTES = "attributes"
    """Inputs are set as attributes before each start; outputs are read from attributes."""
    BLACKBOARD = "blackboard"
    """Inputs are written to py_trees' blackboard before each start; outputs are read from it."""


@dataclass(frozen=True, slots=True)
class Declaration:
    """A behaviour class and what trees need to know of it; `behaviour` makes it."""

    kind: type[Behaviour]
    ports: Mapping[str, Port]
    through: Through
    failure: str
    codes: tuple[str, ...]
    doc: str


def behaviour(
    kind: type[Behaviour],
    *ports: Port,
    through: str = Through.ATTRIBUTES,
    failure: str = FAILED,
    codes: Collection[str] = (),
    doc: str = "",
) -> Declaration:
    """Declare the ports of a behaviour, for an entry point of the group `momantu_bt.behaviours`.

    ports: made by `input_port` and `output_port`, with the names of the behaviour's arguments,
    attributes or keys. through: "constructor", "attributes" or "blackboard"; see `Through`.
    failure: the failure code for its FAILURE; the behaviour's feedback message becomes the
    failure's message. codes: further codes that it raises as `momantu_bt.Failure`. doc: one
    sentence; by default the docstring of the class.

    Raises:
        ValueError: `through` is not one of the three.
    """
    if through not in {*Through}:
        names = ", ".join(Through)
        raise ValueError(f"through={through!r}; expected one of {names}")
    said = doc or (inspect.getdoc(kind) or "").partition("\n")[0]
    by_name = {port.name: port for port in ports}
    return Declaration(kind, by_name, Through(through), failure, tuple(codes), said)


def declared(plugin: object) -> Declaration | None:
    """The declaration of an entry point's object; None for neither a class nor a declaration."""
    if isinstance(plugin, type) and issubclass(plugin, Behaviour):
        return behaviour(plugin)
    return plugin if isinstance(plugin, Declaration) else None


def behaviour_objection(name: str, plugin: object, built_in: Collection[str]) -> str | None:
    """Why trees cannot use this behaviour, or None. built_in: names of the built-in nodes."""
    declaration = declared(plugin)
    if declaration is None:
        return f"{plugin!r} is not a py_trees Behaviour class and not made by `behaviour(…)`"
    if not declaration.doc.strip():
        return f"{declaration.kind.__name__} has no docstring: one sentence that says what it does"
    for code in (declaration.failure, *declaration.codes):
        if not isinstance(code, str) or not CODE.fullmatch(code):
            return f"{code!r} is not a failure code: UPPER_CASE words"
    wrong = (bad_port(name, port) for port in declaration.ports.values())
    return (
        bad_name(name, built_in) or next(filter(None, wrong), None) or _cannot_be_made(declaration)
    )


def _cannot_be_made(declaration: Declaration) -> str | None:
    """Why the class cannot be instantiated (arguments do not fit, `update` is missing), or None."""
    kind = declaration.kind
    if inspect.isabstract(kind):
        return f"{kind.__name__} has no {', '.join(sorted(kind.__abstractmethods__))}"
    inputs = [port.name for port in declaration.ports.values() if port.direction == "in"]
    named = inputs if declaration.through is Through.CONSTRUCTOR else []
    try:
        inspect.signature(kind).bind(name="", **dict.fromkeys(named))
    except TypeError as error:
        return (
            f"the constructor of {kind.__name__} cannot be called with {_list('name', *named)}: "
            f"{error}; behaviour(…, through='constructor') gives it the inputs too"
        )
    except ValueError:
        return None  # Python cannot tell its signature
    return None


def _list(*names: str) -> str:
    return ", ".join(f"`{name}`" for name in names)


def node_class(name: str, plugin: object) -> type[BehaviourLeaf]:
    """Make the node class that runs a behaviour. name: the node's name in YAML and XML."""
    declaration = declared(plugin)
    assert declaration is not None
    spec = leaf(
        name,
        name,
        declaration.doc,
        *declaration.ports.values(),
        first=next((p.name for p in declaration.ports.values() if p.direction == "in"), None),
        codes=and_also(declaration.failure, *declaration.codes, BEHAVIOUR_ERROR, HUNG),
    )
    return type(name, (BehaviourLeaf,), {"spec": spec, "declaration": declaration})


class BehaviourLeaf(ShowsValues, TreeNode):
    """Ticks a behaviour: `initialise` and `update` when it starts, `update` while it runs.

    At its end `terminate` is called with the status, on a halt with INVALID. Before the first
    start the behaviour is made and its `setup(clock=…)` is called. When `update` returns INVALID,
    the node fails.
    """

    declaration: ClassVar[Declaration]

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.outputs = parts.outputs()
        self._behaviour: Behaviour | None = None
        self._at_work = False
        self._feedback = ""

    @property
    def role(self) -> Role:
        """Its role in displays: an action."""
        return Role.ACT

    @property
    def note(self) -> str:
        """The behaviour's feedback message while it runs."""
        return self._feedback

    def step(self) -> Status:
        """One tick of the behaviour."""
        inputs: dict[str, Any] = {}
        begins, self._at_work = not self._at_work, True
        if begins:
            inputs = self.inputs.all()
            self.show_values(inputs)
        said = self.context.ask(f"behaviour {self.index}", lambda: self._ticked(begins, inputs))
        status, self._feedback, outputs = said
        if status == RUNNING.value:
            return RUNNING
        self._at_work = False
        if status != SUCCESS.value:
            return self.fail(self.declaration.failure, self._feedback or f"returned {status}")
        for name, output in self.outputs.items():
            output.cell.store(outputs[name])
        return SUCCESS

    def clear(self) -> None:
        """End the behaviour: `terminate(INVALID)`."""
        self._at_work = False
        self._feedback = ""
        running = self._behaviour
        if running is not None and running.status is PyTreesStatus.RUNNING:
            try:
                running.stop(PyTreesStatus.INVALID)
            except StopRequested:
                raise
            except BaseException as error:  # other people's code: it may raise anything
                running.status = PyTreesStatus.INVALID  # never terminate it twice
                self.context.remark(f"{self.where}: while it was halted: {_words(error)}")

    def _ticked(self, begins: bool, inputs: Mapping[str, Any]) -> tuple[str, str, dict[str, Any]]:
        """The status, the feedback message and, with SUCCESS, the outputs of one tick.

        Raises:
            Failure: the behaviour raised it, or BEHAVIOUR_ERROR, it raised another exception.
        """
        watchdog = self.context.watchdog
        watchdog.begin_step()
        try:
            return self._tick(begins, inputs)
        except Failure:
            raise
        except Hung:
            message = f"{self.name} gave no status back within the run's patience"
            raise Failure(HUNG, message) from None
        except StopRequested:
            raise
        except BaseException as error:
            text = "".join(traceback.format_exception(error))
            raise Failure(BEHAVIOUR_ERROR, _words(error), traceback=text) from error
        finally:
            watchdog.end_step()

    def _tick(self, begins: bool, inputs: Mapping[str, Any]) -> tuple[str, str, dict[str, Any]]:
        running = self._begun(inputs) if begins or self._behaviour is None else self._behaviour
        running.tick_once()
        status = running.status
        done = status is PyTreesStatus.SUCCESS
        return status.value, running.feedback_message or "", self._given(running) if done else {}

    def _begun(self, inputs: Mapping[str, Any]) -> Behaviour:
        """The behaviour with its inputs set; the first call makes it and calls its `setup`."""
        declaration, made = self.declaration, self._behaviour
        if declaration.through is Through.CONSTRUCTOR:
            made = declaration.kind(name=self.name, **inputs)
        elif made is None:
            made = declaration.kind(name=self.name)
        if declaration.through is Through.ATTRIBUTES:
            for name, value in inputs.items():
                setattr(made, name, value)
        if declaration.through is Through.BLACKBOARD:
            for name, value in inputs.items():
                Blackboard.set(name, value)
        if made is not self._behaviour:
            for each in made.iterate():
                each.setup(clock=self.context.clock)
            self._behaviour = made
        return made

    def _given(self, running: Behaviour) -> dict[str, Any]:
        """The values of the outputs that are connected to keys."""
        found = {}
        for name, output in self.outputs.items():
            on_board = self.declaration.through is Through.BLACKBOARD
            value = Blackboard.get(name) if on_board else getattr(running, name)
            found[name] = admit_output(value, output.port)
        return found


def _words(error: BaseException) -> str:
    return f"raised {words_of(error)}"
