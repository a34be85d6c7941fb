"""Build hook of a wheel: it adds the schema of a scene, and packaged scenes that name it."""

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

SCHEMA_FILE = "ocean_sim/scene.schema.json"  # in a checkout as in a wheel
# Models need no kernels, so building needs no Taichi.
SCHEMA_PROGRAM = """
import sys
from unittest.mock import MagicMock

sys.modules["ocean_sim.kernel_library"] = MagicMock(LIBRARY_NAME="taichi")
from ocean_sim.reading.keys import schema_text

sys.stdout.buffer.write(schema_text().encode())
"""


class Schema(BuildHookInterface):
    """A checkout, which an editable install uses as it is, has its schema from `./sandbox`."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        if version == "editable":
            return
        self.kept = TemporaryDirectory(prefix="ocean-sim-")
        command = [sys.executable, "-c", SCHEMA_PROGRAM]
        made = subprocess.run(command, cwd=self.root, check=True, capture_output=True).stdout
        self.hold(made, SCHEMA_FILE, build_data)
        scenes = Path(self.root, "scenes")
        for scene in sorted(scenes.rglob("*.yaml")):
            text = scene.read_bytes().replace(SCHEMA_FILE.encode(), Path(SCHEMA_FILE).name.encode(), 1)
            self.hold(text, f"ocean_sim/scenes/{scene.relative_to(scenes).as_posix()}", build_data)

    def hold(self, content: bytes, name: str, build_data: dict[str, Any]) -> None:
        """Put a file of this content into the wheel, in place of the checkout's where it has one."""
        path = Path(self.kept.name, name)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
        build_data["force_include"][str(path)] = name

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        if version != "editable":
            self.kept.cleanup()
