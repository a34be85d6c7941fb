"""README and docs do what they say: every block of code is run, the quick ones here, the others in the slow suite."""

import re
import shlex
import shutil
import subprocess
import sys
from os import environ
from pathlib import Path
from typing import Any

import pytest
import typer

from ocean_sim.__main__ import answered, app
from ocean_sim.files.yaml_file import Location, SceneError, parsed
from ocean_sim.parts import PACKAGE, library
from ocean_sim.reading.scene import load, load_text
from ocean_sim.ship.shared.stability import Loading

ROOT = library("scenes").parent
PAGES = [ROOT / "README.md", *sorted(p for p in (ROOT / "docs").rglob("*.md") if "generated" not in p.parts)]
BLOCK = re.compile(r"^```(?:\{code-block\} )?(\w+)\n((?::\w+:[^\n]*\n)*)(.*?)^```$", re.M | re.S)
MISTAKE = re.compile(r"^mine\.yaml:(\d+):\d+: ([\w.]*\.)?(\w+): unknown key; did you mean '(\w+)'\?$")
CAPTION = re.compile(r":caption: (\S+)")
LOOKS = ("list", "check", "explain", "new", "hull", "schema")  # verbs that only look, in seconds
BY_SANDBOX = ("demo", "test", "docs")  # what `sandbox` does by itself: every build runs two of them
TUTORIALS = sorted((ROOT / "docs" / "tutorials").glob("*.py"))
QUICK = ("first_scene",)
LOADING = "loading.yaml"  # the caption of a loading condition, which a command on its page reads

pytestmark = pytest.mark.skipif(not (ROOT / "docs").is_dir(), reason="an installed package has no docs")


def blocks(page: Path, *languages: str) -> list[tuple[str, str]]:
    """The caption and the text of each block of code in these languages."""
    found = BLOCK.findall(page.read_text(encoding="utf-8"))
    captions = [(language, CAPTION.search(options), text) for language, options, text in found]
    return [(caption[1] if caption else "", text) for language, caption, text in captions if language in languages]


def commands(page: Path) -> list[list[str]]:
    """The command lines of a page, as words without the name of the program."""
    lines = [line for _, text in blocks(page, "sh") for line in text.splitlines() if line.strip()]
    words = [shlex.split(line, comments=True) for line in lines]
    assert all(line[0] in ("ocean-sim", "./sandbox") for line in words), f"{page}: {lines}"
    return [line[1:] for line in words if line[1] not in BY_SANDBOX]


def lay_out(page: Path) -> None:
    """The loading condition of a page, as a file where its commands run."""
    for caption, text in blocks(page, "yaml"):
        if caption == LOADING:
            Path(caption).write_text(text)


def with_commands() -> list[Path]:
    return [page for page in PAGES if commands(page)]


def test_there_is_something_to_look_at():
    assert len(PAGES) > 15 and len(with_commands()) >= 4
    assert sum(len(commands(page)) for page in PAGES) > 25


@pytest.mark.parametrize("page", with_commands(), ids=lambda page: page.stem)
def test_every_command_is_one_that_the_program_knows(page):
    group: Any = typer.main.get_command(app)
    for verb, *words in commands(page):
        group.commands[verb].make_context(verb, words)


def test_commands_that_only_look_do_what_they_promise(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    seen = set()
    for page in PAGES:
        lay_out(page)
        for words in commands(page):
            if words[0] in LOOKS and tuple(words) not in seen:
                seen.add(tuple(words))
                if words[0] == "new":
                    Path("mine.yaml").unlink(missing_ok=True)
                assert answered(words) == 0, (page.name, words, capsys.readouterr().err)
    assert len(seen) >= 8


@pytest.mark.parametrize("page", [ROOT / "README.md", ROOT / "docs" / "getting_started.md"], ids=lambda page: page.stem)
def test_a_mistake_in_the_scene_is_told_as_the_page_says(page):
    (scene,) = (text for _, text in blocks(page, "yaml") if text.startswith("title"))
    said = [line for _, text in blocks(page, "text") for line in text.splitlines() if line.startswith("mine.yaml:")]
    lines = scene.splitlines()
    for sentence in said:
        line, _, mistake, meant = MISTAKE.fullmatch(sentence).groups()
        assert meant in lines[int(line) - 1]
        lines[int(line) - 1] = lines[int(line) - 1].replace(meant, mistake, 1)
    with pytest.raises(SceneError) as caught:
        load_text("\n".join(lines), "mine.yaml", ROOT)
    assert said and [str(problem) for problem in caught.value.problems] == said


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page, "yaml")], ids=lambda page: page.stem)
def test_every_scene_in_the_docs_is_one(page):
    for caption, text in blocks(page, "yaml"):
        data = parsed(text, Location(page.name)).plain()
        if caption == LOADING:
            Loading.model_validate(data)
        else:
            load(
                data if not caption else {"basin": {"length": 9.0, "depth": 3.0}, "fluid": "thesis_6000", "wind": data}
            )


