// An explorer, the page's side: controls, a picture that follows them, and points in it that can be dragged.
//
// The kernel alone owns the state. The page asks for values, one request at a time, and of what is asked for meanwhile
// only the last is sent. It shows what `shown` says and never sends anything because of it, so nothing can echo. The
// same file runs without a kernel on frames that were computed before: see `frozen` at the end.

const GLIDE = 220; // ms that a scene takes to become the next
const LONGEST_GLIDE = 450; // ms, where a player moves it
const PATIENCE = 4000; // ms without an answer before the page says so
const SVG = "http://www.w3.org/2000/svg";
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const CATCH = 30; // of a scene's px, from which a stop pulls a ring to it
const HAND = new Set(["cx", "cy"]);
const NUMBER = /-?\d+(?:\.\d+)?(?:e-?\d+)?/g;

/** An element with attributes and children; names that begin with "on" are listeners. */
function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
const exact = (value) => Number(value.toPrecision(12)); // 0.7, where adding up steps gives 0.7000000000000001
const decimals = (step) => (String(step).split(".")[1] ?? "").length;
/** A number as it is written: with the decimals of its step, or with four digits where it lies beside the grid. */
function textOf(value, step) {
  const onGrid = value.toFixed(decimals(step));
  return Number(onGrid) === value ? onGrid : String(Number(value.toPrecision(4)));
}

/** Asks the kernel for values: one request under way, the newest wish waiting. */
function asker(model, root) {
  const view = Math.random().toString(36).slice(2);
  let number = 0, wish = {}, underWay = null, patience = 0;
  function send() {
    if (underWay || !Object.keys(wish).length) return;
    underWay = wish;
    wish = {};
    number += 1;
    patience = setTimeout(() => root.classList.add("waiting"), PATIENCE);
    model.send({ view, number, values: underWay });
  }
  return {
    ask(values) { wish = { ...wish, ...values }; send(); },
    /** What the page shows of a control while the kernel has not yet answered: the last wish, not an older answer. */
    wishes: () => ({ ...underWay, ...wish }),
    answered(shown) {
      if (shown.answers?.view !== view || shown.answers.number !== number) return;
      clearTimeout(patience);
      root.classList.remove("waiting");
      underWay = null;
      send();
    },
  };
}

/** A slider over the places of a grid; its number, which can be typed; and buttons where it has steps to play. */
function sliderRow(spec, id, ask) {
  const grid = spec.grid ?? null; // the only values there are, where frames were computed before
  const last = grid ? grid.length - 1 : Math.round((spec.max - spec.min) / spec.step);
  const at = (place) => (grid ? grid[place] : exact(Math.min(spec.min + place * spec.step, spec.max)));
  const nearest = (value) => {
    if (!grid) return clamp(Math.round((value - spec.min) / spec.step), 0, last);
    return grid.reduce((best, each, k) => (Math.abs(each - value) < Math.abs(grid[best] - value) ? k : best), 0);
  };
  let value = spec.min, timer = 0;
  const range = h("input", { type: "range", id, min: 0, max: last, step: 1, "data-control": spec.name });
  const number = h("input", { type: "text", inputmode: "decimal", "aria-label": `${spec.label}, typed`, size: 6 });
  const row = { glides: 0 }; // ms; a player's own steps glide, what a hand does is shown at once
  const go = (wanted, glides = 0) => { row.glides = glides; show(wanted); ask({ [spec.name]: wanted }); };
  range.addEventListener("input", () => { pause(); go(at(Number(range.value))); });
  const take = () => {
    if (number.value === textOf(value, spec.step)) return;
    const typed = Number(number.value.replace(",", ".").replace("\u2212", "-"));
    if (number.value.trim() === "" || !Number.isFinite(typed)) return show(value);
    const inside = clamp(typed, spec.min, spec.max);
    go(grid || spec.whole ? at(nearest(inside)) : inside);
  };
  number.addEventListener("change", take);
  number.addEventListener("keydown", (event) => { if (event.key === "Enter") take(); });

  const label = h("button", { type: "button", class: "play", onclick: () => (timer ? pause() : play()) });
  const glide = clamp(0.6 * spec.play, 0, LONGEST_GLIDE);
  const step = (by) => { pause(); go(at(clamp(nearest(value) + by, 0, last)), glide); };
  const button = (name, sign, onclick) => h("button", { type: "button", "aria-label": name, title: name, onclick }, sign);
  function pause() {
    clearInterval(timer);
    timer = 0;
    label.textContent = "▶";
    label.setAttribute("aria-label", "play");
    label.title = `play ${spec.label}`;
  }
  function play() {
    if (nearest(value) === last) go(at(0), glide);
    label.textContent = "❚❚";
    label.setAttribute("aria-label", "pause");
    label.title = "pause";
    timer = setInterval(() => {
      if (!range.isConnected || nearest(value) === last) return pause();
      go(at(nearest(value) + 1), glide);
      if (nearest(value) === last) pause();
    }, spec.play);
  }
  function show(wanted) {
    value = wanted;
    range.value = nearest(value);
    range.setAttribute("aria-valuetext", textOf(value, spec.step));
    number.value = textOf(value, spec.step);
  }
  pause();
  const buttons = spec.play ? [button("step back", "◀", () => step(-1)), label, button("step on", "▶|", () => step(1))] : [];
  const line = h("div", { class: "row" }, h("label", { for: id }, spec.label), range, number, ...buttons);
  const fits = (wanted) => (grid ? grid.includes(wanted) : wanted >= spec.min && wanted <= spec.max);
  const further = (sign) => {
    const place = nearest(value) + (sign === ">" ? 1 : -1);
    return place === clamp(place, 0, last) ? at(place) : NaN; // there is no further
  };
  return Object.assign(row, { row: line, show, play, stop: pause, at: () => value, fits, further });
}

