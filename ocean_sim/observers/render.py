"""Pictures and a film from the frames of a run, drawn off screen.

The only file with PyVista and imageio.

Everything is drawn in a child process, `python -m ocean_sim.observers.render ORDER`: where OpenGL is missing VTK ends
its process without an exception, and a run that went well must end well. The child follows the frames while the run
goes on: they lie on disk, and it holds one at a time, however far it is behind. It yields to the run (`nice`). A long
film it draws by turns with a second child, of its own, whose pictures come to it through a pipe.
"""

import os
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, suppress
from math import prod
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from ocean_sim.files.atomic_file import atomic_write
from ocean_sim.machine import available_cores, exit_with_parent, kill_session, yield_to_others
from ocean_sim.model import Faults, Model, quantity
from ocean_sim.observers.shared import run_report
from ocean_sim.parts import SEVERAL, LedgerRow, PeriodicConfig, SceneFacts, key_of
from ocean_sim.pictures.frame_files import (
    Frame,
    FrameLog,
    film_frames,
    frame_files,
    frame_path,
    open_frame,
    ship_keys,
    survey_run,
)
from ocean_sim.pictures.stage import opengl
from ocean_sim.pictures.stage.camera import SHIP_CAMERAS, CameraName
from ocean_sim.pictures.stage.picture import MAP_CAMERAS, PIXEL_SAMPLES, Moments, Picture, is_foreseeable, picture_row
from ocean_sim.pictures.stage.render_order import DEFAULT_SIZE, Drawing, Order, RenderFailed
from ocean_sim.pictures.water.sea_state import DRY_DEPTH_SHARE, is_tank, run_scene
from ocean_sim.simulation import OutcomeObserver, Progress, Simulation

PICTURE_SECONDS = {  # processor time [s] of a picture of 1280 x 720 without a graphics card, by dimensions and quality
    2: {"draft": 0.1, "final": 0.15},
    3: {"draft": 0.5, "final": 1.4},
}
START_SECONDS = {2: 3.3, 3: 7.0}  # of starting to draw, and of the pictures next to the film [s]
SERIAL_SHARE = 0.36  # share of the processor time of a process that draws that one core takes by itself; measured
PROCESS_BYTES = {  # bytes of a process that draws, and of each of its pixels, by what it draws; without a graphics card
    "particles": (330e6, 50.0),
    "tank": (370e6, 150.0),
    "sea": (600e6, 65.0),
}
PARTICLE_BYTES = 400  # bytes of each particle in such a process
ENCODER_BYTES = (30e6, 60.0)  # bytes of the encoder of a film, and of each pixel of a picture
STRIP_GAP = 6  # pixels between the pictures of a strip
NICENESS = 13  # by which what draws is nicer than a run that goes on: two processes so take of it what one does at 10
MOMENTS_FILE = "moments.png"  # next to the film
LOOK_INTERVAL = 0.1  # [s] between two looks for a new frame
MAX_PAINTERS = 2  # processes that draw a film by turns: while one leaves all cores but one idle, the other shades
SHORT_FILM = 24  # pictures of a film for which a second process, which takes seconds to start, is not worth it
OpenGLMissing = opengl.OpenGLMissing
probe = opengl.probe


