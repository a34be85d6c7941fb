"""Readers of directional wave spectra of buoys (NDBC, CDIP, Spotter) and of wave models (SWAN, WAVEWATCH III, ERA5),
each by the description that its provider publishes."""

import re
from collections.abc import Callable, Iterable
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ocean_sim.files.csv_file import Table, parse_number, quoted_piece
from ocean_sim.files.input_file import Checked, Rule, Unreadable, open_netcdf, read_bytes, read_text
from ocean_sim.waves.directional import DirectionalSpectrum

TIME_FORM = "%Y-%m-%dT%H:%M"
MISSING_FROM = 999.0  # numbers from here on, and words, stand for none
MAX_MOMENT = 1.05  # length of a moment, rounded
SWAN_ENERGY = 1025.0 * 9.81  # [J/m4] energy over variance, with SWAN's default density of water
MAX_STEEPNESS = 1.0 / 7.0  # of a whole sea, as of the steepest regular wave (Michell 1893)
MAX_EPOCH = 1e11  # [s]
ERA5_FREQUENCIES = 0.03453 * 1.1 ** np.arange(30)  # [Hz]
ERA5_DIRECTIONS = 7.5 + 15.0 * np.arange(24)  # [deg] to which waves travel, clockwise from north
NDBC_ENDINGS, NDBC_LETTERS = (".data_spec", ".swdir", ".swdir2", ".swr1", ".swr2"), "wdijk"
NDBC_HEADING = re.compile(r"#?(YY|YYYY)\s+MM\s+DD\s+hh\s")
FORMAT_RULE = Rule(
    "spectra are those of NDBC (.data_spec, .swdir, .swdir2, .swr1 and .swr2, or those of a year, as 41010w2019.txt "
    "and with d, i, j and k for w), CDIP (sp), Spotter (CSV), SWAN or WAVEWATCH III (2-D, text) or ERA5 (netCDF 3)"
)
TABLE_RULE = Rule(
    "frequencies of a spectrum are above 0 and rise, its directions go all round in equal steps, no density is below 0 "
    "and no moment (r1, r2) above 1"
)
STEEP_RULE = Rule("Hm0 is at most 1/7 of the length of waves with period Tm02; mind the unit of the densities")
CHECKS = (Checked("Wave spectra, `spectrum.file` and `ocean-sim sea FILE`", (FORMAT_RULE, TABLE_RULE, STEEP_RULE)),)
Found = DirectionalSpectrum | None


class Record(NamedTuple):
    """Spectra at one time, one for each point of a file."""

    time: datetime | None  # UTC; None in a file without times
    points: list[Found]  # None for a point without data


class Lines:
    """Reader of a text file, line by line, without empty lines and comments."""

    def __init__(self, path: str | Path) -> None:
        numbered = [(n, line.strip()) for n, line in enumerate(read_text(path).splitlines(), 1) if line.strip()]
        self.rows = [(n, line) for n, line in numbered if line[0] not in "$#" or NDBC_HEADING.match(line)]
        self.path, self.at, self.expected = path, -1, ""
        self.begin = self.rows[0][1] if self.rows else ""

    @property
    def ended(self) -> bool:
        return self.at + 1 >= len(self.rows)

    def words(self, expected: str, *choices: str) -> list[str]:
        """Words of the next line; raises LookupError at the end, or if the first word is not one of `choices`.
        `expected`: what the line should hold, for the message."""
        self.at, self.expected = self.at + 1, expected
        found = self.rows[self.at][1].split()
        if choices and found[0] not in choices:
            raise LookupError
        return found

    def numbers(self, count: int, expected: str) -> np.ndarray:
        """The next `count` numbers, which fill lines; raises LookupError or ValueError. `expected`: their meaning."""
        found: list[float] = []
        while len(found) < count:
            found += map(float, self.words(f"{count} {expected}"))
        return np.array(found).reshape(count)