function choiceRow(spec, id, ask) {
  const list = h("select", { id, "data-control": spec.name, onchange: () => ask({ [spec.name]: list.selectedIndex }) });
  list.append(...spec.options.map((text) => h("option", {}, text)));
  const row = h("div", { class: "row" }, h("label", { for: id }, spec.label), list);
  const fits = (place) => place in spec.options;
  return { row, show: (place) => { list.selectedIndex = place; }, stop() {}, at: () => list.selectedIndex, fits };
}

/** What lies between two texts that differ in their numbers alone; the second one otherwise. */
function between(from, to, share) {
  const [a, b] = [from.match(NUMBER) ?? [], to.match(NUMBER) ?? []];
  if (from === to || a.length !== b.length || from.replace(NUMBER, "#") !== to.replace(NUMBER, "#")) return to;
  let k = 0;
  return to.replace(NUMBER, () => { const [p, q] = [Number(a[k]), Number(b[k])]; k += 1; return String(+(p + share * (q - p)).toFixed(2)); });
}

const calm = matchMedia("(prefers-reduced-motion: reduce)");

/** A drawing of parts, each [tag, attributes, text] by its name; a part glides from what it was to what it becomes. */
function sceneOf(figure, model, ask, rows) {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("role", "group");
  svg.setAttribute("aria-label", "picture with points that can be moved");
  figure.prepend(svg);
  const drawn = new Map(); // name: { element, attributes }
  const places = Object.fromEntries(model.get("controls").filter((each) => each.kind === "places").map((each) => [each.name, each]));
  let frame = 0, held = null, values = {};

  function show(scene, newValues, wishes, glide) {
    values = { ...newValues, ...wishes };
    if (held?.control) values[held.control.name] = held.value;
    svg.setAttribute("viewBox", `0 0 ${scene.size.join(" ")}`);
    svg.style.maxWidth = `${scene.size[0]}px`;
    for (const [name, { element }] of drawn) if (!(name in scene.parts)) { element.remove(); drawn.delete(name); }
    const moves = [];
    for (const [name, [tag, attributes, text]] of Object.entries(scene.parts)) {
      const owner = attributes["data-places"];
      if (owner && !places[owner]) continue; // nothing can be moved where no kernel answers
      let part = drawn.get(name);
      if (!part || part.element.tagName !== tag) {
        part?.element.remove();
        part = { element: document.createElementNS(SVG, tag), attributes: {} };
        drawn.set(name, part);
        for (const [key, value] of Object.entries(attributes)) part.element.setAttribute(key, value);
        if ("data-index" in attributes) grasp(part.element, places[owner], Number(attributes["data-index"]));
        if ("data-stops" in attributes) grip(part);
      }
      if (svg.children[moves.length] !== part.element) svg.insertBefore(part.element, svg.children[moves.length] ?? null);
      if (part.element.textContent !== (text ?? "")) part.element.textContent = text ?? "";
      moves.push([part.element, attributes, Object.fromEntries(Object.keys(attributes).map((key) => [key, part.element.getAttribute(key) ?? ""]))]);
      part.attributes = attributes;
    }
    cancelAnimationFrame(frame);
    const begin = performance.now();
    const draw = (now) => {
      const share = calm.matches || held || document.hidden ? 1 : clamp((now - begin) / glide, 0, 1);
      for (const [element, to, from] of moves) {
        for (const key of Object.keys(to)) {
          if (element === held?.element && HAND.has(key)) continue; // it is where the hand is
          element.setAttribute(key, share < 1 ? between(from[key], to[key], share) : to[key]);
        }
      }
      if (share < 1) frame = requestAnimationFrame(draw);
    };
    draw(begin + 16);
  }

  /** Let mouse and finger lead an element; `take` says what is held, and `move` gets points of the picture. */
  function lead(element, { take, move, drop }) {
    const pointer = (event) => {
      const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
      move(x, y);
    };
    element.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      element.focus();
      element.setPointerCapture(event.pointerId);
      held = { element, ...take() };
    });
    // A finger on a handle drags it and does not scroll the page.
    element.addEventListener("touchstart", (event) => event.preventDefault(), { passive: false });
    element.addEventListener("pointermove", (event) => { if (held?.element === element) pointer(event); });
    for (const end of ["pointerup", "pointercancel"]) {
      element.addEventListener(end, (event) => {
        if (held?.element !== element) return;
        if (end === "pointerup") pointer(event); // a quick finger's last move comes with its end
        held = null;
        drop(end === "pointerup");
      });
    }
  }

  /** Make a part move controls: it has stops, which it follows, or one of which it is dropped on. */
  function grip(part) {
    const { element } = part, follows = () => part.attributes["data-follows"] === "true";
    const reach = () => Number(part.attributes["data-reach"]);
    const home = () => [part.attributes.cx, part.attributes.cy].map(Number);
    const place = ([x, y]) => { element.setAttribute("cx", x); element.setAttribute("cy", y); };
    /** Of "x y value value": the place, and by name what the controls are set to; ">" is a step on, "<" one back. */
    const stopOf = (text) => {
      const [x, y, ...told] = text.split(" "), names = part.attributes["data-moves"].split(" ");
      const wanted = names.map((name, k) => [name, told[k] === ">" || told[k] === "<" ? rows.get(name)?.further(told[k]) : Number(told[k])]);
      return [Number(x), Number(y), Object.fromEntries(wanted)];
    };
    // Without a kernel a control has few values, or is not there, and so are the stops.
    const there = ([, , wanted]) => Object.entries(wanted).every(([name, value]) => rows.get(name)?.fits(value));
    const stops = () => part.attributes["data-stops"].split(";").map(stopOf).filter(there);
    const distance = ([x, y], [p, q]) => Math.hypot(x - p, y - q);
    const nearest = (at, all = stops()) => all.reduce((best, each) => (best && distance(best, at) <= distance(each, at) ? best : each), null);
    const go = ([, , wanted]) => {
      for (const [name, value] of Object.entries(wanted)) {
        const row = rows.get(name);
        row.stop();
        row.glides = 0;
        row.show(value);
      }
      ask(wanted);
    };
    let begin = null, over = null, moved = false; // where it was taken, the stop that it is at, whether it has left

    lead(element, {
      take() { [begin, over, moved] = [null, null, false]; },
      move(x, y) {
        begin ??= [x, y];
        moved ||= distance(begin, [x, y]) > 4;
        if (!moved) return;
        const stop = nearest([x, y]), before = over;
        over = stop && (follows() || distance(stop, [x, y]) < reach()) ? stop : null;
        place(over && (follows() || distance(over, [x, y]) < CATCH) ? over : [x, y]);
        if (follows() && over && String(over) !== String(before)) go(over);
      },
      drop(done) {
        if (follows() && over) return; // it is there already
        if (!moved && done && !follows() && stops().length === 1) over = stops()[0]; // one way: a press is enough
        if (done && over) go(over);
        else place(home());
      },
    });
    element.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      const arrow = ARROWS[event.key], all = stops(), [x, y] = home();
      if (!all.length || (!arrow && !["Enter", " "].includes(event.key))) return;
      event.preventDefault();
      if (!arrow) { if (all.length === 1) go(all[0]); return; }
      if (follows()) {
        const isHere = ([, , wanted]) => Object.entries(wanted).every(([name, value]) => rows.get(name).at() === value);
        const now = all.indexOf(all.find(isHere) ?? nearest([x, y], all));
        const by = (arrow[0] + arrow[1]) * (event.shiftKey ? 5 : 1);
        return go(all[clamp(now + by, 0, all.length - 1)]);
      }
      // The one that lies most nearly where the arrow points; page y runs downwards.
      const cost = ([p, q]) => {
        const [along, aside] = [(p - x) * arrow[0] - (q - y) * arrow[1], (p - x) * arrow[1] + (q - y) * arrow[0]];
        return along > 4 ? along + 2 * Math.abs(aside) : Infinity;
      };
      const best = all.reduce((found, each) => (cost(each) < cost(found) ? each : found));
      if (cost(best) < Infinity) go(best);
    });
  }

  /** Make a part follow mouse, finger and arrow keys. */
  function grasp(element, control, index) {
    const player = rows.get(control.released);
    const { low, high, step, scale } = control; // page = scale[0] * x + scale[1], scale[2] * y + scale[3]
    const moveTo = (x, y) => {
      const rounded = [[x, 0], [y, 1]].map(([each, axis]) => exact(clamp(Math.round(each / step) * step, low[axis], high[axis])));
      if (player) player.stop();
      const all = values[control.name].map((each, k) => (k === index ? rounded : each));
      values = { ...values, [control.name]: all };
      if (held) held.value = all;
      element.setAttribute("cx", scale[0] * rounded[0] + scale[1]);
      element.setAttribute("cy", scale[2] * rounded[1] + scale[3]);
      ask({ [control.name]: all, ...(player && { [control.released]: 0 }) });
    };
    /** Where a player has moved the points, a hand takes them from where they are drawn. */
    const takeAsDrawn = () => {
      if (!player) return;
      const handles = [...drawn.values()].filter((each) => each.attributes["data-places"] === control.name && "data-index" in each.attributes);
      const at = ({ element: { cx, cy } }) => [(cx.baseVal.value - scale[1]) / scale[0], (cy.baseVal.value - scale[3]) / scale[2]].map(exact);
      values = { ...values, [control.name]: handles.map(at) };
    };
    lead(element, {
      take() { takeAsDrawn(); return { control, value: values[control.name] }; },
      move: (x, y) => moveTo((x - scale[1]) / scale[0], (y - scale[3]) / scale[2]),
      drop: () => player?.play(),
    });
    element.addEventListener("keydown", (event) => {
      const arrow = ARROWS[event.key];
      if (!arrow || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      takeAsDrawn();
      const [x, y] = values[control.name][index], far = (event.shiftKey ? 5 : 1) * (control.key ?? step);
      moveTo(x + far * arrow[0], y + far * arrow[1]);
    });
    element.addEventListener("keyup", (event) => { if (ARROWS[event.key]) player?.play(); });
  }
  return { show, stop: () => cancelAnimationFrame(frame) };
}