class Config(Drawing, PeriodicConfig):
    turn: ClassVar[int] = 4
    leaves: ClassVar[str] = "film.mp4, drawn during the run, moments.png, preview.png, strip.png, still_*.png"
    every: float = quantity("s", 0.033, gt=0.0)
    """Simulated time between pictures of the film, which runs in real time; there are no more than frames."""

    def files_of(self, preflight: SceneFacts) -> tuple[str, ...]:
        asked = {"strip.png": self.strip, "still_*.png": self.stills, "film.mp4": self.film, MOMENTS_FILE: self.film}
        return tuple(name for name in super().files_of(preflight) if asked.get(name, True))

    def mismatches(self, preflight: SceneFacts) -> Faults:
        return preflight.unknown_ship(self.ship)

    def warnings(self, preflight: SceneFacts) -> list[str]:
        frames = preflight.parts.get("frames")
        if not isinstance(frames, PeriodicConfig):
            return ["render: without frames there is nothing to draw, no preview and no film"]
        late = [time for time in self.stills if time > preflight.duration + frames.every]
        if not late:
            return []
        times = ", ".join(f"{time:g}" for time in late)
        return [f"render: stills at {times} s are never drawn: the run ends at {preflight.duration:g} s"]

    def film_pictures(self, duration: float, kept: float) -> int:
        """Number of film pictures, 0 without a film, for a run of this duration [s] with frames `kept` [s] apart."""
        return int(duration / max(self.every, kept) * (1.0 + 1e-9)) + 1 if self.film else 0

    def pictures(self, preflight: SceneFacts) -> int | None:
        """Number of pictures in the film of a run, 0 without a film; None if the run has no frames to draw."""
        frames = preflight.parts.get("frames")
        return self.film_pictures(preflight.duration, frames.every) if isinstance(frames, PeriodicConfig) else None

    def picture_time(self, preflight: SceneFacts) -> float:
        dimension, pixels = preflight.tank.dimension, prod(self.size or DEFAULT_SIZE) / prod(DEFAULT_SIZE)
        each, pictures = PICTURE_SECONDS[dimension][self.quality] * pixels, self.pictures(preflight)
        if pictures is None:
            return 0.0
        by_turns, of = pictures * each, painter_count(pictures)
        alone = START_SECONDS[dimension] + (len(self.stills) + self.strip) * each
        wall, wall_by_turns = (SERIAL_SHARE / n + (1.0 - SERIAL_SHARE) / available_cores() for n in (1, of))
        return alone * wall + by_turns * wall_by_turns

    def scenery(self, preflight: SceneFacts) -> str:
        """Scenery of the pictures, as far as it is known before the run: "sea", "tank" or "particles", the keys of
        PROCESS_BYTES, which gives the memory that drawing takes."""
        tank, water = preflight.tank, preflight.untouched
        if self.particles or tank.dimension == 2:
            return "particles"
        area = (tank.upper[0] - tank.lower[0]) * (tank.upper[2] - tank.lower[2])
        mean = tank.depth if water is None else water.n * water.spacing**3 / area
        at_sea = self.far_sea and self.camera not in MAP_CAMERAS and not is_tank(dict(tank.config))
        return "sea" if at_sea and mean > DRY_DEPTH_SHARE * tank.depth else "tank"

    def bytes_a_particle(self, preflight: SceneFacts) -> int:
        pictures = self.pictures(preflight)
        return 0 if pictures is None else PARTICLE_BYTES * painter_count(pictures)

    def ledger(self, preflight: SceneFacts) -> list[LedgerRow]:
        [row], pictures, pixels = super().ledger(preflight), self.pictures(preflight), prod(self.size or DEFAULT_SIZE)
        if pictures is None:
            return [row]
        of, (base, each) = painter_count(pictures), PROCESS_BYTES[self.scenery(preflight)]
        taken = of * (base + each * pixels * PIXEL_SAMPLES[self.quality] ** 2)
        taken += self.bytes_a_particle(preflight) * preflight.particles
        why = f"{of} processes that draw" if of > 1 else "a process that draws"
        if self.film:
            taken, why = taken + ENCODER_BYTES[0] + ENCODER_BYTES[1] * pixels, f"{why}, and the encoder of the film"
        return [row._replace(bytes=int(taken), why=why)]


def config_options(config: Config, folder: Path) -> dict[str, Any]:
    """Options of `render_run` from a config; `every` is at least the interval between the frame files in the folder."""
    with open_frame(folder / "frames" / "grid.npz") as grid:
        return config.model_dump() | {"every": max(config.every, float(grid["every"]))}


class Render(OutcomeObserver, of=Config):
    """Draws film.mp4 while the run goes on and all other pictures after it; then writes report.html again."""

    left_out = ("drawer", "progress", "every")  # of the process that goes on

    def __init__(self, config: Config, folder: Path, simulation: Simulation) -> None:
        self.config, self.folder, self.simulation = config, folder, simulation
        self.progress: Progress | None = None
        self.drawer: Drawer | None = None

    def show_progress(self, progress: Progress) -> None:
        self.progress = progress
        if self.drawer is not None:
            self.drawer.progress = progress

    def observe(self, simulation: Simulation) -> None:
        if self.drawer is None and self.config.film and frame_path(self.folder, 0).exists():
            self.every = float("inf")
            with suppress(OpenGLMissing, RenderFailed):  # `close` says so
                order = order_of(self.folder, **config_options(self.config, self.folder))
                self.drawer = Drawer([order], self.progress, goes_on=True)

    def close(self) -> None:
        files = frame_files(self.folder)
        if not files:
            return
        if self.simulation.reason == "interrupted":  # who stops a run does not want to wait for its film
            self.stop()
            print(f"no pictures; `ocean-sim render {self.folder}` draws them", file=sys.stderr)
            return
        missing = times_without_frame(files, self.config.stills)
        if missing:
            print(f"{no_picture_sentence(files, missing)}; the other pictures are drawn", file=sys.stderr)
        kept = tuple(time for time in self.config.stills if time not in missing)
        try:
            if self.drawer is None:
                options = config_options(self.config, self.folder) | {"stills": kept}
                render_run(self.folder, **options, progress=self.progress)
            else:
                self.drawer.finish()
        except (OpenGLMissing, RenderFailed) as problem:
            print(f"no pictures: {problem}", file=sys.stderr)
        else:
            if (self.folder / "report.html").exists():
                run_report.write_report(self.folder)

    def stop(self) -> None:
        if self.drawer is not None:
            self.drawer.stop()


