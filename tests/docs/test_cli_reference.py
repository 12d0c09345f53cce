"""docs/reference/cli.md is what the help texts say."""

import runpy

from project import ROOT


def test_the_page_is_up_to_date():
    rendered = runpy.run_path(str(ROOT / "docs" / "cli_reference.py"))["render"]()
    page = (ROOT / "docs" / "reference" / "cli.md").read_text()
    assert rendered == page, "help texts changed: run python docs/cli_reference.py"
