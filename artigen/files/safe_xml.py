"""XML of untrusted files: entities and DTDs are refused."""

from pathlib import Path
from xml.etree.ElementTree import Element, ParseError

from artigen.errors import SourceError

MOST_BYTES = 50_000_000
"""No description of an object is longer; meshes are files of their own."""


def read_xml(path: Path, owner: str = "") -> tuple[Element, bytes]:
    """Root element and text of a file.

    Args:
        owner: How errors name the file; by default by its path.

    Raises:
        SourceError: If the file cannot be read, is too long, or is not safe XML.
    """
    owner = owner or str(path)
    try:
        size = path.stat().st_size
        if size > MOST_BYTES:
            raise SourceError(f"{owner}: holds {size:,} bytes of XML, at most {MOST_BYTES:,} are read")
        data = path.read_bytes()
    except OSError as err:
        raise SourceError(f"{owner}: cannot be read ({err.strerror})") from err
    return parse_xml(data, owner), data


def parse_xml(data: bytes | str, owner: str) -> Element:
    """Root element of a text.

    Raises:
        SourceError: If it is not safe XML.
    """
    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import fromstring

    try:
        return fromstring(data, forbid_dtd=True)
    except DefusedXmlException as err:
        raise SourceError(f"{owner}: declares a DTD or entities, which are refused: {err}") from err
    except (ParseError, ValueError) as err:
        raise SourceError(f"{owner}: not valid XML ({type(err).__name__}: {err})") from err
