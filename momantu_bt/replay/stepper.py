"""Stepping through a record by keys: the position, and where each key leads. It draws nothing."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from momantu_bt.replay.moment import Moment
from momantu_bt.replay.seek import (
    FailureAt,
    SeekError,
    changes,
    changes_of,
    failures,
    following,
    matching,
    preceding,
)
from momantu_bt.replay.timeline import Timeline

KEYS = {
    "→ ←": "next, previous tick",
    "↓ ↑": "next, previous change",
    "space": "play, pause",
    "+ -": "faster, slower",
    "f F": "next, previous failure",
    "t": "to a time: t 42.5",
    "n": "to a node's next change, by name or line: n navigate",
    "N": "the same node's previous change",
    "g G": "to the start, to the end",
    "b": "the blackboard",
    "?": "these keys",
    "q": "leave",
}
SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0)
"""Simulated seconds a second of wall time."""
_PROMPTS = {"t": "time in s: ", "n": "node: "}


class Stepper:
    """A place in a record. `press` takes the name of a key: a character, or `right`, `enter`, ….

    index: the tick's index. playing, speed: whether and how fast time passes. prompt: the current
    question with the text typed so far, or None. said: the last key's message.
    shows_board, shows_keys: what the person wants to see. leaving: the person wants to leave.
    """

    def __init__(self, timeline: Timeline, start: int = 0) -> None:
        self.timeline = timeline
        self.index = start
        self.playing = False
        self.speed = 1.0
        self.said = ""
        self.shows_board = self.shows_keys = self.leaving = False
        self._asking = self._typed = ""
        self._node = ""
        self._played_to = 0.0
        self._changes = changes(timeline.recording)
        self._failures: Sequence[FailureAt] = failures(timeline.recording)
        last = len(timeline) - 1
        self._keys: dict[str, Callable[[], None]] = {
            "right": lambda: self._go(self.index + 1),
            "left": lambda: self._go(self.index - 1),
            "down": lambda: self._to(following(self._changes, self.index), "no later change"),
            "up": lambda: self._to(preceding(self._changes, self.index), "no earlier change"),
            " ": self._play,
            "+": lambda: self._faster(1),
            "-": lambda: self._faster(-1),
            "f": lambda: self._to_failure(following, "no later failure"),
            "F": lambda: self._to_failure(preceding, "no earlier failure"),
            "N": lambda: self._to_node(preceding, "no earlier change of"),
            "g": lambda: self._go(0),
            "home": lambda: self._go(0),
            "G": lambda: self._go(last),
            "end": lambda: self._go(last),
            "b": self._toggle_board,
            "?": self._toggle_keys,
            "q": self._leave,
        }

    @property
    def moment(self) -> Moment:
        """The current moment."""
        return self.timeline.moment(self.index)

    @property
    def view(self) -> tuple[object, ...]:
        """The state on which a picture depends."""
        switches = self.playing, self.shows_board, self.shows_keys
        return (self.index, self.speed, self.said, self.prompt, *switches)

    @property
    def prompt(self) -> str | None:
        """The current prompt, with the text typed so far."""
        return f"{_PROMPTS[self._asking]}{self._typed}" if self._asking else None

    def press(self, key: str) -> None:
        """Handle a pressed key. A key without a meaning does nothing."""
        if key == "leave":
            self._leave()
            return
        if self._asking:
            self._type(key)
            return
        self.said = ""
        if key in _PROMPTS:
            self.playing = False
            self._asking, self._typed = key, ""
        elif key in self._keys:
            if key not in " +-b?":
                self.playing = False
            self._keys[key]()

    def pass_time(self, seconds: float) -> None:
        """Let this much wall time pass. While playing, the record moves on with it."""
        if not self.playing:
            return
        self._played_to += seconds * self.speed
        self.index = max(self.index, self.timeline.at(self._played_to))
        if self.index == len(self.timeline) - 1:
            self.playing = False

    def _go(self, index: int) -> None:
        self.index = min(max(index, 0), len(self.timeline) - 1)

    def _to(self, index: int | None, otherwise: str) -> None:
        if index is None:
            self.said = otherwise
        else:
            self._go(index)

    def _play(self) -> None:
        self.playing = not self.playing and self.index < len(self.timeline) - 1
        self._played_to = self.timeline.times[self.index]

    def _faster(self, steps: int) -> None:
        at = SPEEDS.index(self.speed) + steps
        self.speed = SPEEDS[min(max(at, 0), len(SPEEDS) - 1)]

    def _to_failure(
        self, which: Callable[[Sequence[int], int], int | None], otherwise: str
    ) -> None:
        found = which([failure.index for failure in self._failures], self.index)
        self._to(found, otherwise)
        if found is not None:
            number, at = next((n, f) for n, f in enumerate(self._failures) if f.index == found)
            self.said = (
                f"failure {number + 1} of {len(self._failures)}: {at.node.name}: {at.failure}"
            )

    def _to_node(self, which: Callable[[Sequence[int], int], int | None], otherwise: str) -> None:
        if not self._node:
            self.said = "which node? press n first"
            return
        try:
            nodes = matching(self.timeline.recording, self._node)
        except SeekError as error:
            self.said = str(error)
            return
        indices = changes_of(self.timeline.recording, nodes)
        self._to(which(indices, self.index), f"{otherwise} {self._node}")

    def _toggle_board(self) -> None:
        self.shows_board = not self.shows_board

    def _toggle_keys(self) -> None:
        self.shows_keys = not self.shows_keys

    def _leave(self) -> None:
        self.leaving = True

    def _type(self, key: str) -> None:
        """Handle a key during a prompt. Enter confirms, Escape cancels."""
        if key == "enter":
            asked, self._asking = self._asking, ""
            self._take(asked, self._typed.strip())
        elif key == "escape":
            self._asking = ""
        elif key == "backspace":
            self._typed = self._typed[:-1]
        elif len(key) == 1 and key.isprintable():
            self._typed += key

    def _take(self, asked: str, typed: str) -> None:
        if asked == "n":
            self._node = typed or self._node
            self._to_node(following, "no later change of")
            return
        try:
            self._go(self.timeline.at(float(typed.removesuffix("s"))))
        except ValueError:
            self.said = f"{typed!r} is not a time; write seconds, such as 42.5"
