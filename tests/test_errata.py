"""The errata of the thesis: the script runs, and its numbers are those of closed forms."""

import csv
import subprocess
import sys

import pytest

from ocean_sim.parts import library


@pytest.fixture(scope="module")
def rows():
    script = library("figures") / "errata.py"
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return {row["where"]: row for row in csv.DictReader(done.stdout.splitlines())}


@pytest.mark.parametrize(
    "where, as_printed, corrected, tolerance",
    [
        ("(2.14), (2.27)", 50.0 / 70.0, 0.0, 1e-5),  # (60 - 10) / (60 + 10) kPa
        ("(2.20), (2.22)", 0.0888125, 0.177625, 1e-5),
        ("(2.22), v", 0.177625, 0.0394297, 1e-5),
        ("(2.23)", -0.06125, 0.06125, 1e-5),
        ("(2.24)", 0.5**0.5, 1.0, 0.02),
    ],
)
def test_the_numbers_are_right(rows, where, as_printed, corrected, tolerance):
    row = rows[where]
    assert float(row["as_printed"]) == pytest.approx(as_printed, abs=tolerance)
    assert float(row["corrected"]) == pytest.approx(corrected, abs=tolerance)
    assert float(row["difference"]) == pytest.approx(as_printed - corrected, abs=2 * tolerance)
    assert row["why"] and row["unit"]


def test_every_row_differs(rows):
    assert len(rows) == 5 and all(abs(float(row["difference"])) > 0.0 for row in rows.values())
