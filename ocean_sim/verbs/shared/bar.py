"""Progress of long tasks such as studies and films: a bar on a terminal, plain lines elsewhere."""

import sys
from time import perf_counter
from typing import TYPE_CHECKING, Any

from ocean_sim.verbs.shared import console

if TYPE_CHECKING:
    from ocean_sim.studies.shared.study import Study

BAR_SECONDS = 0.1  # wall time between two pictures of the bar [s]
LINE_SHARE = 0.05  # share of the whole between two plain lines
MIN_LINE_SECONDS = 2.0  # and at least this much wall time between them [s]
MIN_TIMED_PICTURES = 3  # pictures from which the time that a film takes is estimated
MIN_KEPT_PICTURES = 10  # and from which films to come are estimated
FILM_CURE = "; Ctrl-C leaves it out, and so does --set render=null from the start"


class Bar:
    """Progress of work from 0 to `total`: a bar on a terminal, lines of text elsewhere, nothing if `quiet`."""

    def __init__(self, total: float, quiet: bool = False) -> None:
        self.total, self.quiet = total, quiet or console.json_asked
        self.shown = perf_counter()
        self.next_line = LINE_SHARE
        self.rich: Any = None

    def due(self, now: float) -> bool:
        """True if the bar is due for redrawing at wall time `now` [s]; cheap enough to call after every step."""
        return not self.quiet and now - self.shown >= BAR_SECONDS

    def show(self, done: float, text: str) -> None:
        """Redraw the bar at `done` of `total`, with a text; without a terminal, print a line after each LINE_SHARE."""
        if self.quiet:
            return
        now, share = perf_counter(), min(1.0, done / self.total)
        if sys.stdout.isatty():
            self.shown = now
            self.rich = self.rich or self.begun()
            self.rich.update(self.rich.task_ids[0], completed=done, text=text)
        elif done == 0.0 or (share >= self.next_line and now - self.shown >= MIN_LINE_SECONDS):
            self.shown, self.next_line = now, share + LINE_SHARE
            console.say(f"{share:4.0%}  {text}")

    def begun(self) -> Any:
        from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
        from rich.progress import Progress as RichProgress

        done = TextColumn("{task.percentage:3.0f} %  {task.fields[text]}")
        bar = RichProgress(BarColumn(), TimeElapsedColumn(), done)  # its clock ticks between two calls of `show`
        bar.add_task("", total=self.total, text="")
        bar.start()
        return bar

    def close(self) -> None:
        """Stop redrawing the bar; a later `show` starts another."""
        if self.rich is not None:
            self.rich.stop()
            self.rich = None


class Drawing:
    """Progress bar for the pictures of a film; after the first ones it prints, once, an estimate of the time left."""

    def __init__(self, quiet: bool = False, cure: str = "") -> None:
        """`quiet`: show nothing; `cure`: hint to draw no film, printed after the estimate of the time left."""
        self.bar, self.cure = Bar(1.0, quiet), cure
        self.first: tuple[float, int] | None = None  # wall time [s], and pictures that were drawn by then
        self.estimated = self.bar.quiet
        self.film_time: float | None = None  # wall time [s] of all pictures, once enough are timed

    def __call__(self, done: int, total: int) -> None:
        """Show that `done` of `total` pictures are drawn; the drawing of a film calls this after each picture."""
        now = perf_counter()
        self.first = self.first or (now, done)
        if (timed := done - self.first[1]) >= MIN_KEPT_PICTURES:
            self.film_time = total * (now - self.first[0]) / timed
        left = self.left(now, done, total)
        if not self.estimated and left is not None and done - self.first[1] >= MIN_TIMED_PICTURES:
            self.estimated = True
            self.bar.close()
            console.say(f"drawing a film of {total} pictures, about {console.duration(left)} more{self.cure}")
        if not self.bar.quiet and (done == total or (self.estimated and self.bar.due(now))):
            time = "" if left is None else f", {console.duration(left)} left"
            text = f"drawing picture {done} of {total}{time}" if done < total else f"{total} pictures drawn, finishing"
            self.bar.show(done / max(1, total), text)

    def left(self, now: float, done: int, total: int) -> float | None:
        """Wall time [s] left at `now` [s], with `done` of `total` pictures drawn; None before the second picture."""
        if self.first is None or done == self.first[1]:
            return None
        return (total - done) * (now - self.first[0]) / (done - self.first[1])

    def close(self) -> None:
        self.bar.close()


def rows_of(study: "Study") -> list[dict[str, Any]]:
    """Run all points (single runs) of a study with a progress bar; returns its table rows. Raises Stopped on Ctrl-C."""
    total, began = len(study.points), perf_counter()
    bar = Bar(max(1.0, total))
    try:
        bar.show(0.0, f"0 of {total} runs; the first compiles its kernels")
        for done in study.run():
            bar.show(done, f"{done} of {total} runs, {console.duration(perf_counter() - began)}")
    except KeyboardInterrupt:
        message = f"stopped after {len(study.found)} of {total} runs; the same command continues from there"
        raise console.Stopped(message) from None
    finally:
        bar.close()
    return study.rows
