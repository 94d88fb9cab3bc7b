// The files of the run; the lines of what runs are marked.

const sourceLines = [];
let sourceFile = -1;
let openFile = () => {};

function showSource() {
  const choice = make("select", { "aria-label": "File", change: () => openFile(Number(choice.value)) });
  choice.append(...record.files.map((file, i) => make("option", { value: i }, file.name)));
  const body = panel("source", "File", choice);
  const text = make("ol", { class: "source" });
  body.append(text);
  openFile = (file) => {
    if (file === sourceFile || !record.files[file]) return;
    sourceFile = file;
    choice.value = String(file);
    const lines = record.files[file].text.split(/\r\n|\n|\r/);
    sourceLines.splice(0, Infinity, ...lines.map((line) => make("li", {}, line || "​")));
    text.replaceChildren(...sourceLines);
    changed();
  };
  openFile(0);
  watch((tick) => markLines(body, statusJournal.at(tick)));
}

/** Mark the lines of running nodes in the file that is open, and show that of the deepest. */
function markLines(body, statuses) {
  const { file, line, row } = record.nodes;
  const wanted = new Map();
  let deepest = -1;
  for (let node = 0; node < nodeCount; node++) {
    if (statuses[node] !== RUNNING || file[node] !== sourceFile || row[node] !== node) continue;
    wanted.set(line[node] - 1, "running");
    deepest = line[node] - 1;
  }
  if (deepest >= 0) wanted.set(deepest, "running deepest");
  sourceLines.forEach((item, i) => {
    const name = wanted.get(i) ?? "";
    if (item.className === name) return;
    item.className = name;
    if (i === deepest && follows) reveal(body, item);
  });
}

/** Open a node's file at its line. */
function showLine(node) {
  const { file, line } = record.nodes;
  if (file[node] < 0) return;
  openFile(file[node]);
  for (const item of sourceLines) delete item.dataset.chosen;
  const item = sourceLines[line[node] - 1];
  if (!item) return;
  item.dataset.chosen = "";
  reveal(document.querySelector("#source .body"), item);
}
