// The blackboard at the instant; what this tick wrote is marked.

/** `Dock/side`, then where in the tree this Dock is; it may break behind slashes and dots. */
function keyName(key) {
  const [, where, name] = /^(\d[\d.]*)\/(.*)$/.exec(key) ?? [null, "", key];
  const parts = name.split(/(?<=[./_])/).flatMap((part) => [part, make("wbr")]);
  return where ? [...parts, " ", make("span", { class: "where" }, where)] : parts;
}

function showBoard() {
  const body = panel("board", "Blackboard");
  const rows = record.keys.map((key) => {
    const value = make("td", { class: "value" });
    const since = make("button", { type: "button", class: "link", title: "go to where it was written" });
    const row = make("tr", {}, make("th", { scope: "row" }, ...keyName(key)), value, make("td", {}, since));
    return { row, value, since, entry: -2 };
  });
  body.append(make("table", {}, ...rows.map((each) => each.row)));
  if (!rows.length) body.append(make("p", { class: "nothing" }, "No key was written."));
  watch((tick) => {
    const entries = boardJournal.at(tick);
    rows.forEach((each, key) => {
      const entry = entries[key];
      const written = entry < 0 ? -1 : writes.tick[entry];
      each.row.classList.toggle("fresh", written === tick);
      if (entry === each.entry) return;
      each.entry = entry;
      each.row.classList.toggle("unset", entry < 0);
      write(each.value, entry < 0 ? "" : record.values[writes.value[entry]]);
      write(each.since, entry < 0 ? "" : seconds(timeOf(written)));
      each.since.onclick = () => step(written - playhead.tick);
    });
  });
}
