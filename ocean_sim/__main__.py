"""The command line `ocean-sim`: one thin function a verb; exit codes 0 done, 1 failed, 2 wrong input, 3 lacking."""

import sys

try:
    import gc
    import os
    from errno import ENAMETOOLONG
    from pathlib import Path
    from typing import Annotated, Any

    import typer

    from ocean_sim.conventions import AxisName, Failed, Refused, in_words
    from ocean_sim.files.input_file import shown
    from ocean_sim.files.whole_file import whole
    from ocean_sim.machine import extra_missing, extra_of, stoppable
    from ocean_sim.verbs.shared import console
    from ocean_sim.verbs.shared.anew import Anew
except KeyboardInterrupt:  # these take as long as it takes to press Ctrl-C
    sys.exit("stopped")

app = typer.Typer(
    name="ocean-sim",
    epilog="Exit codes: 0 done, 1 the run failed, 2 the input is wrong, 3 the machine lacks something. "
    "With --debug anywhere, an error shows its traceback.",
    no_args_is_help=True,
    add_completion=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

# what typer raises where the command line is wrong; some of its versions take it from click, some bring their own
WrongUsage: Any = typer.BadParameter.__mro__[2]


def scenes(begun: str) -> list[str]:
    """For a shell that completes: packaged scenes, and scene files."""
    from ocean_sim.reading.scene import packaged_scenes

    folder = Path(begun) if begun.endswith("/") else Path(begun).parent
    there = [path for path in folder.glob("*") if path.is_dir() or path.suffix in (".yaml", ".yml")]
    files = [f"{path}/" if path.is_dir() else str(path) for path in there]
    return [name for name in (*packaged_scenes(), *sorted(files)) if name.startswith(begun)]


def profiles(begun: str) -> list[str]:
    from ocean_sim.parts import named

    return [name for name in named("run") if name.startswith(begun)]


def paths_of_keys(begun: str) -> list[str]:
    from ocean_sim.reading.keys import keys

    return [key.path for key in keys() if key.path.startswith(begun)]


def sections(begun: str) -> list[str]:
    from ocean_sim.verbs.list import SECTIONS

    return [name for name in SECTIONS if name.startswith(begun)]


def cases_of_validation(begun: str) -> list[str]:
    from ocean_sim.validation import names

    return [name for name in names() if name.startswith(begun)]


def figures(begun: str) -> list[str]:
    from ocean_sim.verbs.figure import scripts

    return [name for name in (*scripts(), "all") if name.startswith(begun)]


Scene = Annotated[
    str,
    typer.Argument(
        help="A scene file, or the name of a packaged scene (ocean-sim list scenes).", autocompletion=scenes
    ),
]
Profile = Annotated[
    str | None,
    typer.Option(
        help="A profile, which says what the machine can afford: a name in configs/run/.", autocompletion=profiles
    ),
]
Sets = Annotated[
    list[str] | None,
    typer.Option("--set", help="key=value, laid over the scene, as fluid.spacing=0.8; may be given several times."),
]
Out = Annotated[Path | None, typer.Option(help="The run folder; by default runs/<scene>.")]
Json = Annotated[bool, typer.Option("--json", help="Print the answer as JSON.")]
Quiet = Annotated[bool, typer.Option("--quiet", help="Print only the run folder, and errors.")]


def show_version(asked: bool) -> None:
    if asked:
        from ocean_sim.machine import installed

        console.say(f"ocean-sim {installed('ocean-sim')}")
        raise typer.Exit


@app.callback()
def program(
    version: Annotated[
        bool, typer.Option("--version", help="Print the version and exit.", callback=show_version, is_eager=True)
    ] = False,
) -> None:
    """A particle ocean with wind, ships and a motion platform, from a YAML scene to pictures and data."""


@app.command()
def run(
    scene: Scene,
    profile: Profile = None,
    sets: Sets = None,
    out: Out = None,
    until: Annotated[float | None, typer.Option(help="Simulated time [s], instead of the scene's duration.")] = None,
    overwrite: Annotated[bool, typer.Option(help="Replace a run that is already in --out.")] = False,
    frame: Annotated[str | None, typer.Option(help="Axes of motion.csv: ship, ned or flu.")] = None,
    quiet: Quiet = False,
    json: Json = False,
) -> None:
    """Simulate a scene and write its run folder."""
    from ocean_sim.verbs.run import run

    axes = [] if frame is None else [f"motion.frame={frame}"]
    run(scene, profile, [*(sets or []), *axes], out, until, overwrite, json, quiet)


@app.command()
def resume(
    run: Annotated[Path, typer.Argument(help="A run folder with checkpoints.")],
    until: Annotated[float | None, typer.Option(help="Simulated time [s], instead of the scene's duration.")] = None,
    anyway: Annotated[bool, typer.Option("--anyway", help="Go on even if the program has changed since.")] = False,
    quiet: Quiet = False,
    json: Json = False,
) -> None:
    """Go on with a run from its last checkpoint."""
    from ocean_sim.verbs.resume import resume

    resume(run, until, anyway, json, quiet)


@app.command()
def check(scene: Scene, profile: Profile = None, sets: Sets = None, json: Json = False) -> None:
    """What a scene needs, and what is wrong with it, without running it."""
    from ocean_sim.verbs.check import check

    check(scene, profile, sets or [], json)


@app.command()
def explain(
    key: Annotated[
        str,
        typer.Argument(
            help="A key such as wind.stress.u10, or without the kind: wind.u10.", autocompletion=paths_of_keys
        ),
    ],
    json: Json = False,
) -> None:
    """One key of a scene: meaning, unit, default, range, example."""
    from ocean_sim.verbs.explain import explain

    explain(key, json)


@app.command()
def new(
    file: Annotated[Path, typer.Argument(help="The scene file to write.")],
    source: Annotated[
        str, typer.Option("--from", help="The scene to start from: a name or a file.", autocompletion=scenes)
    ] = "showcase",
    json: Json = False,
) -> None:
    """A scene of your own to start from, every key with a comment."""
    from ocean_sim.verbs.new import new

    new(file, source, json)


@app.command("list")
def list_(
    slot: Annotated[
        str | None,
        typer.Argument(help="scenes, observers, cases, figures, or a slot such as wind.", autocompletion=sections),
    ] = None,
    json: Json = False,
) -> None:
    """Scenes, parts, kinds and profiles, each with one sentence."""
    from ocean_sim.verbs.list import list_choices

    list_choices(slot, json)


@app.command()
def schema(
    out: Annotated[Path | None, typer.Option(help="A file to write instead of standard output.")] = None,
    json: Annotated[bool, typer.Option("--json", help="The output is always JSON.")] = True,
) -> None:
    """The JSON Schema of a scene, for editors."""
    from ocean_sim.reading.schema import text

    if out is None:
        with console.OUTPUT:
            sys.stdout.write(text())
            sys.stdout.flush()
    else:
        with whole(out) as draft:
            draft.write_text(text(), encoding="utf-8")


@app.command()
def doctor(json: Json = False) -> None:
    """What this machine can do: backends, Vulkan, OpenGL, video; each probed in a child process that may crash."""
    from ocean_sim.verbs.doctor import doctor

    doctor(json)


@app.command()
def bench(
    scenes: Annotated[
        list[str] | None, typer.Argument(help="By default bench/dam_break_6k and bench/dam_break_50k.")
    ] = None,
    profile: Profile = None,
    sets: Sets = None,
    threads: Annotated[int | None, typer.Option(min=1, help="Worker threads; by default all cores.")] = None,
    repeats: Annotated[
        int, typer.Option(min=1, help="Number of blocks, each of at least half a second; the median counts.")
    ] = 5,
    cold: Annotated[bool, typer.Option(help="Start with an empty kernel cache, as on a first run.")] = False,
    peers: Annotated[
        bool, typer.Option("--peers", help="Also time pysplashsurf and Capytaine on the same tasks, where installed.")
    ] = False,
    peer_python: Annotated[
        list[Path] | None,
        typer.Option(
            help="With --peers: the Python of an environment that has pysplishsplash, pysph or both, for dam breaks; "
            "may be given several times."
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Speed alone: milliseconds a step, particle-steps per second, time to the first step, peak memory."""
    from ocean_sim.verbs.bench import bench

    if peer_python and not peers:
        raise typer.BadParameter("--peer-python goes with --peers")
    bench(scenes or [], profile, sets or [], threads, repeats, cold, peers, peer_python or [], json)


@app.command()
def validate(
    cases: Annotated[
        list[str] | None,
        typer.Argument(
            help="Cases, or patterns such as 'open_*'; by default all (ocean-sim list cases).",
            autocompletion=cases_of_validation,
        ),
    ] = None,
    scheme: Annotated[
        list[str] | None,
        typer.Option(help="A kind of fluid or ship; give it twice to compare two. By default delta_sph."),
    ] = None,
    slow: Annotated[
        bool,
        typer.Option(
            "--slow", help="Also run the set-ups that take minutes; with --coarse, those too long for a gate."
        ),
    ] = False,
    coarse: Annotated[
        bool,
        typer.Option(
            "--coarse",
            help="A gate for CI: twice the spacing or more, tolerances of its own, no long cases.",
        ),
    ] = False,
    sets: Sets = None,
    out: Annotated[Path, typer.Option(help="Where validate.csv and the pictures go.")] = Path("runs/validate"),
    junit: Annotated[
        Path | None, typer.Option(help="Also write a report in JUnit's XML, which CI services read.")
    ] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Cases at a time; by default one per core.")] = None,
    json: Json = False,
) -> int:
    """Problems with known answers: value, reference, error, tolerance, and where the tolerance comes from."""
    from ocean_sim.verbs.validate import validate

    with console.claim(out, "validate.csv", "*.png"):
        return validate(cases or [], scheme or [], slow, coarse, sets or [], workers, out, junit, json)


@app.command()
def hull(
    name: Annotated[
        str, typer.Argument(help="The name of a hull, a ship or a scene; a scene file; or an STL, OBJ or PLY file.")
    ],
    mass: Annotated[
        float | None, typer.Option(min=0.001, help="Mass of the whole ship [kg]; by default that of the hull.")
    ] = None,
    draught: Annotated[float | None, typer.Option(min=0.0001, help="Draught [m], upright, instead of a mass.")] = None,
    kg: Annotated[float | None, typer.Option(help="Height of the centre of mass above the keel [m].")] = None,
    cg: Annotated[
        str | None, typer.Option(help="Centre of mass X,Y,Z [m] from the keel amidships: to port, up, forward.")
    ] = None,
    loading: Annotated[
        Path | None,
        typer.Option(
            help="A loading condition (YAML): light: {mass: 250000, at: [0, 2.5, 0]}; weights, tanks, openings by name."
        ),
    ] = None,
    density: Annotated[
        float | None, typer.Option(min=1.0, help="Density of the water [kg/m3]; by default 1000.")
    ] = None,
    ship: Annotated[str | None, typer.Option(help="Which ship, where a scene has several.")] = None,
    cross: Annotated[bool, typer.Option("--cross", help="Also print cross curves of stability.")] = False,
    bilge_keels: Annotated[
        str | None, typer.Option(help="LENGTH,BREADTH of each bilge keel [m]: also print the damping of roll.")
    ] = None,
    depth: Annotated[
        float | None, typer.Option(min=0.001, help="Depth of the water [m]: also print squat over speed.")
    ] = None,
    cells: Annotated[float, typer.Option(min=1.0, max=64.0, help="Number of cubes over the draught.")] = 16.0,
    up: Annotated[
        AxisName | None, typer.Option(help="Axis of a mesh file that points up, -z where z points down; else guessed.")
    ] = None,
    bow: Annotated[
        AxisName | None, typer.Option(help="Axis of a mesh file that points to the bow; by default the longest.")
    ] = None,
    scale: Annotated[
        float | None,
        typer.Option(min=1e-9, help="Metres per unit of a mesh file: 0.001 for millimetres; else guessed."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="The picture; by default runs/hull/<name>.png, with --json none.")
    ] = None,
    json: Json = False,
) -> int:
    """Is this a ship: watertight, volume, draught, trim, stability and its criteria, natural periods, picture."""
    from ocean_sim.verbs.hull import Asked, hull
    from ocean_sim.verbs.shared.after import numbers

    at = numbers("--cg", cg)
    if at is not None and len(at) != 3:
        raise console.Refused(f"--cg: {cg!r} is not like 0,1.2,-0.3")
    centre = None if at is None else (at[0], at[1], at[2])
    keels = numbers("--bilge-keels", bilge_keels)
    if keels is not None and (len(keels) != 2 or min(keels) <= 0.0):
        raise console.Refused(f"--bilge-keels: {bilge_keels!r} is not like 12,0.3")
    plates = None if keels is None else (keels[0], keels[1])
    asked = Asked(mass, draught, kg, centre, density, cells, cross, plates, depth, up, bow, scale)
    return hull(name, asked, loading, ship, out, json)


@app.command("bench-one", hidden=True)
def bench_one(order: str, json: Json = False) -> None:
    """One scene of `bench`, measured in this process."""
    from json import loads

    from ocean_sim.verbs.bench import bench_one

    bench_one(loads(order))


@app.command()
def render(
    run: Annotated[Path, typer.Argument(help="A run folder.")],
    camera: Annotated[
        str, typer.Option(help="third_person, follow, orbit, fixed, first_person, top or side.")
    ] = "third_person",
    quality: Annotated[str, typer.Option(help="draft or final.")] = "final",
    size: Annotated[str | None, typer.Option(help="Width and height in pixels, both even, as 1280x720.")] = None,
    stills: Annotated[str | None, typer.Option(help="Times [s] of further pictures: 2,4.5,6.")] = None,
    strip: Annotated[int, typer.Option(help="Number of pictures side by side in strip.png.")] = 0,
    film: Annotated[bool, typer.Option("--film/--no-film", help="Make film.mp4.")] = True,
    fps: Annotated[float | None, typer.Option(help="Pictures a second of the film, which runs in real time.")] = None,
    particles: Annotated[bool, typer.Option("--particles", help="Draw particles instead of the surface.")] = False,
    eye: Annotated[str | None, typer.Option(help="X,Y,Z [m] of the fixed camera.")] = None,
    target: Annotated[str | None, typer.Option(help="X,Y,Z [m] at which the fixed camera looks.")] = None,
    ship: Annotated[str | None, typer.Option(help="The ship that a camera follows, where there are several.")] = None,
    caption: Annotated[bool, typer.Option("--caption/--no-caption", help="Write the time into the pictures.")] = True,
    outline: Annotated[bool, typer.Option("--outline", help="Draw where the basin ends.")] = False,
    scale_bar: Annotated[
        bool,
        typer.Option("--scale-bar", help="Draw a scale bar; on maps the colours of heights, with --wind an arrow's."),
    ] = False,
    wind: Annotated[bool, typer.Option("--wind", help="Draw where the wind blows, and in which direction.")] = False,
    out: Annotated[Path | None, typer.Option(help="Where to write; by default the run folder.")] = None,
    json: Json = False,
) -> None:
    """Pictures and a film from a finished run, without simulating again."""
    from ocean_sim.verbs.shared.after import numbers, pixels, render

    asked = {
        "camera": camera,
        "quality": quality,
        "size": pixels(size),
        "stills": numbers("--stills", stills),
        "strip": strip,
        "film": film,
        "particles": particles,
        "eye": numbers("--eye", eye),
        "target": numbers("--target", target),
        "ship": ship,
        "caption": caption,
        "outline": outline,
        "scale_bar": scale_bar,
        "wind": wind,
    }
    render(run, asked, fps, out, json)


@app.command()
def export(
    run: Annotated[Path, typer.Argument(help="A run folder.")],
    particles: Annotated[
        str | None, typer.Option(help="vtkhdf: all in one file; ply: points, one file a frame.")
    ] = None,
    surface: Annotated[str | None, typer.Option(help="ply or vtp: one mesh a frame; vtkhdf: all in one file.")] = None,
    scene: Annotated[
        str | None,
        typer.Option(
            help="usd: water, ships, obstacles and particles in one file; glb: all but particles. No file has walls."
        ),
    ] = None,
    z_up: Annotated[bool, typer.Option("--z-up", help="Write files in which z, not y, points up.")] = False,
    every: Annotated[int, typer.Option(min=1, help="Export every Nth frame.")] = 1,
    out: Annotated[Path | None, typer.Option(help="Where to write; by default the folder export/ of the run.")] = None,
    json: Json = False,
) -> None:
    """Files for ParaView and Blender."""
    from ocean_sim.verbs.shared.after import export

    export(run, particles, surface, scene, z_up, every, out, json)


@app.command()
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
    json: Json = False,
) -> None:
    """A window to look and steer in, or the same pictures without a window; `--browser` has sliders and plots, too."""
    if browser:
        from ocean_sim.verbs.serve import serve

        if frames is not None or camera is not None or content is not None:
            raise typer.BadParameter("--browser takes neither --frames nor --camera nor --content")
        serve([scene], profile, sets or [], "127.0.0.1", None, True, out, json)
        return
    from ocean_sim.verbs.preview import preview

    preview(scene, profile, sets or [], frames, out, camera, content, json)


@app.command()
def serve(
    targets: Annotated[
        list[str], typer.Argument(metavar="SCENE|RUN...", help="A scene, a finished run, or two of them side by side.")
    ],
    profile: Profile = None,
    sets: Sets = None,
    host: Annotated[
        str, typer.Option(help="Where to listen; 0.0.0.0 lets other machines in, by an address with a random token.")
    ] = "127.0.0.1",
    port: Annotated[
        int | None, typer.Option(min=1, max=65535, help="The port; by default 8765, or any free one.")
    ] = None,
    show: Annotated[
        bool, typer.Option("--open/--no-open", help="Open the page in the browser, where there is one.")
    ] = True,
    out: Annotated[
        Path | None, typer.Option(help="Where records and saved scenes go; by default runs/<scene>-browser.")
    ] = None,
    json: Json = False,
) -> None:
    """A page in the browser: play with a scene, or look at a finished run; prints its address."""
    from ocean_sim.verbs.serve import serve

    serve(targets, profile, sets or [], host, port, show, out, json)


@app.command()
def report(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN [RUN]", help="A run folder, or two to compare.")],
    out: Annotated[Path | None, typer.Option(help="The page; by default replay.html in the run folder.")] = None,
    json: Json = False,
) -> None:
    """A page with the replay of a run, or of two side by side: one file that opens without a server."""
    from ocean_sim.verbs.serve import report

    report(runs, out, json)


@app.command()
def waves(
    run: Annotated[Path, typer.Argument(help="A run folder, or its gauges.csv.")],
    begin: Annotated[float, typer.Option(help="Ignore the record before this time [s].")] = 0.0,
    detrend: Annotated[
        bool, typer.Option("--detrend", help="Subtract the straight line fitted to each record.")
    ] = False,
    hysteresis: Annotated[
        float, typer.Option(min=0.0, help="Count a wave only if it goes this far below and above zero [m].")
    ] = 0.0,
    out: Annotated[
        Path | None, typer.Option(help="Where the plot and the spectra go; by default next to the record.")
    ] = None,
    json: Json = False,
) -> None:
    """Waves from the gauges of a run: heights, periods, spectrum, zero crossings."""
    from ocean_sim.verbs.waves import waves
    from ocean_sim.waves.record import Treatment

    waves(run, begin, Treatment(detrend, hysteresis), out, json)


@app.command()
def sea(
    scene: Scene,
    sets: Sets = None,
    swd: Annotated[Path | None, typer.Option(help="A spectral-wave-data file (.swd) to write.")] = None,
    openfast: Annotated[
        Path | None, typer.Option(help="An elevation file of OpenFAST (.Elev, WaveMod 5) to write.")
    ] = None,
    at: Annotated[str, typer.Option(help="X,Z [m], the point of that elevation.")] = "0,0",
    every: Annotated[float, typer.Option(min=0.001, help="Time between its rows [s].")] = 0.1,
    until: Annotated[float | None, typer.Option(min=0.001, help="Its end [s]; by default that of the scene.")] = None,
    json: Json = False,
) -> None:
    """The waves of a scene as files for other programs: spectral-wave-data, OpenFAST."""
    from ocean_sim.verbs.sea import sea
    from ocean_sim.verbs.shared.after import numbers

    sea(scene, sets or [], swd, openfast, numbers("--at", at) or [], every, until, json)


@app.command()
def figure(
    names: Annotated[
        list[str],
        typer.Argument(
            help="Figures such as 6-3, or `all` of the thesis (ocean-sim list figures).", autocompletion=figures
        ),
    ],
    fast: Annotated[bool, typer.Option("--fast", help="Coarse and short, for a quick look.")] = False,
    out: Annotated[Path, typer.Option(help="Where data (CSV) and pictures (PNG) go.")] = Path("runs/figures"),
    json: Json = False,
) -> int:
    """The figures of the thesis, drawn anew: data and picture of each."""
    from ocean_sim.verbs.figure import figure

    with console.claim(out):
        return figure(names, fast, out, json)


@app.command()
def gallery(
    names: Annotated[list[str] | None, typer.Argument(help="Pictures; by default those that are out of date.")] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Only list those that are out of date, with their commands.")
    ] = False,
    every: Annotated[bool, typer.Option("--all", help="Make all of them.")] = False,
    out: Annotated[
        Path | None, typer.Option(help="Where to write; by default figures/gallery of this checkout.")
    ] = None,
    json: Json = False,
) -> int:
    """The pictures of the README, made again by the commands that it prints."""
    from ocean_sim.verbs.gallery import gallery

    return gallery(names or [], check, every, out, json)


@app.command()
def platform(
    log: Annotated[Path, typer.Argument(help="A motion log, or a run folder that has one.")],
    geometry: Annotated[str, typer.Option(help="A name in configs/geometry/, or a file.")] = "hexapod_a",
    washout: Annotated[str, typer.Option(help="A name in configs/washout/, or a file.")] = "ship",
    ramp: Annotated[
        float | None, typer.Option(min=0.0, help="Time [s] from neutral to the motion, and back at the end.")
    ] = None,
    sets: Annotated[
        list[str] | None,
        typer.Option("--set", help="key=value over platform, washout and geometry: washout.tilt_rate_deg=2."),
    ] = None,
    frame: Annotated[
        str | None, typer.Option(help="ship, ned or flu: the axes written; the motion log is written in them, too.")
    ] = None,
    stream: Annotated[
        str | None, typer.Option(help="Replay in real time to an address such as udp://127.0.0.1:5005.")
    ] = None,
    packets: Annotated[str, typer.Option(help="ocean_sim, openmotionsim, floats or text.")] = "ocean_sim",
    key: Annotated[Path | None, typer.Option(help="A file whose content signs every packet of ocean_sim.")] = None,
    film: Annotated[
        bool, typer.Option("--film", help="Also film.gif: the 10 s in which the hexapod moves most.")
    ] = False,
    out: Annotated[Path, typer.Option(help="Where platform.csv, metrics.csv and the pictures go.")] = Path(
        "runs/platform"
    ),
    json: Json = False,
) -> None:
    """Motion log, washout, hexapod: poses and leg lengths, how good they are, and a replay in real time."""
    from ocean_sim.verbs.platform import platform

    with console.claim(out, "platform.csv", ".platform-*"):
        laid = [*(sets or []), *([] if ramp is None else [f"ramp={ramp!r}"])]
        platform(log, geometry, washout, laid, frame, stream, packets, key, film, out, json)


@app.command()
def sweep(
    plan: Annotated[Path, typer.Argument(help="A YAML file: scene, profile, set, list, grid, seeds.")],
    scheduler: Annotated[
        str | None, typer.Option(help="A Dask cluster, as in tcp://127.0.0.1:8786, that sees the same files.")
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Runs at a time on this machine; by default one per core.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Where run folders and results.csv go; by default runs/<plan>.")
    ] = None,
    json: Json = False,
) -> None:
    """Many runs from a plan, each in a process of its own; what is finished is not run again, failures are rows."""
    from ocean_sim.verbs.sweep import sweep

    sweep(plan, scheduler, workers, out, json)


@app.command()
def tradeoff(
    scene: Annotated[str | None, typer.Argument(help="A scene; without one, the validation cases.")] = None,
    vary: Annotated[
        list[str] | None,
        typer.Option(help="KEY=A,B,C; given several times: every combination. By default profile=ci,..."),
    ] = None,
    budget: Annotated[
        str | None,
        typer.Option(help="16ms: wall time per 1/60 s simulated; realtime; 30s: wall time of the whole run."),
    ] = None,
    by: Annotated[str | None, typer.Option(help="The error that decides: a column of the table.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Fewer runs and seeds: minutes instead of hours.")] = False,
    profile: Profile = None,
    sets: Sets = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Cases at a time; by default one per core.")] = None,
    out: Annotated[Path | None, typer.Option(help="Where tables, pictures and runs go.")] = None,
    json: Json = False,
) -> None:
    """Speed against accuracy, measured: over the validation cases, or over settings of a scene within a budget."""
    from ocean_sim.verbs.tradeoff import tradeoff

    tradeoff(scene, vary or [], budget, by, quick, profile, sets or [], workers, out, json)


@app.command()
def stability(
    scene: Annotated[str | None, typer.Argument(help="A scene; without one, a collapsing column.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Fewer points: minutes instead of hours.")] = False,
    workers: Annotated[int | None, typer.Option(min=1, help="Runs at a time; by default one per core.")] = None,
    out: Annotated[Path, typer.Option(help="Where tables, pictures and runs go.")] = Path("runs/stability"),
    json: Json = False,
) -> int:
    """Where it breaks: time steps and other settings at their extremes, each with a verdict."""
    from ocean_sim.verbs.stability import stability

    with console.claim(out, "stability.csv", "runs"):
        return stability(scene, quick, workers, out, json)


def main(arguments: list[str] | None = None) -> None:
    """Run the command line and leave with its exit code."""
    gc.set_threshold(20_000)  # reading kernels makes many small objects: a tenth of the time to the first step
    console.open_streams()
    given = sys.argv[1:] if arguments is None else arguments
    try:
        with stoppable():
            code = answered(given)
    except Anew as other:
        other.begin(given)
    console.Outlet.over = True
    sys.exit(code)


def answered(arguments: list[str]) -> int:
    """The exit code of a command line; an error has been reported in one sentence."""
    debug, as_json = "--debug" in arguments, "--json" in arguments
    try:
        must_be_somewhere()
        code: Any = app([word for word in arguments if word != "--debug"], "ocean-sim", standalone_mode=False)
        if code == 130:  # what typer makes of an interrupt
            raise KeyboardInterrupt
        return code if isinstance(code, int) else 0
    except (Exception, KeyboardInterrupt) as error:
        if debug:
            import traceback

            traceback.print_exc()
        return reported(error, as_json)


def must_be_somewhere() -> None:
    """Raises Refused where the folder that names of files start from has been removed."""
    try:
        os.getcwd()
    except FileNotFoundError:
        raise Refused("the folder that you are in has been removed; change to another one") from None


def reported(error: BaseException, as_json: bool) -> int:
    """Print an error in the form that was asked for; gives the exit code."""
    code, sentence, problems = meaning(error)
    if as_json:
        sentence = console.counted(problems) if problems else sentence
        try:
            console.answer({"error": sentence, "problems": [problem._asdict() for problem in problems]})
        except OSError:  # which may be what there is to report
            console.complain(sentence)
    elif isinstance(error, WrongUsage):
        error.show()
    else:
        console.complain(sentence)
    return code


def meaning(error: BaseException) -> tuple[int, str, list[Any]]:
    """Exit code, sentence, and the locations in a scene that an error is about."""
    if isinstance(error, Failed):
        return error.exit_code, error.sentence, [*error.problems]
    if isinstance(error, ImportError | OSError) and "libX11" in str(error):
        return 3, "Taichi needs the system library libX11: as root, apt-get install libx11-6", []
    if isinstance(error, ModuleNotFoundError) and (extra := extra_of((error.name or "").partition(".")[0])):
        return 3, extra_missing(extra) or str(error), []
    if isinstance(error, OSError) and error.errno == ENAMETOOLONG:
        return Refused.exit_code, f"{shown(error.filename)}: this name is too long", []
    if isinstance(error, WrongUsage):
        return error.exit_code, error.message, []
    if isinstance(error, KeyboardInterrupt | typer.Abort):
        return 1, str(error) or "stopped", []
    return 1, in_words(error), []


if __name__ == "__main__":
    main()
