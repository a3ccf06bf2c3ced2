"""How the book looks, on the screen and on paper: one page of HTML around its chapters."""

import html

from npslam_teach import __version__
from npslam_teach.publishing.book_markdown import Chapter

TITLE = "SLAM with objects when nobody tells you which object you see"
_INTRODUCTION = f"""\
<p>The lessons of npslam_teach {__version__}, as they are executed. Pictures and formulas are part of this file, so it
reads and prints without a network. Sliders lead through pictures that were computed before; results lie folded below
their questions, and the exercises are there to be solved in the notebooks.</p>
<p>The method is that of Mu, Liu, Paull, Leonard and How, <cite>SLAM with Objects using a Nonparametric Pose
Graph</cite>, IROS 2016.</p>"""
# Code has lines of up to 100 characters, which fit both the screen's column and the paper's.
_STYLE = """\
:root { color-scheme: light; }
body { max-width: 52rem; margin: 0 auto; padding: 2rem 1.2rem; color: #1a1a1a; background: #fff; }
body { font: 1.05rem/1.55 "Noto Serif", Georgia, serif; }
h1, h2, h3, h4, nav { font-family: "Noto Sans", "Segoe UI", Helvetica, Arial, sans-serif; line-height: 1.25; }
h1 { font-size: 2rem; } h2 { font-size: 1.6rem; } h3 { font-size: 1.25rem; margin-top: 2.2rem; }
h4 { font-size: 1.05rem; }
a { color: #0a558c; }
nav ol { list-style: none; padding-left: 0; } nav ol ol { padding-left: 1.5rem; font-size: 0.92rem; }
nav > ol > li { margin-top: 0.7rem; font-weight: 600; } nav ol ol li { font-weight: 400; }
section.lesson { border-top: 3px solid #0a558c; margin-top: 4rem; padding-top: 0.5rem; }
img { max-width: 100%; height: auto; }
pre { font: 0.78rem/1.45 "DejaVu Sans Mono", Consolas, Menlo, monospace; margin: 0; }
pre { white-space: pre-wrap; overflow-wrap: anywhere; }
code { font-family: "DejaVu Sans Mono", Consolas, Menlo, monospace; font-size: 0.88em; }
.highlight { background: #f5f6f8; border-left: 3px solid #b9c4cf; padding: 0.55rem 0.8rem; margin: 0.9rem 0 0.3rem; }
.output_subarea { margin: 0.3rem 0 0.9rem; padding: 0 0.8rem; }
.np-box { border: 1px solid #3d8fd1; border-left-width: 6px; border-radius: 6px; padding: 0.4rem 0.9rem; }
.np-box fieldset { border: 0; margin: 0; padding: 0; min-width: 0; }
.np-box legend { padding: 0; font-weight: 600; } .np-box fieldset > ul { margin: 0.3rem 0; }
summary { cursor: pointer; padding: 0.2rem 0; font-weight: 600; }
details:not(.np-box details) { border-left: 3px solid #c4c9cf; padding-left: 0.8rem; margin: 0.4rem 0; }
.sliders { font-style: italic; color: #444; }
table { border-collapse: collapse; margin: 1rem 0; font-size: 0.92rem; width: 100%; }
th, td { border: 1px solid #c4c9cf; padding: 0.3rem 0.55rem; text-align: left; vertical-align: top; }
th { background: #eef1f4; }
.formula { margin: 0.9rem 0; overflow-x: auto; }
math { font-family: "Latin Modern Math", "STIX Two Math", "Cambria Math", "DejaVu Math TeX Gyre", math; }
@media print {
  @page { size: A4; margin: 18mm 16mm; }
  body { max-width: none; padding: 0; font-size: 10.5pt; }
  section.lesson { break-before: page; border-top: none; margin-top: 0; }
  pre { font-size: 7.8pt; }
  h2, h3, h4 { break-after: avoid; }
  img, .formula, tr { break-inside: avoid; }
  .formula { overflow-x: visible; }
  details::details-content { content-visibility: visible; block-size: auto; }
}
"""
_PAGE = """\
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
{style}
</style>
</head>
<body>
<header>
<h1>{title}</h1>
{introduction}
</header>
<nav aria-label="Contents">
<h2>Contents</h2>
<ol>
{contents}
</ol>
</nav>
<main>
{lessons}
</main>
</body>
</html>
"""


def page(chapters: list[tuple[Chapter, str]], title: str = TITLE, introduction: str = _INTRODUCTION) -> str:
    """The whole book.

    Args:
        chapters: each lesson and its HTML.
        title: of the book, plain text.
        introduction: HTML.
    """
    contents = "\n".join(_contents(chapter) for chapter, _ in chapters)
    lessons = "\n".join(f'<section class="lesson">\n{body}\n</section>' for _, body in chapters)
    return _PAGE.format(
        title=html.escape(title),
        style=_STYLE + _code_colours(),
        introduction=introduction,
        contents=contents,
        lessons=lessons,
    )


def _contents(chapter: Chapter) -> str:
    (_, name, text), *rest = chapter.headings
    parts = "".join(f'\n<li><a href="#{anchor}">{part}</a></li>' for level, anchor, part in rest if level == 2)
    return f'<li>{chapter.number} <a href="#{name}">{text}</a>\n<ol>{parts}\n</ol></li>'


def _code_colours() -> str:
    from pygments.formatters import HtmlFormatter

    # The style of Pygments in which every colour has a contrast of 4.5 to 1 against the grey behind the code.
    return HtmlFormatter(style="xcode", nobackground=True).get_style_defs(".highlight")