class Request(Model):
    """Input of a drawing process, in JSON: a list of `Order`s, each of which describes the pictures of one run."""

    orders: Sequence[Order]
    goes_on: bool
    """True if their run still writes frames."""
    turn: int = 0
    """Number of the process among those that draw the pictures of a film; process 0 also draws all else."""


class DrawingProcess:
    """Process that draws a `Request`. It is given a pipe as standard input, which breaks if this process dies."""

    def __init__(self, request: Request, **how: Any) -> None:
        """Start the process; `how`: further arguments of subprocess.Popen."""
        command, pipe = [sys.executable, "-m", "ocean_sim.observers.render", request.model_dump_json()], subprocess.PIPE
        self.errors = tempfile.TemporaryFile("w+")
        self.child = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=self.errors, **how)
        assert self.child.stdin is not None and self.child.stdout is not None
        self.told, self.given = self.child.stdin, self.child.stdout

    def say_over(self, over: threading.Event | None = None) -> None:
        """Tell the drawing process that the run is over; with an event `over`, wait for that first."""
        if over is not None:
            over.wait()
        with suppress(OSError, ValueError):  # it has ended
            self.told.write(b"over\n")
            self.told.flush()

    def failure(self) -> RenderFailed:
        """Exception for a process that has ended too early: names its signal, or the last line of its errors."""
        if self.child.returncode < 0:
            opengl.forget()
            return RenderFailed(f"the drawing process died (signal {-self.child.returncode}); {OpenGLMissing()}")
        self.errors.seek(0)
        said = [line for line in self.errors.read().strip().splitlines() if not line.startswith("[")]  # the encoder's
        return RenderFailed(said[-1] if said else "the drawing process ended without a message")

    def close(self) -> None:
        for stream in (self.told, self.given, self.errors):
            with suppress(OSError):
                stream.close()


class Drawer(DrawingProcess):
    """Child process that draws pictures of runs in a Unix session of its own, which `stop` ends. An `Order` (options of
    all pictures of a run) describes those of each run."""

    def __init__(self, orders: Sequence[Order], progress: Progress | None = None, goes_on: bool = False) -> None:
        """Start to draw the pictures that `orders` describe. `progress`: called with the numbers of pictures drawn and
        in all; `goes_on`: True if the run still writes frames, until `finish` is called.

        Raises RenderFailed if the run of an order lacks what it needs, OpenGLMissing if this machine cannot draw."""
        for order in orders:
            stills = () if goes_on else order.stills
            if sentence := obstacle_to_pictures(Path(order.folder), order.camera, stills, order.ship):
                raise RenderFailed(sentence)
        if (window := opengl.window()) is None:
            raise OpenGLMissing
        # Ctrl-C is the parent's, which ends the child and its encoder together.
        how = {"env": opengl.drawing_environment(window), "start_new_session": True}
        super().__init__(Request(orders=orders, goes_on=goes_on), **how)
        self.orders, self.progress, self.stopped = orders, progress, False
        self.reader = threading.Thread(target=self.follow, daemon=True)
        self.reader.start()

    def follow(self) -> None:
        """Report the child's progress lines ("pictures 3 of 600", 0 for unknown) until it ends. Runs in a thread."""
        for line in self.given:
            words = line.split()
            if self.progress is not None and words[:1] == [b"pictures"]:
                self.progress(int(words[1]), int(words[3]))

    def finish(self) -> None:
        """Tell the child that the run is over, and wait for its end; raises RenderFailed if it failed."""
        try:
            self.say_over()
            self.reader.join()
            if self.child.wait() != 0:
                raise self.failure()
        finally:
            self.stop()

    def stop(self) -> None:
        """Kill the child and its encoder if they still run, and remove their unfinished files."""
        if self.stopped:
            return
        self.stopped = True
        if self.child.returncode != 0:  # else it has ended what it led
            kill_session(self.child)
        self.close()
        for order in self.orders:
            for left in Path(order.out).glob(f".*.{self.child.pid}.tmp*"):
                left.unlink(missing_ok=True)