function render({ model, el }) {
  const end = new AbortController();
  const root = h("div", { class: "npslam-explorer" }), asking = asker(model, root);
  const unique = Math.random().toString(36).slice(2);
  const rows = new Map(model.get("controls").filter((each) => each.kind !== "places").map((spec) => {
    const make = spec.kind === "choice" ? choiceRow : sliderRow;
    return [spec.name, make(spec, `${unique}-${spec.name}`, asking.ask)];
  }));
  const caption = h("figcaption", {}), figure = h("figure", {}, caption), error = h("pre", { role: "alert" });
  const wait = h("p", { class: "patience" }, "The kernel has not answered yet: it is busy, or it has stopped.");
  root.append(h("div", { class: "controls" }, ...[...rows.values()].map((each) => each.row)), wait, error, figure);
  let image = null, scene = null;

  function show() {
    const shown = model.get("shown");
    asking.answered(shown);
    const wishes = asking.wishes(), glide = Math.max(...[...rows.values()].map((row) => row.glides ?? 0), 0);
    for (const [name, row] of rows) if (!(name in wishes) && name in shown.values) row.show(shown.values[name]);
    error.textContent = shown.error ?? "";
    figure.hidden = Boolean(shown.error);
    if (shown.error) return;
    caption.textContent = shown.words;
    if (shown.scene) {
      scene ??= sceneOf(figure, model, asking.ask, rows);
      scene.show(shown.scene, shown.values, wishes, glide || GLIDE);
      caption.setAttribute("aria-live", "polite");
      return;
    }
    if (!image) {
      // The words are the picture's alternative text; a screen reader need not read them twice.
      image = h("img", { width: shown.size[0], height: shown.size[1] });
      caption.setAttribute("aria-hidden", "true");
      figure.setAttribute("aria-live", "polite");
      figure.prepend(h("div", { class: "picture" }, image));
    }
    image.alt = shown.words;
    if (glide && !calm.matches && !document.hidden && image.src) {
      // The picture before lies behind the next one while that appears.
      image.parentElement.style.backgroundImage = `url("${image.src}")`;
      image.animate({ opacity: [0, 1] }, { duration: glide, easing: "ease-in-out" });
    }
    image.src = shown.src;
  }

  // JupyterLab hears of a key before a slider does: an arrow selects another cell, and two d delete this one.
  // Its own shortcuts with Ctrl, Alt or Cmd are left to it.
  const keepKeys = ({ target, ctrlKey, altKey, metaKey }) => {
    if (root.contains(target)) target.toggleAttribute("data-lm-suppress-shortcuts", !(ctrlKey || altKey || metaKey));
  };
  window.addEventListener("keydown", keepKeys, { capture: true, signal: end.signal });
  model.on("change:shown", show);
  el.append(root);
  show();
  return () => {
    end.abort();
    model.off("change:shown", show);
    rows.forEach((row) => row.stop());
    scene?.stop();
  };
}

