// What failed, when and why; one failure at a time shows the chain that led to it.

const failureTicks = record.failures.map((failure) => failure.tick);
const failureItems = [];
let chosenFailure = -1;

function showFailures() {
  const body = panel("failures", `Failures (${record.failures.length})`);
  const list = make("ol", { class: "failures" });
  record.failures.forEach((failure, i) => {
    const button = make(
      "button", { type: "button", "aria-expanded": "false", click: () => toggle(i) },
      make("span", { class: "when" }, seconds(timeOf(failure.tick))),
      make("span", { class: "code" }, failure.links[0].code),
      make("span", { class: "node" }, `${failure.links[0].node}: ${failure.links[0].message}`),
    );
    const item = make("li", {}, button);
    failureItems.push({ item, button });
    list.append(item);
  });
  body.append(list);
  if (!record.failures.length) body.append(make("p", { class: "nothing" }, "Nothing failed."));
  watch((tick) => {
    failureItems.forEach(({ item }, i) => item.classList.toggle("fresh", failureTicks[i] === tick));
  });

  function toggle(i) {
    if (i === chosenFailure) chooseFailure(-1);
    else goToFailure(i);
  }
}

/** Open one failure's chain; -1: none. */
function chooseFailure(index) {
  const before = failureItems[chosenFailure];
  if (before) {
    before.button.setAttribute("aria-expanded", "false");
    before.item.lastChild.remove();
  }
  chosenFailure = index;
  if (index < 0) return;
  const { item, button } = failureItems[index];
  button.setAttribute("aria-expanded", "true");
  item.append(chain(record.failures[index].links));
  reveal(document.querySelector("#failures .body"), item);
}

/** Show the instant of a failure, and why. */
function goToFailure(index) {
  setPlaying(false);
  seek(failureTicks[index]);
  chooseFailure(index);
}

/** Go to the next or previous failure; where several share a tick, the next of them. */
function seekFailure(forward) {
  const chosen = failureTicks[chosenFailure] === playhead.tick ? chosenFailure + (forward ? 1 : -1) : -1;
  if (chosen >= 0 && failureTicks[chosen] === playhead.tick) {
    chooseFailure(chosen);
    return;
  }
  const tick = neighbour(failureTicks, forward);
  if (tick === undefined) return;
  goToFailure(forward ? failureTicks.indexOf(tick) : failureTicks.lastIndexOf(tick));
}

/** The failure, then what led to it, further in each time. */
function chain(links) {
  const items = links.map((link) => {
    const name = link.at < 0
      ? make("span", { class: "node" }, link.node)
      : make("button", { type: "button", class: "link node", click: () => chooseNode(link.at) }, link.node);
    const words = [link.role, name, link.place && ` ${link.place}`, link.tries && `, ${link.tries}`];
    const item = make("li", { style: `--depth: ${link.depth}` }, make("div", {}, ...words.filter(Boolean)));
    const says = make("span", { class: "code" }, link.code);
    item.append(make("div", {}, says, link.message ? ` ${link.message}` : ""));
    for (const [key, value] of link.data) {
      item.append(make("div", { class: "datum" }, make("span", { class: "key" }, key), ` ${value}`));
    }
    return item;
  });
  return make("ol", { class: "chain" }, ...items);
}
