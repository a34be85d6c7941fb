"""Tables are read in one place, by one rule of what a cell is."""

import numpy as np
import pytest

from ocean_sim.files import csv_file
from ocean_sim.files.input_file import Unreadable


@pytest.fixture
def file(tmp_path):
    """Writes a table and gives its path."""

    def written(text: str):
        path = tmp_path / "t.csv"
        path.write_text(text)
        return path

    return written


def test_an_empty_cell_is_nan_among_numbers_and_empty_among_words(file):
    table = csv_file.read_columns(file("# rate: 3\n\ntime_s, a,word\n0,1.5,one\n# a remark\n1,,\n2, ,3\n"))
    assert list(table) == ["time_s", "a", "word"] and table["time_s"].tolist() == [0.0, 1.0, 2.0]
    assert table["a"][0] == 1.5 and np.isnan(table["a"][1:]).all()
    assert table["word"].tolist() == ["one", "", "3"]


def test_a_table_of_numbers_has_nan_where_a_word_is(file):
    table = csv_file.Table(file("a,b\n1,\nx,-2e3\n,nan\n"))
    np.testing.assert_array_equal(table["a"], [1.0, np.nan, np.nan])
    np.testing.assert_array_equal(table["b"], [np.nan, -2000.0, np.nan])


def test_all_readers_read_the_same_numbers(file):
    """The quick way, of a table that has nothing else, and the one cell by cell."""
    values = np.random.default_rng(3).normal(size=(50, 2)) * 10.0 ** np.arange(-25, 25)[:, None]
    rows = "".join(f"{a:.17g},{b:.9g}\n" for a, b in values)
    quick, slow = (
        csv_file.Table(file("a,b\n" + rows)),
        csv_file.read_columns(file("a,b,c\n" + rows.replace("\n", ",w\n"))),
    )
    assert quick["a"].tolist() == slow["a"].tolist() == values[:, 0].tolist()
    assert quick["b"].tolist() == slow["b"].tolist()


def test_a_line_that_a_killed_run_did_not_finish_is_no_row(file):
    for torn in ("1,2\n3,4\n5", "1,2\n3,4\n"):
        assert csv_file.read_columns(file("a,b\n" + torn))["a"].tolist() == [1.0, 3.0]
    assert csv_file.read_columns(file("a,b\n1,2\n3,4"))["b"].tolist() == [2.0]  # it may have been 3,45
    assert csv_file.read_columns(file("a,b\n1,2\n\0\0\0\0"))["b"].tolist() == [2.0]  # as a power cut leaves it
    assert csv_file.read_columns(file("a,b")) == {}
    for uneven in ("a,b\n1\n3,4\n", "a,b\n1,2\n3\n", "a,b\n1,2,3\n"):
        with pytest.raises(Unreadable, match=r"row \d \(line \d\) has \d cells under 2 names"):
            csv_file.read_columns(file(uneven))
    with pytest.raises(Unreadable, match=r"row 3 \(line 6\) has 1 cells under 2 names, '5'"):
        csv_file.Table(file("# from: me\na,b\n1,2\n\n3,4\n5"))


def test_a_table_without_rows_or_without_a_heading(file):
    table = csv_file.read_columns(file("# a remark\na,b\n"))
    assert list(table) == ["a", "b"] and len(table["a"]) == 0
    assert csv_file.read_columns(file("# a remark\n")) == {} == csv_file.read_columns(file(""))
    with pytest.raises(Unreadable, match="no rows under a heading"):
        csv_file.Table(file("a,b\n"))
    with pytest.raises(Unreadable, match="two columns 'a'"):
        csv_file.read_columns(file("a,a\n1,2\n"))


def test_a_cell_in_quotes_holds_commas(file):
    text = '# of: me\na,b\n"1",\n2,"x, ""y"""\n'
    assert csv_file.read_columns(file(text))["a"].tolist() == [1.0, 2.0]
    assert csv_file.read_columns(file(text))["b"].tolist() == ["", 'x, "y"']
    assert csv_file.read_records(text) == [{"a": "1", "b": ""}, {"a": "2", "b": 'x, "y"'}]
    assert csv_file.split_lines(text).head == {"of": "me"}


@pytest.mark.parametrize("cell, shown", [("", "empty"), ("word", "'word'"), ("inf", "'inf'"), ("nan", "'nan'")])
def test_the_first_cell_that_is_no_finite_number_is_named(file, cell, shown):
    table = csv_file.Table(file(f"a,b,c\n1,2,x\n1,2,\n1,{cell},3\n{cell},2,3\n"))
    with pytest.raises(Unreadable, match=f"t.csv: b is {shown} in row 3"):
        table.finite("a", "b")