def render_run(folder: Path, *, out: Path | None = None, progress: Progress | None = None, **asked: Any) -> list[Path]:
    """Draw preview.png, and the film, stills and strip that are asked for, into `out` (default: `folder`), and return
    all files. `asked`: fields of Order by name. Raises OpenGLMissing or RenderFailed."""
    order = order_of(folder, out=out, **asked)
    draw_apart([order], progress)
    names = ["preview.png"] * order.preview + [still_name(time) for time in order.stills]
    names += ["strip.png"] * (order.strip > 0) + ["film.mp4", MOMENTS_FILE] * order.film
    return [Path(order.out, name) for name in names]


def order_of(folder: Path, *, out: Path | None = None, every: float = 0.033, **asked: Any) -> Order:
    """`Order` (all options of the pictures to draw) for the run in `folder`, into `out` or else that folder. `every`:
    time between film pictures [s]; `asked`: other fields of Order by name."""
    by_turns = {"painters": painter_count(run_scene(folder).get("duration", 0.0) / every)}
    return Order(folder=str(folder), out=str(out or folder), every=every, **by_turns | asked)


def painter_count(pictures: float) -> int:
    """Number of processes that share the pictures of a film: all cores up to MAX_PAINTERS, but 1 for a short film."""
    return min(MAX_PAINTERS, available_cores()) if pictures > SHORT_FILM else 1


def draw_apart(orders: Sequence[Order], progress: Progress | None = None) -> None:
    """Draw the pictures of `orders` in a child process and wait for it; raises OpenGLMissing or RenderFailed."""
    Drawer(orders, progress).finish()


def obstacle_to_pictures(
    folder: Path, camera: CameraName, stills: Sequence[float], ship: str | None = None
) -> str | None:
    """Reason why a run has no picture from this camera, of this ship or at times `stills` [s]; None if it has all."""
    files, ground = frame_files(folder), folder / "frames" / "grid.npz"
    if not files or not ground.is_file():
        return f"{folder} has no frames to draw; run with the observer `frames`"
    with open_frame(ground) as grid:
        ships = ship_keys(grid, "_vertices")
    if camera in SHIP_CAMERAS and not ships:
        return f"camera {camera} needs a ship, and this run has none; choose third_person, orbit, fixed, top or side"
    if ship is not None and key_of(ship) not in ships:
        there = ", ".join(key.removeprefix(f"{SEVERAL}.") for key in ships) or "none"
        return f"this run draws no ship {ship!r}; there is {there}"
    missing = times_without_frame(files, stills)
    return no_picture_sentence(files, missing) if missing else None


def times_without_frame(files: Sequence[Path], stills: Sequence[float]) -> list[float]:
    """Times in `stills` [s] with no frame file near: all are farther away than the mean interval between frames."""
    start, end = FrameLog([files[0], files[-1]]).span
    interval = (end - start) / max(1, len(files) - 1) + 1e-6
    return [time for time in stills if not start - interval <= time <= end + interval]


def no_picture_sentence(files: Sequence[Path], missing: Sequence[float]) -> str:
    """Sentence that no frame is at the first of the `missing` times [s], with the time span of all frame `files`."""
    start, end = FrameLog([files[0], files[-1]]).span
    return f"there is no picture at {missing[0]:g} s; the frames of this run reach from {start:g} to {end:g} s"


def variants(folder: Path, time: float, switched: Sequence[dict[str, Any]], **options: Any) -> np.ndarray:
    """(n, height, width, 3) pictures, 8-bit RGB, of a run at a `time` [s] for figures: one per dict in `switched`. A
    dict sets fields of Order by name for its picture, even `folder` or `stills`; `options` set fields for all."""
    import imageio.v2 as imageio

    given: dict[str, Any] = {"folder": str(folder), "film": False, "preview": False, "stills": (time,)} | options
    with tempfile.TemporaryDirectory() as made:
        orders = [Order(**given | {"out": str(Path(made, str(k)))} | more) for k, more in enumerate(switched)]
        draw_apart(orders)
        return np.stack([np.asarray(imageio.imread(Path(order.out, still_name(order.stills[0])))) for order in orders])


