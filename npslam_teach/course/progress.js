// What a reader has done, kept in this browser and never in a notebook: predictions made, exercises that have passed.
globalThis.npslamProgress = globalThis.npslamProgress || (() => {
  const read = (key) => { try { return JSON.parse(localStorage.getItem(key)); } catch { return null; } };
  const count = (prefix) => {
    try { return Object.keys(localStorage).filter((key) => key.startsWith(prefix)).length; } catch { return 0; }
  };
  const show = () => {
    for (const each of document.querySelectorAll(".np-progress")) {
      const { lesson, total, exercises } = each.dataset;
      const predicted = total ? [`${count(`npslam/${lesson}/predict/`)} of ${total} predicted`] : [];
      const solved = exercises > 0 ? [`${count(`npslam/${lesson}/exercise/`)} of ${exercises} exercises done`] : [];
      each.textContent = [...predicted, ...solved].join(", ");
    }
  };
  const write = (key, value) => {
    try { value === null ? localStorage.removeItem(key) : localStorage.setItem(key, JSON.stringify(value)); } catch {}
    show();
  };
  return { read, write, show };
})();
