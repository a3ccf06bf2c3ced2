// "Draw your own world", the page's side: drawing with mouse, finger or keys, and showing what the kernel answers.
//
// The model holds `drawing`, what the student decides, and `answer`, what the kernel computes from it; messages.py
// describes both. A drawing is sent when the mouse is lifted, never while it moves, and only one at a time: while the
// kernel works, later ones wait, and of these only the last is sent. There are two answers: at once the round before
// the method starts, later all rounds. A drawing that the kernel refuses is taken back. Everything is in metres until
// `toPixels`.

const MARGIN = { left: 40, right: 8, top: 8, bottom: 36 }; // px around the room, for the axes
const TALLEST = 560; // px
const NEAR = { mouse: 14, pen: 16, touch: 26 }; // px from a handle that still grabs it
const VIEW = { range: 4, half: Math.PI / 3 }; // m, rad: the paper's sensor
const DWELL = 250, GLIDE = 450; // ms that a round stands still, and that it takes to become the next
const PATIENCE = 4000; // ms without an answer before the page says so

// Markers of matplotlib around (0, 0), about 2 wide.
const polygon = (...points) => (c) => points.forEach(([x, y], k) => (k ? c.lineTo(x, y) : c.moveTo(x, y)));
const MARKERS = {
  o: (c) => c.arc(0, 0, 1, 0, 2 * Math.PI),
  s: polygon([-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]),
  "^": polygon([0, -1.1], [1, 0.9], [-1, 0.9]),
  v: polygon([0, 1.1], [1, -0.9], [-1, -0.9]),
  D: polygon([0, -1.2], [1.2, 0], [0, 1.2], [-1.2, 0]),
  P: polygon([-0.35, -1], [0.35, -1], [0.35, -0.35], [1, -0.35], [1, 0.35], [0.35, 0.35], [0.35, 1], [-0.35, 1],
    [-0.35, 0.35], [-1, 0.35], [-1, -0.35], [-0.35, -0.35]),
  X: polygon([-1, -0.5], [-0.5, -1], [0, -0.5], [0.5, -1], [1, -0.5], [0.5, 0], [1, 0.5], [0.5, 1], [0, 0.5],
    [-0.5, 1], [-1, 0.5], [-0.5, 0]),
  "*": polygon(...Array.from({ length: 10 }, (_, k) => {
    const radius = k % 2 ? 0.5 : 1.25;
    return [radius * Math.sin((k * Math.PI) / 5), -radius * Math.cos((k * Math.PI) / 5)];
  })),
};

/** The colour and the marker of a class, by the same rule as plotting.style.class_style. */
function classStyle(look, c) {
  const n = look.colors.length;
  return { color: look.colors[c % n], marker: MARKERS[look.markers[(c + Math.floor(c / n)) % n]] };
}

function drawMarker(context, marker, x, y, radius, { fill, edge, width = 1, alpha = 1 }) {
  context.save();
  context.translate(x, y);
  context.beginPath();
  context.scale(radius, radius);
  marker(context);
  context.closePath();
  context.restore(); // so that the edge is not scaled
  context.save();
  context.globalAlpha *= alpha;
  if (fill) { context.fillStyle = fill; context.fill(); }
  if (edge) { context.strokeStyle = edge; context.lineWidth = width; context.stroke(); }
  context.restore();
}

/** An element with attributes and children; names that begin with "on" are listeners. */
function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (typeof value === "boolean") element.toggleAttribute(name, value);
    else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

const clone = (value) => JSON.parse(JSON.stringify(value));
const withoutRequest = ({ request, ...entries }) => clone(entries);
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
const toMillimetres = (value) => Math.round(value * 1000) / 1000;

