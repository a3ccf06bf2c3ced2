"""What axe-core finds in the HTML that nbconvert makes of each lesson, and in the book: what is put on a web page.

The template loads its scripts for formulas from the network; here they do not come, so formulas stay as they are typed.
"""

import shutil

import pytest
from axe import violations
from lab_server import ROOT

from npslam_teach.publishing import book

NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))


@pytest.fixture
def offline(page):
    """A page that gets nothing from the network."""
    page.route("http*://**", lambda route: route.abort())
    return page


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_axe_finds_nothing_serious_in_an_exported_lesson(path, tmp_path, offline):
    nbconvert = pytest.importorskip("nbconvert")
    html, _ = nbconvert.HTMLExporter(embed_images=True).from_filename(str(path))
    (tmp_path / "lesson.html").write_text(html, encoding="utf-8")
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
        "<p style='color:#bbb;background:#ccc'>faint</p></main></html>"
    )
    found = " ".join(violations(offline))
    assert "image-alt" in found and "color-contrast" in found
