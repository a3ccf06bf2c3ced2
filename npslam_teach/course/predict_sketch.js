// The drawing area of a question: a line drawn with the mouse, a finger, or the arrow keys and Enter. Its box is left,
// bottom, right and top, in metres.
globalThis.npslamSketch = (root, make) => {
  const SVG = "http://www.w3.org/2000/svg";
  const svg = root.querySelector("svg");
  const box = JSON.parse(svg.dataset.box);
  const size = svg.viewBox.baseVal;
  const answer = JSON.parse(svg.dataset.answer);
  const scale = size.width / (box[2] - box[0]);
  const pixel = ([x, y]) => [(x - box[0]) * scale, (box[3] - y) * scale];
  const line = (color) => {
    const element = svg.appendChild(document.createElementNS(SVG, "polyline"));
    const style = { fill: "none", stroke: color, "stroke-width": 4 };
    for (const [name, value] of Object.entries(style)) element.setAttribute(name, value);
    return element;
  };
  const [mine, truth, pen] = [line("#d45e00"), line("#1a1a1a"), line("#d45e00")];
  const status = make("p", svg.parentElement, "", { "aria-live": "polite" });
  let points = [];
  const start = JSON.parse(svg.dataset.start);
  let cursor = start;
  const draw = () => {
    mine.setAttribute("points", points.map(pixel).join(" "));
    const [x, y] = pixel(cursor);
    pen.setAttribute("points", `${x - 9},${y} ${x + 9},${y} ${x},${y} ${x},${y - 9} ${x},${y + 9}`);
  };
  const metres = (event) => {
    const area = svg.getBoundingClientRect();
    const at = [(event.clientX - area.left) / area.width, (event.clientY - area.top) / area.height];
    return [box[0] + at[0] * (box[2] - box[0]), box[3] - at[1] * (box[3] - box[1])];
  };
  let drawing = false;
  const add = (at) => { cursor = at; points.push(at.map((each) => Math.round(each * 100) / 100)); draw(); };
  svg.addEventListener("pointerdown", (event) => {
    drawing = true;
    points = [];
    svg.setPointerCapture(event.pointerId);
    add(metres(event));
  });
  svg.addEventListener("pointermove", (event) => { if (drawing && points.length < 500) add(metres(event)); });
  for (const name of ["pointerup", "pointercancel"]) svg.addEventListener(name, () => { drawing = false; });
  const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  svg.addEventListener("keydown", (event) => {
    const step = STEPS[event.key];
    const inside = (each, i) => Math.min(Math.max(each, box[i]), box[i + 2]);
    if (step) cursor = cursor.map((each, i) => inside(each + (step[i] * (box[2] - box[0])) / 40, i));
    else if (event.key === "Enter" || event.key === " ") add(cursor);
    else if (event.key === "Backspace") points.pop();
    else return;
    event.preventDefault();
    status.textContent = `x ${cursor[0].toFixed(1)} m, y ${cursor[1].toFixed(1)} m, ${points.length} points drawn`;
    draw();
  });
  draw();
  return {
    read: () => (points.length ? points : null),
    show: (kept) => { points = kept ?? []; cursor = points.at(-1) ?? start; draw(); },
    say: (kept) => {
      const [mineEnd, end] = [kept.at(-1), answer.at(-1)];
      const off = Math.hypot(mineEnd[0] - end[0], mineEnd[1] - end[1]).toFixed(1);
      return `Your line, orange, ends ${off} m from where it ends, black.`;
    },
    reveal: (open) => truth.setAttribute("points", open ? answer.map(pixel).join(" ") : ""),
  };
};