function render({ model, el }) {
  const look = model.get("look"), worlds = model.get("worlds"), paths = model.get("paths");
  let drawing = withoutRequest(model.get("drawing")); // as the student sees it, perhaps not yet sent
  let good = drawing; // the last one that the kernel accepted
  let result = null; // its answer
  const answers = new Map(); // the words of each method on the world that is shown
  let tool = "path"; // or the index of the class to drop
  let selected = null; // { index, end }: an object, or the end of its way
  let gesture = null; // what the pointer is doing
  let shown = 0; // the round on the map; between two whole numbers while it glides
  let playing = 0, waiting = 0; // handles of an animation frame and of a timer
  let kept = clone(drawing), past = [], future = []; // the last drawing that was sent, and those to undo and redo to
  let unsent = false, since = 0; // whether an edit waits to be sent, and when it was made
  let scale = 1, width = 0, height = 0;

  // ---- the page ------------------------------------------------------------------------------------------------
  const canvas = h("canvas", { tabindex: "0", role: "application" });
  const context = canvas.getContext("2d");
  const map = h("div", { class: "map" }, canvas);
  const bars = h("div", { class: "bars", role: "group", "aria-label": "Objects in each round; press one to see it" });
  const play = h("button", { type: "button", onclick: () => startPlaying() }, "▶ Play the rounds");
  const roundWords = h("p", { class: "round" });
  const words = h("p", { class: "words", role: "status", "aria-live": "polite" });
  const lookFor = h("p", { class: "look-for" });
  const note = h("span", { class: "note", role: "status", "aria-live": "polite" });
  const chosenNote = h("span", { class: "chosen", role: "status", "aria-live": "polite" });
  const beside = h("ul", { class: "beside" });
  const latency = h("span", { class: "keys" });

  const select = (name, options, onchange) => {
    const list = h("select", { "aria-label": name, onchange: () => onchange(list.value) });
    options.forEach(([value, text]) => list.append(h("option", { value }, text)));
    return [h("label", {}, name, list), list];
  };
  const slider = (name, key, max, step) => {
    const value = h("output", {});
    const input = h("input", { type: "range", min: 0, max, step, onchange: () => commit() });
    input.addEventListener("input", () => { drawing[key] = Number(input.value); value.textContent = input.value; });
    return [h("label", {}, name, input, value), () => { input.value = drawing[key]; value.textContent = drawing[key]; }];
  };
  const worldNames = Object.entries(worlds).map(([key, each]) => [key, each.title]);
  const [worldLabel, worldList] = select("World", [["", "(your own)"], ...worldNames], (key) => {
    if (!key) return;
    drawing = { ...clone(worlds[key].drawing), method: drawing.method };
    lookFor.textContent = worlds[key].look_for;
    selected = null;
    commit();
  });
  const pathNames = Object.keys(paths).map((name) => [name, name]);
  const [pathLabel, pathList] = select("Path", [["", "(as drawn)"], ...pathNames], (name) => {
    if (!name) return;
    const [left, bottom, right, top] = drawing.room; // the paths were made for a room of 12 m x 8 m
    drawing.stroke = paths[name].map(([x, y]) => [left + (x / 12) * (right - left), bottom + (y / 8) * (top - bottom)]);
    commit();
  });
  const [methodLabel, methodList] = select("Method", Object.entries(look.methods), (name) => {
    drawing.method = name;
    commit();
  });
  const undo = h("button", { type: "button", title: "Control+Z", onclick: () => goTo(past, future) }, "↶ Undo");
  const redo = h("button", { type: "button", title: "Control+Shift+Z", onclick: () => goTo(future, past) }, "↷ Redo");
  const again = h("button", { type: "button", onclick: () => { drawing.seed += 1; commit(); } }, "Drive again");
  again.title = "The same world and path with other luck: the noise is drawn anew";
  const [noiseLabel, showNoise] = slider("Noise (1 = the paper's)", "noise", look.max_noise, 0.1);
  const [clutterLabel, showClutter] = slider("False sightings per pose", "clutter_rate", look.max_clutter, 0.05);
  const [chosenLabel, chosenList] = select("Selected", [], (value) => {
    const [index, end] = value.split(" ");
    selected = value ? { index: Number(index), end: end === "end" } : null;
    refresh();
  });
  const moves = h("input", { type: "checkbox", onchange: () => setMoving(moves.checked) });
  const movesLabel = h("label", {}, moves, "is carried during the drive");
  const remove = h("button", { type: "button", onclick: () => removeSelected() }, "Remove");
  const add = h("button", { type: "button", onclick: () => addInTheMiddle() }, "Add in the middle");
  const file = h("input", { type: "text", value: "my_world.npz", size: "18" });
  const ask = (what) => model.send({ do: what, file: file.value.trim() });
  const save = h("button", { type: "button", onclick: () => ask("save") }, "Save");
  const load = h("button", { type: "button", onclick: () => ask("load") }, "Load");
  const give = h("button", { type: "button", onclick: () => download() }, "Export for a friend");
  const opener = h("input", { type: "file", accept: ".json", "aria-label": "Open a world that a friend exported" });
  opener.addEventListener("change", () => openFile(opener.files[0]));
  const tools = h("div", { class: "row", role: "group", "aria-label": "What the mouse draws or drops" });
  const mark = (name, text) => h("span", {}, h("i", { class: name }), text);
  const legend = h("div", { class: "row legend keys" }, mark("dashed", "true path"), mark("", "estimated path"),
    mark("ring", "true object: drag it"), mark("dot", "estimated object, larger when seen more often"));
  const keys = h("p", { class: "keys" }, "Keys on the map: arrows move the selected object by 0.1 m (with Shift 0.5 m), " +
    "Page Up and Page Down select, Enter adds an object of the chosen class in the middle, Delete removes it. " +
    "Control+Z takes the last change back, Control+Shift+Z makes it again.");
  const side = h("div", { class: "side" }, h("strong", {}, "Objects, round by round (log scale)"), bars, roundWords, play);
  const root = h("div", { class: "draw-world" },
    h("div", { class: "row" }, worldLabel, pathLabel, methodLabel, again, undo, redo), tools,
    h("div", { class: "stage" }, map, side), legend, words, beside, lookFor, h("div", { class: "row" }, noiseLabel, clutterLabel),
    h("div", { class: "row" }, chosenLabel, movesLabel, add, remove, chosenNote),
    h("div", { class: "row" }, h("label", {}, "File", file), save, load, note),
    h("div", { class: "row" }, give, h("label", {}, "Open an exported world", opener)), keys, latency);
  el.append(root);

  // ---- sending and receiving -----------------------------------------------------------------------------------
  const busy = () => model.get("drawing").request !== model.get("answer").request || !model.get("answer").done;

  function commit() {
    if (JSON.stringify(drawing) !== JSON.stringify(kept)) {
      past.push(kept);
      future = [];
    }
    send();
  }

  /** Undo with (past, future), redo with (future, past). */
  function goTo(from, to) {
    if (!from.length || gesture) return;
    to.push(kept);
    drawing = from.pop();
    selected = null;
    worldList.value = pathList.value = "";
    send();
    onNames();
  }

  function send() {
    kept = clone(drawing);
    unsent = true;
    since = performance.now();
    stopPlaying();
    refresh();
    flush();
  }

  function flush() {
    if (!unsent || busy()) return;
    unsent = false;
    root.dataset.state = "busy";
    clearTimeout(waiting);
    waiting = setTimeout(() => say("Still waiting for the kernel: it is busy with a cell, or it has stopped.", true), PATIENCE);
    model.set("drawing", { ...clone(drawing), request: model.get("drawing").request + 1 });
    model.save_changes();
  }

  function onDrawing() { // from Python, or our own coming back
    const sent = withoutRequest(model.get("drawing"));
    if (unsent || gesture || JSON.stringify(sent) === JSON.stringify(kept)) return;
    past.push(kept);
    future = [];
    drawing = sent;
    kept = clone(sent);
    selected = null;
    refresh();
  }

  function onAnswer() {
    const answer = model.get("answer");
    if (answer.request !== model.get("drawing").request) return;
    clearTimeout(waiting);
    if (unsent) return flush(); // this answer is stale: the drawing has changed since
    if (answer.error) refuse(answer);
    else accept(answer);
    refresh();
    requestAnimationFrame(() => painted(answer));
  }

  function refuse(answer) {
    drawing = clone(good);
    if (JSON.stringify(past.at(-1)) === JSON.stringify(good)) past.pop();
    kept = clone(good);
    selected = null;
    say(`${answer.error}.${result ? " The last good world is kept." : ""}`, true);
  }

  function accept(answer) {
    const isFirst = !result || result.request !== answer.request;
    result = answer;
    buildBars();
    if (isFirst) startPlaying();
    else showRound(shown);
    if (!answer.done) return;
    compare(answer);
    good = clone(drawing);
    say(answer.words, false);
  }

  /** The answers of several methods to one world, beside each other. */
  function compare(answer) {
    const world = JSON.stringify({ ...drawing, method: "" });
    if (beside.dataset.world !== world) answers.clear();
    beside.dataset.world = world;
    answers.set(drawing.method, answer.words);
    const lines = [...answers].map(([name, text]) => h("li", {}, h("strong", {}, `${look.methods[name]}: `), text));
    beside.replaceChildren(...(lines.length > 1 ? lines : []));
  }

  // ---- a file for a friend ---------------------------------------------------------------------------------------
  function download() {
    const address = URL.createObjectURL(new Blob([JSON.stringify(drawing, null, 1)], { type: "application/json" }));
    h("a", { href: address, download: `${file.value.trim().replace(/\.npz$/, "") || "my_world"}.json` }).click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
    note.textContent = "Exported: a friend opens the file on this page of their own.";
  }

  async function openFile(chosen) {
    if (!chosen) return;
    try {
      drawing = { ...clone(good), ...withoutRequest(JSON.parse(await chosen.text())) };
      handles(); // what is no drawing fails here, or is refused by the kernel
    } catch {
      drawing = clone(good);
      note.textContent = `${chosen.name}: expected a world that this page exported, got something else.`;
      return;
    } finally {
      opener.value = "";
    }
    selected = null;
    note.textContent = `Opened ${chosen.name}.`;
    onNames();
    commit();
  }

  function painted(answer) {
    const milliseconds = since ? Math.round(performance.now() - since) : "";
    if (root.dataset.firstOf !== String(answer.request)) {
      root.dataset.firstOf = answer.request;
      root.dataset.first = milliseconds;
    }
    if (!answer.done) return;
    Object.assign(root.dataset, { state: answer.error ? "error" : "done", request: answer.request, last: milliseconds });
    if (since) latency.textContent = `First picture after ${root.dataset.first} ms, answer after ${milliseconds} ms.`;
    since = 0;
  }

  function say(text, isError) {
    words.textContent = text;
    words.classList.toggle("error", isError);
  }

  // ---- editing -------------------------------------------------------------------------------------------------
  const className = (each) => drawing.class_names[each.class];
  const isCarried = (each) => each.goal_x !== each.x || each.goal_y !== each.y;
  const placeOf = ({ index, end }) => {
    const each = drawing.objects[index];
    return end ? [each.goal_x, each.goal_y] : [each.x, each.y];
  };

  function inside([x, y]) {
    const [left, bottom, right, top] = drawing.room;
    return [toMillimetres(clamp(x, left, right)), toMillimetres(clamp(y, bottom, top))];
  }

  function moveTo({ index, end }, point) {
    const each = drawing.objects[index], carried = isCarried(each);
    const [x, y] = inside(point);
    if (!end) Object.assign(each, { x, y });
    if (end || !carried) Object.assign(each, { goal_x: x, goal_y: y });
    worldList.value = "";
  }

  function addObject(point) {
    const [x, y] = inside(point);
    drawing.objects.push({ x, y, class: tool === "path" ? 0 : tool, goal_x: x, goal_y: y });
    selected = { index: drawing.objects.length - 1, end: false };
    worldList.value = "";
  }

  function addInTheMiddle() {
    const [left, bottom, right, top] = drawing.room;
    addObject([(left + right) / 2, (bottom + top) / 2]);
    commit();
  }

  function removeSelected() {
    if (!selected) return;
    drawing.objects.splice(selected.index, 1);
    selected = null;
    worldList.value = "";
    commit();
  }

  function setMoving(carried) {
    const each = drawing.objects[selected.index];
    const [x, y] = carried ? inside([each.x + (each.x + 2 > drawing.room[2] ? -2 : 2), each.y]) : [each.x, each.y];
    Object.assign(each, { goal_x: x, goal_y: y });
    selected = { index: selected.index, end: carried };
    commit();
  }

  function handles() {
    return drawing.objects.flatMap((each, index) =>
      isCarried(each) ? [{ index, end: false }, { index, end: true }] : [{ index, end: false }]);
  }

  // ---- mouse, finger, pen ----------------------------------------------------------------------------------------
  const toPixels = (x, y) => [MARGIN.left + (x - drawing.room[0]) * scale, MARGIN.top + (drawing.room[3] - y) * scale];
  function toMetres(event) {
    const box = canvas.getBoundingClientRect();
    const x = event.clientX - box.left - canvas.clientLeft - MARGIN.left;
    const y = event.clientY - box.top - canvas.clientTop - MARGIN.top;
    return [drawing.room[0] + x / scale, drawing.room[3] - y / scale];
  }

  function handleAt([x, y], kind) {
    const distance = (handle) => Math.hypot(placeOf(handle)[0] - x, placeOf(handle)[1] - y) * scale;
    const near = handles().filter((handle) => distance(handle) <= (NEAR[kind] || NEAR.mouse));
    return near.sort((a, b) => distance(a) - distance(b))[0] || null;
  }

  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || gesture) return;
    event.preventDefault();
    canvas.focus({ preventScroll: true });
    canvas.setPointerCapture(event.pointerId);
    stopPlaying();
    const point = toMetres(event), handle = handleAt(point, event.pointerType);
    const before = clone(drawing);
    if (handle) {
      const [x, y] = placeOf(handle);
      selected = handle;
      gesture = { pointer: event.pointerId, before, grab: [x - point[0], y - point[1]], moved: false };
    } else if (tool === "path") {
      gesture = { pointer: event.pointerId, before, stroke: [inside(point)] };
    } else {
      addObject(point);
      gesture = { pointer: event.pointerId, before, grab: [0, 0], moved: true };
    }
    refresh();
  });

  canvas.addEventListener("pointermove", (event) => {
    if (!gesture) {
      canvas.style.cursor = handleAt(toMetres(event), event.pointerType) ? "grab" : "crosshair";
      return;
    }
    if (event.pointerId !== gesture.pointer) return;
    const events = event.getCoalescedEvents ? event.getCoalescedEvents() : [];
    for (const each of events.length ? events : [event]) {
      const point = toMetres(each);
      if (gesture.stroke) extend(gesture.stroke, inside(point));
      else { moveTo(selected, [point[0] + gesture.grab[0], point[1] + gesture.grab[1]]); gesture.moved = true; }
    }
    requestPaint();
  });

  function extend(stroke, point) { // points closer than two pixels say nothing new
    const last = stroke[stroke.length - 1];
    if (Math.hypot(point[0] - last[0], point[1] - last[1]) * scale >= 2) stroke.push(point);
  }

  function endGesture(event, keep) {
    if (!gesture || event.pointerId !== gesture.pointer) return;
    const { stroke, moved, before } = gesture;
    gesture = null;
    if (!keep) { drawing = before; refresh(); return; }
    if (stroke) { drawing.stroke = stroke; pathList.value = ""; worldList.value = ""; }
    if (stroke || moved) commit();
    else refresh();
  }
  canvas.addEventListener("pointerup", (event) => endGesture(event, true));
  canvas.addEventListener("pointercancel", (event) => endGesture(event, false));

  // ---- keys ------------------------------------------------------------------------------------------------------
  const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  let nudged = false; // moved by a key that is still held: a held key repeats, the kernel is asked once

  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return; // undo and redo work wherever the focus is
    const cycle = { PageDown: 1, PageUp: -1 }[event.key];
    if (ARROWS[event.key] && selected) nudge(ARROWS[event.key], event.shiftKey ? 0.5 : 0.1);
    else if (cycle) selectNext(cycle);
    else if (event.key === "Delete" || event.key === "Backspace") removeSelected();
    else if (event.key === "Enter" && !event.shiftKey) addInTheMiddle();
    else if (event.key === "Escape" && gesture) endGesture({ pointerId: gesture.pointer }, false);
    else return;
    event.preventDefault();
  });
  // JupyterLab takes single letters and arrows for its own shortcuts ("x" cuts the cell); Control+S may stay its own.
  // It looks for this attribute in a listener of the document, so the window has to be listened to.
  const historyKey = ({ ctrlKey, metaKey, altKey, key }) => (ctrlKey || metaKey) && !altKey && /^[zy]$/i.test(key);
  root.addEventListener("keydown", (event) => {
    if (!historyKey(event) || event.target.type === "text") return;
    event.preventDefault();
    if (event.shiftKey || event.key.toLowerCase() === "y") goTo(future, past);
    else goTo(past, future);
  });
  const shield = (event) => {
    const isPlain = !event.ctrlKey && !event.metaKey && !(event.shiftKey && event.key === "Enter");
    const isOurs = isPlain || historyKey(event);
    if (root.contains(event.target)) event.target.toggleAttribute("data-lm-suppress-shortcuts", isOurs);
  };
  window.addEventListener("keydown", shield, true);
  const endNudge = () => { if (nudged) { nudged = false; commit(); } };
  canvas.addEventListener("keyup", endNudge);
  canvas.addEventListener("blur", endNudge);

  function nudge([right, up], step) {
    const [x, y] = placeOf(selected);
    moveTo(selected, [x + right * step, y + up * step]);
    nudged = true;
    stopPlaying();
    refresh();
  }

  function selectNext(by) {
    const all = handles();
    const now = all.findIndex((each) => selected && each.index === selected.index && each.end === selected.end);
    selected = all.length ? all[(Math.max(now, by > 0 ? -1 : 0) + by + all.length) % all.length] : null;
    refresh();
  }

  // ---- the rounds ------------------------------------------------------------------------------------------------
  function startPlaying() {
    stopPlaying();
    const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
    const begin = performance.now();
    const step = (now) => {
      const last = result.rounds.length - 1; // grows while the kernel works
      const elapsed = Math.max(now - begin, 0) / (DWELL + GLIDE), whole = Math.floor(elapsed); // a frame begins in the past
      const part = clamp(((elapsed - whole) * (DWELL + GLIDE) - DWELL) / GLIDE, 0, 1);
      const position = Math.min(whole + (still ? 0 : part * part * (3 - 2 * part)), last);
      if (now === begin || position !== shown) showRound(position); // while a round stands still there is nothing to paint
      playing = shown < last || !result.done ? requestAnimationFrame(step) : 0;
    };
    step(begin);
  }

  function stopPlaying() {
    cancelAnimationFrame(playing);
    if (playing && result) showRound(result.rounds.length - 1);
    playing = 0;
  }

  function showRound(position) {
    shown = position;
    const k = Math.round(position);
    roundWords.textContent = result.rounds[k].words;
    root.dataset.round = position;
    bars.querySelectorAll("button").forEach((bar, j) => bar.setAttribute("aria-pressed", String(j === k)));
    paint();
  }

  function buildBars() {
    const most = Math.max(...result.rounds.map((each) => each.count), result.num_seen, 2);
    const share = (count) => (78 * Math.log1p(count)) / Math.log1p(most); // per cent of the box
    bars.replaceChildren(...result.rounds.map((each, k) => {
      const bar = h("button", { type: "button", "aria-label": each.words, "aria-pressed": "false" },
        String(each.count), h("i", { style: `height: ${share(each.count)}%` }), h("small", {}, String(k)));
      bar.addEventListener("click", () => { stopPlaying(); showRound(k); });
      return bar;
    }));
    // The bars stand on the line of small numbers, 22 px above the bottom.
    const line = h("div", { class: "there", style: `bottom: calc(${share(result.num_seen)}% + 22px)` });
    line.title = `${result.num_seen} objects were there to be seen`;
    bars.append(line);
  }

  // ---- painting --------------------------------------------------------------------------------------------------
  let painting = 0;
  function requestPaint() {
    if (!painting) painting = requestAnimationFrame(() => { painting = 0; paint(); });
  }

  function fit() {
    const room = [drawing.room[2] - drawing.room[0], drawing.room[3] - drawing.room[1]];
    const space = [map.clientWidth - 2 - MARGIN.left - MARGIN.right, TALLEST - MARGIN.top - MARGIN.bottom];
    scale = Math.max(Math.min(space[0] / room[0], space[1] / room[1]), 1);
    width = Math.round(room[0] * scale) + MARGIN.left + MARGIN.right;
    height = Math.round(room[1] * scale) + MARGIN.top + MARGIN.bottom;
    const ratio = window.devicePixelRatio || 1;
    canvas.style.width = `${width}px`;
    canvas.style.height = `${height}px`;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
  }

  function paint() {
    fit();
    context.fillStyle = "#fff"; // also on a dark page: the colours are chosen for white
    context.fillRect(0, 0, width, height);
    paintAxes();
    context.save();
    context.beginPath();
    context.rect(MARGIN.left, MARGIN.top, width - MARGIN.left - MARGIN.right, height - MARGIN.top - MARGIN.bottom);
    context.clip();
    const editing = gesture || nudged || unsent || (result && result.request !== model.get("drawing").request);
    if (result && !(gesture && gesture.stroke)) paintTruePath(result.path);
    if (result) {
      context.globalAlpha = editing ? 0.25 : 1; // the answer to another drawing
      paintEstimate();
      context.globalAlpha = 1;
    }
    if (gesture && gesture.stroke) paintStroke(gesture.stroke);
    context.restore();
    paintTrueObjects(); // not clipped: a marker at the wall is not cut in half
  }

  function line(flat, style) {
    context.save();
    Object.assign(context, { lineJoin: "round", lineCap: "round", ...style });
    if (style.dash) context.setLineDash(style.dash);
    context.beginPath();
    for (let k = 0; k < flat.length; k += 2) context.lineTo(...toPixels(flat[k], flat[k + 1]));
    context.stroke();
    context.restore();
  }

  function paintAxes() {
    const [left, bottom, right, top] = drawing.room;
    const every = [1, 2, 5, 10, 20, 50].find((step) => step * scale >= 45) || 100;
    Object.assign(context, { font: "12px sans-serif", fillStyle: "#444", textAlign: "center", textBaseline: "top" });
    const grid = { strokeStyle: "#e6e6e6", lineWidth: 1 };
    for (let x = Math.ceil(left / every) * every; x <= right; x += every) {
      line([x, bottom, x, top], grid);
      context.fillText(x, toPixels(x, bottom)[0], height - MARGIN.bottom + 4);
    }
    context.fillText("x (m)", (MARGIN.left + width - MARGIN.right) / 2, height - 15);
    Object.assign(context, { textAlign: "right", textBaseline: "middle" });
    for (let y = Math.ceil(bottom / every) * every; y <= top; y += every) {
      line([left, y, right, y], grid);
      context.fillText(y, MARGIN.left - 5, clamp(toPixels(left, y)[1], 7, height - MARGIN.bottom - 2));
    }
    line([left, bottom, right, bottom, right, top, left, top, left, bottom], { strokeStyle: "#999", lineWidth: 1 });
    context.save();
    context.translate(9, (MARGIN.top + height - MARGIN.bottom) / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText("y (m)", 0, 0);
    context.restore();
  }

  function paintTruePath(path) {
    // A second lap would fill the gaps of the first one's dashes, so a stretch is drawn once.
    for (const stretch of firstLaps(path)) {
      line(stretch, { strokeStyle: look.truth, lineWidth: 2.2, dash: [8, 6], lineCap: "butt" });
    }
    drawMarker(context, MARKERS.o, ...toPixels(path[0], path[1]), 5, { fill: look.estimate });
  }

  function firstLaps(path) {
    const seen = new Map(), stretches = [[]];
    let along = 0;
    for (let k = 0; k < path.length; k += 2) {
      const [x, y] = toPixels(path[k], path[k + 1]);
      if (k) along += Math.hypot(path[k] - path[k - 2], path[k + 1] - path[k - 1]) * scale;
      const cell = (i, j) => `${Math.round(x / 4) + i},${Math.round(y / 4) + j}`; // of 4 px
      const near = [-1, 0, 1].flatMap((i) => [-1, 0, 1].map((j) => cell(i, j)));
      if (near.some((each) => seen.has(each) && along - seen.get(each) > 40)) {
        if (stretches.at(-1).length) stretches.push([]);
      } else {
        stretches.at(-1).push(path[k], path[k + 1]);
        seen.set(near[4], along);
      }
    }
    return stretches.filter((each) => each.length > 2);
  }

  function paintTrueObjects() {
    drawing.objects.forEach((each, index) => {
      const { marker, color } = classStyle(look, each.class);
      const here = toPixels(each.x, each.y), there = toPixels(each.goal_x, each.goal_y);
      if (isCarried(each)) {
        line([each.x, each.y, each.goal_x, each.goal_y], { strokeStyle: color, lineWidth: 1.5, dash: [3, 4] });
        const angle = Math.atan2(there[1] - here[1], there[0] - here[0]);
        for (const side of [-0.45, 0.45]) { // the head of the arrow
          context.beginPath();
          context.moveTo(there[0] - 11 * Math.cos(angle), there[1] - 11 * Math.sin(angle));
          context.lineTo(there[0] - 21 * Math.cos(angle + side), there[1] - 21 * Math.sin(angle + side));
          Object.assign(context, { strokeStyle: color, lineWidth: 1.5 });
          context.stroke();
        }
        drawMarker(context, marker, ...there, 9, { edge: look.truth, width: 1, fill: "#ffffffaa" });
      }
      drawMarker(context, marker, ...here, 11, { edge: look.truth, width: 1.8 });
      drawMarker(context, marker, ...here, 11, { fill: color, alpha: 0.14 });
      if (selected && selected.index === index) {
        const ring = selected.end ? there : here;
        drawMarker(context, MARKERS.o, ...ring, 17, { edge: "#00659f", width: 2.5 });
      }
    });
  }

  function paintEstimate() {
    const k = Math.floor(shown), part = shown - k, now = result.rounds[k], next = result.rounds[k + 1] || now;
    const between = (a, b) => a + part * (b - a);
    line(now.path.map((value, j) => between(value, next.path[j])), { strokeStyle: look.estimate, lineWidth: 1.8 });
    if (part > 0) {
      result.sighting_class.forEach((c, m) => { // each sighting glides from its object to its next one
        const a = 4 * now.labels[m], b = 4 * next.labels[m];
        if (a < 0 || b < 0) return; // taken away as a false positive
        const x = between(now.objects[a], next.objects[b]), y = between(now.objects[a + 1], next.objects[b + 1]);
        const { color, marker } = classStyle(look, c);
        drawMarker(context, marker, ...toPixels(x, y), 2.6, { fill: color, alpha: 0.5 });
      });
      return;
    }
    for (let j = 0; j < now.objects.length; j += 4) {
      const [x, y, c, sightings] = now.objects.slice(j, j + 4), { color, marker } = classStyle(look, c);
      const radius = 2.3 * Math.pow(sightings, 0.25); // as in plotting.maps: the area grows with the square root
      const alpha = sightings > 1 ? 1 : 0.6;
      drawMarker(context, marker, ...toPixels(x, y), radius, { fill: color, edge: look.estimate, width: 0.7 * alpha, alpha });
    }
  }

  function paintStroke(stroke) {
    line(stroke.flat(), { strokeStyle: look.estimate, lineWidth: 3 });
    const end = stroke[stroke.length - 1], from = stroke[Math.max(stroke.length - 6, 0)];
    const [x, y] = toPixels(...end), angle = Math.atan2(from[1] - end[1], end[0] - from[0]);
    context.save(); // what the robot sees from here
    Object.assign(context, { fillStyle: look.truth, globalAlpha: 0.18 });
    context.beginPath();
    context.moveTo(x, y);
    context.arc(x, y, VIEW.range * scale, angle - VIEW.half, angle + VIEW.half);
    context.fill();
    context.restore();
    drawMarker(context, MARKERS.o, x, y, 6, { fill: look.estimate });
  }

  // ---- everything that follows the drawing --------------------------------------------------------------------------
  function refresh() {
    showNoise();
    showClutter();
    const names = handles().map(({ index, end }) => {
      const name = `${index + 1}: ${className(drawing.objects[index])}`;
      return h("option", { value: `${index}${end ? " end" : ""}` }, end ? `${name}, end of its way` : name);
    });
    chosenList.replaceChildren(h("option", { value: "" }, "(none)"), ...names);
    chosenList.value = selected ? `${selected.index}${selected.end ? " end" : ""}` : "";
    moves.disabled = remove.disabled = !selected;
    moves.checked = selected !== null && isCarried(drawing.objects[selected.index]);
    describe();
    requestPaint();
  }

  function describe() {
    const chosen = selected
      ? `Selected: ${className(drawing.objects[selected.index])} at x ${placeOf(selected)[0].toFixed(1)}, y ${placeOf(selected)[1].toFixed(1)} m.`
      : "No object is selected.";
    canvas.setAttribute("aria-label", `Map of the room with ${drawing.objects.length} objects and the robot's path. ${chosen}`);
    chosenNote.textContent = chosen;
    undo.disabled = !past.length;
    redo.disabled = !future.length;
    methodList.value = drawing.method;
  }

  function buildTools() {
    const choose = (value, button) => {
      tool = value;
      tools.querySelectorAll("button").forEach((each) => each.setAttribute("aria-pressed", String(each === button)));
    };
    const path = h("button", { type: "button", class: "tool", "aria-pressed": "true", onclick: () => choose("path", path) }, "✎ Draw the path");
    const classes = drawing.class_names.map((name, c) => {
      const icon = h("canvas", { width: 18, height: 18, "aria-hidden": "true" });
      const { color, marker } = classStyle(look, c);
      drawMarker(icon.getContext("2d"), marker, 9, 9, 6.5, { fill: color, edge: look.estimate, width: 0.7 });
      const button = h("button", { type: "button", class: "tool", "aria-pressed": "false", onclick: () => choose(c, button) }, icon, `Drop a ${name}`);
      return button;
    });
    tools.replaceChildren(path, ...classes);
    tool = "path";
  }

  // ---- begin -------------------------------------------------------------------------------------------------------
  let toolsFor = "";
  function onNames() { // another file may bring other classes
    const names = JSON.stringify(drawing.class_names);
    if (names !== toolsFor) { toolsFor = names; buildTools(); }
  }
  function onNote(message) { if (message.note) note.textContent = message.note; }
  const onNewDrawing = () => { onDrawing(); onNames(); };
  model.on("change:drawing", onNewDrawing);
  model.on("change:answer", onAnswer);
  model.on("msg:custom", onNote);
  const observer = new ResizeObserver(() => requestPaint());
  observer.observe(map);
  const found = Object.keys(worlds).find((key) => JSON.stringify(worlds[key].drawing.objects) === JSON.stringify(drawing.objects));
  worldList.value = found || "";
  lookFor.textContent = found ? worlds[found].look_for : "";
  buildTools();
  toolsFor = JSON.stringify(drawing.class_names);
  onAnswer();

  return () => { // the view goes away
    stopPlaying();
    clearTimeout(waiting);
    observer.disconnect();
    window.removeEventListener("keydown", shield, true);
    model.off("change:drawing", onNewDrawing);
    model.off("change:answer", onAnswer);
    model.off("msg:custom", onNote);
  };
}

export default { render };
