"""`ocean_sim.view`: the page in a notebook, beside a simulation that cells step, or as a replay of a run."""

import html
from os import PathLike
from pathlib import Path
from secrets import token_urlsafe
from tempfile import TemporaryDirectory

from ocean_sim.conventions import Unsuited, number
from ocean_sim.result import Result
from ocean_sim.simulation import Simulation
from ocean_sim.viewer.replay import replay_file
from ocean_sim.viewer.server import File, Server
from ocean_sim.viewer.still import page_document, sky_packet
from ocean_sim.viewer.watch import Watch


class View:
    """Output of a notebook cell that shows the page; `address` opens it in a browser, and is empty for a replay."""

    def __init__(self, source: str, height: int, address: str = "", server: Server | None = None) -> None:
        """`source`: HTML attribute that holds or names the page; `height`: in pixels; `server`: of a live view."""
        self.source, self.height, self.address, self.server = source, height, address, server

    def _repr_html_(self) -> str:
        """HTML of a frame that shows the page; called by the notebook."""
        style = f"width:100%;height:{self.height}px;border:0;border-radius:12px"
        return f'<iframe {self.source} style="{style}" allow="fullscreen; xr-spatial-tracking"></iframe>'

    def __repr__(self) -> str:
        return f"View({self.address or 'a replay'})"

    def close(self) -> None:
        """Stop the server of a live view; a replay has none."""
        if self.server is not None:
            self.server.close()
            self.server = None


def view(what: "Simulation | Result | str | Path", height: int = 560) -> View:
    """Show a simulation live while it is stepped, or a run folder as a replay, in a notebook; `height` [pixels].

    A live view has its own server on this machine until it is closed; its address holds a random token, since any page
    may show it in a frame. A replay is stored whole in the notebook: it needs no server, as on Colab, and is still
    there when the notebook is opened again."""
    number("height", height, "pixels", 1.0)
    if isinstance(what, Simulation):
        document = page_document("Ocean Sim", {"mode": "live"})
        files: dict[str, tuple[str, File]] = {
            "/": ("text/html; charset=utf-8", lambda: document),
            "/sky": ("application/octet-stream", sky_packet),
        }
        server = Server(files, port=0, token=token_urlsafe(24), hello={"drives": False}, framed=True)
        watch = Watch(what, server)
        what.observers.append(watch)
        watch.show(0.0)
        return View(f'src="{server.address}"', height, server.address, server)
    if not isinstance(what, Result | str | PathLike):
        raise Unsuited(f"view takes a simulation, a result or a run folder, not {what!r:.60}")
    folder = what.folder if isinstance(what, Result) else Path(what)
    with TemporaryDirectory() as away:
        content = replay_file([folder], Path(away) / "replay.html").read_bytes()
    return View(f'srcdoc="{html.escape(content.decode())}"', height)
