"""A hook of MkDocs: links to files of the repository outside of docs/ become their paths, as code."""

import re
from posixpath import dirname, normpath
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mkdocs.structure.pages import Page

LINK = re.compile(r"\[[^\]]*\]\((\.\./[^)#]+)\)")


def on_page_markdown(markdown: str, page: "Page", **_: object) -> str:
    """The text of a page, without links that lead out of the documentation."""
    folder = dirname(page.file.src_uri)

    def replace(found: re.Match[str]) -> str:
        path = normpath(f"docs/{folder}/{found[1]}")
        return found[0] if path.startswith("docs/") else f"`{path}`"

    return LINK.sub(replace, markdown)
