"""Scenes in an editor: what yaml-language-server makes of the schema that a scene's first line names."""

import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlparse
from zipfile import ZipFile

import pytest

from ocean_sim.__main__ import run_command_line
from ocean_sim.parts import PACKAGE
from ocean_sim.reading.keys import scene_schema

SERVER = shutil.which("yaml-language-server")
WRONG = """
basin: {length: 40.0, depht: 7.5}
fluid: thesis_6000
ship:
  kind: yacht
  masss: 3.0
  positio
"""


def first_line(file: Path) -> Path:
    """The schema that the first line of a scene names."""
    name = file.read_text().splitlines()[0].partition("$schema=")[2]
    return Path(unquote(urlparse(name).path)) if name.startswith("file:") else file.parent / name


def test_a_new_scene_names_a_schema_that_exists_wherever_it_lies(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    file = tmp_path / "mine.yaml"
    assert run_command_line(["new", str(file)]) == 0
    assert "properties" in json.loads(first_line(file).read_text())


@pytest.mark.slow
def test_packaged_scenes_name_a_schema_that_lies_in_the_wheel(tmp_path):
    pytest.importorskip("hatchling")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path)]
    subprocess.run(command, cwd=PACKAGE.parent, check=True, capture_output=True)
    with ZipFile(next(tmp_path.glob("*.whl"))) as wheel:
        wheel.extractall(tmp_path / "site")
    scenes = sorted((tmp_path / "site" / "ocean_sim" / "scenes").rglob("*.yaml"))
    assert len(scenes) > 15
    named = {first_line(scene).resolve() for scene in scenes if scene.read_text().startswith("# yaml")}
    assert named == {tmp_path.resolve() / "site" / "ocean_sim" / "scene.schema.json"}
    assert json.loads(named.pop().read_text()) == scene_schema()  # though what built it had no Taichi


class Editor:
    """What an editor says to a language server."""

    def __init__(self) -> None:
        assert SERVER is not None
        self.server = subprocess.Popen([SERVER, "--stdio"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.count, self.diagnostics = 0, None

    def send(self, **message: Any) -> None:
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        self.server.stdin.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
        self.server.stdin.flush()

    def heard(self) -> dict[str, Any]:
        length = 0
        while (line := self.server.stdout.readline().strip()) or not length:
            if line.lower().startswith(b"content-length:"):
                length = int(line.split(b":")[1])
        message = json.loads(self.server.stdout.read(length))
        if message.get("method") == "textDocument/publishDiagnostics":
            self.diagnostics = message["params"]["diagnostics"]
        elif "id" in message and "method" in message:  # a question; `workspace/configuration` asks for four
            self.send(id=message["id"], result=[None] * len(message.get("params", {}).get("items", [])) or None)
        return message

    def ask(self, method: str, **params: Any) -> Any:
        self.count += 1
        self.send(id=self.count, method=method, params=params)
        while (message := self.heard()).get("id") != self.count or "method" in message:
            pass
        return message["result"]

    def told(self) -> list[str]:
        """The diagnostics of the text that was opened, once they are there."""
        while not self.diagnostics:
            self.heard()
        return [row["message"] for row in self.diagnostics]

    def close(self) -> None:
        self.server.kill()
        self.server.wait()


@pytest.mark.skipif(
    SERVER is None, reason="no yaml-language-server on this machine; npm install -g yaml-language-server"
)
def test_the_language_server_finds_typos_completes_and_shows_units(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    file = tmp_path / "mine.yaml"
    assert run_command_line(["new", str(file)]) == 0
    text = file.read_text().splitlines()[0] + WRONG
    document = {"uri": file.as_uri()}
    editor = Editor()
    try:
        able = {"textDocument": {"hover": {"contentFormat": ["markdown"]}}}
        editor.ask("initialize", processId=None, rootUri=tmp_path.as_uri(), capabilities=able)
        editor.send(method="initialized", params={})
        opened = {**document, "languageId": "yaml", "version": 1, "text": text}
        editor.send(method="textDocument/didOpen", params={"textDocument": opened})
        told = " ".join(editor.told())
        assert "depht is not allowed" in told and "masss is not allowed" in told
        hover = editor.ask("textDocument/hover", textDocument=document, position={"line": 1, "character": 10})
        shown = hover["contents"]["value"].replace("\\", "")
        assert "Length along x. [m]" in shown
        choices = editor.ask("textDocument/completion", textDocument=document, position={"line": 6, "character": 9})
        labels = {item["label"] for item in choices["items"]}
        assert "position" in labels and "heading_deg" in labels
    finally:
        editor.close()