/** Parts that a frame adds come last, and must not lie over the rings. */
const ringsLast = (parts) => {
  const isRing = ([, [, attributes]]) => "data-stops" in attributes;
  return Object.fromEntries(Object.entries(parts).sort((a, b) => isRing(a) - isRing(b)));
};

/** A model without a kernel: its answers were computed before, one for every place of the grids of its sliders. */
function frozen({ controls, frames }) {
  const grids = controls.map((each) => each.grid ?? each.options.map((_, k) => k));
  const first = frames.find((each) => each.first);
  const values = { ...first.values }, listeners = [];
  const parts = first.scene?.parts;
  const answer = (frame, answers) => {
    // Of a scene, a frame holds what differs from the first one.
    const scene = frame.scene && { ...frame.scene, parts: ringsLast({ ...parts, ...frame.scene.parts }) };
    for (const name of frame.without ?? []) delete scene.parts[name];
    return { ...frame, values: { ...first.values, ...values }, answers, ...(scene && { scene }) };
  };
  let shown = answer(first, null);
  return {
    get: (name) => (name === "shown" ? shown : controls),
    on: (_, listener) => listeners.push(listener),
    off() {},
    send({ view, number, values: wished }) {
      Object.assign(values, wished);
      const place = controls.reduce((sum, each, k) => sum * grids[k].length + grids[k].indexOf(values[each.name]), 0);
      shown = answer(frames[place], { view, number });
      queueMicrotask(() => listeners.forEach((each) => each()));
    },
  };
}

export default { render };