def still_name(time: float) -> str:
    return f"still_{time:08.3f}.png"


def draw_order(order: Order, over: threading.Event) -> Iterator[tuple[int, int]]:
    """Draw the pictures that an `Order` describes; yields (film pictures drawn, film pictures in all, 0 while unknown).
    `over`: event that is set when the run ends."""
    out = Path(order.out)
    out.mkdir(parents=True, exist_ok=True)
    with ExitStack() as stack:
        turns_of_others = range(1, order.painters) if order.film else ()
        others = [stack.enter_context(Painter(order, over, turn)) for turn in turns_of_others]
        picture, coming = begin_picture(order, over)
        if order.film:
            yield from write_film(out / "film.mp4", order, picture, coming, others)
    coming.wait()
    log = coming.log
    if order.preview:
        save_png(out / "preview.png", picture.draw(survey_run(sample_files(log.files), picture.grid)[0]))
    missing = times_without_frame(log.files, order.stills)
    for time in (time for time in order.stills if time not in missing):
        save_png(out / still_name(time), picture.draw(Frame(log.nearest(time))))
    if order.strip:
        times = np.linspace(*log.span, order.strip) if order.strip > 1 else [sum(log.span) / 2.0]
        row = picture_row([picture.draw(Frame(log.nearest(float(time)))) for time in times], STRIP_GAP)
        save_png(out / "strip.png", row)
    picture.close()


def begin_picture(order: Order, over: threading.Event) -> tuple[Picture, "ComingFrames"]:
    """`Picture` that will draw the frames of the run in an `Order` (options of its pictures), and the files of these
    frames, which may be still to come. `over`: event that is set when the run ends."""
    folder = Path(order.folder)
    with open_frame(folder / "frames" / "grid.npz") as file:
        grid = dict(file)
    if not is_foreseeable(grid, order):
        over.wait()
    coming = ComingFrames(folder, over)
    fastest = 0.1 if is_foreseeable(grid, order) else survey_run(sample_files(coming.log.files), grid)[1]
    return Picture(grid, order, Frame(coming.log.files[0]), fastest, coming.log), coming


