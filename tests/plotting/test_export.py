"""Figures on their way out: the same bytes every time, with words."""

import io

import matplotlib
import pytest
from pictures import on_axes, parsed
from PIL import Image

from npslam_teach import plotting


def test_saved_files_are_the_same_on_every_run(tmp_path, scene, runs):
    def contents(name):
        figure = on_axes(plotting.plot_snapshot, runs["np-graph"][1], *scene)
        paths = plotting.save(figure, tmp_path / name)
        assert [path.name for path in paths] == [f"{name}.png", f"{name}.svg"]
        return [path.read_bytes() for path in paths]

    first = contents("first.figure")  # a dot in the name is not a suffix
    with matplotlib.rc_context({"svg.hashsalt": "mine", "savefig.bbox": "tight", "savefig.dpi": 30}):
        second = contents("second")
    assert first == second
    assert first[0].startswith(b"\x89PNG") and b"<svg" in first[1]
    assert b"dc:date" not in first[1] and b"Matplotlib" not in first[0] + first[1]
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        f"{name}.{suffix}" for name in ("first.figure", "second") for suffix in ("png", "svg")
    ]


def test_saved_files_replace_older_ones_whole(tmp_path):
    (tmp_path / "figure.png").write_bytes(b"old" * 100_000)
    plotting.save(plotting.new_figure()[0], tmp_path / "figure")
    picture = Image.open(io.BytesIO((tmp_path / "figure.png").read_bytes()))
    assert picture.size == (7 * 125, int(5.5 * 125))
    with pytest.raises(FileNotFoundError, match="no folder"):
        plotting.save(plotting.new_figure()[0], tmp_path / "missing" / "figure")


def test_show_is_an_image_with_alternative_text():
    alt = 'The "true" path & <b>15</b> objects,\n  d < 1 m\'s'
    figure = plotting.new_figure(size=(7.0, 5.5))[0]
    parser, media_type, data = parsed(plotting.show(figure, alt))
    assert parser.tag == "img"
    assert parser.attributes["alt"] == " ".join(alt.split())
    assert parser.attributes["style"] == "max-width:100%"
    assert media_type == "image/png"
    picture = Image.open(io.BytesIO(data))
    assert picture.width / picture.height == pytest.approx(7.0 / 5.5, rel=0.01)
    assert int(parser.attributes["width"]) == 7 * 96 < picture.width


@pytest.mark.parametrize("alt", ["", "  \n"])
def test_show_refuses_a_picture_without_words(alt):
    for show, picture in ((plotting.show, plotting.new_figure()[0]), (plotting.show_animation, b"")):
        with pytest.raises(ValueError, match="alt: expected a sentence"):
            show(picture, alt)


def test_everything_public_is_there():
    assert all(callable(getattr(plotting, name)) for name in plotting.__all__)