DIALECTS = {
    "comma": lambda row: ",".join(row),
    "semicolon and decimal comma": lambda row: ";".join(row).replace(".", ","),
    "tab": lambda row: "\t".join(row),
    "spaces": lambda row: "   ".join(row),
    "quotes and decimal comma": lambda row: ",".join(f'"{cell}"' for cell in row).replace(".", ","),
}


@pytest.mark.parametrize("seed", range(20))
def test_a_table_has_the_same_numbers_in_every_dialect(file, seed):
    rng = np.random.default_rng(seed)
    values = rng.normal(size=(rng.integers(2, 30), rng.integers(2, 6))) * 10.0 ** rng.integers(-8, 9)
    values[:, 0] = np.sort(np.abs(values[:, 0])) + rng.choice([0.0, 1e5, 2e9])
    names = ["time_s", *(f"x{k}_m" for k in range(1, values.shape[1]))]
    form = rng.choice([".3f", ".9e", ".12g", ".0f"])
    rows = [[format(value, form) for value in row] for row in values]
    wanted = [[float(cell) for cell in column] for column in zip(*rows)]
    for name, written in DIALECTS.items():
        table = csv_file.Table(file("# from: me\n" + "\n".join(map(written, [names, *rows])) + "\n"))
        assert [column.tolist() for column in table.finite(*names)] == wanted, name
        assert list(table) == names and table.head == {"from": "me"}


def test_a_table_of_two_dialects_is_refused(file):
    for text, said in {
        "time_s;x_m\n0,5;1.25\n": r"it has '0,5' and, up to row 1 \(line 2\), '1.25'",
        'time_s,x_m\n0.5,"1,25"\n': r"it has '1,25' and, up to row 1 \(line 2\), '0.5'",
        "time_s,x_m\n0,5,1,25\n": r"row 1 \(line 2\) has 4 cells under 2 names.* decimal comma",
        "time_s\tx_m\n0.5;1\n": r"row 1 \(line 2\) has 1 cells under 2 names",
    }.items():
        with pytest.raises(Unreadable, match=said):
            csv_file.Table(file(text))
    with pytest.raises(Unreadable, match=r"x_m is '1\.234,5' in row 1"):  # a point between thousands
        csv_file.Table(file("time_s;x_m\n1;1.234,5\n2;0,5\n")).finite("x_m")


def test_times_are_dates_or_seconds_and_rise(file):
    for cells in (
        ("2024-03-01T12:00:00", "2024-03-01T12:00:00.5"),
        ("2024-03-01 12:00:00Z", "2024-03-01T13:00:00.5+01:00"),
        ("09:12:00", "09:12:00.500"),
    ):
        [time, x] = csv_file.Table(file("sep=;\ntime_s;x_m\n" + "".join(f"{cell};1\n" for cell in cells))).series("x_m")
        assert time.tolist() == [0.0, 0.5] and x.tolist() == [1.0, 1.0]
    for offset in (0.0, 1e5, 2e9):
        times = offset + 0.02 * np.arange(50)
        for rows, said in {
            (*range(20), 21, 20, *range(22, 50)): r"in row 22 \(line 23\); times rise",
            (*range(20), 19, *range(20, 50)): r"in row 21 \(line 22\); times rise",
        }.items():
            with pytest.raises(Unreadable, match=said):
                csv_file.Table(file("time_s\n" + "".join(f"{times[k]:.3f}\n" for k in rows))).series()
    for cells in (["2024-03-01", "2024-03-02"], ["2024-03-01T12:00:00", "2"], ["12:00", "2024-03-01T12:00:00"]):
        with pytest.raises(Unreadable, match=f"time_s is '{cells[0]}' in row 1"):
            csv_file.Table(file("time_s,x_m\n" + "".join(f"{cell},1\n" for cell in cells))).series("x_m")


@pytest.mark.parametrize("wrong", ["2026-05-17T09:12:5Z", "2026-05-32T09:12:05Z", "2016-12-31T23:59:60Z", "5"])
def test_one_bad_date_is_named_where_it_stands(file, wrong):
    cells = [f"2026-05-17T09:12:{second:02}Z" for second in range(9)]
    with pytest.raises(Unreadable, match=rf"time_s is '{wrong}' in row 6 \(line 7\)"):
        csv_file.Table(file("\n".join(["time_s", *cells[:5], wrong, *cells[6:]]))).series()


