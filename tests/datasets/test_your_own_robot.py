"""The guide from a bag to a map: every command and every piece of Python in it runs on a bag that is written here."""

import contextlib
import io
import re
import shlex

import numpy as np
import pytest
from commands import ROOT, small_log

from npslam_teach import datasets
from npslam_teach.cli import parser

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install -r tests/requirements.txt")

from robot_bags import write_run  # noqa: E402

NOTEBOOKS = ROOT / "notebooks"
GUIDE = (NOTEBOOKS / "your_own_robot.md").read_text(encoding="utf-8")
PROGRAM = "python3 -m npslam_teach "


def blocks():
    """Language and text of each block of code."""
    return re.findall(r"^```(\w*)\n(.*?)^```$", GUIDE, re.M | re.S)


@pytest.mark.slow
def test_the_guide_works_from_top_to_bottom(tmp_path, monkeypatch, capsys):
    log, truth = small_log()
    write_run(tmp_path / "my_run", log)
    write_run(tmp_path / "my_pictures", log, what="pictures")
    monkeypatch.chdir(tmp_path)
    said, ran = [], 0
    for language, text in blocks():
        if language == "python":
            with contextlib.redirect_stdout(io.StringIO()) as out:
                exec(compile(text, "guide", "exec"), {})
            said.append(out.getvalue())
            continue
        for line in text.splitlines():
            if line.startswith(PROGRAM):
                assert parser.main(shlex.split(line.removeprefix(PROGRAM))) == 0, line
                ran += 1
    assert ran == text_count(PROGRAM) and len(said) == GUIDE.count("```python")
    assert {"my_run.npz", "my_pictures.npz", "drawn", "result.json", "objects.csv", "path.tum"} <= {
        path.name for path in tmp_path.iterdir()
    }
    found, _ = datasets.load_log("my_run.npz")
    np.testing.assert_array_equal(found.odometry_std, [0.03, 0.03, 0.02])
    pictures, _ = datasets.load_log("my_pictures.npz")
    np.testing.assert_allclose(pictures.obs_xy, log.obs_xy, atol=1e-6)
    steps, noise, chi2 = said
    assert f"{len(log.odometry)} steps of 0.25" in steps
    assert re.search(r"odometry_std ([\d.]+),([\d.]+),([\d.]+)\nobservation_std ([\d.]+),([\d.]+)\noutliers", noise)
    assert 0.3 < float(chi2.split(":")[1]) < 3.0


def text_count(program):
    return sum(line.startswith(program) for line in GUIDE.splitlines())


def test_commands_of_ros_itself_name_what_is_imported_later():
    lines = [line for _, text in blocks() for line in text.splitlines()]
    others = [line for line in lines if line.startswith(("ros2 ", "rosbag "))]
    assert len(others) == 2 and all(" my_run" in line and "/odom /detections /tf_static" in line for line in others)


def test_links_and_headings_of_the_guide_exist():
    headings = {
        re.sub(r"[^\w\- ]", "", line.lower()).replace(" ", "-") for line in re.findall(r"^#+ (.*)$", GUIDE, re.M)
    }
    targets = [target for target in re.findall(r"\]\(([^)]+)\)", GUIDE) if not target.startswith("https:")]
    assert len(targets) > 6
    for target in targets:
        assert target[1:] in headings if target.startswith("#") else (NOTEBOOKS / target).is_file(), target
    for other in (ROOT / "README.md", NOTEBOOKS / "teaching_guide.md"):
        assert "your_own_robot.md)" in other.read_text(encoding="utf-8")


def test_the_messages_that_the_guide_explains_are_those_of_the_code(tmp_path, capsys):
    """Word for word, but for names, numbers and what stands for several things."""
    path = write_run(tmp_path / "my_run", small_log()[0])
    assert parser.main(["import", "rosbag", str(path), "--out", str(tmp_path / "my_run.npz")]) == 0
    sources = [file for name in ("datasets", "cli") for file in (ROOT / "npslam_teach" / name).glob("*.py")]
    words = capsys.readouterr().out + " ".join(file.read_text(encoding="utf-8") for file in sources)
    tables = re.split(r"^## ", GUIDE, flags=re.M)
    rows = [row for table in tables if table[0] in "26" for row in re.findall(r"^\| (`.*?`) \|", table, re.M)]
    assert len(rows) > 15
    for row in rows:
        for part in re.split(r"`| or |\.\.\.|/\w+|[\d.]+| A, B", row):
            if "vision_msgs" not in row:
                assert part.strip(" ,:-") in words, row
