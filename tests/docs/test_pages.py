"""README and docs do what they say: every block of code is run, the quick ones here, the others in the slow suite."""

import re
import shlex
import shutil
import subprocess
import sys
from os import environ
from pathlib import Path

import pytest

from ocean_sim.__main__ import command_of, run_command_line
from ocean_sim.files.yaml_file import Location, SceneError, parse_yaml
from ocean_sim.parts import PACKAGE, library
from ocean_sim.reading.scene import load, load_text
from ocean_sim.ship.naval.stability import Loading

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
    for verb, *words in commands(page):
        command_of(verb).make_context(verb, words)


@pytest.mark.anchor
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
                assert run_command_line(words) == 0, (page.name, words, capsys.readouterr().err)
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
        data = parse_yaml(text, Location(page.name)).plain()
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
SQUALLS = {"kind": "squall_line"}
WAVES = {"kind": "linear_waves", "height": 0.1, "period": 1.9, "rim": {"width": 1.0}}
PATCH = TANK | {"basin": TANK["basin"] | {"walls": "periodic"}, "sea": WAVES}
SPH = {"kind": "mueller", "spacing": 0.5}
BOX = {"kind": "planing", "hull": "wigley"}
SEA = {"kind": "linear_waves", "height": 0.0, "period": 3.0}
scenes = {
    "wind": TANK | {"fluid": SPH, "wind": SQUALLS | {"speed": 60.0}, "fastest": {"every": 0.02}},
    "preset": TANK | {"fluid": SPH, "wind": "harbour"},
    "scheme": TANK | {"fluid": SPH | {"kind": "tait"}},
    "surface": TANK | {"fluid": SPH, "surface": "mean_level"},
    "ship": TANK | {"fluid": SEA, "ship": BOX | {"velocity": [0.0, 0.0, 2.0]}},
    "patch": PATCH | {"fluid": SPH, "surface": "mean_level", "ship": BOX, "wind": SQUALLS | {"speed": 600.0}},
}
for name, data in scenes.items():
    ocean_sim.run(ocean_sim.load(data), out=f"runs/{name}")