def read_spectra(path: str | Path) -> list[Record]:
    """All spectra of a file whose format is found by its content, in order of time; raises Unreadable without any."""
    if read_bytes(path).startswith((b"CDF", b"\x89HDF")):
        found = [*_read_era5(path)]
    else:
        lines = Lines(path)
        reader = next((reader for begin, reader in TEXT_READERS.items() if re.match(begin, lines.begin)), None)
        if reader is None:
            raise FORMAT_RULE.broken(path, f"line 1 is {quoted_piece(lines.begin)}")
        found = _read_all(lines, reader)
    if not any(any(each.points) for each in found):
        gaps = " or ".join(word for word in ("ZERO", "NODATA") if word.encode() in read_bytes(path))
        raise TABLE_RULE.broken(path, f"it has no spectrum with energy and directions{gaps and f', all are {gaps}'}")
    return sorted(found, key=lambda each: each.time or datetime.min)


def _read_all(lines: Lines, reader: Callable[[Lines], Iterable]) -> list:
    """All items that a `reader` yields from lines; raises Unreadable at the first line that it does not expect."""
    try:
        return [*reader(lines)]
    except (LookupError, ValueError) as error:
        if isinstance(error, Unreadable):
            raise
        number, line = [(0, ""), *lines.rows, (lines.rows[-1][0] + 1 if lines.rows else 1, "the end")][lines.at + 1]
        wrong = f"line {number}: expected {lines.expected}, got {quoted_piece(line)}"
        raise FORMAT_RULE.broken(lines.path, wrong) from None


def read_spectrum(path: str | Path, time: str | None, point: int) -> tuple[datetime | None, DirectionalSpectrum]:
    """Time and spectrum of point number `point`, from 1 on, at a time (ISO 8601, UTC, to the minute), or, if that is
    None, at the only time of the file; raises Unreadable if there is none."""
    known = (each for each in read_spectra(path) if any(each.points))
    records = {f"{each.time:{TIME_FORM}}" if each.time else "": each for each in known}
    first, *_, last = [*records, *records]
    asked = first if time is None and len(records) == 1 else in_utc(time or "")
    if asked not in records:
        wrong = "" if time is None else f", not {quoted_piece(time)}"
        its = "its only time" if len(records) == 1 else f"one of its {len(records)} times"
        raise Unreadable(path, f"name {its}, {first}{f' to {last}' if last != first else ''}{wrong}")
    found = records[asked]
    if point > len(found.points) or (spectrum := found.points[point - 1]) is None:
        there = [f"{k}" for k, each in enumerate(found.points, 1) if each is not None]
        raise Unreadable(path, f"it has no spectrum of point {point}, but of {', '.join(there[:8])}")
    if spectrum.steepness > MAX_STEEPNESS:
        height = f"its Hm0, {spectrum.significant_height:.3g} m"
        raise STEEP_RULE.broken(path, f"{height}, is {spectrum.steepness:.2g} of a length")
    return found.time, spectrum


def in_utc(time: str) -> str:
    """Time (ISO 8601) as text in UTC to the minute, comparable with times in files; any other text is unchanged."""
    try:
        there = datetime.fromisoformat(time)
    except ValueError:
        return time
    return f"{there.astimezone(UTC) if there.tzinfo else there:{TIME_FORM}}"


def numbers_in(words: Iterable[str]) -> np.ndarray:
    """Numbers (n,) read from words; NaN for missing values: 999 or more, MM, or any word that is no number."""
    values = np.array([parse_number(word) for word in words])
    return np.where(np.abs(values) < MISSING_FROM, values, np.nan)


def table_spectrum(
    path: str | Path,
    frequency: np.ndarray,
    direction: np.ndarray,
    density: np.ndarray,
    moments: np.ndarray | None = None,
) -> Found:
    """Checked spectrum, as in `DirectionalSpectrum`; None without energy. Raises Unreadable, for file `path`."""
    back = np.flatnonzero(~(np.diff(frequency, prepend=0.0) > 0.0))
    bad = np.argwhere(~((density >= 0.0) & np.isfinite(density)))
    if len(back) or len(frequency) < 2:
        first, last = np.append(0.0, frequency)[back[0] : back[0] + 2] if len(back) else (*frequency, np.nan)
        raise TABLE_RULE.broken(path, f"{last:g} Hz follows {first:g} Hz")
    if len(bad):
        raise TABLE_RULE.broken(path, f"it has a density of {density[*bad[0]]:g} at {frequency[bad[0, 0]]:g} Hz")
    return DirectionalSpectrum(frequency, direction, density, moments) if density.any() else None


