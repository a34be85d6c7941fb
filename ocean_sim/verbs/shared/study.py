"""Studies on the command line: their progress, and cells of their tables."""

from time import perf_counter
from typing import Any

from ocean_sim.studies.shared.study import Study
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.bar import Bar


def rows_of(study: Study, quiet: bool) -> list[dict[str, Any]]:
    """Run a study, with its progress shown; gives its rows, and raises Stopped on Ctrl-C."""
    total, began = len(study.points), perf_counter()
    bar = Bar(max(1.0, total), quiet)
    try:
        for done in study.run():
            bar.show(done, f"{done} of {total} runs, {console.duration(perf_counter() - began)}")
    except KeyboardInterrupt:
        message = f"stopped after {len(study.found)} of {total} runs; the same command continues from there"
        raise console.Stopped(message) from None
    finally:
        bar.close()
    return study.rows


def text(value: Any) -> str:
    """A cell for people."""
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)
