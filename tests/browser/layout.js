// The notebook in front: how high it is, and what in it cannot be read.
{
  bottom() {
    return [...document.querySelectorAll(".jp-WindowedPanel-viewport > .jp-Cell")].at(-1).getBoundingClientRect().bottom;
  },

  isSettled() {
    const before = window.bottomOfTheNotebook;
    window.bottomOfTheNotebook = this.bottom();
    return before === window.bottomOfTheNotebook;
  },

  scrollToTop() {
    document.querySelector(".jp-WindowedPanel-outer").scrollTo(0, 0);
  },

  complaints() {
    const found = [];
    const complain = (what, element) =>
      found.push(`${what}: ${(element.alt || element.textContent || element.className).trim().slice(0, 60)}`);
    const notebook = document.querySelector(".jp-Notebook");
    const right = notebook.querySelector(".jp-WindowedPanel-viewport").getBoundingClientRect().right;
    for (const image of notebook.querySelectorAll(".jp-Cell img")) {
      const box = image.getBoundingClientRect();
      const place = image.closest(".jp-RenderedHTMLCommon, .npslam-explorer").getBoundingClientRect();
      const shape = image.naturalWidth / image.naturalHeight;
      if (!image.complete || image.naturalWidth === 0) complain("not loaded", image);
      // A badge is a link, and small on purpose.
      if (!image.closest("a") && (box.width < 100 || box.height < 50)) complain("too small", image);
      if (box.right > Math.min(place.right, right) + 1) complain("cut off", image);
      if (Math.abs(box.width / box.height / shape - 1) > 0.02) complain("out of shape", image);
    }
    // A formula may end in a few pixels of nothing.
    for (const text of notebook.querySelectorAll(".jp-RenderedMarkdown, .jp-OutputArea-output, .npslam-explorer label")) {
      if (text.scrollWidth > text.clientWidth + 8) complain("cut off", text);
    }
    for (const control of notebook.querySelectorAll(".npslam-explorer .row")) {
      if (control.getBoundingClientRect().right > right) complain("cut off", control);
    }
    return found;
  },
}
