"""`ocean-sim preview`: a window to play with, or its pictures as numbered files."""

from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import typer

from ocean_sim import runtime
from ocean_sim.conventions import Diverged
from ocean_sim.machine import missing_extra
from ocean_sim.observers import render
from ocean_sim.observers.preview import Config, Screen, require, write_png
from ocean_sim.reading.scene import SceneConfig, load, scene_path
from ocean_sim.simulation import Simulation
from ocean_sim.verbs.serve import LOCAL_HOST, serve
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.bar import Bar
from ocean_sim.verbs.shared.options import Profile, Scene, Sets

RIG_OBSERVERS = ("motion", "platform_log", "stream")  # observers that play along where a scene names `stream`
STEP_SECONDS = 0.1  # wall time for steps between two pictures of a window
MIN_FILM_INTERVAL, MAX_FILM_INTERVAL = 1.0 / 120.0, 1.0  # [s] of a picture of a film


def preview(
    scene: Scene,
    profile: Profile = None,
    sets: Sets = None,
    frames: int | None = typer.Option(
        None, min=1, help="Number of pictures to write instead of opening a window; needs no screen."
    ),
    out: Path | None = typer.Option(None, help="Where pictures and snapshots go; by default runs/<scene>-preview."),
    camera: str | None = typer.Option(None, help="third_person, helm, top or side."),
    content: str | None = typer.Option(None, help="surface, particles or both."),
    browser: bool = typer.Option(False, "--browser", help="Use the browser instead, as `serve` does."),
) -> None:
    """Open a window, or write `frames` pictures into a folder."""
    if browser:
        if frames is not None or camera is not None or content is not None:
            raise typer.BadParameter("--browser takes neither --frames nor --camera nor --content")
        serve([scene], profile, sets, LOCAL_HOST, None, True, out)
        return
    overrides: dict[str, Any] = dict(console.set_values(sets))
    overrides |= {f"preview.{key}": value for key, value in (("camera", camera), ("content", content)) if value}
    config = load(scene, overrides, profile)
    console.must_compute_with(config.runtime.library)
    folder = out or Path("runs") / f"{scene_path(scene).stem}-preview"
    if frames is not None and (folder / picture_name(0)).exists():
        raise console.Refused(f"--out {folder}: there are pictures here already; name another folder")
    require(show=frames is None)
    with console.claim(folder):
        session = Session(config, folder, frames is None)
        try:
            if frames is None:
                session.play()
            else:
                session.film(frames)
        finally:
            session.close()
    console.reply(session.facts(), session.summary())


def picture_name(number: int) -> str:
    return f"{number:05d}.png"


