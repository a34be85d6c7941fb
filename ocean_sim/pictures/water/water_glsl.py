"""Formulas of `water_shading` and `foam` for a graphics processor, as replacements in VTK's shaders.

Numbers come from those files, so that each law is written once; the tests compare the colours. Traps of VTK: it
declares uniforms and samplers itself; a mistake in a shader only logs and draws nothing (see `refusal`). Mesa's
processor in software computes both sides of every `if`, but leaves a loop as soon as no pixel of a group goes on: code
for few pixels is a loop of one turn or none.
"""

import re
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from ocean_sim.pictures.stage import sky as sky_module
from ocean_sim.pictures.stage.sky import Sky
from ocean_sim.pictures.water import foam
from ocean_sim.pictures.water import water_shading as w

SHADER_FOLDER = Path(__file__).parents[1] / "shaders"
# Coefficients of the ratio of polynomials of a root that is x^(1/2.2): see the test
GAMMA_POLYNOMIAL = (0.0319, 0.8804, 0.8577, 0.0193, 0.7503)
CONSTANT_REFLECTANCE = 0.4  # share of the mirrored sky where Fresnel's is switched off
GLINTS = {"none": 0.0, "physical": 1.0, "thesis": 2.0}  # of the sun, as the program numbers them


def number(value: float) -> str:
    """GLSL literal of a float, with a decimal point or an exponent."""
    return f"{float(value):.9g}" if "." in f"{float(value):.9g}" or "e" in f"{float(value):.9g}" else f"{value:.1f}"


def literal(value: Any) -> str:
    """GLSL literal of an integer, a float, or a vector of floats."""
    if np.ndim(value):
        return f"vec{len(value)}({', '.join(map(number, value))})"
    return str(value) if isinstance(value, int) else number(value)


def shader(name: str, *modules: ModuleType, **parts: object) -> str:
    """GLSL text of the file `name` in the folder `shaders`. Names of the modules' constants are replaced by their
    values (NAME[0]: the first of several), and @NAME by the text `parts[NAME]`."""
    text = (SHADER_FOLDER / f"{name}.glsl").read_text(encoding="utf-8")
    for part, value in parts.items():
        text = text.replace(f"@{part}", str(value))
    known = {key: value for module in modules for key, value in vars(module).items() if key.isupper()}

    def constant(found: re.Match[str]) -> str:
        value = known[found[1]]
        return literal(value if found[2] is None else value[int(found[2])])

    return re.sub(rf"\b({'|'.join(known) or '$^'})\b(?:\[(\d)\])?", constant, text)


COMMON_FUNCTIONS = shader("common", sky_module, sys.modules[__name__])
FOG_FUNCTIONS = shader("fog", sky_module, w)
WATER_FUNCTIONS = FOG_FUNCTIONS + shader("water", w, foam)
SKY_PROGRAM = "  fragOutput0 = vec4(filmic(skyAt(normalize(posW - eyeW), 0.0)), 1.0);\n"


def water_program(ships: int, grain: str = "posW.xz", shadows: str = "") -> str:
    """GLSL program of the water around a number of ships. `grain`: GLSL expression of the position at which foam's fine
    pattern is read; `shadows`: program that reduces the variable `sunlit`."""
    hulls = "".join(shader("sea_hull", k=k, ships=ships) for k in range(ships))
    mirrors = "".join(shader("sea_mirror", k=k) for k in range(ships))
    return shader("sea", w, hulls=hulls, mirrors=mirrors, grain=grain, shadows=shadows)


def sky_textures(sky: Sky) -> dict[str, Any]:
    """Textures of a sky's image and of its haze, by the names of their samplers in the shaders."""
    return {"sky": make_texture(sky.image, smaller=True), "haze": make_texture(sky.haze)}


def make_texture(image: np.ndarray, *, smaller: bool = False) -> Any:
    """Texture of an image of floats or 8-bit numbers, whose row 0 has the coordinate 0; `smaller`: True for mipmaps."""
    from vtkmodules.vtkCommonDataModel import vtkImageData

    data = vtkImageData()
    fill_image(data, image)
    return image_texture(data, smaller)


def image_texture(data: Any, smaller: bool) -> Any:
    """Texture of a VTK image; `smaller`: True for mipmaps. Each window needs a texture of its own; a shared one is sent
    to each window again in every picture."""
    from vtkmodules.vtkRenderingOpenGL2 import vtkOpenGLTexture

    made = vtkOpenGLTexture()
    made.SetMipmap(smaller)
    made.InterpolateOn()
    made.SetMaximumAnisotropicFiltering(1)  # else levels asked for are not those read, where neighbours look elsewhere
    made.RepeatOff()
    made.EdgeClampOn()
    made.SetColorModeToDirectScalars()
    made.SetInputDataObject(data)
    return made


def own_textures(textures: dict[str, Any]) -> dict[str, Any]:
    """Second textures of the same images, by the same names, for use in another window."""
    return {name: image_texture(of.GetInput(), of.GetMipmap()) for name, of in textures.items()}


def fill_image(data: Any, image: np.ndarray) -> None:
    """Copy pixels (height, width, channels) into a VTK image."""
    from vtkmodules.util.numpy_support import numpy_to_vtk

    height, width, channels = image.shape
    data.SetDimensions(width, height, 1)
    data.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(image.reshape(-1, channels)), deep=True))
    data.Modified()


