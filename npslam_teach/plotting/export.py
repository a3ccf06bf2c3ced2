"""Figures on their way out: to files, into notebooks, into an animation.

A figure that is made anew gives the same bytes again, so that files change only when their content does.
"""

import base64
import html
import io
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure
from PIL import Image

from npslam_teach.system.files import atomic_write

PNG_DPI = 125  # the largest figures of the course stay below 120 kB
FRAME_DPI = 90
CSS_DPI = 96  # what a browser takes an inch for
# White becomes transparent on a light page. On a dark one lightness is turned over and hues are kept, and black becomes
# transparent. The signs of a dark page are those of JupyterLab, VS Code and Colab; where styles are stripped a picture
# keeps its white background.
PICTURE_CLASS = "np-figure"
_DARK = ", ".join(
    f"{page} img.{PICTURE_CLASS}" for page in ("[data-jp-theme-light=false]", ".vscode-dark", "html[theme=dark]")
)
PICTURE_STYLE = (
    f"<style>img.{PICTURE_CLASS} {{ mix-blend-mode: multiply; }} "
    f"{_DARK} {{ filter: invert(1) hue-rotate(180deg); mix-blend-mode: screen; }}</style>"
)
# Whatever a user's own settings are: random ids inside an SVG, its text, and the edges of a picture.
_FIXED = {
    "svg.hashsalt": "npslam_teach",
    "svg.fonttype": "path",
    "savefig.bbox": "standard",
    "savefig.transparent": False,
}


def save(figure: Figure, path_without_suffix) -> list[Path]:
    """Write a figure as PNG and as SVG, byte for byte the same on every run.

    A file appears under its name only when it is complete.

    Args:
        figure: the figure.
        path_without_suffix: "figures/figure_14" makes figure_14.png and figure_14.svg.

    Returns:
        the two paths.
    """
    contents = {"png": png_bytes(figure), "svg": svg_bytes(figure)}
    paths = [Path(f"{path_without_suffix}.{suffix}") for suffix in contents]
    for path, content in zip(paths, contents.values(), strict=True):
        with atomic_write(path, "wb") as stream:
            stream.write(content)
    return paths


def png_bytes(figure: Figure, dpi: float = PNG_DPI) -> bytes:
    """The figure as a PNG file; with a palette it is a third of the size, and notebooks keep it for years."""
    stream = io.BytesIO()
    _drawn(figure, dpi).save(stream, format="PNG", optimize=True)
    return stream.getvalue()


def svg_bytes(figure: Figure) -> bytes:
    """The figure as an SVG file, with neither date nor version in it."""
    stream = io.BytesIO()
    with matplotlib.rc_context(_FIXED):
        figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    return stream.getvalue()


def gif_bytes(figures, durations_ms) -> bytes:
    """Figures of one size as an animated GIF that starts over at its end.

    Args:
        figures: one for each frame.
        durations_ms: how long each is shown, in ms.
    """
    frames = [_drawn(figure, FRAME_DPI) for figure in figures]
    stream = io.BytesIO()
    frames[0].save(stream, format="GIF", save_all=True, append_images=frames[1:], duration=list(durations_ms), loop=0)
    return stream.getvalue()


def _drawn(figure: Figure, dpi: float) -> Image.Image:
    """The figure as a picture of 256 colours."""
    stream = io.BytesIO()
    with matplotlib.rc_context(_FIXED):
        figure.savefig(stream, format="png", dpi=dpi, pil_kwargs={"compress_level": 0})  # it is read at once
    picture = Image.open(stream).convert("RGB")
    # Of Pillow's methods this one keeps small patches of a colour (no channel is off by more than some 5 %), where the
    # default takes the colours of two classes for one. Dithering would add grain, which compresses badly.
    return picture.quantize(256, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)


def show(figure: Figure | bytes, alt: str):
    """A figure for a notebook, with the text that a screen reader reads instead.

    Args:
        figure: the figure, or the bytes of an animated GIF.
        alt: what the picture shows, in a sentence or two.

    Returns:
        ``IPython.display.HTML``: the last value of a cell is displayed.

    Raises:
        ValueError: ``alt`` is empty.
    """
    if isinstance(figure, bytes):
        return show_animation(figure, alt)
    text = _checked(alt)
    # A third more pixels than it is wide on the page, for sharp lines when it is projected.
    return _as_html("image/png", png_bytes(figure), text, figure.get_figwidth())


def show_animation(gif: bytes, alt: str):
    """An animated GIF for a notebook, with alternative text; see ``show``.

    Args:
        gif: the file, as from ``animate``.
        alt: what happens in it.
    """
    text = _checked(alt)
    return _as_html("image/gif", gif, text, Image.open(io.BytesIO(gif)).width / FRAME_DPI)


def _checked(alt: str) -> str:
    if not alt.strip():
        raise ValueError("alt: expected a sentence that says what the picture shows, got an empty text")
    return " ".join(alt.split())


def picture_tag(png: bytes, alt: str, inches) -> str:
    """The ``<img>`` of a picture that follows a slider.

    Args:
        png: the file.
        alt: what the picture shows now.
        inches: its width and height; a page that knows both keeps its place free while the next picture is decoded.
    """
    width, height = (round(length * CSS_DPI) for length in inches)
    size = f'width="{width}" height="{height}" style="max-width:100%;height:auto"'
    return _tag("image/png", png, _checked(alt), size)


def _as_html(media_type: str, content: bytes, alt: str, inches: float):
    # Imported here: files are also written where there is no notebook.
    from IPython.display import HTML

    size = f'width="{round(inches * CSS_DPI)}" style="max-width:100%"'
    return HTML(_tag(media_type, content, alt, size))


def _tag(media_type: str, content: bytes, alt: str, size: str) -> str:
    data = base64.b64encode(content).decode("ascii")
    words, source = html.escape(alt, quote=True), f"data:{media_type};base64,{data}"
    return f'<img class="{PICTURE_CLASS}" alt="{words}" src="{source}" {size}>{PICTURE_STYLE}'
