"""What every script of a figure takes on its command line."""

import argparse
from pathlib import Path


def options(doc: str | None, fast: str) -> argparse.Namespace:
    """`fast` and `out`, a folder that is there. The first paragraph of `doc` says what the figure is, `fast` what haste
    leaves out."""
    parser = argparse.ArgumentParser(description=(doc or "").split("\n\n")[0])
    parser.add_argument("--fast", action="store_true", help=fast)
    parser.add_argument("--out", type=Path, default=Path("figures_out"), help="where the CSV and the picture go")
    found = parser.parse_args()
    found.out.mkdir(parents=True, exist_ok=True)
    return found
