"""`ocean-sim preview`: a window to play with, or its pictures as numbered files."""

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Annotated, Any

import typer

from ocean_sim import runtime
from ocean_sim.conventions import Diverged
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.machine import missing_extra
from ocean_sim.observers import checkpoint, render
from ocean_sim.observers.preview import Config, Screen, require, write
from ocean_sim.parts import named
from ocean_sim.pictures.live.panel import Panel
from ocean_sim.reading.scene import SceneConfig, load, scene_path
from ocean_sim.simulation import Simulation
from ocean_sim.verbs.serve import serve
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.anew import must_compute_with
from ocean_sim.verbs.shared.bar import Bar
from ocean_sim.verbs.shared.options import Json, Profile, Scene, Sets
from ocean_sim.verbs.shared.rewind import Rewind

OWN = "of the scene"  # a wind that is not a preset
RIG = ("motion", "platform_log", "stream")  # observers that play along where a scene names `stream`
STEP_SECONDS = 0.1  # wall time for steps between two pictures of a window
FILM_INTERVALS = 1.0 / 120.0, 1.0  # [s] shortest and longest of a picture of a film


def preview(
    scene: Scene,
    profile: Profile = None,
    sets: Sets = None,
    frames: Annotated[
        int | None,
        typer.Option(min=1, help="Number of pictures to write instead of opening a window; needs no screen."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Where pictures, snapshots and recordings go; by default runs/<scene>-preview.")
    ] = None,
    camera: Annotated[str | None, typer.Option(help="third_person, helm, top or side.")] = None,
    content: Annotated[str | None, typer.Option(help="surface, particles or both.")] = None,
    browser: Annotated[bool, typer.Option("--browser", help="Use the browser instead, as `serve` does.")] = False,
    as_json: Json = False,
) -> None:
    """Open a window, or write `frames` pictures into a folder."""
    if browser:
        if frames is not None or camera is not None or content is not None:
            raise typer.BadParameter("--browser takes neither --frames nor --camera nor --content")
        serve([scene], profile, sets, out=out, as_json=as_json)
        return
    overrides: dict[str, Any] = dict(console.settings(sets))
    overrides |= {f"preview.{key}": value for key, value in (("camera", camera), ("content", content)) if value}

    def blown(wind: str) -> SceneConfig:
        if wind == OWN:
            return load(scene, overrides, profile)
        kept = {key: value for key, value in overrides.items() if key.split(".")[0] != "wind"}
        return load(scene, kept | {"wind": wind}, profile)

    config = blown(OWN)
    must_compute_with(config.runtime.library)
    folder = out or Path("runs") / f"{scene_path(scene).stem}-preview"
    if frames is not None and (folder / picture(0)).exists():
        raise console.Refused(f"--out {folder}: there are pictures here already; name another folder")
    require(show=frames is None)
    with console.claim(folder):
        session = Session(config, folder, blown, frames is None)
        try:
            if frames is None:
                session.play()
            else:
                session.film(frames, as_json)
        finally:
            session.close()
    if as_json:
        console.answer(session.facts())
    else:
        console.say(session.summary())


def picture(number: int) -> str:
    """The name of a numbered picture."""
    return f"{number:05d}.png"


class Session:
    """A scene that is stepped, drawn, and played with."""

    def __init__(self, config: SceneConfig, folder: Path, blown: Callable[[str], SceneConfig], shown: bool) -> None:
        """`blown`: the scene with another preset of wind, by name; raises SceneError. `shown`: in a window."""
        self.config, self.folder, self.blown, self.shown = config, folder, blown, shown
        look, kept = config.observers.get("preview"), config.observers.get("checkpoint")
        self.look = look if isinstance(look, Config) else Config(size=(1280, 720))
        self.away = TemporaryDirectory(prefix="ocean-sim-")  # files of observers, which are thrown away
        every = (kept if isinstance(kept, checkpoint.Config) else checkpoint.Config()).every
        self.rewind = Rewind(every, Path(self.away.name))
        self.simulation = self.built()
        own = "still" if config.wind.still else OWN
        self.panel = Panel(list(dict.fromkeys([own, *named("wind"), "still"])), own)
        self.playing = own  # wind of the simulation
        self.screen: Any = None
        self.milliseconds: list[float] = []
        self.pictures = self.snapshots = self.recordings = self.recorded = 0

    def open(self, show: bool) -> None:
        self.screen = Screen(self.look, show)
        self.screen.watch(self.simulation, self.panel, self.look)

    def film(self, frames: int, quiet: bool) -> None:
        """Numbered pictures every `preview.every` of simulated time, from the beginning on."""
        self.open(show=False)
        self.folder.mkdir(parents=True, exist_ok=True)
        bar = Bar(frames, quiet)
        for number in range(frames):
            self.advance(number * self.look.every)
            begin = perf_counter()
            self.screen.draw(self.panel)
            image = self.screen.image()
            self.milliseconds.append(1e3 * (perf_counter() - begin))
            write(self.folder / picture(number), image)
            self.pictures += 1
            bar.show(number + 1, f"picture {number + 1} of {frames}, t = {self.simulation.time:.2f} s")
        bar.close()
        if frames > 1:
            self.join(self.folder, self.look.every)

    def advance(self, until: float) -> None:
        """Step until a time [s]."""
        if self.simulation.time < until * (1.0 - 1e-12):
            self.simulation.run(until)

    def play(self) -> None:
        """The window, until it is closed."""
        self.open(show=True)
        last = perf_counter()
        while not self.panel.closed:
            now = perf_counter()
            wall, last = now - last, now
            self.screen.listen(self.panel, wall)
            self.obey()
            before = self.simulation.time
            self.go_on(min(wall, self.look.every))
            self.milliseconds = [1e3 * wall]
            pace = (self.simulation.time - before) / wall if wall > 0.0 else None
            self.screen.draw(self.panel, pace)
            if self.panel.take("snapshot"):
                self.folder.mkdir(parents=True, exist_ok=True)
                write(free_name(self.folder, "snapshot_{:03d}.png"), self.screen.image())
                self.snapshots += 1
            self.record()
            self.screen.show()
            self.pictures += 1

    def obey(self) -> None:
        """Do the actions asked for since the last picture, but snapshots."""
        panel = self.panel
        if panel.take("helm") and panel.ship:
            panel.person = self.simulation.ships[panel.ship].hand_over()
        reset, wind, back = panel.take("reset"), panel.take("wind"), panel.take("rewind")
        if reset or (wind and panel.wind != self.playing):
            self.rebuild(panel.wind)
        elif back:
            self.go_back()

    def go_back(self) -> None:
        """Return to the newest moment that is kept; the helm stays with the person."""
        panel, steered = self.panel, self.panel.person is not None
        moments = self.rewind.earlier(self.simulation.time)
        if not moments:
            panel.message = "nothing is kept yet to go back to"
            return
        panel.wind = self.playing
        self.rebuild(self.playing)
        self.rewind.restore(self.simulation, moments)
        if steered:
            panel.person = self.simulation.ships[panel.ship].hand_over()

    def rebuild(self, wind: str) -> None:
        """Begin the scene anew with a preset of wind; in a new window where Taichi has to restart."""
        panel = self.panel
        try:
            config = self.config if wind == self.playing else self.blown(wind)
        except SceneError as error:
            panel.message, panel.wind = f"{wind}: {error.problems[0].message}", self.playing
            return
        self.config, self.playing, panel.message = config, wind, ""
        with runtime.Fields():  # something stays open, for which Taichi goes on, and the window with it
            self.simulation.close()
            restarted = runtime.must_restart(config.runtime)
            if restarted:
                self.screen.close()
            self.simulation = self.built()
        self.rewind.forget()
        if restarted:
            self.open(self.screen.shown)
        else:
            self.screen.watch(self.simulation, panel)

    def go_on(self, span: float) -> None:
        """Step over a span of simulated time [s], as far as there is wall time; once, where that was asked for."""
        panel, begin = self.panel, perf_counter()
        until = self.simulation.time + span
        single = panel.take("step")
        self.rewind.keep(self.simulation)
        try:
            while single or (not panel.paused and self.simulation.time < until):
                self.simulation.run(self.simulation.time + 0.5 * self.simulation.next_dt)
                if single or perf_counter() - begin > STEP_SECONDS:
                    break
        except Diverged as failure:
            panel.paused, panel.message = True, f"diverged: {failure}. Reset starts again, w goes back."

    def record(self) -> None:
        """One more picture of a recording; each recording is a folder of its own."""
        if not self.panel.recording:
            self.cut()
            return
        if self.recorded == 0:
            self.reel = free_name(self.folder, "recording_{:03d}")
            self.reel.mkdir(parents=True)
            self.recordings += 1
            self.began = self.simulation.time
        write(self.reel / picture(self.recorded), self.screen.image())
        self.recorded += 1

    def cut(self) -> None:
        """End the recording, if there is one, with a film that runs as simulated time did."""
        count, self.recorded = self.recorded, 0
        if count > 1:
            span = self.simulation.time - self.began
            self.join(self.reel, span / count if span > 0.0 else self.look.every)

    def join(self, folder: Path, every: float) -> None:
        """A film of the numbered pictures of a folder, one for so much time [s]; they stay."""
        missing = missing_extra("pictures")
        if missing:
            self.panel.message = f"no film, but its pictures are there: {missing}"
            console.complain(self.panel.message)
            return
        shortest, longest = FILM_INTERVALS
        render.join(sorted(folder.glob("[0-9]*.png")), folder / "film.mp4", min(max(every, shortest), longest))

    def close(self) -> None:
        self.cut()
        if self.screen is not None:
            self.screen.close()
        self.simulation.close()
        self.away.cleanup()

    def built(self) -> Simulation:
        """The simulation; where the scene of a window names `stream`, who steers rides on the platform it drives."""
        if not self.shown or "stream" not in self.config.observers:
            return Simulation(self.config)
        playing = {name: part for name, part in self.config.observers.items() if name in RIG or not part.writes}
        return Simulation(self.config.model_copy(update={"observers": playing}), Path(self.away.name))

    def facts(self) -> dict[str, Any]:
        """Numbers of what was drawn, for programs."""
        drawn = sorted(self.milliseconds[1:] or self.milliseconds)
        return {
            "pictures": self.pictures,
            "simulated_s": self.simulation.time,
            "ms_per_picture": drawn[len(drawn) // 2] if drawn else None,
            "folder": str(self.folder),
            "snapshots": self.snapshots,
            "recordings": self.recordings,
        }

    def summary(self) -> str:
        facts = self.facts()
        sentence = f"{facts['pictures']} pictures, {facts['simulated_s']:.3g} s simulated"
        if facts["ms_per_picture"] is not None:
            sentence += f", {facts['ms_per_picture']:.0f} ms a picture"
        return f"{sentence}; {facts['folder']}" if self.folder.exists() else sentence


def free_name(folder: Path, pattern: str) -> Path:
    """The first of numbered names that is not taken."""
    k = 0
    while (folder / pattern.format(k)).exists():
        k += 1
    return folder / pattern.format(k)
