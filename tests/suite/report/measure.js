// What a reader would stumble over, found by measuring: run in a copy of a report, which answers to the page whose frame it is in.
const found = [];
document.querySelectorAll("details").forEach((details) => (details.open = true));
if (document.documentElement.scrollWidth > window.innerWidth) {
  found.push(`the page is ${document.documentElement.scrollWidth} px wide in a window of ${window.innerWidth}`);
}
const within = (inner, outer, room) =>
  inner.left >= outer.left - room && inner.right <= outer.right + room &&
  inner.top >= outer.top - room && inner.bottom <= outer.bottom + room;
const overlap = (a, b) =>
  Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1;
let panels = 0;
document.querySelectorAll("figure svg, svg.scale").forEach((svg) => {
  const frame = svg.getBoundingClientRect();
  if (frame.width === 0) return;
  panels += 1;
  const name = svg.getAttribute("aria-label") || "scale";
  const texts = [...svg.querySelectorAll("text")].filter((text) => text.textContent.trim() !== "");
  const boxes = texts.map((text) => text.getBoundingClientRect());
  texts.forEach((text, i) => {
    if (!within(boxes[i], frame, 0.5)) found.push(`${name}: "${text.textContent}" is cut`);
    for (let j = 0; j < i; j++) {
      if (overlap(boxes[i], boxes[j])) found.push(`${name}: "${text.textContent}" overlaps "${texts[j].textContent}"`);
    }
  });
  if (!svg.matches(".scale") && texts.length < 3) found.push(`${name}: has ${texts.length} labels only`);
});
// What scrolls may be wider than the window; nothing else.
document.querySelectorAll("p, h1, h2, figcaption, summary, .legend, nav, figure").forEach((element) => {
  if (element.scrollWidth > element.clientWidth + 1) found.push(`"${element.textContent.slice(0, 60)}" is wider than its place`);
});
// Whatever the page asked for, got or not.
const requests = performance.getEntriesByType("resource").map((entry) => entry.name).filter((name) => !name.startsWith("data:"));
parent.postMessage(JSON.stringify({ width: window.innerWidth, panels, found, requests }), "*");
