"""Inline draws in files of the same folder, and nothing else is ever opened."""

import pytest

from qmd_studio.registry import open_file

PART = "#X3D V3.3 utf8\nShape { geometry Box { size 1 1 1 } }\n"


def figure(url):
    return (
        "<X3D><Scene><HAnimHumanoid><HAnimJoint containerField='skeleton' DEF='J' center='0 1 0'>"
        f"<HAnimSegment><Shape><Sphere radius='0.1'/></Shape><Inline url='{url}'/></HAnimSegment></HAnimJoint>"
        "<HAnimJoint USE='J' containerField='joints'/></HAnimHumanoid></Scene></X3D>"
    )


@pytest.fixture
def folder(tmp_path):
    inner = tmp_path / "figures"
    inner.mkdir()
    (tmp_path / "secret.x3dv").write_text(PART)
    (inner / "part.x3dv").write_text(PART)
    return inner


def opened(folder, url):
    (folder / "ann.x3d").write_text(figure(url))
    loaded = open_file(folder / "ann.x3d")
    return loaded.body.surface.vertices[:, 0].max() > 0.4, loaded.warnings


def test_a_file_beside_the_scene_is_drawn_in(folder):
    assert opened(folder, '"absent.x3d" "part.x3dv"') == (True, ())


@pytest.mark.parametrize(
    "url",
    [
        "../secret.x3dv",
        "http://example.invalid/part.x3dv",
        "file:///part.x3dv",
        "/etc/passwd",
        "figures/../part.x3dv",
        "..",
        "absent.x3d",
        "ann.x3d",
        "",
    ],
)
def test_nothing_else_is_opened(folder, url):
    seen, warnings = opened(folder, url and f'"{url}"')
    assert not seen
    assert "left out" in warnings[0]


def test_a_link_out_of_the_folder_is_not_followed(folder):
    (folder / "link.x3dv").symlink_to(folder.parent / "secret.x3dv")
    seen, warnings = opened(folder, '"link.x3dv"')
    assert not seen
    assert "another folder" in warnings[0]


def test_files_that_draw_each_other_in_end(folder):
    (folder / "a.x3dv").write_text('#X3D V3.3 utf8\nInline { url "b.x3dv" }')
    (folder / "b.x3dv").write_text('#X3D V3.3 utf8\nInline { url "a.x3dv" } ' + PART.split("\n")[1])
    seen, warnings = opened(folder, '"a.x3dv"')
    assert seen
    assert "draws in itself" in warnings[0]


def test_a_broken_part_leaves_the_rest_standing(folder):
    (folder / "part.x3dv").write_text("#X3D V3.3 utf8\nShape {")
    seen, warnings = opened(folder, '"part.x3dv"')
    assert not seen
    assert "cannot be read" in warnings[0]
