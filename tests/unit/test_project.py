"""The project block: from a case or a file to every page and result, and to no other line."""

from __future__ import annotations

import base64
import zlib
from pathlib import Path

import pytest

from tautwire.errors import InputError
from tautwire.inputs.attached import load_project, with_project
from tautwire.inputs.load import load_case
from tautwire.report.writers.html import render
from tautwire.report.writers.project import common_project, project_block
from tautwire.specs.project import MOST_LOGO_BYTES, Project, image_of

PNG = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJg"
    "gg=="
)
SVG = b'<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"><path d="M0 0h9v9z"/></svg>'


def own_line(folder: Path, project: str) -> Path:
    """Write a case that includes a library case and has a project block."""
    path = folder / "mine.yaml"
    path.write_text(f"schema: 2\ninclude: ac-simple\nproject: {project}\n", encoding="utf-8")
    return path


@pytest.mark.parametrize(("name", "content"), [("logo.png", PNG), ("logo.svg", SVG)])
def test_image_is_kept_in_the_case(tmp_path: Path, name: str, content: bytes) -> None:
    """The case holds the image itself, found beside the file, so that results need no file."""
    (tmp_path / name).write_bytes(content)
    path = own_line(tmp_path, f"{{client: Valley Railway, revision: 2, logo: {name}}}")
    project = load_case(path).project
    assert image_of(project.logo)[1] == content
    assert project.rows() == {"Client": "Valley Railway", "Revision": "2"}


def test_project_changes_no_hash_and_is_never_inherited(tmp_path: Path) -> None:
    """A signature does not make another case of it, and a line made from it begins unsigned."""
    base = own_line(tmp_path, "{client: Somebody, approved: C. Approver}")
    case = load_case(base)
    assert case.hash() == case.with_(project=Project()).hash()
    (tmp_path / "other.yaml").write_text("schema: 2\ninclude: mine.yaml\n", encoding="utf-8")
    assert load_case(tmp_path / "other.yaml").project == Project()


def test_office_block_is_included_and_completed(tmp_path: Path) -> None:
    """What an office shares stands in one file, with its image beside it."""
    (tmp_path / "office").mkdir()
    (tmp_path / "office" / "logo.svg").write_bytes(SVG)
    (tmp_path / "office" / "office.yaml").write_text("client: A\nlogo: logo.svg\n")
    project = load_case(own_line(tmp_path, "{include: office/office.yaml, revision: C}")).project
    assert (project.client, project.revision) == ("A", "C")
    assert image_of(project.logo)[1] == SVG


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"no image at all", "is not a whole PNG, JPEG or SVG image"),
        (PNG[:40], "is not a whole PNG"),
        (PNG + zlib.compress(b"") + b"x" * MOST_LOGO_BYTES, "at most 200 kB"),
        (None, "there is no such file; did you mean 'logo.svg'?"),
    ],
)
def test_bad_image_is_refused(tmp_path: Path, content: bytes | None, words: str) -> None:
    """Not an image, half an image, too large, missing: each with its place and what to try."""
    (tmp_path / "logo.svg").write_bytes(SVG)
    if content is not None:
        (tmp_path / "logo.png").write_bytes(content)
    with pytest.raises(InputError, match=r"project\.logo: ") as caught:
        load_case(own_line(tmp_path, "{logo: logo.png, clientt: A}"))
    text = str(caught.value)
    assert words in text
    assert "did you mean 'client'" in text


def test_image_outside_the_folder_is_not_read(tmp_path: Path) -> None:
    """A case from elsewhere cannot have any file of the reader's copied into a result."""
    inner = tmp_path / "inner"
    inner.mkdir()
    (tmp_path / "logo.png").write_bytes(PNG)
    with pytest.raises(InputError, match="not in the folder"):
        load_case(own_line(inner, "{logo: ../logo.png}"))


def test_project_of_a_file_replaces_that_of_the_case(tmp_path: Path) -> None:
    """``--project`` names a file with the keys of the block, or with the block as in a case."""
    case = load_case(own_line(tmp_path, "{client: A, author: B}"))
    for text in ("client: Z\n", "project: {client: Z}\n"):
        (tmp_path / "block.yaml").write_text(text, encoding="utf-8")
        assert with_project(case, tmp_path / "block.yaml").project == Project(client="Z")
    assert with_project(case, None) is case


def test_faults_of_a_project_file_are_told_together(tmp_path: Path) -> None:
    """Every fault with its key and the closest one that is known."""
    path = tmp_path / "block.yaml"
    path.write_text("clientt: A\nauthor: [B]\n", encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_project(path)
    assert len(caught.value.problems) == 2
    assert "did you mean 'client'" in str(caught.value)


def test_text_of_a_block_does_not_act_on_the_page() -> None:
    """A page shows the block as text, whatever it says, and the image as an image."""
    block = project_block(Project(client="<script>alert(1)</script>"))
    page = render([], {"title": "t", "description": "", "facts": {}, "version": "",
                       "case_hash": "", "project": block})  # fmt: skip
    assert "<script>alert" not in page
    assert "&lt;script&gt;alert" in page


def test_runs_of_different_projects_share_none() -> None:
    """An overlay of runs that were made for different clients names neither."""
    case = load_case("ac-simple")
    ours, theirs = (case.with_(project=Project(client=name)) for name in ("A", "B"))
    assert common_project([ours, ours]).client == "A"
    assert common_project([ours, theirs]) == Project()
    assert project_block(Project()) is None
