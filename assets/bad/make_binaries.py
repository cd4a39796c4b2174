"""Writes the cases' meshes that no text editor writes, from parts/anterior.obj.

python make_binaries.py
"""

import base64
import gzip
import struct
import zlib
from pathlib import Path

FOLDER = Path(__file__).parent


def anterior():
    """Points and faces, from 0, of the good anterior leaflet."""
    points, faces = [], []
    for line in (FOLDER / "parts/anterior.obj").read_text().splitlines():
        kind, *words = line.split()
        if kind == "v":
            points.append([float(word) for word in words])
        elif kind == "f":
            faces.append([int(word) - 1 for word in words])
    return points, faces


def stl(points, faces, header=b"SPACE=LPS", count=None):
    """Binary STL; the header's count may lie."""
    data = header.ljust(80) + struct.pack("<I", len(faces) if count is None else count)
    for face in faces:
        corners = [coordinate for point in face for coordinate in points[point]]
        data += struct.pack("<12fH", 0, 0, 0, *corners, 0)
    return data


def ply(points, faces, count=None):
    """Binary PLY; the header's count of points may lie."""
    header = [
        "ply",
        "format binary_little_endian 1.0",
        "comment SPACE=LPS",
        f"element vertex {count or len(points)}",
        *(f"property double {axis}" for axis in "xyz"),
        f"element face {len(faces)}",
        "property list uchar int vertex_indices",
        "end_header",
    ]
    data = ("\n".join(header) + "\n").encode()
    data += b"".join(struct.pack("<3d", *point) for point in points)
    return data + b"".join(struct.pack("<B3i", 3, *face) for face in faces)


def zlib_bomb():
    """VTK XML whose one block of points says that it unpacks to 2^40 bytes."""
    block = zlib.compress(bytes(24 * 100_000), 9)
    header = struct.pack("<4Q", 1, 1 << 40, 0, len(block))
    data = base64.b64encode(header).decode() + base64.b64encode(block).decode()
    return f"""<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64" compressor="vtkZLibDataCompressor">
<PolyData><Piece NumberOfPoints="100000" NumberOfPolys="0">
<Points><DataArray type="Float64" Name="points" NumberOfComponents="3" format="binary">{data}</DataArray></Points>
</Piece></PolyData>
</VTKFile>
""".encode()


def main():
    """Writes all of them."""
    points, faces = anterior()
    text = (FOLDER / "parts/anterior.obj").read_text().strip()
    files = {
        "stl_cut.stl": stl(points, faces)[:700],
        "stl_solid_binary.stl": stl(points, faces, header=b"solid anterior SPACE=LPS"),
        "stl_trailing_bytes.stl": stl(points, faces) + b"made by hand",
        "stl_count_huge.stl": stl(points, faces, count=0xFFFF_FFFF),
        "ply_cut.ply": ply(points, faces)[:800],
        "ply_count_huge.ply": ply(points, faces, count=353_535_235_358),
        "crlf.obj": text.replace("\n", "\r\n").encode(),
        "latin1_name.obj": ("o Segel ä\n" + text).encode("latin-1"),
        "bom_mesh.obj": b"\xef\xbb\xbf" + text.encode(),
        "utf16_mesh.obj": text.encode("utf-16-be"),
        "mesh_gzip.obj": gzip.compress(text.encode(), mtime=0),
        "zlib_bomb.vtp": zlib_bomb(),
    }
    for name, data in files.items():
        (FOLDER / name).write_bytes(data)


if __name__ == "__main__":
    main()
