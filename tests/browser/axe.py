"""What axe-core finds in a page, without what is not ours."""

import pytest

SERIOUS = ("serious", "critical")
# What nbconvert's own template does, on every notebook of the world: by rule what it looks at, and the elements that
# the template styles.
OF_THE_TEMPLATE = {
    # Grey prompts; the colours of the code; text in which nothing has a style of its own. Axe looks at what lies behind
    # every word: most words of a page are these.
    "color-contrast": (
        ("*",),
        (".jp-InputPrompt", ".jp-OutputPrompt", ".highlight", ".jp-MarkdownOutput:not(:has([style]))"),
    ),
    # Links are blue, and underlined under the mouse alone.
    "link-in-text-block": (("a[href]", "[role=link]"), (".jp-RenderedHTMLCommon a",)),
}
# Whatever it finds is moderate, and it takes a third of the time of all others together.
LESS_THAN_SERIOUS = ("region",)
# All rules in one run, because every run begins with a look at the whole page: what a rule is not to see has a mark.
RUN = """([context, ofTheTemplate, off]) => {
    const rules = Object.entries(ofTheTemplate).map(([id, [seen, theirs]]) => {
        const mark = `data-not-ours-for-${id}`;
        for (const each of document.querySelectorAll(theirs.flatMap((own) => [own, `${own} *`]).join())) {
            each.setAttribute(mark, "");
        }
        return { id, selector: seen.map((each) => `${each}:not([${mark}])`).join() };
    });
    axe.configure({ rules });
    const disabled = Object.fromEntries(off.map((rule) => [rule, { enabled: false }]));
    return axe.run(context ?? document, { resultTypes: ["violations"], rules: disabled });
}"""


def violations(page, context=None) -> list[str]:
    """Serious and critical violations of ours, one line each.

    Args:
        page: a page of Playwright.
        context: a selector, of what to look at; the whole page when None.
    """
    axe = pytest.importorskip(
        "axe_playwright_python.base", reason="axe is not installed: pip install -r tests/requirements.txt"
    )
    if not page.evaluate("() => 'axe' in window"):
        page.evaluate(axe.AXE_SCRIPT)
    found = page.evaluate(RUN, [context, OF_THE_TEMPLATE, LESS_THAN_SERIOUS])["violations"]
    return [
        f"{violation['id']} ({violation['impact']}): {node['html'][:200]}"
        for violation in found
        if violation["impact"] in SERIOUS
        for node in violation["nodes"]
    ]
