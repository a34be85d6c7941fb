"""The errata of the thesis: the script runs, and its numbers are those of closed forms."""

import csv
import os
import subprocess
import sys

import pytest

from ocean_sim.parts import PACKAGE, library


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    out = tmp_path_factory.mktemp("errata")
    command = [sys.executable, str(library("figures") / "errata.py"), "--out", str(out)]
    here = os.environ | {"PYTHONPATH": str(PACKAGE.parent)}
    done = subprocess.run(command, capture_output=True, text=True, env=here)
    assert done.returncode == 0, done.stderr
    assert (out / "errata.csv").read_text() == done.stdout and (out / "errata.png").stat().st_size > 10_000
    return {row["where"]: row for row in csv.DictReader(done.stdout.splitlines())}


@pytest.mark.parametrize(
    "where, as_printed, corrected, tolerance",
    [
        ("(2.14), (2.27)", 50.0 / 70.0, 0.0, 1e-5),  # (60 - 10) / (60 + 10) kPa
        ("(2.20), (2.22)", 0.0888125, 0.177625, 1e-5),
        ("(2.22), v", 0.177625, 0.0394297, 1e-5),
        ("(2.23)", -0.06125, 0.06125, 1e-5),
        ("(2.24)", 0.5**0.5, 1.0, 0.02),
        ("(3.2) to (3.4)", 4.0, 2.0, 1e-9),
        ("3.3.2, Figure 3-7", 48.59, 48.6066, 1e-4),
        ("5.2.3: 0.02", 0.047898, 0.027898, 1e-6),
        ("5.2.3: Eye", 1.0, 0.027898, 1e-6),
        ("Algorithm 5", 33.0**2 * 6144.0, 4.0 * 32.0**2, 1e-9),  # a node touches the four around it, at a wall fewer
        ("4.3: -rho V", -3.2e5, 3139200.0, 1e-3),
        ("5.3: addBuoyancy", 7848000.0, 6278400.0, 1e-3),
        ("5.3: lever", 1.0 / 6.0, 7.0 / 6.0, 1e-5),
        ("5.3: getWaveHeight", 1.125, 1.03, 1e-9),
        ("Algorithm 7", 9.81 / 60.0, 9.81, 1e-9),
    ],
)
def test_the_numbers_are_right(rows, where, as_printed, corrected, tolerance):
    row = rows[where]
    assert float(row["as_printed"]) == pytest.approx(as_printed, abs=tolerance)
    assert float(row["corrected"]) == pytest.approx(corrected, abs=tolerance)
    assert float(row["difference"]) == pytest.approx(as_printed - corrected, abs=2 * tolerance)
    assert row["why"] and row["unit"]


def test_every_row_differs(rows):
    assert len(rows) == 26
    for where, row in rows.items():
        assert where == "(3.8)" or abs(float(row["difference"])) > 0.0
    assert rows["(3.8)"]["as_printed"] == "nan" and float(rows["(3.8)"]["corrected"]) == pytest.approx(0.0203732)


def test_the_program_gives_what_is_right(rows):
    """But for the pairs that cells leave to be looked at, which are more than those that touch."""
    for where, row in rows.items():
        if where != "Algorithm 5":
            tolerance = 0.02 if where == "(2.24)" else 1e-4
            assert float(row["measured"]) == pytest.approx(float(row["corrected"]), rel=tolerance, abs=1e-6), where
    pairs = rows["Algorithm 5"]
    assert float(pairs["corrected"]) <= float(pairs["measured"]) < 0.01 * float(pairs["as_printed"])
