"""What axe-core finds in the HTML that nbconvert makes of each lesson, and in the book: what is put on a web page.

The template loads its scripts for formulas from the network; here they do not come, so formulas stay as they are typed.
"""

import html
import io
import shutil

import numpy as np
import pytest
from axe import violations
from lab_server import LARGE_WINDOW, ROOT, new_context
from PIL import Image

from npslam_teach import plotting
from npslam_teach.plotting.style import CLASS_COLORS
from npslam_teach.publishing import book

NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))


@pytest.fixture(scope="module")
def offline(chromium):
    """A page that gets nothing from the network, in which one document is opened after the other."""
    context = new_context(chromium, viewport=LARGE_WINDOW)
    page = context.new_page()
    page.route("http*://**", lambda route: route.abort())
    yield page
    context.close()


@pytest.fixture(scope="module")
def exporter():
    """One for all lessons: it compiles its templates once.

    Code has no colours: those are the template's, axe does not look at them, and there are thousands of pieces of them.
    """
    return pytest.importorskip("nbconvert").HTMLExporter(embed_images=True, filters={"highlight_code": plain_code})


def plain_code(source: str, **how) -> str:
    """The template's box around code, as it stands there with colours."""
    return f'<div class="highlight hl-ipython3"><pre>{html.escape(source)}</pre></div>'


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_axe_finds_nothing_serious_in_an_exported_lesson(path, tmp_path, offline, exporter):
    page, _ = exporter.from_filename(str(path))
    (tmp_path / "lesson.html").write_text(page, encoding="utf-8")
    offline.goto((tmp_path / "lesson.html").as_uri(), wait_until="load")
    assert offline.locator("img").count() >= 1
    assert violations(offline) == []


def test_axe_finds_nothing_serious_in_the_book(tmp_path, offline):
    """In a book of three lessons: each of the others has been looked at above, and axe compares all with all."""
    shutil.copytree(ROOT / "figures", tmp_path / "figures")
    folder = shutil.copytree(ROOT / "notebooks", tmp_path / "notebooks")
    for path in NOTEBOOKS[3:]:
        (folder / path.name).unlink()
    (tmp_path / "book.html").write_text(book.book_html(folder), encoding="utf-8")
    offline.goto((tmp_path / "book.html").as_uri(), wait_until="load")
    assert violations(offline) == []


def test_axe_finds_a_picture_without_words_and_grey_on_grey(offline):
    """The tests above would see what they look for."""
    offline.set_content(
        "<html lang='en'><title>t</title><main><h1>t</h1><img src='data:image/gif;base64,R0lGODlhAQABAAAAACw='>"
        "<div class='jp-MarkdownOutput'><p style='color:#bbb;background:#ccc'>faint</p></div></main></html>"
    )
    found = " ".join(violations(offline))
    assert "image-alt" in found and "color-contrast" in found


DARK_PAGES = {
    "JupyterLab": '<body data-jp-theme-light="false"',
    "VS Code": '<body class="vscode-dark"',
    "Colab": '<html theme="dark"><body',
}


def seen(page, body: str, background: str) -> np.ndarray:
    """What a reader sees of a picture with a black bar and one of the first class's colour, on a page of a colour."""
    figure, ax = plotting.new_figure(size=(3.0, 2.0))
    ax.axis("off")
    ax.bar([0, 2], [1, 1], color=["black", CLASS_COLORS[0]])
    shown = plotting.show(figure, "Two bars beside each other, of one height").data
    page.set_content(f'{body} style="margin:0;background:{background}">{shown}')
    return np.asarray(Image.open(io.BytesIO(page.locator("img").screenshot())).convert("RGB")).astype(int)


def bars(picture: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The colours of the corner, of the left bar and of the right one."""
    height, width, _ = picture.shape
    return picture[2, 2], picture[height // 2, width // 4], picture[height // 2, 3 * width // 4]


def test_a_picture_has_the_colour_of_a_light_page_behind_it(page):
    behind, black, first = bars(seen(page, "<body", "#eeeeee"))
    assert behind.tolist() == [0xEE] * 3 and black.max() < 20 and first.argmax() == 2, "blue stays blue"


@pytest.mark.parametrize("where", DARK_PAGES)
def test_on_a_dark_page_a_picture_is_light_on_dark_and_keeps_its_hues(page, where):
    behind, black, first = bars(seen(page, DARK_PAGES[where], "#111111"))
    assert behind.tolist() == [0x11] * 3, "no white slab"
    assert black.min() > 230, "what was black is white"
    assert first.argmax() == 2 and first.sum() > 300, "blue stays blue, and can be seen"