result = lambda name: ocean_sim.result.Result(Path("runs") / name)
import ocean_sim.result
assert result("wind").accuracy["impulse_wind_x_Ns"][-1] > 0.0
assert result("wind").table("fastest")["speed_m_s"][-1] > 0.0
assert isfinite(result("scheme").accuracy["kinetic_energy_J"][-1])
assert result("ship").motion["force_lift_y_N"].max() > 0.0
assert result("patch").accuracy["impulse_wind_x_Ns"][-1] > 0.0
assert result("patch").motion["force_wind_drag_x_N"].max() > 0.0
"""


ADDITIONS = dict(blocks(ROOT / "docs" / "extending.md", "python", "yaml")) if (ROOT / "docs").is_dir() else {}


@pytest.fixture(scope="module")
def extended(tmp_path_factory):
    """A copy of the program with each addition of the page on extending in the file that its caption names."""
    copy = tmp_path_factory.mktemp("extended")
    without = shutil.ignore_patterns("__pycache__", "scenes", "configs")
    for folder in (PACKAGE, ROOT / "tests", *map(library, ("scenes", "configs", "figures"))):
        shutil.copytree(folder, copy / folder.name, ignore=without)
    shutil.copy(ROOT / "pyproject.toml", copy)
    (copy / "docs").mkdir()
    shutil.copy(ROOT / "docs" / "test_costs.csv", copy / "docs")
    assert len(ADDITIONS) == 7
    for caption, text in ADDITIONS.items():
        assert not (copy / caption).exists()
        (copy / caption).write_text(text)
    return copy


def in_copy(copy: Path, *words: str) -> None:
    """A command of Python on a copy of the program."""
    command = [sys.executable, "-m", *words]
    done = subprocess.run(
        command, cwd=copy, env=environ | {"PYTHONPATH": str(copy)}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]


def test_the_additions_of_the_page_on_extending_keep_their_contracts(extended):
    modules = [caption for caption in ADDITIONS if caption.startswith("ocean_sim/")]
    assert len(modules) == 5
    in_copy(extended, "mypy", f"--cache-dir={ROOT / '.mypy_cache' / 'extended'}", *modules)


def test_the_test_of_the_page_on_extending_passes(extended):
    (test,) = [caption for caption in ADDITIONS if caption.startswith("tests/")]
    in_copy(extended, "pytest", "-q", "-p", "no:cacheprovider", test)


@pytest.mark.slow
def test_the_additions_of_the_page_on_extending_are_one_file_each(extended, tmp_path):
    """A scene names each; the wind also blows over a patch of open sea, on water and ship."""
    (tmp_path / "use.py").write_text(ADDED)
    run(tmp_path / "use.py", tmp_path, PYTHONPATH=str(extended))


def test_every_reader_of_a_file_that_a_scene_names_has_its_rules_on_the_page(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "docs"))
    from generate import checked_files, checks

    elsewhere = {
        "dynamic.py": "radiation.py",
        "floating.py": "drift.py",
        "stream.py": "datagrams.py",
        "shapes.py": "mesh.py",
        "__init__.py": "bathymetry.py",
    }  # who reads them
    readers = [path for path in PACKAGE.rglob("*.py") if re.search(r"^    \w+: (Any)?FileName", path.read_text(), re.M)]
    known = {path.name for path in PACKAGE.rglob("*.py") if "\nCHECKS = " in path.read_text()}
    assert len(readers) >= 8 and all(elsewhere.get(path.name, path.name) in known for path in readers)
    page = checked_files()
    for checked in checks():
        assert f"\n## {checked.title}\n" in page
        for rule in checked.rules:
            assert rule.sentence in page and rule in str(rule.broken("a.csv", "it is wrong"))


def test_every_term_of_a_scheme_stands_by_its_equation_and_links_to_its_code(monkeypatch):
    """And nothing is linked to that is no term."""
    monkeypatch.syspath_prepend(str(ROOT / "docs"))
    import generate

    page = (ROOT / "docs" / "theory" / "sph.md").read_text(encoding="utf-8")
    linked = re.findall(r"\[`([\w.]+)`\]\(#(\w+)\.([\w.]+)\):\n\n\$\$", page)
    assert all(shown == name for shown, _, name in linked)
    terms = [(scheme, name) for scheme in generate.SCHEMES for name in generate.terms_of(scheme)]
    assert sorted((scheme, name) for _, scheme, name in linked) == sorted(terms)
    assert all(f"({scheme}.{name})=" in generate.terms() for scheme, name in terms)


def test_rows_that_only_detect_regressions_are_counted_apart(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "docs"))
    import generate

    row = {"quantity": "front", "scheme": "delta_sph", "unit": "%", "ok": "True"}
    judge = row | {"error": "1.0", "tolerance": "2.0", "source": "theory"}
    alarm = row | {"error": "-9.0", "tolerance": "11.0", "source": f"theory; {generate.COARSE_BASIS}"}
    reported = row | {"error": "", "tolerance": "", "source": "theory"}
    kept, words = generate.line_of("tank", [alarm, judge, reported])
    assert kept == "[tank](#tank) 1\u00a0of\u00a01"
    assert "error 1\u00a0%, tolerance 2\u00a0%; 1 for regressions only, with errors up to -9\u00a0%" in words
    assert [generate.verdict(each) for each in (alarm, judge, reported)] == ["no regression", "kept", "reported"]
    rows = [each | {"case": "couette", "value": "", "reference": ""} for each in (alarm, judge, reported)]
    late = rows[0] | {"ok": "False", "quantity": "back"}, rows[1] | {"ok": "False"}
    monkeypatch.setattr(generate, "rows_of", lambda name: [*rows, *late])
    page = generate.validation()
    assert "5 rows; 1 of 2 tolerances kept. Missed: [couette](#couette) 1. 2 more rows only" in page
    assert "beyond it now: [couette](#couette), back, error -9" in page and "<summary>Misses: 1</summary>" in page


@pytest.mark.parametrize("page", sorted((ROOT / "docs" / "guide").glob("*.md")), ids=lambda page: page.stem)
def test_a_guide_is_a_how_to_of_at_most_500_words(page):
    assert len(page.read_text(encoding="utf-8").split()) <= 500, "move what was measured to docs/measurements"


def test_pages_that_are_read_as_files_show_no_tree_of_pages():
    assert [page.name for page in PAGES if "{toctree}" in page.read_text(encoding="utf-8")] == []