@pytest.mark.parametrize("cells", [("604799.8", "604799.9", "0.0"), ("23:59:59.8", "23:59:59.9", "00:00:00.0")])
def test_a_clock_that_starts_anew_is_named(file, cells):
    with pytest.raises(Unreadable, match=rf"{cells[2]} follows {cells[1]} in row 3 .*: did a clock start anew"):
        csv_file.Table(file("time_s\n" + "\n".join(cells))).series()


@pytest.mark.parametrize(
    "text, said",
    [
        ("0.0,0.0,1.5\n0.1,0.1,1.6\n", "its first line is numbers, '0.0,0.0,1.5', no names"),
        ("Export v3\ntime_s,x_m\n0,1\n", r"row 1 \(line 2\) .* is 'Export v3' a line above the names"),
        ("time_s,x_m\n0,1,\n1,2,\n", r"row 1 \(line 2\) .* is a separator at its end too many"),
    ],
)
def test_what_is_wrong_with_the_line_of_names_is_said(file, text, said):
    with pytest.raises(Unreadable, match=said):
        csv_file.Table(file(text))


@pytest.mark.parametrize(
    "content, said",
    [
        (b"PK\3\4\x14\0", "an Excel workbook: .*save its table as CSV"),
        (b"MATLAB 5.0 MAT-file", "a MATLAB file"),
        (b"\x1f\x8b\x08\0", "a gzip archive: unpack it"),
        ("Roll [\xb0]\n1\n".encode("latin-1"), "this is not UTF-8 text .*Windows-1252"),
    ],
)
def test_a_file_that_is_no_text_is_known_by_its_first_bytes(tmp_path, content, said):
    (tmp_path / "t.csv").write_bytes(content)
    with pytest.raises(Unreadable, match=said):
        csv_file.Table(tmp_path / "t.csv")


@pytest.mark.parametrize("codec", ["utf-8", "utf-16-le", "utf-16-be", "utf-32-le", "utf-32-be"])
def test_text_with_a_byte_order_mark_is_read_in_every_reader(tmp_path, codec):
    """Tables as spreadsheets save "Unicode text", scenes as shells of Windows write them, records and meshes."""
    import trimesh

    from ocean_sim.files import yaml_file
    from ocean_sim.ship.hull.shapes import MeshFile
    from ocean_sim.waves.exchange import of_openfast

    box = trimesh.creation.box((1.0, 2.0, 3.0))
    files = {
        "t.csv": "a,b\n1,2\n",
        "scene.yaml": "title: \u00dcber\n",
        "sea.Elev": "Time WaveElev\n0 1\n1 2\n2 3\n",
        "a.stl": trimesh.exchange.stl.export_stl_ascii(box),
        "a.obj": trimesh.exchange.obj.export_obj(box, header=""),  # the mark stands before a corner
        "a.ply": trimesh.exchange.ply.export_ply(box, encoding="ascii").decode(),
    }
    for name, text in files.items():
        (tmp_path / name).write_bytes(("\ufeff" + text.lstrip()).encode(codec))
    assert csv_file.Table(tmp_path / "t.csv")["a"].tolist() == [1.0]
    assert csv_file.read_columns(tmp_path / "t.csv")["b"].tolist() == [2.0]
    assert yaml_file.read_mapping(tmp_path / "scene.yaml").plain()["title"] == "\u00dcber"
    assert of_openfast(tmp_path / "sea.Elev")[1].tolist() == [1.0, 2.0, 3.0]
    for name in ("a.stl", "a.obj", "a.ply"):
        assert MeshFile(kind="mesh", file=str(tmp_path / name)).closed_mesh().volume == pytest.approx(6.0)


def test_text_that_is_not_what_its_mark_says_is_refused_by_its_codec(tmp_path):
    (tmp_path / "t.csv").write_bytes("a,b\n1,2\n".encode("utf-16") + b"3")
    with pytest.raises(Unreadable, match="this is not UTF-16-LE text"):
        csv_file.Table(tmp_path / "t.csv")


@pytest.mark.parametrize("angles, warned", [("0.1 3.1", True), ("0 5", False), ("0.1 90", False), ("word 1.1", False)])
def test_angles_in_degrees_that_could_be_radians_are_told(file, angles, warned):
    table = csv_file.Table(file("yaw_deg,yaw_rad\n" + "".join(f"{angle},0.5\n" for angle in angles.split())))
    assert [name for name in table if any(f"is {name} in radians?" in told for told in table.like_radians())] == [
        "yaw_deg"
    ] * warned
