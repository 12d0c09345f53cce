"""A hook of MkDocs: links to files of the repository that are no pages become their paths, as code."""

import re

OUTSIDE = re.compile(r"\[[^\]]*\]\((?:\.\./)+([^)#]+)\)")


def on_page_markdown(markdown: str, **_: object) -> str:
    """The text of a page, without links that lead out of the documentation."""
    return OUTSIDE.sub(lambda found: f"`{found[1]}`", markdown)
