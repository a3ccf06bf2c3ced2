// Measures, inside the page, how long it takes from a key press to changed pixels of an explorer: of its picture or, where
// another value gives the same picture, of the words under it.
(root) => {
  const content = (image) => (image ? image.src + image.alt : root.querySelector("figure").innerHTML);
  const latencies = [];
  let pressed = null;
  let shown = content(root.querySelector("figure img"));

  function afterTheNextFrame(callback) {
    requestAnimationFrame(() => {
      const channel = new MessageChannel();
      channel.port1.onmessage = callback; // a task that comes after the frame was painted
      channel.port2.postMessage(null);
    });
  }

  async function compare() {
    const image = root.querySelector("figure img");
    if (content(image) === shown) return;
    shown = content(image);
    const begun = pressed;
    await image?.decode();
    if (begun !== null) afterTheNextFrame(() => latencies.push(performance.now() - begun));
  }

  root.addEventListener("keydown", (event) => (pressed = event.timeStamp), true);
  new MutationObserver(compare).observe(root, { subtree: true, childList: true, attributes: true });
  root.latencies = latencies;
};
