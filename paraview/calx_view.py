# SPDX-License-Identifier: BSD-3-Clause
"""Shows a result of calx in ParaView: grains as spheres of their radius, walls, slabs, contacts, colour bar with unit, time.

In the window of ParaView: paraview/view RESULT.pvd (which runs `paraview --script=paraview/calx_view.py` with CALX_PVD set).
Without a screen: paraview/render. From a script: import calx_view; calx_view.build("RESULT.pvd").
"""
import glob
import os

from paraview import simple

# Colour map and unit of what grains may be coloured by, the preferred first.
COLORS = [
    ("temperature", "K", "Cool to Warm"),
    ("velocity", "m/s", "Viridis (matplotlib)"),
    ("spin", "rad/s", "Viridis (matplotlib)"),
    ("force", "N", "Inferno (matplotlib)"),
    ("heat", "W", "Cool to Warm"),
    ("contacts", "", "Viridis (matplotlib)"),
    ("material", "", "Viridis (matplotlib)"),
    ("mass", "kg", "Viridis (matplotlib)"),
    ("radius", "m", "Viridis (matplotlib)"),
    ("id", "", "Viridis (matplotlib)"),
]
GRAY = [0.55, 0.57, 0.6]
INK = [0.1, 0.1, 0.1]
SAMPLES = 12  # frames that are looked at for ranges: enough to see a trend, few enough to open quickly
ROUNDNESS = [(2000, 24), (10000, 16), (float("inf"), 10)]  # (most grains, resolution): software rendering stays quick
BAR = 0.16  # share of the width kept free for the colour bar


class Scene:
    """What build() made: sources, view, times (s), bounds (m), dimension (2 or 3), the field that gives the colour."""

    def __init__(self, view):
        self.view = view
        self.grains = self.walls = self.contacts = None
        self.slabs = []
        self.times = [0.0]
        self.bounds = [0.0] * 6
        self.dimension = 3
        self.color = None


def companion(pvd, suffix):
    path = pvd[: -len(".pvd")] + suffix + ".pvd"
    return path if os.path.exists(path) else None


def slabs_of(pvd):
    """The series of the solids behind walls, NAME_slab_WALL.pvd."""
    return sorted(glob.glob(glob.escape(pvd[: -len(".pvd")]) + "_slab_*.pvd"))


def open_series(path, name):
    source = simple.PVDReader(FileName=path)
    simple.RenameSource(name, source)
    source.UpdatePipeline()
    return source


def times_of(source):
    times = source.TimestepValues
    return list(times) if hasattr(times, "__len__") else [times]


def sampled(times):
    last = len(times) - 1
    return sorted({times[round(k * last / (SAMPLES - 1))] for k in range(SAMPLES)})


def union(a, b):
    if b[0] > b[1]:  # no points
        return a
    if a is None:
        return list(b)
    return [min(x, y) if k % 2 == 0 else max(x, y) for k, (x, y) in enumerate(zip(a, b))]


def survey(scene):
    """Bounds of grains, walls and slabs over sampled times, with room for the largest radius; 2D if all z are the same."""
    bounds, radius = None, 0.0
    for time in sampled(scene.times):
        for source in (scene.grains, scene.walls, *scene.slabs):
            if source:
                source.UpdatePipeline(time)
                bounds = union(bounds, source.GetDataInformation().GetBounds())
        if scene.grains.PointData["radius"]:
            radius = max(radius, scene.grains.PointData["radius"].GetRange()[1])
    bounds = bounds or [0.0] * 6
    scene.dimension = 2 if bounds[4] == bounds[5] else 3
    scene.bounds = [x - radius if k % 2 == 0 else x + radius for k, x in enumerate(bounds)]


def span_of(scene, source, attributes, field):
    """Range of an array (magnitude of vectors) over sampled times, never empty."""
    low, high = float("inf"), float("-inf")
    for time in sampled(scene.times):
        source.UpdatePipeline(time)
        array = getattr(source, attributes)[field]
        if array:
            span = array.GetRange(-1 if array.GetNumberOfComponents() > 1 else 0)
            low, high = min(low, span[0]), max(high, span[1])
    if low > high:
        return 0.0, 1.0
    margin = max(abs(low) * 5e-4, 1e-12) if high - low <= 1e-9 * abs(low) else 0.0
    return low - margin, high + margin


def choose_color(scene, wanted):
    present = set(scene.grains.PointData.keys())
    if wanted and wanted not in present:
        raise ValueError("no field '%s' in the result; there are: %s" % (wanted, ", ".join(sorted(present))))
    known = [row for row in COLORS if row[0] == wanted] if wanted else [row for row in COLORS if row[0] in present]
    return known[0] if known else (wanted, "", "Viridis (matplotlib)") if wanted else None


