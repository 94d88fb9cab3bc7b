// What holds at an instant, out of what changed: prefix snapshots make any jump quick.

/** Entries between two snapshots, and so the most that one jump applies. */
const STRIDE = 256;

/** Slots that hold numbers; entry i puts `values[i]` into slot `slots[i]` at tick `ticks[i]`. */
class Journal {
  constructor(size, empty, ticks, slots, values) {
    this.ticks = ticks;
    this.slots = slots;
    this.values = values;
    this.state = new Int32Array(size).fill(empty);
    this.applied = 0;
    this.snapshots = [this.state.slice()];
    while (this.applied < ticks.length) {
      this.apply(Math.min(ticks.length, this.applied + STRIDE));
      if (this.applied % STRIDE === 0) this.snapshots.push(this.state.slice());
    }
  }

  /** Apply the entries before `end`. */
  apply(end) {
    for (let i = this.applied; i < end; i++) this.state[this.slots[i]] = this.values[i];
    this.applied = end;
  }

  /** The slots after all that happened up to a tick; the array is the same one each time. */
  at(tick) {
    const end = countUpTo(this.ticks, tick);
    if (end < this.applied || end > this.applied + STRIDE) {
      const nearest = Math.floor(end / STRIDE);
      this.state.set(this.snapshots[nearest]);
      this.applied = nearest * STRIDE;
    }
    this.apply(end);
    return this.state;
  }
}

const { changes, writes } = record;
const nodeCount = record.nodes.name.length;
const statusJournal = new Journal(nodeCount, IDLE, changes.tick, changes.node, changes.status);
const noteJournal = new Journal(nodeCount, 0, changes.tick, changes.node, changes.note);
const labelJournal = new Journal(nodeCount, 0, record.labels.tick, record.labels.node, record.labels.text);
const boardJournal = new Journal(
  record.keys.length, -1, writes.tick, writes.key, writes.tick.map((_, i) => i),
);
