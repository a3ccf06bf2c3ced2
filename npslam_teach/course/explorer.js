// Gives an explorer what ipywidgets leaves out: names that a screen reader finds, words that it reads when they change,
// and keys that move a slider or a list and not the notebook around it. Without this file explorers work all the same.

const ICONS = { "fa-play": "play", "fa-pause": "pause", "fa-stop": "stop and return", "fa-retweet": "repeat" };

function set(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) element?.setAttribute(name, value);
}

function describe(root) {
  for (const slider of root.querySelectorAll(".widget-slider")) {
    const name = slider.querySelector("label")?.textContent;
    set(slider.querySelector("[role=slider]"), { "aria-label": name });
    set(slider.querySelector(".widget-readout"), { role: "textbox", "aria-label": `${name}, typed` });
  }
  for (const icon of root.querySelectorAll(".widget-play button i")) {
    const name = Object.keys(ICONS).find((each) => icon.classList.contains(each));
    set(icon.parentElement, { "aria-label": ICONS[name], title: ICONS[name] });
  }
  set(root.querySelector(".widget-html-content"), { "aria-live": "polite", "aria-atomic": "true" });
}

async function attached(element, signal) {
  while (!element.isConnected && !signal.aborted) await new Promise(requestAnimationFrame);
}

export default {
  render({ el }) {
    const end = new AbortController();
    attached(el, end.signal).then(() => {
      const root = el.closest(".npslam-explorer");
      if (!root || end.signal.aborted) return;
      // JupyterLab hears of a key before the slider does: an arrow selects another cell, and two d delete this one.
      // Its own shortcuts with Ctrl, Alt or Cmd are left to it.
      const keepKeys = ({ target, ctrlKey, altKey, metaKey }) => {
        if (!root.contains(target)) return;
        target.toggleAttribute("data-lm-suppress-shortcuts", !(ctrlKey || altKey || metaKey));
      };
      window.addEventListener("keydown", keepKeys, { capture: true, signal: end.signal });
      const observer = new MutationObserver(() => describe(root));
      observer.observe(root, { childList: true, subtree: true, attributeFilter: ["class"] });
      end.signal.addEventListener("abort", () => observer.disconnect());
      describe(root);
    });
    return () => end.abort();
  },
};
