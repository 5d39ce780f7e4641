"""The drawing process: reads orders from standard input and writes pixels to standard output until the input ends.

Without a working OpenGL library VTK ends its process with a segmentation fault, which no `except` catches. Therefore
VTK has a process of its own, which starts while gears are being solved. This file is run as a script. It loads only
the modules with which VTK renders.

Orders (`Order`, made by `offscreen.shapes`, as `marshal` data) and answers follow their length. An answer has the pixels
(RGBA, rows from below). If depths are asked for, their shares of the range of depths (float32) and this range follow.
"""

from __future__ import annotations

import marshal
import os
import sys
from array import array
from collections.abc import Callable, Iterator
from io import BufferedReader
from math import atan, degrees, radians, tan
from typing import IO, Any, TypedDict, cast

#: largest number of rows of pixels that are drawn at once
MAX_STRIP_ROWS = 400
#: rows drawn beyond a strip on either side: VTK omits lines and dots whose middles are out of sight, however wide they
#: are
STRIP_MARGIN_ROWS = 32


class Primitive(TypedDict):
    """Cells that are drawn in one way. Arrays are bytes: float32, indices int64, colours uint8."""

    #: points (V, 3), mm
    points: bytes
    #: indices of the cells' points, one cell after the other
    cells: bytes
    #: offsets (C + 1,) of the C cells in `cells`
    starts: bytes
    #: points of a cell: 1 for dots, 2 for lines
    corners: int
    #: colours (V, 3) of the points, or None
    colours: bytes | None
    #: colour of all points otherwise, parts of 1
    colour: tuple[float, float, float]
    #: values (V,) that take the colours of the table, or None
    values: bytes | None
    #: value at the end of the table; it begins at 0
    limit: float
    #: colours (256, 4), or None
    table: bytes | None
    #: value beyond which cells are cut off, or None
    cut: float | None
    #: 1 for opaque
    opacity: float
    #: width of lines and dots, pixels as drawn
    width: float
    #: side of the triangles that is not drawn: "front", "back" or neither
    culled: str


class Order(TypedDict):
    """A picture to draw: its camera and primitives; lengths in mm."""

    #: width and height, pixels
    size: tuple[int, int]
    #: position (3,) of the camera
    position: list[float]
    #: point (3,) at which it looks
    focus: list[float]
    #: direction (3,) upwards
    up: list[float]
    #: True for a parallel projection
    parallel: bool
    #: height of the picture at the focus, if parallel
    height: float
    #: angle of view, deg, if not parallel
    angle: float
    #: layers of translucent bodies that are distinguished
    peels: int
    #: primitives, in the order of drawing
    primitives: list[Primitive]
    #: distance of the pixels whose depth is answered, in rows and in columns; 0 for no depth
    depth_step: int


