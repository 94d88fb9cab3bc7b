// The tree by keys: up and down between the rows that are seen, left folds, right opens.

function walkTree(event) {
  if (event.altKey || event.ctrlKey || event.metaKey) return;
  const row = treeRows[Number(event.target.closest("[data-node]").dataset.node)];
  const seen = treeRows.filter((each) => each.line.offsetParent !== null);
  const place = seen.indexOf(row);
  const open = row.group && !row.folded;
  const ways = {
    ArrowDown: () => seen[place + 1],
    ArrowUp: () => seen[place - 1],
    Home: () => seen[0],
    End: () => seen[seen.length - 1],
    ArrowRight: () => (open ? seen[place + 1] : fold(row, false)),
    ArrowLeft: () => (open ? fold(row, true) : row.above),
    Enter: () => row,
  };
  if (!(event.key in ways)) return;
  event.preventDefault();
  event.stopPropagation();
  const next = ways[event.key]();
  if (!next) return;
  chooseNode(next.node);
  next.item.focus({ preventScroll: true });
}
