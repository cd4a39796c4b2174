"""Writes the fixtures of this folder with VTK, and checks with VTK what coapt has written.

    pip install vtk          # made with 9.7.2
    python make_fixtures.py write assets/meshes
    python make_fixtures.py check assets/meshes/written_by_coapt.vtp
"""

import sys
from pathlib import Path

import vtk

# Eighths and sixteenths: exact in single precision and in few digits, so that all formats must agree exactly.
POINTS = [(0, 0, 0), (10, 0, 1.5), (20, 0, 0), (0, 8, 0.25), (10, 8, 2.125), (20, 8, 0.25),
          (0, 16, 0.5), (10, 16, 2.5), (20, 16, 0.5), (5, 4, -12), (5, 4, -18.75)]
VERTS = [[10]]
LINES = [[10, 9, 3], [9, 4]]
POLYS = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [3, 4, 7, 6], [4, 5, 8], [4, 8, 7]]
TAG = "3D Slicer output. SPACE=LPS"


def cell_array(cells):
    array = vtk.vtkCellArray()
    for cell in cells:
        array.InsertNextCell(len(cell))
        for point in cell:
            array.InsertCellPoint(point)
    return array


def named(array, name, values):
    array.SetName(name)
    for value in values:
        array.InsertNextValue(value)
    return array


