"""What axe-core finds in a page, without what is not ours."""

import pytest

SERIOUS = ("serious", "critical")
# What nbconvert's own template does, on every notebook of the world: by rule, the elements that it styles.
OF_THE_TEMPLATE = {
    "color-contrast": ".jp-InputPrompt, .jp-OutputPrompt, .highlight",  # grey prompts; the colours of the code
    "link-in-text-block": ".jp-RenderedHTMLCommon a",  # links are blue, and underlined under the mouse alone
}


def violations(page, context=None) -> list[str]:
    """Serious and critical violations of ours, one line each.

    Args:
        page: a page of Playwright.
        context: a selector, of what to look at; the whole page when None.
    """
    axe = pytest.importorskip(
        "axe_playwright_python.sync_playwright", reason="axe is not installed: pip install -r tests/requirements.txt"
    )
    found = axe.Axe().run(page, context, {"resultTypes": ["violations"]}).response["violations"]
    return [
        f"{violation['id']} ({violation['impact']}): {node['html'][:200]}"
        for violation in found
        if violation["impact"] in SERIOUS
        for node in violation["nodes"]
        if not _is_of_the_template(page, violation["id"], node["target"][0])
    ]


def _is_of_the_template(page, rule: str, target: str) -> bool:
    if rule not in OF_THE_TEMPLATE:
        return False
    inside = "([target, its]) => document.querySelector(target).closest(its) !== null"
    return page.evaluate(inside, [target, OF_THE_TEMPLATE[rule]])
