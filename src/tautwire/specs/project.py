"""The project block: for whom, by whom and in which revision a result was made."""

from __future__ import annotations

import base64
import binascii
import re
from typing import Annotated
from xml.etree import ElementTree as ET

from pydantic import AfterValidator, ConfigDict, Field

from tautwire.specs.base import Spec, Typical

MOST_LOGO_BYTES = 200_000
"""Size of an image: it stands in every result file and page, and a logo for print needs less."""
Line = Annotated[str, Field(max_length=200, pattern=r"^[^\x00-\x1f\x7f]*$")]
_URI = re.compile(r"data:image/(png|jpeg|svg\+xml);base64,([A-Za-z0-9+/=]*)\Z")
_KINDS = "a whole PNG, JPEG or SVG image"


def data_uri(content: bytes) -> str:
    """Return an image as text for a page (RFC 2397).

    Raises
    ------
    ValueError
        When it is too large, or no image of a kind that browsers and printers take.
    """
    if len(content) > MOST_LOGO_BYTES:
        raise ValueError(
            f"has {len(content) / 1e3:.0f} kB; at most {MOST_LOGO_BYTES / 1e3:g} kB are kept in "
            "every result; save it smaller"
        )
    kind = _kind_of(content)
    if kind is None:
        raise ValueError(f"is not {_KINDS}; save the logo as one of them")
    return f"data:image/{kind};base64,{base64.b64encode(content).decode('ascii')}"


def image_of(uri: str) -> tuple[str, bytes]:
    """Return kind (``"png"``, ``"jpeg"``, ``"svg+xml"``) and content of an image kept as text.

    Raises
    ------
    ValueError
        When the text is no such image.
    """
    match = _URI.match(uri)
    if match is None:
        raise ValueError(f"is not {_KINDS}; give the path of an image file")
    try:
        content = base64.b64decode(match[2], validate=True)
    except binascii.Error:
        raise ValueError("is damaged; give the path of an image file") from None
    return match[1], content


def _kind_of(content: bytes) -> str | None:
    """Tell what kind of image a file holds by its first and last bytes; None for no whole one."""
    if content.startswith(b"\x89PNG\r\n\x1a\n"):
        return "png" if b"IEND" in content[-16:] else None
    if content.startswith(b"\xff\xd8\xff"):
        return "jpeg" if b"\xff\xd9" in content[-64:] else None
    try:
        root = ET.fromstring(content)
    except (ET.ParseError, ValueError, LookupError):
        return None
    return "svg+xml" if root.tag == "{http://www.w3.org/2000/svg}svg" else None


def _checked(logo: str) -> str:
    return data_uri(image_of(logo)[1]) if logo else logo


class Project(Spec):
    """What stands at the head of every page for its reader; nothing in it changes a number."""

    model_config = ConfigDict(coerce_numbers_to_str=True)

    client: Annotated[Line, Typical("Valley Railway")] = Field(
        default="", description="For whom the work is done."
    )
    project: Annotated[Line, Typical("Renewal of the Valley line")] = Field(
        default="", description="Name or number of the project."
    )
    revision: Annotated[Line, Typical("B")] = Field(
        default="", description="Revision of the document."
    )
    author: Annotated[Line, Typical("A. Author")] = Field(default="", description="Who made it.")
    checked: Annotated[Line, Typical("B. Checker")] = Field(
        default="", description="Who checked it, and when."
    )
    approved: Annotated[Line, Typical("C. Approver")] = Field(
        default="", description="Who approved it, and when."
    )
    date: Annotated[Line, Typical("2026-05-04")] = Field(
        default="", description="Date of the document."
    )
    logo: Annotated[str, AfterValidator(_checked), Typical("logo.png")] = Field(
        default="",
        description="Image file (PNG, JPEG or SVG, at most 200 kB), seen from the file that names "
        "it; the image itself is kept in the results.",
    )

    def is_empty(self) -> bool:
        """Tell that nothing was given."""
        return self == Project()

    def rows(self) -> dict[str, str]:
        """Return what was given, in words and in the order of a title block."""
        names = {name: name.capitalize() for name in type(self).model_fields if name != "logo"}
        names |= {"checked": "Checked by", "approved": "Approved by"}
        return {words: text for name, words in names.items() if (text := getattr(self, name))}
