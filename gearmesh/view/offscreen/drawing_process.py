"""The process that draws: orders on its standard input, pixels on its standard output, until the input ends.

VTK without a working OpenGL library ends its process with a segmentation fault that no `except` catches, so it has one of its
own, which starts while gears are being solved. The file is run as a script that loads what VTK needs to render, and nothing else.

Orders (`Order`, made by `offscreen.shapes`, as `marshal` texts) and answers (RGBA, rows from below) come after their length.
"""

from __future__ import annotations

import marshal
import os
import sys
from collections.abc import Callable, Iterator
from math import atan, degrees, radians, tan
from typing import IO, Any, TypedDict, cast

#: rows of pixels, at most, that are drawn at once, and rows beyond them on either side: lines and dots whose middles are out of
#: sight are not drawn, however wide they are
STRIP, BEYOND_STRIP = 400, 32


class Primitive(TypedDict):
    """What is drawn in one way; arrays are bytes: float32, indices int64, colours uint8.

    points (V, 3), cells of so many `corners` (one for dots, two for lines), one after the other, and where they begin (C + 1,),
    `colours` (V, 3) of points, or one `colour` of three parts of 1. `values` (V,) from 0 to `limit` take the
    colours of a `table` (256, 4), if there is one; what is beyond `cut` is left out.
    """

    points: bytes
    cells: bytes
    starts: bytes
    corners: int
    colours: bytes | None
    colour: tuple[float, float, float]
    values: bytes | None
    limit: float
    table: bytes | None
    cut: float | None
    opacity: float
    width: float
    culled: str


class Order(TypedDict):
    """A picture: `size` in pixels, and the camera, aimed at the `focus`; lengths in mm.

    The picture is `height` mm high at the focus, or an `angle` of so many deg where it is not `parallel`; `peels` are the layers of
    translucent bodies that are distinguished.
    """

    size: tuple[int, int]
    position: list[float]
    focus: list[float]
    up: list[float]
    parallel: bool
    height: float
    angle: float
    peels: int
    primitives: list[Primitive]


#: nothing, plainly: what most of what is drawn has in common
PLAIN = Primitive(
    points=b"",
    cells=b"",
    starts=b"",
    corners=3,
    colours=None,
    colour=(0.0, 0.0, 0.0),
    values=None,
    limit=1.0,
    table=None,
    cut=None,
    opacity=1.0,
    width=1.0,
    culled="",
)


def receive(stream: IO[bytes]) -> bytes:
    """What `send` wrote. Raises EOFError where nothing more comes."""
    length = int.from_bytes(stream.read(8), "little")
    data = stream.read(length)
    if not length or len(data) < length:
        raise EOFError
    return data


def send(stream: IO[bytes], data: bytes) -> None:
    """Write bytes, one at least, after how many they are."""
    stream.write(len(data).to_bytes(8, "little"))
    stream.write(data)
    stream.flush()


def main() -> None:
    """Answer orders."""
    from signal import SIG_IGN, SIGINT, signal

    # who starts this process ends it
    signal(SIGINT, SIG_IGN)
    # what libraries print is no answer
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    # VTK loads numpy where it is there, which takes as long as VTK's own modules
    sys.modules["numpy"] = None  # type: ignore[assignment]
    draw = drawer()
    while True:
        try:
            order: Order | None = marshal.loads(receive(sys.stdin.buffer))
        except EOFError:
            return
        if order is None:
            return
        width, height = order["size"]
        answers.write((4 * width * height).to_bytes(8, "little"))
        for part in draw(order):
            answers.write(part)
        answers.flush()


