// What hovering tells: one box that follows the pointer.

const tip = document.getElementById("tip");

/** Say `words(event)` while the pointer is over an element; an empty text says nothing. */
function hint(element, words) {
  element.addEventListener("pointermove", (event) => {
    event.stopPropagation();
    const text = words(event);
    tip.hidden = !text;
    write(tip, text);
    const right = window.innerWidth - tip.offsetWidth - 8;
    const below = event.clientY + 18;
    const high = below + tip.offsetHeight > window.innerHeight;
    tip.style.left = `${Math.max(4, Math.min(event.clientX + 12, right))}px`;
    tip.style.top = `${high ? event.clientY - tip.offsetHeight - 10 : below}px`;
  });
  element.addEventListener("pointerleave", () => (tip.hidden = true));
}