#: values that most primitives share
PLAIN_PRIMITIVE = Primitive(
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


def receive(stream: BufferedReader) -> bytearray:
    """Return the bytes that `send` wrote. Raises EOFError at the end of the stream."""
    data = bytearray(int.from_bytes(stream.read(8), "little"))
    if not data or stream.readinto(data) < len(data):
        raise EOFError
    return data


def send(stream: IO[bytes], data: bytes) -> None:
    """Write the length of `data` and the data, which has one byte at least."""
    stream.write(len(data).to_bytes(8, "little"))
    stream.write(data)
    stream.flush()


def main() -> None:
    """Answer orders until the input ends."""
    from signal import SIG_IGN, SIGINT, signal

    # the process that starts this one also ends it
    signal(SIGINT, SIG_IGN)
    # output of libraries must not be taken for an answer
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    # without this VTK would load numpy, which takes as long as VTK's own modules
    sys.modules["numpy"] = None  # type: ignore[assignment]
    draw = drawer()
    while True:
        try:
            order: Order | None = marshal.loads(receive(cast("Any", sys.stdin.buffer)))
        except EOFError:
            return
        if order is None:
            return
        width, height = order["size"]
        step = order["depth_step"]
        depths = (-(-width // step)) * (-(-height // step)) + 2 if step else 0
        answers.write((4 * (width * height + depths)).to_bytes(8, "little"))
        for part in draw(order):
            answers.write(part)
        answers.flush()


def drawer() -> Callable[[Order], Iterator[memoryview]]:
    """Return the function that draws an order and yields its pixels in parts.

    All pictures share a window, so that OpenGL compiles its shaders once. A picture is drawn strip by strip, because
    OpenGL and VTK hold several copies of a window's pixels.
    """
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
    from vtkmodules.vtkCommonCore import vtkFloatArray, vtkLogger, vtkUnsignedCharArray
    from vtkmodules.vtkRenderingCore import vtkMapper, vtkRenderer, vtkRenderWindow

    # suppresses VTK's messages about every window system that it tries
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    # primitives in front are moved towards the viewer; VTK's own depth offsets would also shade hidden parts
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
        strips = -(-height // MAX_STRIP_ROWS)
        rows, pixels = -(-height // strips), vtkUnsignedCharArray()
        depths, step, kept = vtkFloatArray(), order["depth_step"], []
        window.SetSize(width, rows + 2 * STRIP_MARGIN_ROWS)
        window.AddRenderer(renderer)
        for strip in range(strips):
            _aim(renderer, order, rows, strip)
            window.Render()
            window.GetRGBACharPixelData(0, STRIP_MARGIN_ROWS, width - 1, STRIP_MARGIN_ROWS + rows - 1, 0, pixels, 0)
            # the last strip may reach beyond the picture
            yield memoryview(cast("Any", pixels)).cast("B")[: 4 * width * (height - strip * rows)]
            if step:
                window.GetZbufferData(0, STRIP_MARGIN_ROWS, width - 1, STRIP_MARGIN_ROWS + rows - 1, depths)
                numbers = range(strip * rows, min(height, (strip + 1) * rows))
                kept += _thinned(memoryview(cast("Any", depths)), width, step, numbers)
        if step:
            yield from kept
            yield memoryview(array("f", renderer.GetActiveCamera().GetClippingRange()).tobytes())
        window.RemoveRenderer(renderer)

    return draw


def _thinned(depths: memoryview, width: int, step: int, rows: range) -> list[memoryview]:
    """Return every `step`-th depth of the rows whose number is a multiple of `step`."""
    kept = (k * width for k, number in enumerate(rows) if number % step == 0)
    return [memoryview(depths[first : first + width : step].tobytes()) for first in kept]


def _aim(renderer: Any, order: Order, rows: int, strip: int) -> None:
    """Aim the camera at a strip of `rows` rows of pixels; strip 0 is at the bottom of the picture."""
    height, seen = order["size"][1], rows + 2 * STRIP_MARGIN_ROWS
    share = seen / height
    camera = renderer.GetActiveCamera()
    camera.SetPosition(order["position"])
    camera.SetFocalPoint(order["focus"])
    camera.SetViewUp(order["up"])
    camera.SetParallelProjection(order["parallel"])
    camera.SetParallelScale(share * order["height"] / 2)
    camera.SetViewAngle(degrees(2.0 * atan(share * tan(radians(order["angle"]) / 2.0))))
    # in halves of the strip's height, from the middle of the picture
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
        """Return VTK's array of bytes, which stay in the order's memory."""
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
    """Return the part of a surface on which values are at most `value`."""
    from vtkmodules.vtkFiltersCore import vtkClipPolyData

    clip = vtkClipPolyData()
    clip.SetInputData(surface)
    clip.SetValue(value)
    clip.SetInsideOut(True)
    clip.Update()
    return clip.GetOutput()


def _take_colours(mapper: Any, table: bytes, limit: float) -> None:
    """Let a mapper interpolate the colours of a table (256, 4) for values from 0 to a limit."""
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
