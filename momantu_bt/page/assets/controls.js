// Buttons, and the keys that do the same.

/** The next tick in `ticks` (sorted) after the one shown, or the last before it. */
function neighbour(ticks, forward) {
  const after = countUpTo(ticks, playhead.tick);
  return forward ? ticks[after] : ticks[countUpTo(ticks, playhead.tick - 1) - 1];
}

/** Go to the next or the previous change of the tree. */
function seekChange(forward) {
  setPlaying(false);
  seek(neighbour(changes.tick, forward) ?? (forward ? lastTick : 0));
}

function step(ticks) {
  setPlaying(false);
  seek(playhead.tick + ticks);
}

const KEYS = {
  " ": ["play or pause", () => setPlaying(!playhead.playing)],
  ArrowLeft: ["a tick back", () => step(-1)],
  ArrowRight: ["a tick on", () => step(1)],
  "Shift+ArrowLeft": ["a second back", () => step(tickAt(timeOf(playhead.tick) - 1) - playhead.tick)],
  "Shift+ArrowRight": ["a second on", () => step(tickAt(timeOf(playhead.tick) + 1) - playhead.tick)],
  p: ["the change before", () => seekChange(false)],
  n: ["the next change", () => seekChange(true)],
  F: ["the failure before", () => seekFailure(false)],
  f: ["the next failure", () => seekFailure(true)],
  Home: ["the beginning", () => step(-lastTick)],
  End: ["the end", () => step(lastTick)],
};

/** What a key is called on a keyboard. */
function nameOfKey(key) {
  return key.replace(" ", "Space").replace("Arrow", "").replace("Shift+", "Shift ");
}

function controls() {
  const button = (key, text) => {
    const [words, act] = KEYS[key];
    return make("button", { type: "button", title: `${words} (${nameOfKey(key)})`, "aria-label": words, click: act }, text);
  };
  const play = button(" ", "▶");
  play.classList.add("play");
  const time = make("output", { class: "time" });
  const doing = make("span", { class: "doing" });
  watch((tick) => {
    write(play, playhead.playing ? "❚❚" : "▶");
    write(time, `${seconds(timeOf(tick))} / ${seconds(timeOf(lastTick))}`);
    write(doing, `tick ${record.numbers[tick] ?? 0}  ${runningWords(tick)}`);
  });
  return make(
    "div", { class: "controls" },
    button("Home", "⇤"), button("F", "✗◂"), button("p", "◂◂"), button("ArrowLeft", "◂"), play,
    button("ArrowRight", "▸"), button("n", "▸▸"), button("f", "▸✗"), button("End", "⇥"),
    speedChoice(), time, doing,
  );
}

function speedChoice() {
  const options = SPEEDS.map((speed) => make("option", { value: speed }, `${speed}×`));
  const choice = make("select", { "aria-label": "Speed", title: "Speed" }, ...options);
  choice.value = String(playhead.speed);
  choice.addEventListener("change", () => (playhead.speed = Number(choice.value)));
  return choice;
}

/** What runs deepest, with its note. */
function runningWords(tick) {
  const statuses = statusJournal.at(tick);
  const deepest = statuses.lastIndexOf(RUNNING);
  if (deepest < 0) return nodeCount ? STATUSES[statuses[0]] : "";
  const note = record.notes[noteJournal.at(tick)[deepest]];
  return [labelAt(tick, deepest), note].filter(Boolean).join(", ");
}

/** Keys work wherever they mean nothing else. */
function obeyKeys() {
  document.addEventListener("keydown", (event) => {
    const typing = event.target.closest("select, input, textarea, summary");
    const pressing = event.key === " " && event.target.closest("button");
    if (typing || pressing || event.altKey || event.ctrlKey || event.metaKey) return;
    const shifted = event.shiftKey && event.key.startsWith("Arrow") ? `Shift+${event.key}` : event.key;
    if (!(shifted in KEYS)) return;
    event.preventDefault();
    KEYS[shifted][1]();
  });
}
