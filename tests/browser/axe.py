"""What axe-core finds in a page, without what is not ours."""

import pytest

SERIOUS = ("serious", "critical")
# What nbconvert's own template does, on every notebook of the world: by rule, the elements that it styles.
OF_THE_TEMPLATE = {
    # Grey prompts; the colours of the code; text in which nothing has a style of its own. Axe looks at what lies behind
    # every word: most words of a page are these.
    "color-contrast": (".jp-InputPrompt", ".jp-OutputPrompt", ".highlight", ".jp-MarkdownOutput:not(:has([style]))"),
    "link-in-text-block": (".jp-RenderedHTMLCommon a",),  # links are blue, and underlined under the mouse alone
}
# Whatever it finds is moderate, and it takes a third of the time of all others together.
LESS_THAN_SERIOUS = ("region",)


def violations(page, context=None) -> list[str]:
    """Serious and critical violations of ours, one line each.

    Args:
        page: a page of Playwright.
        context: a selector, of what to look at; the whole page when None.
    """
    axe = pytest.importorskip(
        "axe_playwright_python.sync_playwright", reason="axe is not installed: pip install -r tests/requirements.txt"
    )
    others = {"rules": {rule: {"enabled": False} for rule in (*OF_THE_TEMPLATE, *LESS_THAN_SERIOUS)}}
    found = axe.Axe().run(page, context, {"resultTypes": ["violations"]} | others).response["violations"]
    for rule, selectors in OF_THE_TEMPLATE.items():
        ours = {"exclude": [[each] for each in selectors]} | ({"include": [[context]]} if context else {})
        options = {"resultTypes": ["violations"], "runOnly": [rule]}
        found += axe.Axe().run(page, ours, options).response["violations"]
    return [
        f"{violation['id']} ({violation['impact']}): {node['html'][:200]}"
        for violation in found
        if violation["impact"] in SERIOUS
        for node in violation["nodes"]
    ]