def test_no_block_of_code_is_where_nothing_runs_it():
    """Commands and scenes are run on any page, Python on the two pages that tests below run whole; `text` is output."""
    opened = re.compile(r"^```(\{[\w-]+\})?[ ]?(\w*)[^\n]*\n.*?^```$", re.M | re.S)
    for page in PAGES:
        for directive, language in opened.findall(page.read_text(encoding="utf-8")):
            if directive in ("", "{code-block}"):
                allowed = {"sh", "yaml", "text"} | ({"python"} if page.stem in ("python", "extending") else set())
                assert language in allowed, f"{page}: nothing runs a block of {language or 'no language'}"


def test_every_python_block_is_python():
    for page in PAGES:
        for caption, text in blocks(page, "python"):
            compile(text, f"{page.name} {caption}", "exec")


def run(script: Path, folder: Path, **more: str) -> None:
    done = subprocess.run(
        [sys.executable, str(script)], cwd=folder, env=environ | more, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]


@pytest.mark.parametrize(
    "script",
    [pytest.param(path, marks=[] if path.stem in QUICK else [pytest.mark.slow]) for path in TUTORIALS],
    ids=lambda path: path.stem,
)
def test_a_tutorial_runs_and_keeps_what_it_asserts(script, tmp_path):
    run(script, tmp_path, PYTHONPATH=str(PACKAGE.parent))


@pytest.mark.slow
@pytest.mark.parametrize("page", with_commands(), ids=lambda page: page.stem)
def test_the_commands_of_a_page_run_in_their_order(page, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    lay_out(page)
    for words in commands(page):
        done = subprocess.run(
            [sys.executable, "-m", "ocean_sim", *words],
            env=environ | {"PYTHONPATH": str(PACKAGE.parent)},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, (words, done.stdout[-1000:], done.stderr[-1000:])


@pytest.mark.slow
def test_what_the_page_on_python_shows_runs(tmp_path):
    text = "\n".join(text for _, text in blocks(ROOT / "docs" / "guide" / "python.md", "python"))
    (tmp_path / "shown.py").write_text(text)
    run(tmp_path / "shown.py", tmp_path, PYTHONPATH=str(PACKAGE.parent))


ADDED = """
import sys
from math import isfinite
from pathlib import Path
import ocean_sim
from ocean_sim.simulation import Simulation
OFF = dict.fromkeys(("frames", "render", "report", "timings"))
TANK = {"basin": {"length": 6.0, "width": 6.0, "depth": 2.0}, "duration": 0.05, "accuracy": {"every": 0.01}} | OFF
SPH = {"kind": "mueller", "spacing": 0.5}
BOX = {"kind": "planing", "hull": "wigley"}
SEA = {"kind": "linear_waves", "height": 0.0, "period": 3.0}
scenes = {
    "wind": TANK | {"fluid": SPH, "wind": {"kind": "squall_line", "speed": 60.0}, "fastest": {"every": 0.02}},
    "preset": TANK | {"fluid": SPH, "wind": "harbour"},
    "scheme": TANK | {"fluid": SPH | {"kind": "tait"}},
    "surface": TANK | {"fluid": SPH, "surface": "mean_level"},
    "ship": TANK | {"fluid": SEA, "ship": BOX | {"velocity": [0.0, 0.0, 2.0]}},
}
for name, data in scenes.items():
    ocean_sim.run(ocean_sim.load(data), out=f"runs/{name}")
result = lambda name: ocean_sim.result.Result(Path("runs") / name)
import ocean_sim.result
assert result("wind").accuracy["impulse_wind_x_Ns"][-1] > 0.0
assert result("wind").table("fastest")["speed_m_s"][-1] > 0.0
assert isfinite(result("scheme").accuracy["kinetic_energy_J"][-1])
assert result("ship").motion["force_lift_y_N"].max() > 0.0
"""


@pytest.mark.slow
def test_the_additions_of_the_page_on_extending_are_one_file_each(tmp_path):
    """Each is written into a copy of the program, where a scene names it."""
    copy = tmp_path / "copy"
    shutil.copytree(PACKAGE, copy / "ocean_sim", ignore=shutil.ignore_patterns("__pycache__", "scenes", "configs"))
    for folder in ("scenes", "configs", "figures"):
        shutil.copytree(library(folder), copy / folder)
    added = blocks(ROOT / "docs" / "extending.md", "python", "yaml")
    assert len(added) == 6
    for caption, text in added:
        assert not (copy / caption).exists()
        (copy / caption).write_text(text)
    (tmp_path / "use.py").write_text(ADDED)
    run(tmp_path / "use.py", tmp_path, PYTHONPATH=str(copy))


def test_every_reader_of_a_file_that_a_scene_names_has_its_rules_on_the_page(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "docs"))
    from generate import checked_files, checks

    elsewhere = {"seakeeping.py": "radiation.py", "stream.py": "datagrams.py", "shapes.py": "mesh.py"}  # who reads them
    readers = [path for path in PACKAGE.rglob("*.py") if re.search(r"^    \w+: (Any)?FileName", path.read_text(), re.M)]
    known = {path.name for path in PACKAGE.rglob("*.py") if "\nCHECKS = " in path.read_text()}
    assert len(readers) >= 9 and all(elsewhere.get(path.name, path.name) in known for path in readers)
    page = checked_files()
    for checked in checks():
        assert f"\n## {checked.title}\n" in page
        for rule in checked.rules:
            assert rule.sentence in page and rule in str(rule.broken("a.csv", "it is wrong"))