class Shaded:
    """VTK actor of a triangle mesh with a fragment program of our own; the mesh's points are world coordinates [m]."""

    def __init__(
        self, mesh: Any, body: str, functions: str, textures: dict[str, Any], attributes: Sequence[str] = ()
    ) -> None:
        """`body`, `functions`: fragment program and its GLSL functions; `textures`: by sampler name; `attributes`:
        three-letter names of vectors at the mesh's points, which the program reads with a W appended, as nrmW."""
        self.mesh, self.attributes = mesh, attributes
        self.textures = textures or {"sky": make_texture(np.zeros((2, 2, 3), np.uint8))}  # which common functions name
        self.actor = self.new_actor(self.textures)
        program = self.actor.GetShaderProperty()
        taken = "".join(f"in vec3 {name}In; out vec3 {name}W;\n" for name in attributes)
        given = "".join(f"in vec3 {name}W;\n" for name in attributes)
        copied = "".join(f"  {name}W = {name}In;\n" for name in attributes)
        keep = "//VTK::Normal::Dec\n"
        program.AddVertexShaderReplacement("//VTK::Normal::Dec", True, f"{keep}{taken}out vec3 posW;\n", False)
        body_of_vertex = f"//VTK::Normal::Impl\n{copied}  posW = vertexMC.xyz;\n"
        program.AddVertexShaderReplacement("//VTK::Normal::Impl", True, body_of_vertex, False)
        program.AddFragmentShaderReplacement("//VTK::Normal::Dec", True, f"{keep}{given}in vec3 posW;\n", False)
        declared = f"//VTK::TMap::Dec\n{COMMON_FUNCTIONS}{functions}"
        program.AddFragmentShaderReplacement("//VTK::TMap::Dec", True, declared, False)
        program.AddFragmentShaderReplacement("//VTK::Light::Impl", True, body, False)
        self.uniforms = program.GetFragmentCustomUniforms()

    def new_actor(self, textures: dict[str, Any]) -> Any:
        """New actor of the same mesh and attributes with these textures; its program is still to be set."""
        from vtkmodules.vtkCommonDataModel import vtkDataObject
        from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

        mapper, actor = vtkPolyDataMapper(), vtkActor()
        mapper.SetInputData(self.mesh)
        mapper.ScalarVisibilityOff()
        mapper.SetVBOShiftScaleMethod(0)  # positions reach the shader as they are
        for name in self.attributes:
            mapper.MapDataArrayToVertexAttribute(f"{name}In", name, vtkDataObject.FIELD_ASSOCIATION_POINTS, -1)
        actor.SetMapper(mapper)
        for name, image in textures.items():
            actor.GetProperty().SetTexture(name, image)
        return actor

    def twin(self) -> Any:
        """Second actor of the same mesh and program for another plotter, with its own textures."""
        twin = self.new_actor(own_textures(self.textures))
        twin.SetShaderProperty(self.actor.GetShaderProperty())
        return twin

    def set(self, **values: Any) -> None:
        """Set uniforms of the fragment program by name: numbers, triples and 4 x 4 matrices."""
        from vtkmodules.vtkCommonMath import vtkMatrix4x4

        for name, value in values.items():
            array = np.asarray(value, dtype=float)
            if array.shape == (4, 4):
                matrix = vtkMatrix4x4()
                matrix.DeepCopy(array.T.ravel().tolist())
                self.uniforms.SetUniformMatrix(name, matrix)
            elif array.ndim:
                self.uniforms.SetUniform3f(name, array.tolist())
            else:
                self.uniforms.SetUniformf(name, float(array))


def projection(camera: Any, aspect: float) -> np.ndarray:
    """Matrix (4, 4) of a VTK camera from world to clip coordinates; `aspect`: width over height of the picture."""
    matrix = camera.GetCompositeProjectionTransformMatrix(aspect, -1.0, 1.0)
    return np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])


def collect_messages() -> Any:
    """Send VTK's messages to a collector from now on; returns it, to be passed to `refusal`."""
    from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow

    said = vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(said)
    return said


def refusal(said: Any) -> str | None:
    """Reason why OpenGL refused a shader program, from `said`, the collector of VTK's messages; None if it did not."""
    if "vtkShaderProgram" not in (text := said.GetOutput()):
        return None
    why = (line for line in text.splitlines() if "error" in line.lower() and not line.startswith("ERROR: In"))
    return next(why, "it does not say why").rsplit("): ", 1)[-1]


def sky_uniforms(sky: Sky) -> dict[str, Any]:
    """Shader uniforms of a sky's sun and mean light."""
    return {"sunDir": sky.sun, "sunLight": sky.sunlight, "skyLight": sky.ambient}


def neutral_uniforms(ships: int) -> dict[str, Any]:
    """Shader uniforms, except of light, for calm water that mirrors no ship, all parts of its colour switched on."""
    nothing = dict.fromkeys(("useMirror", "rippleVariance", "windAngle", "time"), 0.0)
    ones = dict.fromkeys(("rippleLongest", "mirrorPixel", "glintKind"), 1.0)  # the kind of glint is a key of GLINTS
    ones |= dict.fromkeys(("useFresnel", "useReflection", "useBody", "useFoam", "useFog"), 1.0)
    known = {"exposure": w.SEA_EXPOSURE, "fogReach": w.FOG_DISTANCE, "mirrorView": np.eye(4), "hullFoam": np.ones(3)}
    known["constantShare"] = CONSTANT_REFLECTANCE
    for k in range(ships):
        nothing |= {f"useHull{k}": 0.0}
        ones |= {f"mirrorSize{k}": 1.0, f"mirrorReach{k}": 1.0}
        known |= {f"hullBox{k}": np.zeros(3), f"hullSize{k}": np.ones(3), f"mirrorAt{k}": np.zeros(3)}
    return known | nothing | ones
