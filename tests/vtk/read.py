"""Reads VTK XML files and prints what is in them; ends with an error if a file cannot be read, is empty or has numbers that are not finite."""

import math
import sys

from vtkmodules.vtkCommonCore import vtkObject
from vtkmodules.vtkIOXML import vtkXMLGenericDataObjectReader

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
    print(f"{data.GetClassName()}: {data.GetNumberOfCells()} cells, {', '.join(arrays)}")
