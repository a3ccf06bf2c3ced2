"""The book: it holds everything that the lessons show, and needs nothing outside of it."""

import base64
import functools
import html.parser
import re
import shutil
from dataclasses import dataclass, field
from pathlib import Path

import nbformat
import pytest

from npslam_teach.cli import parser
from npslam_teach.publishing import book, book_markdown, lessons

ROOT = Path(__file__).parents[2]
LESSONS = lessons.lesson_paths(ROOT / "notebooks")
HEADING = re.compile(r"^#+ +(.+)$", re.MULTILINE)
FENCE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
PICTURE = re.compile(r"!\[([^\]]*)\]\(([^)]+)\)")
LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")
NUMBER = re.compile(r"^\d+\. ", re.MULTILINE)  # of a list; the browser counts
FORMULA = re.compile(r"\$\$.+?\$\$|\$[^$\n]+?\$", re.DOTALL)
RUNNING = re.compile(r"<(script|style)>.*?</\1>", re.DOTALL)
FOLD = re.compile(r"</?(details|summary)>")
VOID = {"meta", "img", "br", "hr", "link", "input", "col", "wbr"}


@dataclass
class Element:
    tag: str
    attributes: dict
    parents: tuple
    pieces: list = field(default_factory=list)

    @functools.cached_property
    def text(self) -> str:
        """Once the page is read to its end."""
        return "".join(self.pieces)