def buoy_spectrum(path: str | Path, frequency: np.ndarray, density: np.ndarray, moments: np.ndarray) -> Found:
    """Directional spectrum of a buoy, from densities (n,) [m2/Hz] and complex Fourier moments, first and second (2, n).
    Frequencies without density are left out; those without moments take the nearest. None without energy or moments."""
    there = np.isfinite(density)
    directed = there & np.isfinite(moments).all(axis=0)
    if not directed.any():
        return None
    if np.abs(moments[:, directed]).max() > MAX_MOMENT:
        raise TABLE_RULE.broken(path, f"it has a moment of {np.abs(moments[:, directed]).max():.3g}")
    nearest = np.abs(frequency[there, None] - frequency[directed]).argmin(axis=1)
    return table_spectrum(path, frequency[there], np.zeros(1), density[there, None], moments[:, directed][:, nearest])


def model_spectrum(path: str | Path, frequency: np.ndarray, towards: np.ndarray, density: np.ndarray) -> Found:
    """Directional spectrum from densities (n, m) [m2/(Hz rad)] at directions `towards` (m,) [deg] to which waves
    travel, clockwise from north, at equal steps all round but for the file's rounding; raises Unreadable."""
    coming = np.round(towards + 180.0, 3) % 360.0
    even = 360.0 / len(coming) * np.arange(len(coming))
    ahead = np.sort(coming) - even
    if np.ptp(ahead) > 0.2 * even[1]:
        raise TABLE_RULE.broken(path, f"its directions are up to {np.ptp(ahead):.3g} deg off equal steps")
    return table_spectrum(path, frequency, even + ahead.mean(), density[:, coming.argsort()])


def _ndbc_rows(lines: Lines) -> Iterable[tuple[datetime, np.ndarray]]:
    """Yield time, and frequencies and values (2, n), of each row of an NDBC file; a frequency stands in brackets after
    its value, or above it in the heading."""
    heading = lines.words("#YY MM DD hh")
    paired, dated = "(" in lines.begin, 5 if "mm" in heading[:5] else 4
    while not lines.ended:
        words = lines.words("a date and a value for each frequency")
        rest = words[dated + ("Sep_Freq" in heading) :]
        names, cells = ([name.strip("()") for name in rest[1::2]], rest[::2]) if paired else (heading[dated:], rest)
        date = [words[0] if len(words[0]) == 4 else f"19{words[0]}", *words[1:dated], "00"][:5]
        yield datetime.strptime(" ".join(date), "%Y %m %d %H %M"), np.stack([np.array(names, float), numbers_in(cells)])


def ndbc_files(path: str | Path) -> list[Path]:
    """The five NDBC files to which the one named `path` belongs; empty if its name is not an NDBC one."""
    path = Path(path)
    if path.suffix in NDBC_ENDINGS:
        return [path.with_suffix(ending) for ending in NDBC_ENDINGS]
    year = re.fullmatch(rf"(.+)[{NDBC_LETTERS}](\d{{4}}.*)", path.name)
    return [path.with_name(f"{year[1]}{letter}{year[2]}") for letter in NDBC_LETTERS] if year else []