def show_grains(scene):
    display = simple.Show(scene.grains, scene.view)
    # instances of one sphere: no memory per grain, and the array of radii is used as it is
    display.SetRepresentationType("3D Glyphs")
    display.GlyphType = "Sphere"
    count = scene.grains.GetDataInformation().GetNumberOfPoints()
    display.GlyphType.ThetaResolution = display.GlyphType.PhiResolution = next(r for most, r in ROUNDNESS if count <= most)
    display.Orient = 0
    display.Scaling = 1
    display.ScaleMode = "Magnitude"
    display.SelectScaleArray = "radius"
    display.ScaleFactor = 2.0  # of a sphere of radius 0.5
    display.Specular = 0.2
    return display


def show_walls(scene, colored):
    display = simple.Show(scene.walls, scene.view)
    display.SetRepresentationType("Surface")
    display.AmbientColor = display.DiffuseColor = GRAY
    if scene.dimension == 2:
        display.LineWidth = 4.0
        display.Ambient, display.Diffuse = 1.0, 0.0
    else:
        display.Opacity = 0.2
        display.LineWidth = 2.0
    if colored:
        simple.ColorBy(display, ("CELLS", "temperature"))
    else:
        display.ColorArrayName = ["POINTS", ""]


def show_slabs(scene, colored):
    """Their cells in the colours of the grains where these show temperature, else gray."""
    for slab in scene.slabs:
        display = simple.Show(slab, scene.view)
        display.SetRepresentationType("Surface")
        display.AmbientColor = display.DiffuseColor = GRAY
        display.Ambient, display.Diffuse = 1.0, 0.0  # flat: nothing but the field
        if colored:
            simple.ColorBy(display, ("CELLS", "temperature"))
        else:
            display.ColorArrayName = ["POINTS", ""]


def show_contacts(scene, visible, span):
    scene.contacts.UpdatePipeline(scene.times[-1])
    if "normal_force" not in scene.contacts.CellData.keys():
        return
    display = simple.Show(scene.contacts, scene.view)
    display.SetRepresentationType("Surface")
    display.LineWidth = 3.0
    simple.ColorBy(display, ("CELLS", "normal_force"))
    if visible:
        set_colors("normal_force", "Inferno (matplotlib)", span or span_of(scene, scene.contacts, "CellData", "normal_force"))
        show_bar(scene, display, "normal_force", "N")
    else:
        simple.Hide(scene.contacts, scene.view)


def set_colors(field, preset, span):
    table = simple.GetColorTransferFunction(field)
    table.ApplyPreset(preset, True)
    table.NanColor = GRAY
    table.AutomaticRescaleRangeMode = "Never"  # the same colour means the same number in every frame
    table.RescaleTransferFunction(*span)


def show_bar(scene, display, field, unit):
    display.SetScalarBarVisibility(scene.view, True)
    bar = simple.GetScalarBar(simple.GetColorTransferFunction(field), scene.view)
    bar.Title = field + (" [%s]" % unit if unit else "")
    bar.ComponentTitle = ""
    bar.TitleColor = bar.LabelColor = INK
    bar.TitleFontSize, bar.LabelFontSize = 18, 16
    bar.WindowLocation = "Any Location"
    bar.Orientation = "Vertical"
    bar.Position = [1.0 - 0.92 * BAR, 0.25]
    bar.ScalarBarLength = 0.5
    bar.HorizontalTitle = 1
    bar.RangeLabelFormat = "%-#.4g"


def color_grains(scene, display, field, unit, preset, span):
    components = scene.grains.PointData[field].GetNumberOfComponents()
    simple.ColorBy(display, ("POINTS", field) + (("Magnitude",) if components > 1 else ()))
    spans = [span_of(scene, scene.grains, "PointData", field)]
    if field == "temperature":
        spans += [span_of(scene, slab, "CellData", field) for slab in scene.slabs]
    set_colors(field, preset, span or (min(s[0] for s in spans), max(s[1] for s in spans)))
    show_bar(scene, display, field, unit)


def show_time(scene):
    steps = [b - a for a, b in zip(scene.times, scene.times[1:]) if b > a]
    digits = 3
    if steps:
        while digits < 9 and min(steps) * 10**digits < 0.999:
            digits += 1
    label = simple.AnnotateTimeFilter(scene.grains)
    simple.RenameSource("time", label)
    label.Format = "t = {time:.%df} s" % digits
    display = simple.Show(label, scene.view)
    display.Color = INK
    display.FontSize = 22
    display.WindowLocation = "Upper Left Corner"
    simple.SetActiveSource(scene.grains)


def upwards(scene):
    """The axis against the load that the grains put on the walls at the end: y where there is none."""
    from paraview import servermanager

    if not scene.walls:
        return 1, 1.0
    scene.walls.UpdatePipeline(scene.times[-1])
    data = servermanager.Fetch(scene.walls).GetCellData()
    wall, force = data.GetArray("wall"), data.GetArray("force")
    if not wall or not force:
        return 1, 1.0
    loads = {wall.GetValue(c): force.GetTuple3(c) for c in range(wall.GetNumberOfTuples())}
    total = [sum(load[k] for load in loads.values()) for k in range(3)]
    axis = max((1, 2, 0), key=lambda k: abs(total[k]))
    return (axis, -1.0 if total[axis] > 0 else 1.0) if total[axis] else (1, 1.0)


