"""The triangle of lesson 05 as a scene: its density, its summaries, and the votes that are dropped into it."""

import base64
import io

import numpy as np
from PIL import Image

from npslam_teach.course.class_votes.pictures import CORNERS, DENSITY_TICKS, on_triangle, shade
from npslam_teach.course.scene import Panel, Scene
from npslam_teach.plotting.style import class_style

SIZE = (980.0, 470.0)  # px
TRIANGLE = Panel((50.0, 44.0, 440.0, 440.0 * np.sqrt(3) / 2), (0.0, 1.0), (0.0, np.sqrt(3) / 2))
CONTROLS = ("first", "second", "third")
TRAY, PILES, ROWS = 620.0, 664.0, (80.0, 148.0, 216.0)  # px: where a new vote lies, where the cast ones begin
SPACING = 14.5  # px between two cast votes
REACH = 260.0  # px from the middle of the triangle, a little beyond its corners
PIXELS, LEVELS = (72, 62), 32  # of the shading
BLUE = (0, 101, 159)
LEGEND = 590.0  # px
DOT = "stroke-width: 3.4; stroke-linecap: round"


def draw_density(scene: Scene, concentration: np.ndarray, samples: np.ndarray, class_names, votes) -> None:
    """The shaded triangle with its corners, and samples of the distribution.

    Args:
        scene: gets them.
        concentration: (3,) positive.
        samples: (N, 3) probabilities.
        class_names: (3,).
        votes: (3,).
    """
    left, top, width, height = TRIANGLE.box
    corners = TRIANGLE.to_page(CORNERS)
    outline = ", ".join(f"{x:g}px {y:.1f}px" for x, y in corners)
    place = {"x": left, "y": top, "width": width, "height": height, "preserveAspectRatio": "none"}
    style = f"clip-path: polygon({outline}) view-box"
    scene.add("density", "image", href=shading(concentration), style=style, **place)
    TRIANGLE.line(scene, "outline", CORNERS[[0, 1, 2, 0]], "estimate")
    dots = " ".join(f"M{x:.0f},{y:.0f}h0" for x, y in TRIANGLE.to_page(on_triangle(samples)))
    scene.add("samples", "path", d=dots, class_="estimate", style=DOT)
    for c, name in enumerate(class_names):
        shift = (0.0, -12.0) if c == 2 else (0.0, 24.0)
        TRIANGLE.text(scene, f"corner {c}", CORNERS[c], f"{name}: 1", shift, "middle bold")


def shading(concentration: np.ndarray) -> str:
    """The density over the box of the triangle as a picture: the same blue everywhere, more or less opaque."""
    across, down = (np.arange(count) + 0.5 for count in PIXELS)
    x, y = np.meshgrid(across / PIXELS[0], (1 - down / PIXELS[1]) * CORNERS[2][1])
    third = y / CORNERS[2][1]
    second = x - third / 2
    points = np.stack([1 - second - third, second, third], axis=-1)
    level = np.round(shade(concentration, points.reshape(-1, 3)) * (LEVELS - 1)).astype(np.uint8)
    picture = Image.fromarray(level.reshape(PIXELS[::-1]), mode="P")
    picture.putpalette(BLUE * LEVELS)
    stream = io.BytesIO()
    opacity = bytes(int(255 * k / (LEVELS - 1)) for k in range(LEVELS))
    picture.save(stream, format="PNG", transparency=opacity, optimize=True)
    return f"data:image/png;base64,{base64.b64encode(stream.getvalue()).decode('ascii')}"


def draw_summaries(scene: Scene, summaries: dict) -> None:
    """The answers that there are, each with its mark, and what the marks mean."""
    y = 330.0
    for name in ("maximum likelihood", "mean", "mode"):
        _mark(scene, f"key {name}", scene.page, (LEGEND, y), name)
        scene.add(f"key text {name}", "text", name, x=LEGEND + 18, y=y + 5)
        if summaries[name] is not None:
            _mark(scene, name, TRIANGLE, on_triangle(summaries[name]), name)
        y += 27
    scene.add(
        "key sample", "path", d=f"M{LEGEND},{y}h0", class_="estimate", style="stroke-width: 4; stroke-linecap: round"
    )
    scene.add("key text sample", "text", "sample", x=LEGEND + 18, y=y + 5)
    _draw_scale(scene)


def _mark(scene: Scene, name: str, panel: Panel, xy, kind: str) -> None:
    """Maximum likelihood is drawn around the mode, which it often equals."""
    if kind == "mode":
        panel.mark(scene, name, xy, 3, 6.5, fill="#d45e00")
        return
    x, y = panel.to_page(xy)[0]
    if kind == "mean":
        scene.add(name, "circle", cx=x, cy=y, r=5, class_="mark", fill="#fff")
    else:
        scene.add(name, "rect", x=x - 9, y=y - 9, width=18, height=18, class_="estimate", style="stroke-width: 2.4")


def _draw_scale(scene: Scene) -> None:
    """How opaque which density is."""
    scene.add("scale title", "text", "density (times the even one)", x=772, y=335)
    for k, density in enumerate(DENSITY_TICKS):
        x = 772.0 + 33 * k
        opacity = density / (1 + density)
        color = f"rgb{BLUE}"
        scene.add(f"scale {k}", "rect", x=x, y=348, width=33, height=20, fill=color, fill_opacity=opacity)
        text = "1/3" if 0 < density < 1 else f"{density:g}"
        scene.add(f"scale text {k}", "text", text, x=x + 16.5, y=386, class_="middle quiet")
    scene.add("scale frame", "rect", x=772, y=348, width=33 * len(DENSITY_TICKS), height=20, class_="frame")


def draw_votes(scene: Scene, votes: np.ndarray, class_names, most: int) -> None:
    """For each class the votes that are cast, one that waits to be dropped, and the rings for both.

    Args:
        scene: gets them.
        votes: (3,).
        class_names: (3,).
        most: votes that a class can have.
    """
    page = scene.page
    inside = np.array([TRIANGLE.box[0] + TRIANGLE.box[2] / 2, TRIANGLE.box[1] + TRIANGLE.box[3] * 2 / 3])
    scene.add("votes title", "text", "votes", x=TRAY - 30, y=26, class_="title")
    for c, (name, y, count) in enumerate(zip(class_names, ROWS, votes.astype(int).tolist(), strict=True)):
        page.mark(scene, f"new vote {c}", (TRAY, y), c, 9.0)
        scene.add(f"count {c}", "text", f"{name}: {count}", x=TRAY - 30, y=y - 24, class_="bold")
        for k in range(count):
            page.mark(scene, f"vote {c} {k}", (PILES + SPACING * k, y), c, 5.5)
        look = {"fill": class_style(c)[0], "fill_opacity": 0.3}  # so that it is seen what the hand has
        if count < most:
            label = f"a vote for {name}; drag it into the triangle, or press Enter"
            page.grip(scene, f"cast {c}", (TRAY, y), [(inside, {CONTROLS[c]: ">"})], label, REACH, r=19.0, **look)
        if count > 0:
            last = (PILES + SPACING * (count - 1), y)
            label = f"the last vote for {name}; drag it back to the left, or press Enter"
            page.grip(scene, f"take {c}", last, [((TRAY, y), {CONTROLS[c]: "<"})], label, 40.0, r=11.0, **look)
    for k, hint in enumerate(("drag a vote from its ring into the triangle,", "or the last of a row back to its ring")):
        scene.add(f"hint {k}", "text", hint, x=TRAY - 30, y=262 + 17 * k, class_="quiet small", data_hint="true")