class Session:
    """A scene that runs in a preview window under the user's control, or is drawn into files."""

    def __init__(self, config: SceneConfig, folder: Path, shown: bool) -> None:
        """`folder`: for pictures and snapshots; `shown`: True to draw in a window on the screen."""
        self.config, self.folder, self.shown = config, folder, shown
        look = config.observers.get("preview")
        self.look = look if isinstance(look, Config) else Config(size=(1280, 720))
        self.scratch = TemporaryDirectory(prefix="ocean-sim-")  # files of observers, which are thrown away
        self.simulation = self.build()
        self.panel = self.look.first_panel()
        self.screen: Any = None
        self.milliseconds: list[float] = []
        self.pictures = self.snapshots = 0

    def open(self, show: bool) -> None:
        """Open a window that shows the simulation, on the screen or, with `show` false, hidden."""
        self.screen = Screen(self.look, show)
        self.screen.watch(self.simulation, self.panel)

    def film(self, frames: int) -> None:
        """Write so many numbered pictures, one every `preview.every` s of simulated time, and a film of them."""
        self.open(show=False)
        self.folder.mkdir(parents=True, exist_ok=True)
        bar = Bar(frames)
        for number in range(frames):
            until = number * self.look.every
            if self.simulation.time < until * (1.0 - 1e-12):
                self.simulation.run(until)
            begin = perf_counter()
            self.screen.draw(self.panel)
            image = self.screen.image()
            self.milliseconds.append(1e3 * (perf_counter() - begin))
            write_png(self.folder / picture_name(number), image)
            self.pictures += 1
            bar.show(number + 1, f"picture {number + 1} of {frames}, t = {self.simulation.time:.2f} s")
        bar.close()
        missing = missing_extra("pictures")
        if frames > 1 and missing:
            console.complain(f"no film, but its pictures are there: {missing}")
        elif frames > 1:
            every = min(max(self.look.every, MIN_FILM_INTERVAL), MAX_FILM_INTERVAL)
            render.join_film(sorted(self.folder.glob("[0-9]*.png")), self.folder / "film.mp4", every)

    def play(self) -> None:
        """Step, draw and follow the user's input, until the window is closed."""
        self.open(show=True)
        last = perf_counter()
        while not self.panel.closed:
            now = perf_counter()
            wall, last = now - last, now
            self.screen.listen(self.panel, wall)
            self.obey()
            before = self.simulation.time
            self.advance(min(wall, self.look.every))
            self.milliseconds = [1e3 * wall]
            self.screen.draw(self.panel, (self.simulation.time - before) / wall if wall > 0.0 else None)
            if self.panel.take("snapshot"):
                self.folder.mkdir(parents=True, exist_ok=True)
                taken = list(self.folder.glob("snapshot_*.png"))
                write_png(self.folder / f"snapshot_{len(taken):03d}.png", self.screen.image())
                self.snapshots += 1
            self.screen.show()
            self.pictures += 1

    def obey(self) -> None:
        """Carry out the user's requests since the last picture: to take the helm, or to reset the scene."""
        panel = self.panel
        if panel.take("helm") and panel.ship:
            panel.person = self.simulation.ships[panel.ship].hand_over()
        if panel.take("reset"):
            self.reset()

    def reset(self) -> None:
        """Restart the scene; if Taichi itself has to restart, open a new window."""
        self.panel.message = ""
        with runtime.Fields():  # something stays open, for which Taichi goes on, and the window with it
            self.simulation.close()
            restarted = runtime.must_restart(self.config.runtime)
            if restarted:
                self.screen.close()
            self.simulation = self.build()
        if restarted:
            self.open(self.screen.shown)
        else:
            self.screen.watch(self.simulation, self.panel)

    def advance(self, span: float) -> None:
        """Advance by `span` [s] of simulated time, less if that takes too long; one step if the user asked so."""
        panel, begin = self.panel, perf_counter()
        until = self.simulation.time + span
        single = panel.take("step")
        try:
            while single or (not panel.paused and self.simulation.time < until):
                self.simulation.run(self.simulation.time + 0.5 * self.simulation.next_dt)
                if single or perf_counter() - begin > STEP_SECONDS:
                    break
        except Diverged as failure:
            panel.paused, panel.message = True, f"diverged: {failure}. Reset starts again."

    def close(self) -> None:
        if self.screen is not None:
            self.screen.close()
        self.simulation.close()
        self.scratch.cleanup()

    def build(self) -> Simulation:
        """Build the simulation; shown in a window, it also drives the motion platform of a scene that has `stream`."""
        if not self.shown or "stream" not in self.config.observers:
            return Simulation(self.config)
        observers = self.config.observers.items()
        playing = {name: part for name, part in observers if name in RIG_OBSERVERS or not part.writes}
        return Simulation(self.config.model_copy(update={"observers": playing}), Path(self.scratch.name))

    def facts(self) -> dict[str, Any]:
        drawn = sorted(self.milliseconds[1:] or self.milliseconds)
        return {
            "pictures": self.pictures,
            "simulated_s": self.simulation.time,
            "ms_per_picture": drawn[len(drawn) // 2] if drawn else None,
            "folder": str(self.folder),
            "snapshots": self.snapshots,
        }

    def summary(self) -> str:
        facts = self.facts()
        sentence = f"{facts['pictures']} pictures, {facts['simulated_s']:.3g} s simulated"
        if facts["ms_per_picture"] is not None:
            sentence += f", {facts['ms_per_picture']:.0f} ms a picture"
        return f"{sentence}; {facts['folder']}" if self.folder.exists() else sentence
