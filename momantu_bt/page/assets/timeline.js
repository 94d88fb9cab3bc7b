// The run from left to right: what the skills did, failures, faults; and the place that is shown.

const span = Math.max(timeOf(lastTick) - timeOf(0), 1e-9);

/** Per cent of the timeline's width at a time. */
function percent(time) {
  return (100 * (time - timeOf(0))) / span;
}

function showTimeline() {
  const cursor = make("div", { class: "cursor" });
  const bars = make(
    "div",
    {
      class: "bars", role: "slider", tabindex: "0", "aria-label": "Time",
      "aria-valuemin": "0", "aria-valuemax": lastTick, keydown: slide,
    },
    axis(), ...record.lanes.map(lane), cursor,
  );
  const names = make("div", { class: "names" }, make("div", { class: "axis" }, "s"));
  names.append(...record.lanes.map((each) => make("div", { class: "lane" }, each.name)));
  document.getElementById("timeline").append(
    controls(), make("div", { class: "lanes" }, names, bars),
  );
  dragging(bars);
  hint(bars, (event) => seconds(timeUnder(bars, event)));
  watch((tick) => {
    cursor.style.left = `${percent(timeOf(tick))}%`;
    bars.setAttribute("aria-valuenow", tick);
    bars.setAttribute("aria-valuetext", `${seconds(timeOf(tick))}, tick ${record.numbers[tick]}`);
  });
}

/** Seconds along the top: about ten round numbers. */
function axis() {
  const step = [0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1800, 3600]
    .find((each) => span / each <= 12) ?? span / 10;
  const marks = [];
  for (let i = Math.ceil(timeOf(0) / step); i * step <= timeOf(lastTick) + 1e-9; i++) {
    const left = percent(i * step);
    const text = left > 97 ? "" : String(Number((i * step).toFixed(2)));
    marks.push(make("span", { style: `left: ${left}%` }, text));
  }
  return make("div", { class: "axis" }, ...marks);
}

/** One line of bars. A bar that took no time is still seen. */
function lane({ kind, bars }) {
  const line = make("div", { class: `lane ${kind}` });
  for (const { begin, end, status, words } of bars) {
    const left = percent(timeOf(begin));
    const width = Math.max(0, percent(timeOf(end)) - left);
    const bar = make("div", { class: "bar", style: `left: ${left}%; width: ${width}%` });
    bar.dataset.status = STATUSES[status];
    hint(bar, () => words);
    line.append(bar);
  }
  return line;
}

/** The time under the pointer. */
function timeUnder(bars, event) {
  const { left, width } = bars.getBoundingClientRect();
  const part = Math.min(1, Math.max(0, (event.clientX - left) / width));
  return timeOf(0) + part * span;
}

function dragging(bars) {
  bars.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    bars.setPointerCapture(event.pointerId);
    setPlaying(false);
    seek(tickAt(timeUnder(bars, event)));
  });
  bars.addEventListener("pointermove", (event) => {
    if (bars.hasPointerCapture(event.pointerId)) seek(tickAt(timeUnder(bars, event)));
  });
}

/** The slider's own keys beside those of the page. */
function slide(event) {
  const steps = { ArrowUp: 1, ArrowDown: -1, PageUp: 20, PageDown: -20 };
  if (!(event.key in steps)) return;
  event.preventDefault();
  seek(playhead.tick + steps[event.key]);
}