def valve():
    points = vtk.vtkPoints()
    for point in POINTS:
        points.InsertNextPoint(*point)
    mesh = vtk.vtkPolyData()
    mesh.SetPoints(points)
    mesh.SetVerts(cell_array(VERTS))
    mesh.SetLines(cell_array(LINES))
    mesh.SetPolys(cell_array(POLYS))
    count = len(POINTS)
    cells = len(VERTS) + len(LINES) + len(POLYS)
    at_points, at_cells = mesh.GetPointData(), mesh.GetCellData()
    at_points.SetScalars(named(vtk.vtkIntArray(), "annulus", [int(i < 3) for i in range(count)]))
    displacement = vtk.vtkDoubleArray()
    displacement.SetName("displacement")
    displacement.SetNumberOfComponents(3)
    for i in range(count):
        displacement.InsertNextTuple3(-i * 0.5, i * 0.25, 0.125)
    at_points.AddArray(displacement)
    at_points.AddArray(named(vtk.vtkFloatArray(), "wall thickness é", [i * 0.0625 for i in range(count)]))
    at_cells.SetScalars(named(vtk.vtkTypeInt64Array(), "leaflet", [i // 4 for i in range(cells)]))
    at_cells.AddArray(named(vtk.vtkDoubleArray(), "rest_length_mm", [i * 1.5 for i in range(cells)]))
    return mesh


def grid_of(mesh):
    grid = vtk.vtkUnstructuredGrid()
    grid.SetPoints(mesh.GetPoints())
    grid.GetPointData().ShallowCopy(mesh.GetPointData())
    grid.GetCellData().ShallowCopy(mesh.GetCellData())
    for i in range(mesh.GetNumberOfCells()):
        cell = mesh.GetCell(i)
        grid.InsertNextCell(cell.GetCellType(), cell.GetPointIds())
    return grid


def surface_of(mesh):
    triangles = vtk.vtkTriangleFilter()
    triangles.SetInputData(mesh)
    triangles.PassVertsOff()
    triangles.PassLinesOff()
    clean = vtk.vtkCleanPolyData()  # drops points without faces
    clean.PointMergingOff()
    clean.SetInputConnection(triangles.GetOutputPort())
    clean.Update()
    surface = vtk.vtkPolyData()
    surface.SetPoints(clean.GetOutput().GetPoints())
    surface.SetPolys(clean.GetOutput().GetPolys())
    return surface


def write_legacy(path, writer, data, version, binary):
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    writer.SetFileVersion(version)
    writer.SetHeader(TAG)
    writer.SetFileTypeToBinary() if binary else writer.SetFileTypeToASCII()
    assert writer.Write()


def write_xml(path, mesh, mode, base64=False, compressor="None", header=32, big_endian=False, block=None):
    space = vtk.vtkStringArray()
    space.SetName("SPACE")
    space.InsertNextValue("LPS")
    marked = vtk.vtkPolyData()
    marked.ShallowCopy(mesh)
    marked.GetFieldData().AddArray(space)
    writer = vtk.vtkXMLPolyDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(marked)
    getattr(writer, "SetDataModeTo" + mode)()
    writer.SetEncodeAppendedData(base64)
    getattr(writer, "SetCompressorTypeTo" + compressor)()
    getattr(writer, f"SetHeaderTypeToUInt{header}")()
    writer.SetByteOrderToBigEndian() if big_endian else writer.SetByteOrderToLittleEndian()
    if block:
        writer.SetBlockSize(block)  # several blocks even in a small file
    assert writer.Write()


def write_all(folder):
    mesh = valve()
    grid = grid_of(mesh)
    surface = surface_of(mesh)
    for version in (42, 51):
        for binary, kind in ((False, "ascii"), (True, "binary")):
            write_legacy(folder / f"valve_legacy_{version}_{kind}.vtk", vtk.vtkPolyDataWriter(), mesh, version, binary)
            write_legacy(folder / f"valve_grid_{version}_{kind}.vtk", vtk.vtkUnstructuredGridWriter(), grid, version,
                         binary)
    # VTK no longer writes 3.0, which differs in the first line only.
    text = (folder / "valve_legacy_42_ascii.vtk").read_text()
    (folder / "valve_legacy_30_ascii.vtk").write_text(text.replace("Version 4.2", "Version 3.0"))

    write_xml(folder / "valve_ascii.vtp", mesh, "Ascii")
    write_xml(folder / "valve_appended_raw_u64.vtp", mesh, "Appended", header=64)
    write_xml(folder / "valve_appended_raw_u32_big_endian.vtp", mesh, "Appended", big_endian=True)
    write_xml(folder / "valve_appended_raw_zlib.vtp", mesh, "Appended", compressor="ZLib")
    write_xml(folder / "valve_appended_raw_zlib_blocks.vtp", mesh, "Appended", compressor="ZLib", header=64, block=64)
    write_xml(folder / "valve_appended_base64.vtp", mesh, "Appended", base64=True, header=64)
    write_xml(folder / "valve_appended_base64_zlib.vtp", mesh, "Appended", base64=True, compressor="ZLib")
    write_xml(folder / "valve_appended_base64_zlib_blocks.vtp", mesh, "Appended", base64=True, compressor="ZLib",
              header=64, block=64)
    write_xml(folder / "valve_inline_binary.vtp", mesh, "Binary")
    write_xml(folder / "valve_inline_binary_zlib_blocks.vtp", mesh, "Binary", compressor="ZLib", block=64)
    write_xml(folder / "valve_inline_binary_zlib_u64_big_endian.vtp", mesh, "Binary", compressor="ZLib", header=64,
              big_endian=True)

    for name, binary, big_endian in (("ascii", False, False), ("binary", True, False), ("binary_big_endian", True, True)):
        writer = vtk.vtkPLYWriter()
        writer.SetFileName(str(folder / f"surface_{name}.ply"))
        writer.SetInputData(surface)
        writer.SetFileTypeToBinary() if binary else writer.SetFileTypeToASCII()
        writer.SetDataByteOrderToBigEndian() if big_endian else writer.SetDataByteOrderToLittleEndian()
        writer.AddComment(TAG)
        assert writer.Write()
    for binary, kind in ((False, "ascii"), (True, "binary")):
        writer = vtk.vtkSTLWriter()
        writer.SetFileName(str(folder / f"surface_{kind}.stl"))
        writer.SetInputData(surface)
        writer.SetFileTypeToBinary() if binary else writer.SetFileTypeToASCII()
        writer.SetHeader(TAG)
        assert writer.Write()
    writer = vtk.vtkOBJWriter()
    writer.SetFileName(str(folder / "surface.obj"))
    writer.SetInputData(surface)
    writer.Write()

    stripper = vtk.vtkStripper()
    stripper.SetInputData(surface)
    stripper.Update()
    for version in (42, 51):
        write_legacy(folder / f"strips_legacy_{version}_ascii.vtk", vtk.vtkPolyDataWriter(), stripper.GetOutput(),
                     version, False)

    tetrahedron = vtk.vtkUnstructuredGrid()
    tetrahedron.SetPoints(mesh.GetPoints())
    tetrahedron.InsertNextCell(vtk.VTK_TETRA, 4, (0, 1, 4, 9))
    write_legacy(folder / "unsupported_tetrahedron_grid.vtk", vtk.vtkUnstructuredGridWriter(), tetrahedron, 42, False)
    write_xml(folder / "unsupported_lz4.vtp", mesh, "Binary", compressor="LZ4")


def check(path):
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    mesh = reader.GetOutput()
    assert reader.GetErrorCode() == 0
    assert [mesh.GetPoint(i) for i in range(mesh.GetNumberOfPoints())] == [tuple(map(float, p)) for p in POINTS]
    cells = [[mesh.GetCell(i).GetPointId(k) for k in range(mesh.GetCell(i).GetNumberOfPoints())]
             for i in range(mesh.GetNumberOfCells())]
    lines = [[10, 9], [9, 3], [9, 4]]
    triangles = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [3, 4, 6], [4, 7, 6], [4, 5, 8], [4, 8, 7]]
    assert cells == lines + triangles, cells
    source = [1, 1, 2, 3, 4, 5, 6, 7, 7, 8, 9]
    rest_length = mesh.GetCellData().GetArray("rest_length_mm")
    assert [rest_length.GetValue(i) for i in range(len(cells))] == [1.5 * i for i in source]
    displacement = mesh.GetPointData().GetArray("displacement")
    assert displacement.GetTuple3(5) == (-2.5, 1.25, 0.125)
    assert mesh.GetPointData().GetArray("wall thickness é").GetValue(3) == 0.1875
    assert mesh.GetFieldData().GetAbstractArray("SPACE").GetValue(0) == "LPS"
    print(f"{path}: VTK {vtk.vtkVersion().GetVTKVersion()} reads the same mesh")


if __name__ == "__main__":
    {"write": write_all, "check": check}[sys.argv[1]](Path(sys.argv[2]))
