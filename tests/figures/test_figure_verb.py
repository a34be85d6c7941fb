"""`ocean-sim figure` and `list figures`."""

import json

import pytest

from ocean_sim.__main__ import run_command_line
from ocean_sim.parts import library
from ocean_sim.verbs import figure

GOOD = '''"""Figure 1-1: a dot.

More of it.
"""
import sys
from pathlib import Path
print("noise for nobody")
print(" 50%  half way", file=sys.stderr)
out = Path(sys.argv[sys.argv.index("--out") + 1])
(out / "fig1_1.csv").write_text("fast\\n" if "--fast" in sys.argv else "whole\\n")
(out / "fig1_1.png").write_bytes(b"picture")
'''
BAD = '''"""Figure 1-2: none."""
import sys
from pathlib import Path
(Path(sys.argv[sys.argv.index("--out") + 1]) / "fig1_2.csv").write_text("half")
raise ValueError("no ink")
'''


@pytest.fixture
def scripts(tmp_path, monkeypatch):
    """Two figures, the second of which fails, and one that is shared code."""
    folder = tmp_path / "figures"
    folder.mkdir()
    for name, text in (("fig1_2", BAD), ("fig1_1", GOOD), ("_shared", GOOD), ("errata", GOOD), ("ours", BAD)):
        (folder / f"{name}.py").write_text(text)
    monkeypatch.setattr(figure, "library", lambda name: folder)
    return folder


def test_names_are_those_of_the_thesis_in_its_order():
    names = list(figure.figure_scripts())
    assert names[:3] == ["2-1", "2-2", "3-2"] and names[-5:] == [
        "errata",
        "stability",
        "open-sea",
        "speed-accuracy",
        "yacht-kinds",
    ]
    assert names.index("6-9") < names.index("6-10")
    assert len(names) == len(list(library("figures").glob("[!_]*.py")))


def test_list_says_what_each_figure_is(capsys):
    assert run_command_line(["list", "figures", "--json"]) == 0
    rows = {row["name"]: row["sentence"] for row in json.loads(capsys.readouterr().out)}
    assert rows.keys() == figure.figure_scripts().keys()
    assert all(sentence and "python figures/" not in sentence for sentence in rows.values())


def test_a_wrong_name_is_told_before_anything_is_drawn(tmp_path, capsys):
    out = tmp_path / "out"
    assert run_command_line(["figure", "3-7", "6-33", "--out", str(out)]) == 2
    assert "there is no figure '6-33'; did you mean '6-3'?" in capsys.readouterr().err
    assert not out.exists()


def test_no_name_is_a_question_of_use(capsys):
    assert run_command_line(["figure"]) == 2


def test_all_goes_on_past_a_figure_that_fails_and_leaves_nothing_half(scripts, tmp_path, capsys):
    out = tmp_path / "out"
    assert run_command_line(["figure", "all", "--fast", "--out", str(out)]) == 1
    printed = capsys.readouterr()
    assert "[1/3] Figure 1-1: a dot." in printed.out and "FAILED: ValueError: no ink" in printed.out
    assert "1 of 3 figures failed: 1-2" in printed.err
    assert sorted(path.name for path in out.iterdir()) == ["fig1_1.csv", "fig1_1.png"]
    assert (out / "fig1_1.csv").read_text() == "fast\n" and "noise" not in printed.out


def test_json_tells_files_and_failures(scripts, tmp_path, capsys):
    out = tmp_path / "out"
    assert run_command_line(["figure", "1-2", "1-1", "1-1", "--json", "--out", str(out)]) == 1
    first, second = json.loads(capsys.readouterr().out)
    assert (first["figure"], first["ok"], first["error"]) == ("1-2", False, "ValueError: no ink")
    assert second["ok"] and second["files"] == [str(out / "fig1_1.csv"), str(out / "fig1_1.png")]
    assert (out / "fig1_1.csv").read_text() == "whole\n"
