// The instant that the page shows, and what moves it.

const SPEEDS = [0.25, 0.5, 1, 2, 5, 10, 20];
const playhead = { tick: 0, speed: 1, playing: false, time: 0 };
const watchers = [];
let drawing = 0;
let beat = 0;

/** Call `show(tick)` whenever the instant changes, and once now. */
function watch(show) {
  watchers.push(show);
  show(playhead.tick);
}

/** Tell all watchers, at most once per picture of the screen. */
function changed() {
  if (drawing) return;
  drawing = requestAnimationFrame(() => {
    drawing = 0;
    for (const show of watchers) show(playhead.tick);
    document.documentElement.dataset.tick = playhead.tick;
  });
}

/** Go to a tick; what lies outside of the run is its first or last one. */
function seek(tick) {
  playhead.tick = Math.min(lastTick, Math.max(0, tick));
  playhead.time = timeOf(playhead.tick);
  changed();
}

/** Start playing, from the beginning where the end is shown; or stop. */
function setPlaying(playing) {
  cancelAnimationFrame(beat);
  if (playing && playhead.tick === lastTick) seek(0);
  playhead.playing = playing && lastTick > 0;
  changed();
  if (!playhead.playing) return;
  let before = performance.now();
  beat = requestAnimationFrame(function advance(now) {
    playhead.time += (Math.max(0, now - before) / 1000) * playhead.speed;
    before = now;
    const tick = tickAt(playhead.time);
    if (tick !== playhead.tick) {
      playhead.tick = tick;
      changed();
    }
    if (tick === lastTick) setPlaying(false);
    else beat = requestAnimationFrame(advance);
  });
}
