"""The page of the library's names: nothing public is missing, and it says what the docstrings say."""

import html
import importlib
import inspect
import re

import pytest

from npslam_teach.cli import parser
from npslam_teach.publishing import api_page


@pytest.fixture(scope="module")
def page():
    return api_page.api_html()


@pytest.mark.parametrize("part", api_page.PARTS)
def test_every_public_name_is_there_once_with_its_words(page, part):
    module = importlib.import_module(f"npslam_teach.{part}")
    names = api_page.public_names(module)
    assert len(names) >= 5
    for name in names:
        assert page.count(f'id="api-{part}.{name}"') == 1
        assert f'href="#api-{part}.{name}"' in page
        value = getattr(module, name)
        if callable(value) and value.__doc__:
            first = inspect.getdoc(value).split("\n\n")[0]
            plain = re.sub("</?code>", "``", page)
            assert html.escape(first) in plain or html.escape(first).replace("``", "") in plain.replace("``", "")


def test_the_short_names_of_the_package_are_among_them(page):
    import npslam_teach

    assert {*api_page.PARTS, "course"} == set(npslam_teach._FOLDERS_AND_MODULES)
    missing = [name for name in npslam_teach.__all__ if f'.{name}"' not in page]
    assert missing == []


def test_fields_have_their_shapes_and_units(page):
    assert "poses: np.ndarray  # (T, 3)" in page
    assert re.search(r"observation_std: np.ndarray\s+# \(2,\)", page)


def test_the_command_writes_it_without_a_network(tmp_path, capsys):
    assert parser.main(["book", "--api", "--out", str(tmp_path / "api.html")]) == 0
    text = (tmp_path / "api.html").read_text(encoding="utf-8")
    assert "optimize(graph, tolerance=1e-09, max_iterations=100)" in text
    assert not re.findall(r'(?:src|href)="(?!#)[^"]*"', text), "it asks for nothing else"
