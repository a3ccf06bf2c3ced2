"""The hook of the server: what JupyterLab writes into a lesson on opening it does not reach the file."""

import copy
import json
from types import SimpleNamespace

import pytest

from npslam_teach.system.saving import keep_what_was_there

SHORT = {"kernelspec": {"name": "python3", "display_name": "Python 3"}, "language_info": {"name": "python"}}
LONG = {
    "kernelspec": {"name": "python3", "display_name": "Python 3 (another)"},
    "language_info": {"name": "python", "version": "3.13.1"},
    "own": {"kept": True},
}


@pytest.fixture
def save(tmp_path):
    """Save this metadata over those of a file, and return what would be written."""

    def saves(metadata, kind="notebook", file="a.ipynb"):
        (tmp_path / "a.ipynb").write_text(json.dumps({"metadata": SHORT, "cells": []}))
        model = {"type": kind, "content": {"metadata": copy.deepcopy(metadata), "cells": ["own"]}}
        keep_what_was_there(file, model, SimpleNamespace(root_dir=str(tmp_path)), format="json")
        assert model["content"]["cells"] == ["own"]
        return model["content"]["metadata"]

    return saves


def test_the_language_stays_as_the_file_has_it_and_nothing_else_is_touched(save):
    assert save(LONG) == SHORT | {"own": {"kept": True}}
    assert save(SHORT) == SHORT


def test_another_kernel_is_the_readers_choice(save):
    chosen = {"kernelspec": {"name": "julia", "display_name": "Julia"}, "language_info": {"name": "julia"}}
    assert save(chosen) == chosen


def test_a_new_notebook_and_other_files_are_left_alone(save):
    assert save(LONG, file="new.ipynb") == LONG
    assert save(LONG, kind="file") == LONG


@pytest.mark.parametrize("content", [None, "text"])
def test_a_model_without_a_notebook_is_left_alone(tmp_path, content):
    model = {"type": "notebook", "content": content}
    keep_what_was_there("a.ipynb", model, SimpleNamespace(root_dir=str(tmp_path)))
    assert model == {"type": "notebook", "content": content}


def test_a_file_that_is_no_notebook_is_overwritten_as_ever(save, tmp_path):
    (tmp_path / "broken.ipynb").write_text("not JSON")
    assert save(LONG, file="broken.ipynb") == LONG
