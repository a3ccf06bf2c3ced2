"""Lessons on a code host: its viewer runs nothing, strips scripts and styles, and has what is in the repository."""

import html.parser
import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NOTEBOOKS = sorted(path for path in (ROOT / "notebooks").rglob("*.ipynb") if ".ipynb_checkpoints" not in path.parts)
# What a host strips, and what it keeps of a question with a folded result.
STRIPPED = re.compile(r"<(script|style)>.*?</\1>", re.DOTALL)
QUESTION = set("div span fieldset legend ul li label input svg rect polyline text details summary p strong em".split())
QUESTION |= {"pre", "img"}
WIDGET = "application/vnd.jupyter.widget-view+json"
PICTURE = re.compile(r"!\[[^\]]*\]\(([^)]+)\)")
CODE = re.compile(r"^```.*?^```|`[^`\n]*`|\$\$.*?\$\$|\$[^$\n]*\$", re.MULTILINE | re.DOTALL)


@pytest.fixture(params=NOTEBOOKS, ids=lambda path: path.stem)
def path(request):
    return request.param


def outputs(notebook):
    return [output for cell in notebook.cells for output in cell.get("outputs", [])]


class Tags(html.parser.HTMLParser):
    """The opening tags of a piece of HTML, and the text between them."""

    def __init__(self, source):
        super().__init__()
        self.tags, self.text = [], ""
        self.feed(source)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data):
        self.text += data


def test_every_output_is_of_a_kind_that_a_viewer_shows(notebook):
    for output in outputs(notebook):
        assert output.output_type in ("stream", "execute_result", "display_data")
        assert set(output.get("data", {})) <= {"text/plain", "text/html", WIDGET}


def test_html_is_pictures_and_questions_that_survive_without_styles_and_scripts(notebook):
    for output in outputs(notebook):
        if "text/html" in output.get("data", {}):
            # Of an explorer, what a viewer leaves that strips scripts and styles: its first picture and its words.
            is_explorer = output.data["text/plain"].startswith("Explorer: ")
            found = Tags(STRIPPED.sub("", output.data["text/html"]))
            kinds = [tag for tag, _ in found.tags]
            if "details" in kinds:
                assert set(kinds) <= QUESTION
            elif 'class="np-box np-done"' in output.data["text/html"]:  # in solutions: a verdict, and its mark
                assert kinds in (["div", "span", "p"], ["div", "span", "p", "img"])
            else:
                assert kinds == (["div", "img", "p"] if is_explorer else ["img"])
                assert found.text == (dict(found.tags)["img"]["alt"] if is_explorer else "")
            for attributes in (attributes for tag, attributes in found.tags if tag == "img"):
                assert set(attributes) - {"class"} == {"alt", "src", "width", "style"}
                assert re.match(r"data:image/(png|gif|svg\+xml);base64,", attributes["src"])
                assert 200 < int(attributes["width"]) < 1500, "the size does not hang on the style"


def test_what_is_folded_comes_after_its_question(notebook):
    for output in outputs(notebook):
        page = output.get("data", {}).get("text/html", "")
        if "<details>" in page:
            assert page.count("<details>") == page.count("</details>") == 1
            shown, _ = STRIPPED.sub("", page).split("<details>")
            assert {"img", "pre"}.isdisjoint(tag for tag, _ in Tags(shown).tags)


def test_a_widget_reads_as_words(notebook):
    for output in outputs(notebook):
        if WIDGET in output.get("data", {}):
            assert re.match(r"[A-Z]\w+: \w.{20}", output.data["text/plain"]), "not the name of a class alone"
    assert "widgets" not in notebook.metadata, "a viewer would load them from the network"


def test_text_is_markdown_alone_but_for_what_is_folded(notebook):
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            tags = re.findall(r"</?[a-zA-Z][^>]*>", CODE.sub("", cell.source))
            assert set(tags) <= {"<details>", "</details>", "<summary>", "</summary>"}
            # Without an empty line after it, what is folded would not be read as Markdown.
            assert not re.search(r"</summary>\n?[^\n]", cell.source)
            assert not cell.get("attachments")
        assert cell.cell_type in ("markdown", "code")


def test_pictures_are_files_of_the_repository(path, notebook):
    if not (ROOT / ".git").exists() or shutil.which("git") is None:
        pytest.skip("this is no clone, or there is no git: what is in the repository is not known")
    command = ["git", "-c", f"safe.directory={ROOT}", "ls-files", "-z", "notebooks", "figures"]
    files = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\0")
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            for name in PICTURE.findall(cell.source):
                target = (path.parent / name).resolve().relative_to(ROOT.resolve()).as_posix()
                assert target in files, "case and all, as on a server"


def test_a_notebook_is_small_enough_to_be_shown(path):
    assert path.stat().st_size < 1_000_000
