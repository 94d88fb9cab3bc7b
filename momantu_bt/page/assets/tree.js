// The tree: a row for each node that is no frame, with its status, note and counts.

const treeRows = [];
let follows = true;
let chosenRow = null;

/** Rows below one another; what is below a node is in a group that folds. */
function showTree() {
  const follow = make("input", { type: "checkbox", checked: "", change: () => setFollows(follow.checked) });
  const body = panel(
    "tree", "Tree",
    make("label", { title: "Open what runs and fold the rest" }, follow, " follow"),
    make("button", { type: "button", click: () => foldAll(false) }, "open all"),
    make("button", { type: "button", click: () => foldAll(true) }, "fold all"),
  );
  const root = make("ul", { role: "tree", "aria-label": "Nodes", keydown: walkTree });
  body.append(root);
  const rows = record.nodes.row.map((own, node) => (own === node ? treeRow(node, root) : null)).filter(Boolean);
  if (rows.length) rows[0].item.tabIndex = 0;
  const again = record.nodes.again.flatMap((texts, node) => texts.map((text) => againRow(node, text, root)));
  watch((tick) => {
    const [statuses, notes] = [statusJournal.at(tick), noteJournal.at(tick)];
    for (const row of rows) paint(row, statuses[row.node], record.notes[notes[row.node]], record.nodes.prefix[row.node] + labelAt(tick, row.node));
    for (const row of again) paintAgain(row, statuses[row.node], record.notes[notes[row.node]]);
    if (follows) followRows(rows, body);
  });

  function setFollows(on) {
    follows = on;
    changed();
  }

  function foldAll(folded) {
    follow.checked = follows = false;
    for (const row of rows) fold(row, folded && row.above !== null);
  }
}

/** A node's row, in the group of the row above it, which comes first. */
function treeRow(node, root) {
  const { above, runs, failures } = record.nodes;
  const row = { node, above: treeRows[above[node]] ?? null, group: null, folded: false, status: -1 };
  row.depth = row.above ? row.above.depth + 1 : 0;
  const counts = failures[node] ? `${failures[node]} ✗  ${runs[node]}×` : `${runs[node]}×`;
  [row.sign, row.label, row.note] = ["sign", "label", "note"].map((name) => make("span", { class: name }));
  row.line = make(
    "div", { class: "row", style: `--depth: ${Math.min(row.depth, 24)}` },
    make("span", { class: "fold", "aria-hidden": "true" }), row.sign, row.label, row.note,
    make("span", { class: "counts" }, counts),
  );
  row.item = make("li", { role: "treeitem", tabindex: "-1", "data-node": node }, row.line);
  groupOf(row.above, root).append(row.item);
  row.line.addEventListener("click", (event) => {
    if (event.target.classList.contains("fold")) fold(row, !row.folded);
    else chooseNode(node);
  });
  row.line.addEventListener("dblclick", () => fold(row, !row.folded));
  hint(row.line, () => rowHint(row));
  treeRows[node] = row;
  return row;
}

/** A handler without a node, which only tries again; it has a row below its `recover`. */
function againRow(node, text, root) {
  const above = treeRows[record.nodes.row[node]];
  const [sign, label] = ["sign", "label"].map((name) => make("span", { class: name }));
  write(label, text);
  const style = `--depth: ${Math.min(above.depth + 1, 24)}`;
  const line = make("div", { class: "row again", style }, make("span", { class: "fold", "aria-hidden": "true" }), sign, label);
  groupOf(above, root).append(make("li", { role: "none" }, line));
  return { node, text, line, sign };
}

/** It runs while the note of its node says that it tries again because of one of its codes. */
function paintAgain(row, status, note) {
  const [code, how] = (note ?? "").split(": ");
  const other = row.text.startsWith("on any") || row.text.includes(" more ");
  const runs = status === RUNNING && how === "again" && (other || row.text.includes(code));
  const shown = runs ? RUNNING : 0;
  row.line.dataset.status = STATUSES[shown];
  write(row.sign, SIGNS[shown]);
}

function groupOf(row, root) {
  if (!row) return root;
  if (!row.group) {
    row.group = make("ul", { role: "group" });
    row.item.append(row.group);
    row.item.setAttribute("aria-expanded", "true");
  }
  return row.group;
}

/** What hovering over a row tells. */
function rowHint({ node, status, label }) {
  const { type, runs, failures } = record.nodes;
  const times = `started ${runs[node]} times, failed ${failures[node]} times`;
  return `${label.textContent}\n${whereIs(node)}\n${type[node]}, ${STATUSES[status]}\n${times}`;
}

function paint(row, status, note, label) {
  write(row.note, status === RUNNING ? note : "");
  if (status === row.status && row.label.textContent === label) return;
  row.status = status;
  row.line.dataset.status = STATUSES[status];
  row.item.setAttribute("aria-label", `${label}, ${STATUSES[status]}`);
  write(row.label, label);
  write(row.sign, SIGNS[status]);
}

function fold(row, folded) {
  if (!row.group || row.folded === folded) return;
  row.folded = folded;
  row.item.setAttribute("aria-expanded", String(!folded));
}

/** Open what runs or has failed, fold what has not begun or went well. */
function followRows(rows, body) {
  for (const row of rows) fold(row, row.above !== null && ![RUNNING, FAILURE].includes(row.status));
  const deepest = rows.findLast((row) => row.status === RUNNING);
  if (deepest) reveal(body, deepest.line);
}

/** Open everything above a node's row, show it, and the node's line in the file. */
function chooseNode(node) {
  const row = treeRows[record.nodes.row[node]];
  if (chosenRow) chosenRow.item.removeAttribute("aria-selected");
  for (const { item } of [treeRows[0], chosenRow ?? treeRows[0]]) item.tabIndex = -1;
  chosenRow = row;
  row.item.setAttribute("aria-selected", "true");
  row.item.tabIndex = 0;
  for (let up = row.above; up; up = up.above) fold(up, false);
  reveal(document.querySelector("#tree .body"), row.line);
  showLine(node);
}
