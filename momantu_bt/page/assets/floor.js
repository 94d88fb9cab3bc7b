// The map from above: floor plan, places, the way that was driven, and what was seen.

/** A picture in metres, y upwards; `unit` is a hundredth of its greater side. */
function showFloor() {
  const { bounds, path } = record.floor;
  if (!bounds) return leaveOut("floor");
  const caption = make("span", { class: "caption" });
  const body = panel("floor", "Map", caption);
  const [left, bottom, right, top] = bounds;
  const unit = Math.max(right - left, top - bottom) / 100;
  const driven = draw("polyline", { class: "driven" });
  const robot = draw("path", { class: "robot", d: "M 1.6 0 L -1 1 L -0.5 0 L -1 -1 Z" });
  const seen = draw("g", { class: "seen" });
  const marked = draw("g", { class: "marked" });
  const image = draw(
    "svg",
    {
      viewBox: `${left} ${-top} ${right - left} ${top - bottom}`, role: "img",
      "aria-label": "Map with the robot's way", style: `--unit: ${unit}px`,
    },
    ...plan(), ...record.floor.surfaces.map((each) => surface(each, unit)),
    ...record.floor.places.map((each) => place(each, unit)),
    draw("polyline", { class: "way", points: points(path, path.t.length) }), driven, marked, seen, robot,
  );
  body.append(image);
  let passed = -1;
  let scene = null;
  let drawn = "";
  watch((tick) => {
    const now = timeOf(tick) + 1e-6;
    const items = record.floor.scenes.items[countUpTo(record.floor.scenes.t, now) - 1] ?? [];
    if (items !== scene) {
      const lying = items.filter((item) => "x" in item);
      seen.replaceChildren(...lying.map((item) => sighting(item, unit)));
    }
    const there = [...record.floor.markers.keys()].filter((i) => isThere(record.floor.markers[i], now));
    if (there.join() !== drawn) {
      marked.replaceChildren(...there.map((i) => marker(record.floor.markers[i], unit)));
    }
    drawn = there.join();
    const count = countUpTo(path.t, now);
    if (count !== passed) {
      driven.setAttribute("points", points(path, count));
      moveRobot(robot, path, count - 1, unit);
    }
    if (items !== scene || count !== passed) write(caption, poseWords(path, count - 1, items));
    [scene, passed] = [items, count];
  });
}

/** Put the arrow where the robot was; out of sight before anybody knew. */
function moveRobot(robot, { x, y, yaw }, at, unit) {
  const turn = (-yaw[at] * 180) / Math.PI;
  const pose = `translate(${x[at]} ${-y[at]}) rotate(${turn}) scale(${1.6 * unit})`;
  robot.setAttribute("transform", at < 0 ? "scale(0)" : pose);
}

/** Where the robot is, and what it holds. */
function poseWords({ x, y, yaw }, at, items) {
  const held = items.filter((item) => !("x" in item)).map((item) => `holds ${item.name}`);
  const words = at < 0 ? [] : [
    `x ${x[at].toFixed(2)} m`, `y ${y[at].toFixed(2)} m`, `${Math.round((yaw[at] * 180) / Math.PI)}°`,
  ];
  return [...words, ...held].join(", ");
}

function points({ x, y }, count) {
  const texts = [];
  for (let i = 0; i < count; i++) texts.push(`${x[i]},${-y[i]}`);
  return texts.join(" ");
}

/** The floor plan's picture, if there is one. */
function plan() {
  const { image } = record.floor;
  if (!image) return [];
  const { x, y, width, height } = image;
  return [draw("image", { href: image.data, x, y: -y - height, width, height, preserveAspectRatio: "none" })];
}

function label(x, y, unit, name) {
  return draw("text", { x, y: -y, "font-size": 2.6 * unit }, name);
}

function surface({ name, x, y, yaw, size, round }, unit) {
  const [depth, width] = size;
  const transform = `translate(${x} ${-y}) rotate(${(-yaw * 180) / Math.PI})`;
  const box = { x: -depth / 2, y: -width / 2, width: depth, height: width, rx: round ? depth / 2 : 0, transform };
  const top = draw("rect", box);
  return draw("g", { class: "surface" }, top, label(x, y + Math.max(depth, width) / 2 + 1.2 * unit, unit, name));
}

function place({ name, x, y }, unit) {
  const dot = draw("circle", { cx: x, cy: -y, r: 0.8 * unit });
  return draw("g", { class: "place" }, dot, label(x, y + 1.2 * unit, unit, name));
}

function isThere({ begin, end }, now) {
  return begin <= now && now < end;
}

/** What a skill drew: a text, dots, or a line. */
function marker({ points: found, color, text, size, closed }, unit) {
  const flipped = found.map(([x, y]) => [x, -y]);
  if (text !== undefined) {
    const [x, y] = flipped[0];
    return draw("text", { x, y, "font-size": 2.6 * unit, style: `fill: ${color}` }, text);
  }
  if (size !== undefined) {
    const r = Math.max(size / 2, 0.25 * unit);
    return draw("g", {}, ...flipped.map(([cx, cy]) => draw("circle", { cx, cy, r, style: `fill: ${color}` })));
  }
  const corners = flipped.map((each) => each.join()).join(" ");
  return draw(closed ? "polygon" : "polyline", { points: corners, style: `stroke: ${color}` });
}

/** An object as it was seen, at least as large as a dot; its name is below it. */
function sighting({ name, x, y, size }, unit) {
  const radius = Math.max(size / 2, 0.9 * unit);
  return draw("g", {}, draw("circle", { cx: x, cy: -y, r: radius }), label(x, y - radius - 2.3 * unit, unit, name));
}