def sample_files(files: list[Path]) -> list[Path]:
    """About sixty of many frame files, evenly chosen, from which the highest particle speed of a run is estimated."""
    return files[:: max(1, len(files) // 60)]


class ComingFrames:
    """Frame files of a run, listed as it writes them; the event `over` is set when the run ends."""

    def __init__(self, folder: Path, over: threading.Event) -> None:
        self.folder, self.over = folder, over
        self.log, self.ended = FrameLog([]), False
        self.look()

    def look(self) -> None:
        """Add new frame files to `log`; set `ended` if the run was over before this search, which then is the last."""
        ended, number = self.over.is_set(), len(self.log.files)
        if ended:
            known = {path.name for path in self.log.files}
            self.log.grow([path for path in frame_files(self.folder) if path.name not in known])
        else:
            while frame_path(self.folder, number).exists():
                number += 1
            self.log.grow([frame_path(self.folder, k) for k in range(len(self.log.files), number)])
        self.ended = ended

    def wait(self) -> None:
        self.over.wait()
        self.look()

    def chosen(self, every: float) -> Iterator[tuple[Path, int]]:
        """Yield, for each picture of a film, `every` [s] apart: its frame file, and their number, 0 while unknown."""
        done = 0
        while True:
            ended, there = self.ended, len(self.log.files)
            numbers = film_frames(self.log.times, every, ended)
            for number in numbers[done:] if ended or there > 1 else ():  # two show how fast ships begin
                yield self.log.files[number], len(numbers) if ended else 0
                done += 1
            if ended:
                return
            self.look()
            if not self.ended and len(self.log.files) == there:
                self.over.wait(LOOK_INTERVAL)


class Painter(DrawingProcess, AbstractContextManager["Painter"]):
    """Further process that draws every n-th picture of a film; the one that writes the film reads it from a pipe."""

    def __init__(self, order: Order, over: threading.Event, turn: int) -> None:
        """Start the process. `over`: event set when the run ends; `turn`: its number, from 1; this process has 0."""
        super().__init__(Request(orders=[order], goes_on=not over.is_set(), turn=turn))
        if not over.is_set():
            threading.Thread(target=self.say_over, args=(over,), daemon=True).start()

    def picture(self, size: tuple[int, int]) -> np.ndarray:
        """Next picture (height, width, 3), 8-bit RGB; raises RenderFailed if it has ended. `size`: as Order's."""
        pixels = self.given.read(3 * prod(size))
        if len(pixels) < 3 * prod(size):
            self.child.wait()
            raise self.failure()
        return np.frombuffer(pixels, np.uint8).reshape(*size[::-1], 3)

    def __exit__(self, *_: object) -> None:
        self.child.kill()
        self.child.wait()
        self.close()


def film_turns(coming: ComingFrames, every: float, of: int) -> Iterator[tuple[Path, int, int | None]]:
    """Yield for each picture of a film, `every` [s] apart: (a) its frame file; (b) the number of pictures in all, 0
    while unknown; (c) which of `of` processes draws it, from 0, or None if it equals the picture before."""
    shown, turn = None, 0
    for file, total in coming.chosen(every):
        yield file, total, None if file == shown else turn % of
        turn, shown = turn + (file != shown), file


def write_film(
    path: Path, order: Order, picture: Picture, coming: ComingFrames, others: Sequence[Painter]
) -> Iterator[tuple[int, int]]:
    """Write a film (H.264) as long as its frames `coming`, and a sheet of small pictures. `order`: options; `picture`
    draws here, processes `others` by turns with it. Yields (pictures done, pictures in all, 0 while unknown)."""
    with atomic_write(path) as draft:
        moments, image = Moments(), np.zeros(0)
        with film_writer(draft, order.every) as writer:
            for k, (file, total, whose) in enumerate(film_turns(coming, order.every, order.painters)):
                if whose is not None:
                    image = others[whose - 1].picture(picture.stage.size) if whose else picture.draw(Frame(file))
                writer.append_data(image)
                moments.see(image)
                yield k + 1, total
    save_png(path.with_name(MOMENTS_FILE), moments.sheet())


def hand_over(order: Order, over: threading.Event, turn: int) -> None:
    """Draw the pictures of a film that fall to this process, the one of number `turn` (see `film_turns`), and write
    their pixels to standard output. `order`: options of the pictures; `over`: event that is set when the run ends."""
    with os.fdopen(os.dup(sys.stdout.fileno()), "wb") as pixels:
        os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # for what else is printed
        picture, coming = begin_picture(order, over)
        for file, _, whose in film_turns(coming, order.every, order.painters):
            if whose == turn:
                pixels.write(picture.draw(Frame(file)).data)
    picture.close()


def join_film(pictures: list[Path], path: Path, every: float) -> None:
    """Write the film `path` from picture files, each shown for `every` [s]."""
    import imageio.v2 as imageio

    with atomic_write(path) as draft, film_writer(draft, every) as writer:
        for picture in pictures:
            writer.append_data(imageio.imread(picture))


def film_writer(path: Path, every: float) -> Any:
    """imageio writer of a film file; each picture appended to it is shown for `every` [s]."""
    import imageio.v2 as imageio

    return imageio.get_writer(
        path,
        fps=1.0 / every,
        codec="libx264",
        quality=8,
        macro_block_size=2,
        pixelformat="yuv420p",
        ffmpeg_params=["-preset", "veryfast", "-movflags", "+faststart"],
    )


def save_png(path: Path, image: np.ndarray) -> None:
    """Write `image` (height, width, 3), 8-bit RGB, as a PNG file, atomically."""
    import imageio.v2 as imageio

    with atomic_write(path) as draft:
        imageio.imwrite(draft, image, format="png", compress_level=6)


def hurry_when_over(over: threading.Event) -> None:
    """Wait until the run is over, then give this process and its children normal priority; runs in a thread."""
    over.wait()
    yield_to_others(0)


def main() -> None:
    """Draw the `Request` that is the first argument, in JSON."""
    over = exit_with_parent()
    request = Request.model_validate_json(sys.argv[1])
    if not request.goes_on:
        over.set()
    elif request.turn == 0:  # the others are as nice as this one
        yield_to_others(NICENESS)
        threading.Thread(target=hurry_when_over, args=(over,), daemon=True).start()
    try:
        for order in request.orders:
            if request.turn > 0:
                hand_over(order, over, request.turn)
            else:
                for done, total in draw_order(order, over):
                    print(f"pictures {done} of {total}", flush=True)
    except (RenderFailed, OSError, ValueError) as problem:
        sys.exit(str(problem))


if __name__ == "__main__":
    main()
