"""Surfaces of the bodies of a run, whose large frames hold a point per body.

ParaView: File > Load State, this file (or `paraview --script=` with it); it lies next to the series
of its name (bodies.py: bodies.pvd). Python with the package `vtk`: `python3 bodies.py` writes the
surfaces of all frames to bodies_surfaces/NNNNN.vtp, without ParaView.
"""

import functools
import os
import sys

import numpy
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPolyDataWriter


def read(path):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def cells(array):
    """Ends of the cells of a vtkCellArray, and their corners."""
    return vtk_to_numpy(array.GetOffsetsArray()), vtk_to_numpy(array.GetConnectivityArray())


@functools.lru_cache(maxsize=None)
def shape(path):
    """Points, lines and polygons of a shape."""
    surface = read(path)
    return vtk_to_numpy(surface.GetPoints().GetData()), cells(surface.GetLines()), cells(surface.GetPolys())


def rotated(q, points):
    """Points (n, m, 3), turned by unit quaternions w, x, y, z (n, 4)."""
    w, v = q[:, None, :1], q[:, None, 1:]
    t = 2.0 * numpy.cross(v, points)
    return points + w * t + numpy.cross(v, t)


def joined(parts):
    """vtkCellArray of (first point, ends, corners) of many copies of cells, and the cells of each copy."""
    ends, corners, counts, last = [numpy.zeros(1, int)], [], [], 0
    for firsts, (own_ends, own_corners) in parts:
        n, size = len(firsts), len(own_corners)
        ends.append((last + size * numpy.arange(n)[:, None] + own_ends[None, 1:]).ravel())
        corners.append((firsts[:, None] + own_corners[None]).ravel())
        counts.append(numpy.full(n, len(own_ends) - 1))
        last += n * size
    array = vtkCellArray()
    whole = [numpy.concatenate(part).astype(numpy.int64) for part in (ends, corners)]
    array.SetData(*(numpy_to_vtkIdTypeArray(part, deep=True) for part in whole))
    return array, numpy.concatenate(counts)


def surfaces(frame, folder):
    """Surfaces of the bodies of a frame of points; another frame as it is."""
    data = frame.GetPointData()
    if not data.HasArray("shape"):
        return frame
    rows = {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}
    centres = vtk_to_numpy(frame.GetPoints().GetData())
    points, lines, polygons, order, first = [], [], [], [], 0
    for number in numpy.unique(rows["shape"]):
        which = numpy.flatnonzero(rows["shape"] == number)
        own, own_lines, own_polygons = shape(os.path.join(folder, "shapes", f"{number:05}.vtp"))
        scaled = own[None] * rows["scale"][which, None]
        points.append((rotated(rows["orientation"][which], scaled) + centres[which, None]).reshape(-1, 3))
        firsts = first + len(own) * numpy.arange(len(which))
        lines.append((firsts, own_lines))
        polygons.append((firsts, own_polygons))
        order.append(which)
        first += len(own) * len(which)
    order = numpy.concatenate(order)
    (lines, lines_each), (polygons, polygons_each) = joined(lines), joined(polygons)
    owners = numpy.concatenate([numpy.repeat(order, lines_each), numpy.repeat(order, polygons_each)])
    result, places = vtkPolyData(), vtkPoints()
    places.SetData(numpy_to_vtk(numpy.concatenate(points).astype(numpy.float32), deep=True))
    result.SetPoints(places)
    result.SetLines(lines)
    result.SetPolys(polygons)
    for name in ("body", "velocity", "angular_velocity"):
        array = numpy_to_vtk(rows[name][owners], deep=True)
        array.SetName(name)
        result.GetCellData().AddArray(array)
    return result


def show(stem):
    """Shows the series in ParaView."""
    from paraview import simple

    series = simple.PVDReader(FileName=stem + ".pvd")
    bodies = simple.ProgrammableFilter(Input=series, OutputDataSetType="vtkPolyData")
    bodies.Script = (
        "import runpy\n"
        f"surfaces = runpy.run_path({stem + '.py'!r}, run_name='surfaces')['surfaces']\n"
        f"self.GetOutputDataObject(0).ShallowCopy(surfaces(self.GetInputDataObject(0, 0), {stem!r}))\n"
    )
    simple.RenameSource(os.path.basename(stem), bodies)
    view = simple.GetActiveViewOrCreate("RenderView")
    simple.ColorBy(simple.Show(bodies, view), ("CELLS", "velocity", "Magnitude"))
    simple.ResetCamera(view)


def write(stem):
    """Writes the surfaces of all frames."""
    folder = stem + "_surfaces"
    os.makedirs(folder, exist_ok=True)
    for name in sorted(os.listdir(stem)):
        if name.endswith(".vtp"):
            writer = vtkXMLPolyDataWriter()
            writer.SetFileName(os.path.join(folder, name))
            writer.SetInputData(surfaces(read(os.path.join(stem, name)), stem))
            writer.Write()


# Consoles of ParaView have names of their own.
if __name__ != "surfaces":
    stem = os.path.splitext(os.path.abspath(__file__))[0]
    if "paraview" in sys.modules:
        show(stem)
    else:
        write(stem)