def _read_ndbc(lines: Lines) -> Iterable[Record]:
    """Yield spectra of NDBC buoys: density [m2/Hz], mean direction alpha1, principal direction alpha2 [deg], and r1,
    r2, which yearly files give in hundredths."""
    path = Path(lines.path)
    live, paths = path.suffix in NDBC_ENDINGS, ndbc_files(path)
    if not paths:
        raise FORMAT_RULE.broken(path, "its name does not tell those of the other four")
    if absent := [each.name for each in paths if not each.exists()]:
        raise FORMAT_RULE.broken(path, f"there is no {', '.join(absent)} next to it, which it needs")
    files = [Lines(each) for each in paths]
    density, *others = [dict(_read_all(each, _ndbc_rows)) for each in files]
    scale, share = (1.0, "fractions") if live else (100.0, "hundredths")
    angles, shares = (1.0, 360.0, "degrees"), (0.01 * scale, MAX_MOMENT * scale, share)
    meanings = (0.0, np.inf, "m2/Hz, after Sep_Freq"), angles, angles, shares, shares
    for file, each, (least, most, unit) in zip(files, (density, *others), meanings):
        top = max((np.nanmax(values, initial=0.0) for _, values in each.values()), default=0.0)
        if (live and ("Sep_Freq" in file.begin) != (each is density)) or 0.0 < top <= least or top > most:
            wrong = f"expected values in {unit}, got values up to {top:g}: is it another of the five files?"
            raise FORMAT_RULE.broken(file.path, wrong)
        if density.keys().isdisjoint(each) and density:
            raise TABLE_RULE.broken(file.path, f"it has none of the {len(density)} times of {paths[0].name}")
    for time, (frequency, values) in density.items():
        rows = [each[time] for each in others if time in each]
        if not all(np.array_equal(row[0], frequency) for row in rows):
            raise TABLE_RULE.broken(path, f"its frequencies at {time:{TIME_FORM}} are not those of the other four")
        found: Found = None
        if len(rows) == len(others):
            alpha_1, alpha_2, r_1, r_2 = (row[1] for row in rows)
            moments = np.array([r_1, r_2]) * np.exp(1j * np.radians([alpha_1, 2.0 * alpha_2])) / scale
            found = buoy_spectrum(path, frequency, values, moments)
        yield Record(time, [found])


def _read_cdip(lines: Lines) -> Iterable[Record]:
    """Yield the spectrum of a CDIP file: rows of frequency, width, energy [m2/Hz], direction, and Fourier moments a1,
    b1, a2, b2 about north and east of the directions from which waves come."""
    time = datetime.strptime(lines.words("File Name: sp and a time like 202610031200")[2][-12:], "%Y%m%d%H%M")
    while lines.words("freq")[0].lower() != "freq":
        pass
    lines.words("units")
    rows = []
    while not lines.ended:
        rows.append(numbers_in(lines.words("nine numbers, of a higher frequency than before")).reshape(9))
        if len(rows) > 1 and rows[-1][0] <= rows[-2][0]:
            raise LookupError
    found = np.array(rows).T
    yield Record(time, [buoy_spectrum(lines.path, found[0], found[2], found[[4, 6]] + 1j * found[[5, 7]])])


def _read_spotter(lines: Lines) -> Iterable[Record]:
    """Yield spectra of a Spotter buoy: Fourier moments, about east and north, of directions to which waves travel."""
    rows = Table(lines.path)
    count = sum(name.startswith("varianceDensity_") for name in rows.names)
    names = [f"{name}_{k}" for name in ("f", "varianceDensity", "a1", "b1", "a2", "b2") for k in range(count or 1)]
    if missing := [name for name in names if name not in rows]:
        raise FORMAT_RULE.broken(lines.path, f"line 1: expected a column {missing[0]}")
    for row, seconds in enumerate(rows.finite("Epoch Time")[0].tolist()):
        f, density, *parts = np.array([rows[name][row] for name in names]).reshape(6, -1)
        first, second = parts[0] + 1j * parts[1], parts[2] + 1j * parts[3]
        moments = np.array([-1j * first.conj(), -second.conj()])  # an angle t there is a direction of 270 deg - t
        if not 0.0 <= seconds < MAX_EPOCH:
            raise FORMAT_RULE.broken(lines.path, f"Epoch Time is {seconds:.0f} s: is it in milliseconds?")
        time = datetime.fromtimestamp(seconds, UTC).replace(tzinfo=None)
        yield Record(time, [buoy_spectrum(lines.path, f, density, moments)])


