"""The notebook in front in windows of several widths: can all of it be read?"""

import os
from pathlib import Path

LAYOUT = (Path(__file__).parent / "layout.js").read_text(encoding="utf-8")
NARROW, LAPTOP, PROJECTOR = 800, 1400, 1920  # px
HIGHEST = 16_000  # px: what Chromium can take a picture of
ALL_ARE_KEPT = "NPSLAM_TEACH_SCREENSHOTS" in os.environ


def take_screenshot(page, path: Path) -> None:
    """Of what is in the window; to draw a page once more takes longer than to measure it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=path)


class Window:
    """The window of a page at another width, and so high that the whole notebook is in sight; ``with`` restores it."""

    def __init__(self, page, width: int):
        self.page, self.width = page, width

    def __enter__(self):
        self.before = self.page.viewport_size
        self._resize(HIGHEST)
        # A cell that was never in sight has a guessed height, so the layout settles in steps.
        self.page.wait_for_function(f"() => ({LAYOUT}).isSettled()", polling=100)
        self._resize(self.page.evaluate(f"() => ({LAYOUT}).bottom()") + 60)
        return self

    def __exit__(self, *error):
        self.page.set_viewport_size(self.before)

    def _resize(self, height: float) -> None:
        self.page.set_viewport_size({"width": self.width, "height": int(height)})
        self.page.evaluate(f"() => ({LAYOUT}).scrollToTop()")

    def complaints(self) -> list[str]:
        """What cannot be read."""
        return self.page.evaluate(f"() => ({LAYOUT}).complaints()")

    def screenshot(self, path: Path) -> None:
        """Of the whole notebook."""
        take_screenshot(self.page, path)
