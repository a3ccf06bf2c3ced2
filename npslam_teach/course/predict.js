// Makes a question of a lesson answer: the reader's prediction is kept in this browser, and the result unfolds.
// Without this script the choices are a list, and the result is folded below them.
(() => {
  const store = globalThis.npslamProgress;
  const make = (tag, parent, text, attributes = {}) => {
    const element = parent.appendChild(document.createElement(tag));
    element.textContent = text;
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    return element;
  };

  // Each kind: how to read the answer, how to show a kept one, and what to say to it.
  const choices = (root) => {
    const inputs = [...root.querySelectorAll("input[type=radio]")];
    const text = (k) => inputs[k].parentElement.textContent.trim();
    const right = Number(root.dataset.right);
    return {
      read: () => (inputs.some((each) => each.checked) ? inputs.findIndex((each) => each.checked) : null),
      show: (k) => inputs.forEach((each, i) => { each.checked = i === k; }),
      say: (k) => `You said “${text(k)}”${k === right ? ", and so it is." : `. It is: “${text(right)}”.`}`,
      reveal: (open) => inputs[right].parentElement.classList.toggle("np-right", open),
    };
  };
  const number = (root) => {
    const input = root.querySelector("input[type=number]");
    const { answer, unit } = root.dataset;
    return {
      read: () => (input.value === "" ? null : Number(input.value)),
      show: (value) => { input.value = value ?? ""; },
      say: (value) => `You said ${value}${unit}. It is ${answer}${unit}.`,
      reveal: () => {},
    };
  };
  const KINDS = { choice: choices, number, sketch: (root) => globalThis.npslamSketch(root, make) };

  const key = (root) => `npslam/${root.dataset.lesson}/predict/${root.dataset.name}`;
  const more = () => document.querySelectorAll(".np-predict[data-kind=more]");
  // What the text below says about the result unfolds with it, down to the next question.
  const explain = (root, open) => {
    for (const each of document.querySelectorAll(".np-predict, details > summary")) {
      if (!(root.compareDocumentPosition(each) & Node.DOCUMENT_POSITION_FOLLOWING) || root.contains(each)) continue;
      if (each.matches(".np-predict:not([data-kind=more])")) return;
      if (each.textContent === "What it shows") each.parentElement.open = open;
    }
  };

  const wire = (root) => {
    const kind = KINDS[root.dataset.kind](root);
    const [fieldset, details] = [root.querySelector("fieldset"), root.querySelector("details")];
    const said = make("p", root, "", { "aria-live": "polite" });
    const button = make("button", fieldset, "This is my prediction", { type: "button" });
    const again = make("button", fieldset, "Ask me again", { type: "button" });
    root.insertBefore(said, details);
    const show = (kept) => {
      kind.show(kept);
      again.hidden = kept === null;
      said.textContent = kept === null ? "" : kind.say(kept);
      details.open = kept !== null;
      kind.reveal(details.open);
      for (const each of more()) if (key(each) === key(root)) each.querySelector("details").open = kept !== null;
      store.show();
    };
    button.addEventListener("click", () => {
      const answer = kind.read();
      if (answer === null) said.textContent = "First answer, or open “Show me”.";
      else { store.write(key(root), answer); show(answer); }
    });
    again.addEventListener("click", () => { store.write(key(root), null); show(null); });
    details.addEventListener("toggle", () => { kind.reveal(details.open); explain(root, details.open); });
    // JupyterLab hears of a key before the question does: without this, letters typed here would be commands to it.
    window.addEventListener("keydown", ({ target, ctrlKey, altKey, metaKey, shiftKey }) => {
      if (!root.contains(target)) return;
      target.toggleAttribute("data-lm-suppress-shortcuts", !(ctrlKey || altKey || metaKey || shiftKey));
    }, true);
    show(store.read(key(root)));
  };
  for (const root of document.querySelectorAll(".np-predict:not([data-ready], [data-kind=more])")) {
    root.setAttribute("data-ready", "");
    wire(root);
  }
})();