def _read_swan(lines: Lines) -> Iterable[Record]:
    """Yield spectra of SWAN. Directions are NDIR (from which waves come, clockwise from north) or CDIR (to which they
    travel, counter-clockwise from the x-axis, taken as east); density is in m2 or J/m2 per Hz and degree or radian."""
    axes: dict[str, np.ndarray] = {}
    timed, points = False, 1
    keys = "TIME", "LONLAT", "LOCATIONS", "AFREQ", "RFREQ", "NDIR", "CDIR", "QUANT"
    lines.words("SWAN")
    while (key := lines.words(f"one of {', '.join(keys)}", *keys)[0]) != "QUANT":
        count = int(lines.words(f"a number for {key}")[0])
        if key == "TIME":
            timed = True
        elif key in ("LONLAT", "LOCATIONS"):
            points = len([lines.words("a place") for _ in range(count)])
        else:
            values = lines.numbers(count, key)
            axes[key[1:]] = {"NDIR": values + 180.0, "CDIR": 90.0 - values}.get(key, values)
    lines.words("1, of a 2-D spectrum", "1")
    begin, unit = {"VaDens": ("", 1.0), "EnDens": ("J/", 1.0 / SWAN_ENERGY)}[lines.words("VaDens or EnDens")[0]]
    angle = lines.words(f"{begin}m2/Hz/degr or {begin}m2/Hz/rad")[0].replace("^", "").removeprefix(f"{begin}m2/Hz/")
    unit *= {"rad": 1.0, "degr": np.degrees(1.0), "deg": np.degrees(1.0)}[angle]
    lines.words("an exception value, after frequencies and directions")
    shape = len(axes["FREQ"]), len(axes["DIR"])
    while not lines.ended:
        time = datetime.strptime(lines.words("20261003.120000")[0], "%Y%m%d.%H%M%S") if timed else None
        found: list[Found] = [None] * points
        for k in range(points):
            if lines.words("FACTOR, ZERO or NODATA", "FACTOR", "ZERO", "NODATA")[0] == "FACTOR":
                factor = unit * lines.numbers(1, "factor")
                density = factor * lines.numbers(shape[0] * shape[1], "densities").reshape(shape)
                found[k] = model_spectrum(lines.path, axes["FREQ"], axes["DIR"], density)
        yield Record(time, found)


def _read_ww3(lines: Lines) -> Iterable[Record]:
    """Yield spectra of WAVEWATCH III: directions [rad] to which waves travel, clockwise from north, then for each time
    and point densities [m2/(Hz rad)], frequency running fastest."""
    lines.words("numbers of frequencies and directions")
    n, m = map(int, lines.begin.split("'")[2].split()[:2])
    frequency, towards = lines.numbers(n, "frequencies [Hz]"), np.degrees(lines.numbers(m, "directions [rad]"))
    found: list[Record] = []
    while not lines.ended:
        words = lines.words("a time like 20261003 120000, or a point in quotes")
        if words[0].startswith("'"):
            density = lines.numbers(n * m, "densities").reshape(m, n).T
            found[-1].points.append(model_spectrum(lines.path, frequency, towards, density))
        else:
            found.append(Record(datetime.strptime(" ".join(words), "%Y%m%d %H%M%S"), []))
    return found


def _read_era5(path: str | Path) -> Iterable[Record]:
    """Yield spectra of ERA5: log10 of density [m2/(Hz rad)], missing if low, by time, frequency, direction, place."""
    expected = "a whole netCDF file, but this one is cut short or damaged"
    try:
        with open_netcdf(path) as file:
            expected = "a variable d2fd over time, 30 frequencies and 24 directions"
            variable = file.variables["d2fd"]
            clock = file.variables[variable.dimensions[0]]
            shape = len(clock[:]), len(ERA5_FREQUENCIES), len(ERA5_DIRECTIONS), -1
            density = np.nan_to_num(10.0 ** np.ma.filled(1.0 * variable[:], np.nan).reshape(shape))
            expected = f"a time in a unit like 'hours since 1900-01-01', not {quoted_piece(clock.units.decode())}"
            unit, _, day = clock.units.decode().split()[:3]
            begin = datetime.strptime(day, "%Y-%m-%d")
            times = [begin + timedelta(**{unit: float(value)}) for value in clock[:]]
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError, OSError) as error:
        if isinstance(error, Unreadable):
            raise
        raise FORMAT_RULE.broken(path, f"expected {expected}") from None
    for time, points in zip(times, np.moveaxis(density, -1, 1)):
        yield Record(time, [model_spectrum(path, ERA5_FREQUENCIES, ERA5_DIRECTIONS, each) for each in points])


TEXT_READERS = {
    NDBC_HEADING.pattern: _read_ndbc,
    "File Name:": _read_cdip,
    ".*Epoch Time": _read_spotter,
    "SWAN": _read_swan,
    "'WAVEWATCH III SPECTRA'": _read_ww3,
}
