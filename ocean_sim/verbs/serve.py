"""`ocean-sim serve`: a page in the browser to play with a scene, or to look at finished runs; `ocean-sim report`."""

import os
import secrets
import sys
from contextlib import nullcontext, suppress
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Any

import typer

from ocean_sim.files import run_files
from ocean_sim.files.run_files import MANIFEST_FILE
from ocean_sim.files.yaml_file import read_mapping
from ocean_sim.machine import stoppable
from ocean_sim.parts import library
from ocean_sim.verbs.list import section_rows
from ocean_sim.verbs.render import require_frames
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.options import Profile, Sets

if TYPE_CHECKING:
    from ocean_sim.viewer.session import Source

HTML_TYPE, BYTES_TYPE, JSON_TYPE = "text/html; charset=utf-8", "application/octet-stream", "application/json"
LOCAL_HOST = "127.0.0.1"  # where a page is served to this machine alone


def serve(
    targets: list[str] = typer.Argument(
        metavar="SCENE|RUN...", help="A scene, a finished run, or two of them side by side."
    ),
    profile: Profile = None,
    sets: Sets = None,
    host: str = typer.Option(
        LOCAL_HOST, help="Where to listen; 0.0.0.0 lets other machines in, by an address with a random token."
    ),
    port: int | None = typer.Option(None, min=1, max=65535, help="The port; by default 8765, or any free one."),
    show: bool = typer.Option(True, "--open/--no-open", help="Open the page in the browser, where there is one."),
    out: Path | None = typer.Option(None, help="Where records and saved scenes go; by default runs/<scene>-browser."),
) -> None:
    """Serve a page with a scene or with finished runs until Ctrl-C."""
    runs = [Path(target) for target in targets if (Path(target) / MANIFEST_FILE).exists()]
    if len(runs) == len(targets) and len(runs) <= 2:
        if profile or sets:
            raise console.Refused("a finished run is only shown: --profile and --set are for scenes")
        watch_runs(runs, host, port, show)
    elif len(targets) == 1:
        from ocean_sim.viewer.session import Source

        play_scene(Source.of(targets[0], profile, console.set_values(sets)), host, port, show, out)
    else:
        raise console.Refused("give one scene, or one or two run folders")


def play_scene(source: "Source", host: str, port: int | None, show: bool, out: Path | None) -> None:
    """Simulate a scene and serve its page until Ctrl-C; `show`: open a browser; `out`: folder of recorded runs."""
    from ocean_sim.viewer.server import Server
    from ocean_sim.viewer.session import Session

    console.must_compute_with(source.load().runtime.library)  # what is wrong is told before anything is opened
    with stoppable(), Server(live_files(source.name), host, port, access_token(host), {"drives": True}) as server:
        announce_page(server, show, "the scene starts when a page is opened")
        with suppress(KeyboardInterrupt):
            with Session(source, server, out or Path("runs") / f"{source.name}-browser", scene_rows) as session:
                session.play()
    console.say("stopped")


def scene_rows() -> list[dict[str, str]]:
    """Packaged scenes as rows of `section_rows`, each with the file name of its gallery `picture`, or an empty one."""
    listed = read_mapping(library("figures") / "gallery" / "gallery.yaml").plain()["pictures"]
    shown = {entry["scene"]: entry["picture"] for entry in reversed(listed)}  # the first of each
    return [row | {"picture": shown.get(row["name"], "")} for row in section_rows("scenes")]


def live_files(title: str) -> dict[str, Any]:
    """Files of a live simulation's page by address: (content type, function that returns the content)."""
    from ocean_sim.verbs.new import schema_file
    from ocean_sim.viewer.still import page_document, sky_packet

    schema = schema_file()  # now: while Taichi compiles, no other thread may parse (seen in Python 3.11)
    return {
        "/": (HTML_TYPE, lambda: page_document(f"{title} · Ocean Sim", {"mode": "live"})),
        "/sky": (BYTES_TYPE, sky_packet),
        "/schema": (JSON_TYPE, schema.read_bytes),
        **{f"/{path.name}": ("image/jpeg", path.read_bytes) for path in (library("figures") / "gallery").glob("*.jpg")},
    }


def watch_runs(runs: list[Path], host: str, port: int | None, show: bool) -> None:
    """Serve the replay of a finished run, or of two side by side, until Ctrl-C; `show`: open it in a browser."""
    from ocean_sim.viewer.replay import Recorded
    from ocean_sim.viewer.server import Server
    from ocean_sim.viewer.still import page_document, sky_packet

    found = [Recorded(run) for run in runs]
    start = {"mode": "replay", "held": False, "runs": [{"title": run.title, "name": run.folder.name} for run in found]}
    files: dict[str, Any] = {
        "/": (HTML_TYPE, lambda: page_document("Ocean Sim", start)),
        "/sky": (BYTES_TYPE, sky_packet),
    }
    for k, run in enumerate(found):
        files |= {f"/still/{k}": (BYTES_TYPE, run.still), f"/replay/{k}": (BYTES_TYPE, run.stream)}
    with stoppable(), Server(files, host, port, access_token(host), {"drives": False}) as server:
        announce_page(server, show, "")
        with suppress(KeyboardInterrupt):
            Event().wait()


def access_token(host: str) -> str:
    """Random token to put into the page's address if other machines can reach `host`; else empty."""
    from ocean_sim.viewer.server import LOCAL_HOSTS

    return "" if host in LOCAL_HOSTS else secrets.token_urlsafe(24)


def announce_page(server: Any, show: bool, more: str) -> None:
    """Print a page's address and the hint `more`; open it in a browser if `show` is true and there is a screen."""
    stops = "Ctrl-C stops" + (f"; {more}" if more else "")
    console.reply({"address": server.address}, f"{server.address}\n{stops}")
    has_screen = sys.platform == "darwin" or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if show and not console.json_asked and has_screen:
        import webbrowser

        webbrowser.open(server.address)


def report(
    runs: list[Path] = typer.Argument(metavar="RUN [RUN]", help="A run folder, or two to compare."),
    out: Path | None = typer.Option(None, help="The page; by default replay.html in the run folder."),
) -> None:
    """Write one page with the replay of a run, or of two, that needs no server; and write report.html anew."""
    from ocean_sim.observers.shared import run_report
    from ocean_sim.viewer.replay import replay_file

    if len(runs) > 2:
        raise console.Refused("a page holds the replay of one run, or of two")
    for run in runs:
        require_frames(run)
    path = out or runs[0] / "replay.html"
    if path.is_dir():
        path = path / "replay.html"
    with nullcontext() if out else console.claim(runs[0]):
        replay_file(runs, path)
        files = [path]
        if len(runs) == 1 and out is None:
            files.append(run_report.write_report(runs[0]))
        run_files.add_to_manifest(runs[0], files)
    size = path.stat().st_size
    console.reply({"files": files, "bytes": size}, f"{path} ({size / 1e6:.2f} MB)")
