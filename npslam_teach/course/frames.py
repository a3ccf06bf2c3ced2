"""Explorers without a kernel: every picture that their sliders lead to, computed before, in one piece of HTML.

Where scripts run the piece becomes an explorer, driven by the same ``explorer.js``; where they are stripped, its first
picture and the words remain.
"""

import base64
import html
import io
import itertools
import json
from pathlib import Path

from PIL import Image

from npslam_teach.course.controls import Slider

_HERE = Path(__file__).parent
COLORS = 48  # of a frame: a third of the size of one in full colour


def html_of(explorer, with_frames: bool) -> str:
    """An explorer as it stands, or with all of its frames.

    Args:
        explorer: ``explorers.Explorer``; it is left as it was.
        with_frames: whether the sliders should work.
    """
    first = _frame(explorer)
    picture = _still(explorer, first)
    if not with_frames or not explorer.without_kernel:
        return f"<div>{picture}</div>"
    controls, all_frames = _all_frames(explorer, first)
    data = json.dumps({"controls": controls, "frames": all_frames}, separators=(",", ":")).replace("</", "<\\/")
    script = (_HERE / "explorer.js").read_text(encoding="utf-8").replace("export default { render };", "")
    start = "const place = document.currentScript.previousElementSibling;\nplace.textContent = '';\n"
    start += f"render({{ model: frozen({data}), el: place }});"
    return f"<style>{explorer._css}</style><div>{picture}</div><script>(() => {{\n{script}\n{start}\n}})();</script>"


def _all_frames(explorer, first: dict) -> tuple[list, list]:
    """The controls that have frames, and a frame for every combination of their values, the last control fastest."""
    before, controls = explorer.values(), explorer.sliders
    grids = {name: _with_present(controls[name], grid) for name, grid in explorer.without_kernel.items()}
    found = []
    for values in itertools.product(*grids.values()):
        for name, value in zip(grids, values, strict=True):
            explorer.sliders[name].put(value)
        frame = _frame(explorer) | {"values": _on_page(explorer, grids)}
        is_first = all(explorer.sliders[name].value == before[name] for name in grids)
        found.append(frame | {"first": True} if is_first else frame)
    for name, value in before.items():
        explorer.sliders[name].put(value)
    explorer.picture()
    specs = [_control(explorer, name, grid) for name, grid in grids.items()]
    return specs, [frame if "first" in frame else _less(frame, first) for frame in found]


def _with_present(control, grid) -> list:
    """The values of a grid and the one that is shown first, in the order of the control."""
    values = [control.checked(each) for each in grid]
    if control.value not in values:
        values.append(control.value)
    return sorted(values, key=None if isinstance(control, Slider) else control.grid().index)


def _control(explorer, name: str, grid) -> dict:
    control = explorer.sliders[name]
    spec = control.spec(name)
    if isinstance(control, Slider):
        return spec | {"grid": list(grid)}
    texts = dict(zip(control.options.values(), control.options, strict=True))
    return spec | {"options": [texts[value] for value in grid]}


def _on_page(explorer, grids: dict) -> dict:
    """The values that the page's controls have: of a list, the number among those that have frames."""
    values = {}
    for name, grid in grids.items():
        control = explorer.sliders[name]
        values[name] = control.value if isinstance(control, Slider) else list(grid).index(control.value)
    return values


def _frame(explorer) -> dict:
    shown = explorer.picture()
    return shown | {"src": _small(shown["src"])} if "src" in shown else shown


def _less(frame: dict, first: dict) -> dict:
    """Of a scene only the parts that the first one has otherwise."""
    if "scene" not in frame:
        return frame
    parts, known = frame["scene"]["parts"], first["scene"]["parts"]
    changed = {name: part for name, part in parts.items() if known.get(name) != part}
    gone = [name for name in known if name not in parts]
    return frame | {"scene": frame["scene"] | {"parts": changed}} | ({"without": gone} if gone else {})


def _small(source: str) -> str:
    """A picture with a palette."""
    picture = Image.open(io.BytesIO(base64.b64decode(source.split(",")[1]))).convert("RGB")
    stream = io.BytesIO()
    few = picture.quantize(COLORS, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    few.save(stream, format="PNG", optimize=True)
    return f"data:image/png;base64,{base64.b64encode(stream.getvalue()).decode('ascii')}"


def _still(explorer, frame: dict) -> str:
    """The picture and its words, for where no scripts run."""
    if "scene" in frame:
        content = base64.b64encode(explorer.scene.svg().encode("utf-8")).decode("ascii")
        source, width = f"data:image/svg+xml;base64,{content}", round(explorer.scene.size[0])
    else:
        source, width = frame["src"], frame["size"][0]
    words = html.escape(frame["words"], quote=True)
    return f'<img alt="{words}" src="{source}" width="{width}" style="max-width:100%"><p>{words}</p>'
