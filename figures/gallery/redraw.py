"""The README's pictures, redrawn by their commands, and a list of those older than the code they show.

`ocean-sim gallery` calls it in a checkout of the project.
"""

import ast
import hashlib
import json
import os
import shlex
import subprocess
import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from ocean_sim import pictures
from ocean_sim.conventions import Failed
from ocean_sim.files.atomic_file import atomic_write, write_facts
from ocean_sim.files.input_file import read_json_object
from ocean_sim.files.yaml_file import read_mapping
from ocean_sim.model import Model
from ocean_sim.parts import PACKAGE, KindConfig, library, slot_of
from ocean_sim.reading.scene import load
from ocean_sim.reading.translation import choice_sentence
from ocean_sim.verbs.shared import console

LIST_FILE, STAMP_FILE = "gallery.yaml", "stamps.json"
PICTURE_SIZE, JPEG_QUALITY = "1280x720", 88  # of a picture, and as a JPEG
LAW_SLOTS = ("sea", "wind", "fluid", "surface", "ship")  # slots whose kinds make what a picture shows


class Entry(Model):
    """One picture of the gallery: file, caption, scene and its end time, drawing command, and code it depends on."""

    picture: str
    about: str
    scene: str
    until: float
    draw: str
    code: list[str] = []
    """Patterns of the package's files that make what is shown and that `pictures.LOOK_VERSION` says nothing of."""

    def files(self) -> list[Path]:
        """Source files on which the picture depends: those of the kinds in its scene, and those it names as `code`."""
        kinds = {f"{slot_of(place)}/{part.kind}.py" for place, part in shown_parts(self.scene).items()}
        return [path for pattern in [*sorted(kinds), *self.code] for path in sorted(PACKAGE.glob(pattern))]

    @property
    def stamp(self) -> str:
        """Hash of the scene, presets, drawing command, code and look; if it changes, the picture is out of date."""
        scene = read_mapping(library("scenes") / f"{self.scene}.yaml").plain()
        asked = [
            {key: value for key, value in scene.items() if key != "title"},
            self.until,
            self.draw,
            pictures.LOOK_VERSION,
        ]
        asked += [part.model_dump(mode="json", exclude_defaults=True) for part in shown_parts(self.scene).values()]
        asked += [code_lines(path.read_text(encoding="utf-8")) for path in self.files()]
        return hashlib.sha256(json.dumps(asked, sort_keys=True).encode()).hexdigest()[:16]

    def commands(self, run: str) -> tuple[list[str], list[str]]:
        """Arguments of two `ocean-sim` commands: one simulates the scene into folder `run`, one draws its picture."""
        verb, *options = shlex.split(self.draw)
        looks = ["--no-film", "--quality", "final", "--size", PICTURE_SIZE] if verb == "render" else []
        drawing = [verb, run, *options, *looks]
        return ["run", self.scene, "--until", f"{self.until:g}", "--set", "render=null", "--out", run], drawing


@cache
def shown_parts(scene: str) -> dict[str, KindConfig]:
    """Configs of a packaged scene's slots that pictures show (LAW_SLOTS), by path such as `wind`, `ships.tug`."""
    parts = load(scene).parts().items()
    return {place: part for place, part in parts if isinstance(part, KindConfig) and slot_of(place) in LAW_SLOTS}


def code_lines(code: str) -> list[str]:
    """Lines of Python code that compute: without docstrings, comment lines and empty lines."""
    texts = [node for node in ast.walk(ast.parse(code)) if isinstance(node, ast.Expr)]
    said = {
        n
        for node in texts
        if isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
        for n in range(node.lineno, (node.end_lineno or node.lineno) + 1)
    }
    lines = [(n, line.strip()) for n, line in enumerate(code.splitlines(), 1)]
    return [line for n, line in lines if line and not line.startswith("#") and n not in said]


def gallery_entries() -> list[Entry]:
    listed = read_mapping(library("figures") / "gallery" / LIST_FILE).plain()["pictures"]
    return [Entry.model_validate(row) for row in listed]


def stale_entries(folder: Path) -> list[Entry]:
    """Entries whose picture is missing from a folder, or whose stamp there differs from the present one."""
    known = read_json_object(folder / STAMP_FILE)
    old = lambda entry: not (folder / entry.picture).exists() or known.get(entry.picture) != entry.stamp
    return [entry for entry in gallery_entries() if old(entry)]


def redraw(names: list[str], check: bool, every: bool, out: Path | None) -> int:
    """Make the pictures that are out of date, or those of these `names`, or `every` one; `check`: only list the
    outdated ones, and return exit code 1 if there are any."""
    folder = out or library("figures") / "gallery"
    known = {entry.picture.split(".")[0]: entry for entry in gallery_entries()}
    for name in names:
        if name not in known:
            raise console.Refused(f"there is no picture {name!r}{choice_sentence(name, list(known))[0]}")
    if check:
        old = stale_entries(folder)
        console.answer([{"picture": entry.picture, "commands": show_entry(entry)} for entry in old])
        for entry in old:
            console.say("\n  ".join([f"{entry.picture} is older than what draws it", *show_entry(entry)]))
        return int(bool(old))
    folder.mkdir(parents=True, exist_ok=True)
    wanted = [known[name] for name in names] or (list(known.values()) if every else stale_entries(folder))
    made = []
    with TemporaryDirectory() as place:
        for entry in wanted:
            run = Path(place, f"{entry.scene.replace('/', '_')}_{entry.until:g}")
            simulate, draw = entry.commands(str(run))
            if not run.exists():
                console.say(f"{entry.scene} until {entry.until:g} s")
                command_line(simulate)
            drawn = Path(place, entry.picture)
            command_line([*draw, "--out", str(drawn)])
            keep_picture(drawn, folder / entry.picture)
            stamps = read_json_object(folder / STAMP_FILE) | {entry.picture: entry.stamp}
            write_facts(folder / STAMP_FILE, dict(sorted(stamps.items())))
            made.append(folder / entry.picture)
            console.say(str(made[-1]))
    console.answer({"files": made})
    return 0


def show_entry(entry: Entry) -> list[str]:
    """Command lines to print, with which a person can make the picture of an entry."""
    run = f"runs/{entry.scene.split('/')[-1]}_to_{entry.until:g}"  # never the folder of `run` itself, or of the demo
    return [f"ocean-sim {shlex.join(words)}" for words in entry.commands(run)]


def command_line(words: list[str]) -> None:
    """Run `ocean-sim` with these arguments in a child process; raises Failed."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(PACKAGE.parent), os.environ.get("PYTHONPATH", "")])}
    command = [sys.executable, "-m", "ocean_sim", *words]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, stdin=subprocess.DEVNULL)
    if done.returncode:
        lines = done.stderr.strip().splitlines() or ["it ended without a message"]
        raise Failed(f"`ocean-sim {shlex.join(words)}` failed: {lines[-1]}")


def keep_picture(drawn: Path, path: Path) -> None:
    """Convert the picture that a command drew at `drawn` to the JPEG or PNG file `path` of the gallery."""
    from PIL import Image

    found = sorted(drawn.glob("still_*.png")) or [drawn / "motion.png"]
    with Image.open(found[0]) as image, atomic_write(path) as draft:
        if path.suffix == ".jpg":
            image.convert("RGB").save(draft, "JPEG", quality=JPEG_QUALITY, optimize=True)
        else:
            image.save(draft, "PNG", optimize=True)
