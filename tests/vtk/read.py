"""Reads VTK XML files and prints their content.

Ends with an error if a file cannot be read, is empty or has numbers that are not finite, or if a surface in 3D is not closed.
"""

import math
import sys

from vtkmodules.vtkCommonCore import vtkObject
from vtkmodules.vtkFiltersCore import vtkFeatureEdges
from vtkmodules.vtkIOXML import vtkXMLGenericDataObjectReader


def open_edges(surface):
    """Number of edges without exactly two polygons."""
    edges = vtkFeatureEdges()
    edges.SetInputData(surface)
    edges.FeatureEdgesOff()
    edges.ManifoldEdgesOff()
    edges.Update()
    return edges.GetOutput().GetNumberOfLines()


vtkObject.GlobalWarningDisplayOn()
for path in sys.argv[1:]:
    reader = vtkXMLGenericDataObjectReader()
    reader.SetFileName(path)
    reader.Update()
    data = reader.GetOutput()
    if reader.GetErrorCode() or data is None or data.GetNumberOfCells() == 0:
        sys.exit(f"{path}: error {reader.GetErrorCode()}, or no cells")
    arrays = []
    for attributes, tuples in ((data.GetCellData(), data.GetNumberOfCells()), (data.GetPointData(), data.GetNumberOfPoints())):
        for i in range(attributes.GetNumberOfArrays()):
            array = attributes.GetArray(i)
            if array.GetNumberOfTuples() != tuples or not all(map(math.isfinite, array.GetRange(-1))):
                sys.exit(f"{path}: {array.GetName()} has {array.GetNumberOfTuples()} of {tuples} values, or some are not finite")
            arrays.append(array.GetName())
    if not arrays:
        sys.exit(f"{path}: no arrays")
    bounds = data.GetBounds()
    if data.GetClassName() == "vtkPolyData" and bounds[5] > bounds[4] and open_edges(data) > 0:
        sys.exit(f"{path}: {open_edges(data)} edges without two polygons")
    print(f"{data.GetClassName()}: {data.GetNumberOfCells()} cells, {', '.join(arrays)}")
