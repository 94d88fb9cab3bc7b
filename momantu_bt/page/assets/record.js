// The run, as Python laid it out: columns of numbers, tables of texts.

const record = JSON.parse(document.getElementById("record").textContent);
const [IDLE, RUNNING, SUCCESS, FAILURE, SKIPPED] = [0, 1, 2, 3, 4];
const STATUSES = ["idle", "running", "success", "failure", "skipped"];
const SIGNS = ["○", "▶", "✓", "✗", "–"];
const lastTick = Math.max(0, record.times.length - 1);

/** How many of the sorted numbers are at most `value`. */
function countUpTo(sorted, value) {
  let [low, high] = [0, sorted.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (sorted[middle] <= value) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Seconds of the world's clock at a tick. */
function timeOf(tick) {
  return record.times[tick] ?? 0;
}

/** The last tick that is not after a time, s; the first one where all are. */
function tickAt(time) {
  return Math.max(0, countUpTo(record.times, time + 1e-6) - 1);
}

/** `12.35 s`, always with two decimals. */
function seconds(time) {
  return `${time.toFixed(2)} s`;
}

/** A node in one line, with the values of its newest start. */
function labelAt(tick, node) {
  return record.labels.texts[labelJournal.at(tick)[node]];
}

/** `name (file:line)` of a node. */
function whereIs(node) {
  const { name, file, line } = record.nodes;
  return file[node] < 0 ? name[node] : `${name[node]} (${record.files[file[node]].name}:${line[node]})`;
}