def cross(a, b):
    return [a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3] for k in range(3)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    length = dot(a, a) ** 0.5
    return [x / length for x in a]


def directions(scene, up):
    """Unit vectors from the scene to the camera and upwards: from +z with y up in 2D, obliquely from above in 3D."""
    if scene.dimension == 2:
        return [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]
    axis, sign = ("xyz".index(up), 1.0) if up else upwards(scene)
    toward, upward = [0.0] * 3, [0.0] * 3
    upward[axis] = sign
    toward[axis] = 0.35 * sign
    # the front is +z with y up, -y with z up: as one would draw the axes on paper
    front, side = ((2, 1.0), 0) if axis == 1 else ((1, -1.0), 0) if axis == 2 else ((2, 1.0), 1)
    toward[front[0]] = front[1]
    toward[side] = 0.55
    return unit(toward), upward


def place_camera(scene, size, up=None):
    """Fits the box of the scene into the picture, left of the colour bar."""
    toward, upward = directions(scene, up)
    right = unit(cross(upward, toward))
    above = cross(toward, right)
    b = scene.bounds
    center = [(b[2 * k] + b[2 * k + 1]) / 2 for k in range(3)]
    corners = [[b[i] - center[0], b[2 + j] - center[1], b[4 + k] - center[2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    width, height = (max(abs(dot(corner, axis)) for corner in corners) for axis in (right, above))
    aspect = size[0] / size[1]
    half = 1.06 * max(height, width / (aspect * (1 - BAR)), 1e-9)  # of the height of the picture, m
    focus = [c + r * half * aspect * BAR for c, r in zip(center, right)]
    reach = 4 * max(half, *(dot(corner, corner) ** 0.5 for corner in corners))
    view = scene.view
    view.CameraParallelProjection = 1
    view.CameraParallelScale = half
    view.CameraFocalPoint = focus
    view.CameraPosition = [f + d * reach for f, d in zip(focus, toward)]
    view.CameraViewUp = upward
    view.CenterOfRotation = center


def set_time(scene, time):
    simple.GetAnimationScene().AnimationTime = time
    scene.view.ViewTime = time


def prepare_view(view):
    view.UseColorPaletteForBackground = 0
    view.BackgroundColorMode = "Single Color"
    view.Background = [1.0, 1.0, 1.0]
    view.OrientationAxesVisibility = 0
    view.EnableRayTracing = 0


def build(pvd, color=None, span=None, contacts=False, up=None, size=None):
    """Opens NAME.pvd with its walls and contacts and sets up the picture. Returns the Scene.

    color: a field (default: temperature, else velocity); span: (low, high) of the colours; contacts: show the contact network;
    up: 'x', 'y' or 'z' in 3D (default: against gravity); size: (width, height) in pixels of the picture.
    """
    simple._DisableFirstRenderCameraReset()
    scene = Scene(simple.GetActiveViewOrCreate("RenderView"))
    if size:
        scene.view.ViewSize = list(size)
    prepare_view(scene.view)
    pvd = os.path.abspath(pvd)
    scene.grains = open_series(pvd, "grains")
    scene.times = times_of(scene.grains) or [0.0]
    walls, network = companion(pvd, "_walls"), companion(pvd, "_contacts")
    scene.walls = open_series(walls, "walls") if walls else None
    scene.contacts = open_series(network, "contacts") if network else None
    scene.slabs = [open_series(path, os.path.basename(path)[: -len(".pvd")]) for path in slabs_of(pvd)]
    survey(scene)
    simple.GetAnimationScene().UpdateAnimationUsingDataTimeSteps()
    set_time(scene, scene.times[-1])  # at the start there may be no contacts, and then no range for their colours
    through = contacts and scene.contacts is not None
    chosen = None if through else choose_color(scene, color)
    scene.color = chosen[0] if chosen else None
    if scene.walls:  # before the grains: ColorBy() fits the colours to what was shown last
        show_walls(scene, scene.color == "temperature" and "temperature" in scene.walls.CellData.keys())
    show_slabs(scene, scene.color == "temperature")
    if scene.contacts:
        show_contacts(scene, contacts, span)
    display = show_grains(scene)
    if chosen:
        color_grains(scene, display, *chosen, span)
    if through:
        display.ColorArrayName = ["POINTS", ""]
        display.AmbientColor = display.DiffuseColor = GRAY
        display.Opacity = 0.2
    show_time(scene)
    set_time(scene, scene.times[0])
    place_camera(scene, size or scene.view.ViewSize, up)
    return scene


def main():
    pvd = os.environ.get("CALX_PVD")
    if not pvd or not os.path.exists(pvd):
        raise SystemExit("calx_view: set CALX_PVD to a .pvd file, or call paraview/view RESULT.pvd")
    build(pvd, color=os.environ.get("CALX_COLOR"))
    simple.Render()


if __name__ == "__main__":
    main()