@dataclass
class Page(html.parser.HTMLParser):
    """The elements of a page in their order; the text of each includes that of the elements inside."""

    source: str
    elements: list = field(default_factory=list)

    def __post_init__(self):
        super().__init__()
        self.open = []
        self.feed(self.source)
        assert not self.open, "an element that is never closed"

    def handle_starttag(self, tag, attrs):
        element = Element(tag, dict(attrs), tuple(each.tag for each in self.open))
        self.elements.append(element)
        if tag not in VOID:
            self.open.append(element)

    def handle_startendtag(self, tag, attrs):
        self.elements.append(Element(tag, dict(attrs), tuple(each.tag for each in self.open)))

    def handle_endtag(self, tag):
        assert self.open.pop().tag == tag

    def handle_data(self, data):
        hidden = self.open and self.open[-1].tag in ("script", "style")  # no text of what is around it
        for element in self.open[-1:] if hidden else self.open:
            element.pieces.append(data)

    def all(self, *tags):
        return [element for element in self.elements if element.tag in tags]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The folder into which the command has written the book: what it writes is what all tests look at."""
    folder = tmp_path_factory.mktemp("book")
    assert parser.main(["book", "--out", str(folder / "book.html")]) == 0
    return folder


@pytest.fixture(scope="module")
def source(made):
    return (made / "book.html").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def page(source):
    return Page(source)


@pytest.fixture(params=LESSONS, ids=lambda path: path.stem)
def lesson(request):
    return lessons.read(request.param)


def markdown(notebook):
    return [cell.source for cell in notebook.cells if cell.cell_type == "markdown"]


def printed_by_html(output):
    return output.get("data", {}).get("text/html", "")


def plain(text):
    """Letters and digits alone: what Markdown and HTML have in common."""
    return "".join(filter(str.isalnum, text))


def test_every_heading_is_in_the_book_once_in_its_order(page):
    wanted = [
        plain(FORMULA.sub("", title))
        for path in LESSONS
        for text in markdown(lessons.read(path))
        for title in HEADING.findall(FENCE.sub("", text))
    ]
    without_formulas = re.compile(r"<math.*?</math>", re.DOTALL)
    sections = page.source.split("<main>")[1]
    found = re.findall(r"<h([2-6]) id=[^>]*>(.*?)</h\1>", sections, re.DOTALL)
    titles = [plain("".join(e.text for e in Page(f"<p>{without_formulas.sub('', h)}</p>").all("p"))) for _, h in found]
    assert len(wanted) > 80
    assert titles == wanted


def test_the_contents_lead_to_every_lesson_and_section(page):
    links = {element.attributes["href"][1:] for element in page.all("a") if "nav" in element.parents}
    headings = {e.attributes["id"] for e in page.all("h2", "h3") if "main" in e.parents}
    assert links == headings
    assert {book_markdown.anchor(lessons.number(path)) for path in LESSONS} <= links


def test_every_sentence_cell_and_printed_line_is_in_the_book(page, lesson):
    everything = plain(page.all("main")[0].text)
    for cell in book.for_paper(lesson).cells:
        if cell.cell_type == "code":
            assert plain(cell.source) in everything
            for output in cell.outputs:
                printed = output.get("text", "")
                if "text/html" not in output.get("data", {}):
                    printed += output.get("data", {}).get("text/plain", "")
                assert plain(printed) in everything
                folded = Page(printed_by_html(output)).all("legend", "pre", "em", "summary")
                assert all(plain(each.text) in everything for each in folded)
        else:
            text = FOLD.sub("\n", LINK.sub(r"\1", PICTURE.sub("", NUMBER.sub("", cell.source))))
            for words in re.split(r"\n|\||\$\$.+?\$\$|\$[^$\n]+?\$", text, flags=re.DOTALL):
                assert plain(words) in everything


def test_every_picture_is_in_the_book_with_its_alternative_text(page, lesson):
    inside = [(e.attributes["alt"], e.attributes["src"]) for e in page.all("img")]
    wanted = 0
    for text in markdown(lesson):
        for alt, name in PICTURE.findall(text):
            wanted += 1
            content = (ROOT / "notebooks" / name).read_bytes()
            assert any(alt == a and base64.b64decode(src.split(",")[1]) == content for a, src in inside), name
    for cell in lesson.cells:
        for output in cell.get("outputs", []):
            for image in Page(output.get("data", {}).get("text/html", "")).all("img"):
                wanted += 1
                assert (image.attributes["alt"], image.attributes["src"]) in inside
    assert wanted >= 2
    assert all(len(alt) > 20 for alt, _ in inside)


def test_nothing_is_fetched_and_explorers_alone_run(page):
    for script in page.all("script"):
        assert not script.attributes and "document.currentScript.previousElementSibling" in script.text
    assert not page.all("iframe", "object", "embed", "link", "video", "audio", "source", "base", "svg")
    for element in page.elements:
        for name, value in element.attributes.items():
            if name in ("src", "srcset", "data", "poster", "background", "xlink:href"):
                assert value.startswith("data:image/"), (element.tag, value[:80])
            assert not name.startswith("on")
    for style in page.all("style"):
        assert "url(" not in style.text and "@import" not in style.text


def test_links_lead_to_the_book_itself_or_to_the_network(page):
    places = [element.attributes["id"] for element in page.elements if "id" in element.attributes]
    assert len(places) == len(set(places))
    for element in page.all("a"):
        target = element.attributes["href"]
        assert target[1:] in places if target.startswith("#") else target.startswith("https://"), target
    inner = {e.attributes["href"] for e in page.all("a") if "main" in e.parents}
    assert {f"#{book_markdown.anchor(lessons.number(path))}" for path in LESSONS[1:]} <= inner, "from lesson to lesson"


def test_questions_keep_their_choices_and_lie_above_what_is_folded(page):
    """Without a kernel and a script nothing could be entered, so there is no field for it."""
    asked = [
        printed_by_html(output)
        for path in LESSONS
        for cell in lessons.read(path).cells
        for output in cell.get("outputs", [])
        if "<legend>" in printed_by_html(output)
    ]
    shown = [each for each in page.all("fieldset") if "main" in each.parents]
    assert len(shown) == len(asked) > 100
    choices = [element for element in page.all("li") if "fieldset" in element.parents]
    assert len(choices) == sum(each.count('<input type="radio"') for each in asked)
    assert not page.all("input", "button", "form")
    assert all("details" not in each.parents for each in shown)


def test_on_the_screen_results_and_hints_are_folded_and_on_paper_they_are_not(page, source):
    folds = page.all("details")
    assert len(folds) > 200 and not any("open" in each.attributes for each in folds)
    assert all("open" in each.attributes for each in Page(book.unfolded(source)).all("details"))


def test_no_widget_leaves_a_hole(page):
    assert "widget-view" not in page.source and "Loading widget" not in page.source
    assert "Explorer: " not in page.source
    outputs = [each for path in LESSONS for cell in lessons.read(path).cells for each in cell.get("outputs", [])]
    kinds = [each.data for each in outputs if "data" in each]
    sliders = [e for e in page.all("p") if e.attributes.get("class") == "sliders"]
    assert len(sliders) == sum("application/vnd.jupyter.widget-view+json" in each for each in kinds)
    explorers = [each["text/html"] for each in kinds if each["text/plain"].startswith("Explorer: ")]
    assert len(explorers) >= 10
    # The page's own pen writes attributes in another order; pictures are compared above.
    running = [piece.group() for each in explorers for piece in RUNNING.finditer(each)]
    assert len(running) >= 2 * 10 and all(piece in page.source for piece in running)


def test_every_formula_is_set(page, source):
    formulas = [
        formula
        for path in LESSONS
        for text in markdown(lessons.read(path))
        for formula in FORMULA.findall(re.sub(r"`[^`]*`", "", text))
    ]
    set_ones = [element for element in page.all("math") if "main" in element.parents]
    assert len(set_ones) == len(formulas) > 150
    assert sum(e.attributes["display"] == "block" for e in set_ones) == sum(f.startswith("$$") for f in formulas)
    assert not page.all("merror")
    prose = re.sub(r"<pre.*?</pre>|<code.*?</code>", "", RUNNING.sub("", source.split("<main>")[1]), flags=re.DOTALL)
    assert "$" not in re.sub(r"<[^>]*>", "", prose)


def test_formulas_keep_their_structure():
    inside = Page(book_markdown.mathml(r"\frac{1}{m_i} \sqrt{x^2} \begin{pmatrix} a \\ b \end{pmatrix}", "block"))
    assert [len(inside.all(tag)) for tag in ("mfrac", "msub", "msqrt", "msup", "mtable", "mtr")] == [1, 1, 1, 1, 1, 2]
    assert inside.all("mfrac")[0].text == "1mi"


@pytest.mark.parametrize("formula", [r"\nosuchcommand x", r"\begin{pmatrix} a", r"x_{"])
def test_a_formula_that_cannot_be_set_is_named(formula):
    with pytest.raises(ValueError, match="^formula .*: expected "):
        book_markdown.mathml(formula, "inline")


@pytest.fixture
def folder(tmp_path):
    """A course of one short lesson, which tests may damage."""
    (tmp_path / "notebooks").mkdir()
    (tmp_path / "cup.png").write_bytes(b"\x89PNG")
    return tmp_path / "notebooks"


def write_lesson(folder, text):
    cells = [nbformat.v4.new_markdown_cell(text)]
    nbformat.write(nbformat.v4.new_notebook(cells=cells), folder / "00_cups.ipynb")


def test_titles_are_escaped_and_twins_get_names_of_their_own(folder):
    write_lesson(folder, "# Is a < b & c?\n\n## Twin\n\n## Twin\n\n![A cup that stands](../cup.png)")
    inside = Page(book.book_html(folder))
    assert [(e.text, e.attributes["id"]) for e in inside.all("h2", "h3") if "main" in e.parents] == [
        ("Is a < b & c?", "lesson-00"),
        ("Twin", "lesson-00-1"),
        ("Twin", "lesson-00-2"),
    ]
    assert inside.all("img")[0].attributes["src"] == "data:image/png;base64,iVBORw=="


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("# A?\n\n![A picture that is lost](../lost.png)", "lost.png: expected a file"),
        ("# A?\n\n![A picture of another kind](../cup.tiff)", "cup.tiff: expected a picture"),
        ("# A?\n\n$\\nosuch$", "formula '.*nosuch': expected"),
    ],
)
def test_what_a_book_cannot_hold_is_named(folder, text, message):
    write_lesson(folder, text)
    with pytest.raises((ValueError, OSError), match=message):
        book.book_html(folder)


def test_a_folder_without_lessons_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match="expected lessons such as 00_start_here.ipynb"):
        book.book_html(tmp_path)


def test_the_command_writes_the_file_alone(made):
    assert [path.name for path in made.iterdir()] == ["book.html"]


@pytest.fixture(scope="module")
def two_lessons(tmp_path_factory):
    """A folder with the first two, and the book that is made of them."""
    folder = tmp_path_factory.mktemp("short")
    shutil.copytree(ROOT / "figures", folder / "figures")
    shutil.copytree(ROOT / "notebooks", folder / "notebooks")
    for path in lessons.lesson_paths(folder / "notebooks")[2:]:
        path.unlink()
    return folder / "notebooks", book.book_html(folder / "notebooks")


def test_the_same_lessons_make_the_same_book(two_lessons):
    """What could differ from one time to the next, numbers of anchors and orders, is in each of them."""
    folder, made = two_lessons
    assert book.book_html(folder) == made


def test_the_command_refuses_in_one_sentence(tmp_path, refused):
    assert ".html or .pdf, got '.docx'" in refused("book", "--out", tmp_path / "book.docx")
    assert "expected a folder" in refused("book", "--out", tmp_path / "no" / "book.html")
    assert "found none" in refused("book", "--out", tmp_path / "book.pdf", "--browser", "no-such-browser")
    assert list(tmp_path.iterdir()) == []


def test_a_browser_that_prints_nothing_is_named(tmp_path):
    with pytest.raises(ValueError, match="expected a PDF, got none"):
        book.print_to_pdf("<p>", shutil.which("true") or shutil.which("hostname"))


@pytest.fixture
def browser():
    try:
        return book.find_browser()
    except FileNotFoundError as error:
        pytest.skip(str(error))


@pytest.mark.slow
def test_the_book_prints_to_pdf(tmp_path, browser, two_lessons, monkeypatch):
    """A short one: every lesson more is more of the same work for the browser, and that it shows all is seen below."""
    monkeypatch.setattr(book, "book_html", lambda folder: two_lessons[1])
    assert parser.main(["book", "--out", str(tmp_path / "book.pdf"), "--browser", browser]) == 0
    content = (tmp_path / "book.pdf").read_bytes()
    assert content.startswith(b"%PDF-") and content.rstrip().endswith(b"%%EOF")
    assert len(re.findall(rb"/Type\s*/Page\b", content)) > 8
    assert [path.name for path in tmp_path.iterdir()] == ["book.pdf"]


def test_a_browser_needs_nothing_but_the_file(tmp_path, source, browser):
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    (tmp_path / "book.html").write_text(source, encoding="utf-8")
    asked, said = [], []
    with playwright.sync_playwright() as started:
        chromium = started.chromium.launch(executable_path=browser, args=["--no-sandbox", "--disable-gpu"])
        tab = chromium.new_page(viewport={"width": 900, "height": 1000})
        tab.on("request", lambda request: asked.append(request.url))
        tab.on("console", lambda message: said.append(message.text))
        tab.goto((tmp_path / "book.html").as_uri())
        tab.wait_for_load_state("networkidle")
        shown = tab.evaluate("[...document.images].map(each => each.naturalWidth > 0)")
        formulas = tab.evaluate(
            "[...document.querySelectorAll('math')].map(each => each.getBoundingClientRect().width)"
        )
        overflow = tab.evaluate("document.documentElement.scrollWidth - window.innerWidth")
        chromium.close()
    assert [url for url in asked if not url.startswith("data:")] == [(tmp_path / "book.html").as_uri()]
    assert said == []
    assert len(shown) > 50 and all(shown)
    assert all(width > 0 for width in formulas)
    assert overflow <= 0, "nothing sticks out of the page"