def drawer() -> Callable[[Order], Iterator[memoryview]]:
    """What draws: the pixels of an order, in parts. All pictures share a window, and so what OpenGL has compiled.

    A picture is drawn strip by strip: OpenGL and VTK hold several copies of all pixels of a window.
    """
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
    from vtkmodules.vtkCommonCore import vtkLogger, vtkUnsignedCharArray
    from vtkmodules.vtkRenderingCore import vtkMapper, vtkRenderer, vtkRenderWindow

    # VTK's word on every window system that it tries
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    # what is to win is nearer to the viewer; VTK's own offsets in depth would shade what is hidden, too
    vtkMapper.SetResolveCoincidentTopologyToOff()
    window = vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(0)

    def draw(order: Order) -> Iterator[memoryview]:
        renderer = vtkRenderer()
        renderer.SetBackground(1.0, 1.0, 1.0)
        _aim(renderer, order, order["size"][1], 0)
        if order["peels"]:
            renderer.SetUseDepthPeeling(True)
            renderer.SetMaximumNumberOfPeels(order["peels"])
            renderer.SetOcclusionRatio(0.0)
        for primitive in order["primitives"]:
            renderer.AddActor(_actor(primitive))
        renderer.ResetCameraClippingRange()
        width, height = order["size"]
        strips = -(-height // STRIP)
        rows, pixels = -(-height // strips), vtkUnsignedCharArray()
        window.SetSize(width, rows + 2 * BEYOND_STRIP)
        window.AddRenderer(renderer)
        for strip in range(strips):
            _aim(renderer, order, rows, strip)
            window.Render()
            window.GetRGBACharPixelData(0, BEYOND_STRIP, width - 1, BEYOND_STRIP + rows - 1, 0, pixels, 0)
            # the last strip may reach beyond the picture
            yield memoryview(cast("Any", pixels)).cast("B")[: 4 * width * (height - strip * rows)]
        window.RemoveRenderer(renderer)

    return draw


def _aim(renderer: Any, order: Order, rows: int, strip: int) -> None:
    """Set the camera to a strip of so many rows of pixels, the first of which is at the bottom of the picture."""
    height, seen = order["size"][1], rows + 2 * BEYOND_STRIP
    share = seen / height
    camera = renderer.GetActiveCamera()
    camera.SetPosition(order["position"])
    camera.SetFocalPoint(order["focus"])
    camera.SetViewUp(order["up"])
    camera.SetParallelProjection(order["parallel"])
    camera.SetParallelScale(share * order["height"] / 2)
    camera.SetViewAngle(degrees(2.0 * atan(share * tan(radians(order["angle"]) / 2.0))))
    # in halves of the strip from the middle of the picture
    camera.SetWindowCenter(0.0, (2 * strip * rows + rows - height) / seen)


def _actor(primitive: Primitive) -> Any:
    from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

    mapper, actor = vtkPolyDataMapper(), vtkActor()
    mapper.SetInputData(_poly_data(primitive))
    mapper.SetScalarVisibility(primitive["colours"] is not None or primitive["table"] is not None)
    if primitive["table"] is not None:
        _take_colours(mapper, primitive["table"], primitive["limit"])
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetColor(*primitive["colour"])
    look.SetOpacity(primitive["opacity"])
    look.SetLineWidth(primitive["width"])
    look.SetPointSize(primitive["width"])
    look.SetRenderPointsAsSpheres(primitive["corners"] == 1)
    look.SetBackfaceCulling(primitive["culled"] == "back")
    look.SetFrontfaceCulling(primitive["culled"] == "front")
    look.SetLighting(False)
    return actor


def _poly_data(primitive: Primitive) -> Any:
    from vtkmodules.vtkCommonCore import vtkFloatArray, vtkPoints, vtkTypeInt64Array, vtkUnsignedCharArray
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

    def array(kind: Any, data: bytes, components: int, size: int) -> Any:
        """VTK's array of bytes, which stay those of the order."""
        made = kind()
        made.SetNumberOfComponents(components)
        made.SetVoidArray(data, len(data) // size, 1)
        return made

    surface, points, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    points.SetData(array(vtkFloatArray, primitive["points"], 3, 4))
    surface.SetPoints(points)
    cells.SetData(*(array(vtkTypeInt64Array, data, 1, 8) for data in (primitive["starts"], primitive["cells"])))
    {1: surface.SetVerts, 2: surface.SetLines}.get(primitive["corners"], surface.SetPolys)(cells)
    if primitive["colours"] is not None:
        surface.GetPointData().SetScalars(array(vtkUnsignedCharArray, primitive["colours"], 3, 1))
    if primitive["values"] is not None:
        surface.GetPointData().SetScalars(array(vtkFloatArray, primitive["values"], 1, 4))
    return surface if primitive["cut"] is None else _cut(surface, primitive["cut"])


def _cut(surface: Any, value: float) -> Any:
    """The part of a surface on which values are at most `value`."""
    from vtkmodules.vtkFiltersCore import vtkClipPolyData

    clip = vtkClipPolyData()
    clip.SetInputData(surface)
    clip.SetValue(value)
    clip.SetInsideOut(True)
    clip.Update()
    return clip.GetOutput()


def _take_colours(mapper: Any, table: bytes, limit: float) -> None:
    """Let a mapper give values from 0 to a limit the colours of a table (256, 4), in between as the table has them."""
    from vtkmodules.vtkCommonCore import vtkLookupTable

    colours = vtkLookupTable()
    colours.SetNumberOfTableValues(len(table) // 4)
    for k in range(len(table) // 4):
        colours.SetTableValue(k, *(part / 255.0 for part in table[4 * k : 4 * k + 4]))
    mapper.SetLookupTable(colours)
    mapper.SetScalarRange(0.0, limit)
    mapper.UseLookupTableScalarRangeOff()
    mapper.InterpolateScalarsBeforeMappingOn()


if __name__ == "__main__":
    main()
