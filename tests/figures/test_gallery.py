"""The README's pictures are those that its commands make now."""

import re

import pytest

from figures.gallery import redraw as gallery
from ocean_sim import parts, pictures
from ocean_sim.parts import library
from ocean_sim.verbs import figure as verb

FOLDER = library("figures") / "gallery"


def test_no_picture_of_the_gallery_is_older_than_what_draws_it():
    """After a change of a scene, of the laws that it uses, or of `pictures.LOOK_VERSION`: `ocean-sim gallery`."""
    assert [entry.picture for entry in gallery.stale_entries(FOLDER)] == []


def test_another_look_or_another_scene_makes_pictures_old(monkeypatch):
    monkeypatch.setattr(pictures, "LOOK_VERSION", pictures.LOOK_VERSION + 1)
    assert len(gallery.stale_entries(FOLDER)) == len(gallery.gallery_entries())


def test_code_that_a_picture_shows_makes_it_old(monkeypatch, tmp_path):
    """That of the platform, and of the kinds of water, wind, surface and ship which a scene uses; not what it says of
    itself."""
    for entry in gallery.gallery_entries():
        assert all(list(gallery.PACKAGE.glob(pattern)) for pattern in entry.code), entry.picture
        for path in entry.files():
            copy = tmp_path / path.relative_to(gallery.PACKAGE)
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_bytes(path.read_bytes())
    before = {entry.picture: entry.stamp for entry in gallery.gallery_entries()}
    monkeypatch.setattr(gallery, "PACKAGE", tmp_path)
    shown = {
        "platform/washout/classical.py": {"platform.png"},
        "platform/shared/limits.py": {"platform.png"},
        "fluid/delta_sph.py": {"box_in_wave_tank.jpg", "dam_break_on_a_box.jpg", "reef.jpg"},
        "fluid/mueller.py": {"showcase.jpg", "wind_wide.jpg", "wind_vortex.jpg"},
        "wind/vortex.py": {"wind_vortex.jpg"},
    }
    for name, pictures_of in shown.items():
        changed = tmp_path / name
        plain = changed.read_text(encoding="utf-8")
        for added, old in (('\n\n# A comment.\n"""A docstring."""\n', set()), ("\nMORE = 1\n", pictures_of)):
            changed.write_text(plain + added, encoding="utf-8")
            now = {entry.picture: entry.stamp for entry in gallery.gallery_entries()}
            assert {picture for picture, stamp in now.items() if stamp != before[picture]} == old, name
        changed.write_text(plain, encoding="utf-8")


def test_what_a_preset_says_makes_pictures_old(monkeypatch):
    [water] = [entry for entry in gallery.gallery_entries() if entry.picture == "wind_vortex.jpg"]
    before, laws = water.stamp, gallery.shown_parts(water.scene)
    denser = laws | {"fluid": laws["fluid"].model_copy(update={"rest_density": 1025.0})}
    monkeypatch.setattr(gallery, "shown_parts", lambda scene: denser)
    assert water.stamp != before


def test_the_commands_name_the_scene_and_draw_from_its_run():
    entry = gallery.gallery_entries()[0]
    simulate, draw = entry.commands("runs/showcase")
    began = ["run", "showcase", "--until", f"{entry.until:g}"]
    assert simulate[:4] == began and draw[:2] == ["render", "runs/showcase"]
    readme = FOLDER.parents[1] / "README.md"
    if readme.exists():
        shown = re.findall(r"figures/gallery/(\w+\.\w+)", readme.read_text(encoding="utf-8"))
        assert set(shown) <= {each.picture for each in gallery.gallery_entries()}


@pytest.mark.skipif(not (FOLDER.parents[1] / "docs").exists(), reason="an installed package has no docs")
def test_the_docs_show_every_picture_with_its_commands(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER.parents[1] / "docs"))
    from generate import gallery as page

    shown = page().replace(" \\\n    ", " ")  # long commands go on in the next line
    for entry in gallery.gallery_entries():
        simulate, draw = gallery.show_entry(entry)
        assert f"/{entry.picture}\n" in shown and 0 <= shown.find(f"\n{simulate}\n") < shown.find(f"\n{draw}\n"), draw
        assert shown.count(simulate) == 1, "a folder that holds a run is refused to another one"


@pytest.mark.parametrize("name", ["showcas", "nothing"])
def test_a_name_that_is_not_there_is_refused(name):
    with pytest.raises(gallery.console.Refused, match="there is no picture"):
        gallery.redraw([name], False, False, None)


def test_without_a_checkout_a_sentence_says_where_the_program_is(monkeypatch, tmp_path):
    monkeypatch.setattr(parts, "PACKAGE", tmp_path / "ocean_sim")
    where = (
        "^gallery: the program that makes the pictures is in a checkout of the project, in figures/gallery/; use that$"
    )
    with pytest.raises(gallery.console.Refused, match=where):
        verb.gallery()
