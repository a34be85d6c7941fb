"""Command-line options of all scripts of figures, and their report of progress."""

import argparse
import re
import sys
from pathlib import Path


class Said:
    """Caption of all pictures of the figure that this process draws, set by `options`."""

    caption = ""  # number and what it shows
    fast = False  # whether it was made in haste
    whole = False  # whether haste leaves nothing out


def options(doc: str | None, fast: str = "", **files: str) -> argparse.Namespace:
    """Parse `--fast`, `--out` (a folder, made if absent) and an option for each of `files`. `doc`: its first paragraph
    is the figure's caption; `fast`: says what `--fast` leaves out, if anything."""
    parser = argparse.ArgumentParser(description=(doc or "").split("\n\n")[0])
    parser.add_argument("--fast", action="store_true", help=fast or "nothing here takes long")
    parser.add_argument("--out", type=Path, default=Path("figures_out"), help="where the CSV and the picture go")
    for name, what in files.items():
        parser.add_argument(f"--{name}", type=Path, help=what)
    found = parser.parse_args()
    found.out.mkdir(parents=True, exist_ok=True)
    Said.caption = re.sub(r": CSV.*", "", " ".join((doc or "").split("\n\n")[0].split())).replace("`", "")
    Said.fast, Said.whole = found.fast, not fast
    return found


def progress(share: float, doing: str) -> None:
    """Print progress, `share` from 0 to 1, on standard error, which `ocean-sim figure` shows as its bar."""
    print(f"{share:4.0%}  {doing}", file=sys.stderr, flush=True)
