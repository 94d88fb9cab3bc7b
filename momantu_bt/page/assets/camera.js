// The picture that was taken nearest to the instant.

function showCamera() {
  const cameras = record.cameras;
  if (!cameras.length) return leaveOut("camera");
  const choice = make("select", { "aria-label": "Camera", change: changed });
  choice.append(...cameras.map((camera, i) => make("option", { value: i }, camera.name)));
  const caption = make("span", { class: "caption" });
  const body = panel("camera", "Camera", caption, ...(cameras.length > 1 ? [choice] : []));
  const image = make("img", { alt: "" });
  body.append(image);
  watch((tick) => {
    const camera = cameras[Number(choice.value)];
    const now = timeOf(tick);
    const after = countUpTo(camera.times, now);
    const near = [after - 1, after].filter((i) => i >= 0 && i < camera.times.length);
    near.sort((a, b) => Math.abs(camera.times[a] - now) - Math.abs(camera.times[b] - now));
    const at = camera.times[near[0]];
    if (image.src !== camera.images[near[0]]) image.src = camera.images[near[0]];
    image.alt = `${camera.name} at ${seconds(at)}`;
    const apart = Math.abs(at - now);
    const when = apart < 0.025 ? "now" : `${seconds(apart)} ${at < now ? "ago" : "later"}`;
    write(caption, `${camera.name} at ${seconds(at)}, ${when}`);
  });
}
