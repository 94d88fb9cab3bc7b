// What ran, and how it ended.

function showHead() {
  const { title, outcome, facts, details, warning } = record.about;
  const rows = facts.map(([name, text]) => make("div", {}, make("dt", {}, name), make("dd", {}, text)));
  const more = details.flatMap(([name, text]) => [make("dt", {}, name), make("dd", {}, text)]);
  document.getElementById("head").append(
    make("h1", {}, title),
    make("span", { class: `outcome ${outcome.kind}` }, outcome.words),
    make("dl", { class: "facts" }, ...rows),
    make("details", {}, make("summary", {}, "Versions and options"), make("dl", {}, ...more)),
  );
  if (outcome.sentence) {
    document.getElementById("head").append(make("p", { class: "sentence" }, outcome.sentence));
  }
  if (warning) {
    document.getElementById("head").append(make("p", { class: "warning", role: "alert" }, warning));
  }
}
