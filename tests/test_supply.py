"""What is installed is pinned and its licence known; and a run speaks to nobody."""

import csv
import importlib.metadata
import json
import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
LOCK = (ROOT / "requirements.lock").read_text()
PERMITTED = re.compile(r"MIT|BSD|Apache|PSF|Python Software|MPL|ISC|0BSD|Zlib|CC0|TOST-1.0")  # TOST-1.0: of OpenUSD
LISTENING = """
import sys
heard = []
def hook(event, facts):
    if event in ("socket.connect", "socket.getaddrinfo", "socket.bind", "socket.sendto", "urllib.Request"):
        heard.append(f"{event} {facts}"[:200])
    if event == "import" and facts[0] == "taichi._version_check":
        import os
        heard.extend([] if os.environ.get("TI_SKIP_VERSION_CHECK") == "ON" else ["Taichi asks for its version"])
sys.addaudithook(hook)
from ocean_sim.__main__ import run_command_line
code = run_command_line(sys.argv[1:])
print("HEARD", code, heard)
"""


def third_party() -> list[dict[str, str]]:
    with (ROOT / "docs" / "third_party.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def test_all_that_is_installed_is_pinned_with_its_hash_what_installs_too():
    pinned = dict(re.findall(r"^([a-z0-9.-]+)==([^ ;\\]+)", LOCK, re.MULTILINE))
    assert {"pip", "setuptools", "hatchling", "taichi"} <= set(pinned)
    for entry in re.split(r"^(?=[a-z])", LOCK, flags=re.MULTILINE)[1:]:
        assert "--hash=sha256:" in entry, entry
    assert {row["name"]: row["version"] for row in third_party()} == pinned


def test_every_licence_is_known_permits_use_and_is_the_one_that_the_package_states():
    for row in third_party():
        assert PERMITTED.search(row["licence"]), row
        try:
            meta = importlib.metadata.metadata(row["name"])
        except importlib.metadata.PackageNotFoundError:
            continue  # of another platform
        expression = meta.get("License-Expression")
        if meta["Version"] == row["version"] and expression:
            assert expression == row["licence"], row["name"]


def test_a_run_opens_no_connection(tmp_path):
    """Not even Taichi, which would ask a server for its newest version once a day: a home that is empty has not asked
    today."""
    basin = {"length": 20.0, "width": 20.0, "depth": 5.0, "walls": "none"}
    waves = {"kind": "linear_waves", "height": 0.5, "period": 3.0}
    scene = {"duration": 0.1, "basin": basin, "fluid": waves, "render": None, "report": None, "runtime": {"threads": 1}}
    (tmp_path / "scene.yaml").write_text(json.dumps(scene))
    home = os.environ | {"HOME": str(tmp_path / "home")}
    home.pop("TI_SKIP_VERSION_CHECK", None)
    (tmp_path / "home").mkdir()
    words = [sys.executable, "-c", LISTENING, "run", str(tmp_path / "scene.yaml"), "--out", str(tmp_path / "run")]
    done = subprocess.run(words, env=home, capture_output=True, text=True, timeout=300, check=False)
    assert "HEARD 0 []" in done.stdout, done.stdout[-2000:] + done.stderr[-2000:]
