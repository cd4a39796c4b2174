"""Writes the cases' meshes that no text editor writes, from parts/anterior.obj.

python make_binaries.py
"""

import base64
import gzip
import io
import struct
import zipfile
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


def ply(points, faces, count=None, newline="\n", lengths=None):
    """Binary PLY; the header's count of points may lie, and so may the lengths of the faces' lists, by their numbers."""
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
    data = "".join(line + newline for line in header).encode()
    data += b"".join(struct.pack("<3d", *point) for point in points)
    length = [(lengths or {}).get(number, len(face)) for number, face in enumerate(faces)]
    return data + b"".join(struct.pack(f"<B{len(f)}i", n, *f) for n, f in zip(length, faces))


def vtk(points, faces, ids=None):
    """Binary VTK legacy, which is big-endian: version 3.0, or with `ids` of a type version 5.1."""
    head = f"# vtk DataFile Version {'5.1' if ids else '3.0'}\nSPACE=LPS\nBINARY\nDATASET POLYDATA\n"
    data = f"{head}POINTS {len(points)} double\n".encode()
    data += b"".join(struct.pack(">3d", *point) for point in points)
    if ids is None:
        data += f"\nPOLYGONS {len(faces)} {4 * len(faces)}\n".encode()
        return data + b"".join(struct.pack(">4i", 3, *face) for face in faces) + b"\n"
    data += f"\nPOLYGONS {len(faces) + 1} {3 * len(faces)}\nOFFSETS {ids}\n".encode()
    data += struct.pack(f">{len(faces) + 1}q", *range(0, 3 * len(faces) + 1, 3))
    data += f"\nCONNECTIVITY {ids}\n".encode()
    return data + b"".join(struct.pack(">3q", *face) for face in faces) + b"\n"


def vtp(points, faces, form, order="<", packed=False):
    """VTK XML; `form` is raw or base64 appended data, or binary within the arrays."""
    arrays = [
        struct.pack(f"{order}{3 * len(points)}d", *(c for point in points for c in point)),
        struct.pack(f"{order}{3 * len(faces)}q", *(i for face in faces for i in face)),
        struct.pack(f"{order}{len(faces)}q", *range(3, 3 * len(faces) + 1, 3)),
    ]

    def text(raw):
        return base64.b64encode(raw)

    def stored(array):
        sizes, body = struct.pack(order + "I", len(array)), array
        if packed:
            body = zlib.compress(array, 9)
            sizes = struct.pack(order + "4I", 1, len(array), 0, len(body))
        if form == "raw":
            return sizes + body
        return text(sizes) + text(body) if packed else text(sizes + body)

    blocks = [stored(array) for array in arrays]
    starts = [sum(map(len, blocks[:number])) for number in range(3)]

    def tag(number, kind, name, more=""):
        head = f'<DataArray type="{kind}" Name="{name}"{more}'
        if form == "binary":
            return f'{head} format="binary">{blocks[number].decode()}</DataArray>'
        return f'{head} format="appended" offset="{starts[number]}"/>'

    endian = "LittleEndian" if order == "<" else "BigEndian"
    compressor = ' compressor="vtkZLibDataCompressor"' if packed else ""
    data = f"""<?xml version="1.0"?>
<VTKFile type="PolyData" version="0.1" byte_order="{endian}" header_type="UInt32"{compressor}>
<PolyData>
<FieldData><Array type="String" Name="SPACE" NumberOfTuples="1" format="ascii">76 80 83 0</Array></FieldData>
<Piece NumberOfPoints="{len(points)}" NumberOfPolys="{len(faces)}">
<Points>{tag(0, "Float64", "Points", ' NumberOfComponents="3"')}</Points>
<Polys>{tag(1, "Int64", "connectivity")}{tag(2, "Int64", "offsets")}</Polys>
</Piece></PolyData>
""".encode()
    if form != "binary":
        encoding = form.encode()
        data += b'<AppendedData encoding="' + encoding + b'">_' + b"".join(blocks) + b"</AppendedData>\n"
    return data + b"</VTKFile>\n"


def zlib_bomb(points=100_000, told=1 << 40, inside=24 * 100_000):
    """VTK XML whose one block of points holds so many bytes and says that it unpacks to so many."""
    block = zlib.compress(bytes(inside), 9)
    header = struct.pack("<4Q", 1, told, 0, len(block))
    data = base64.b64encode(header).decode() + base64.b64encode(block).decode()
    return f"""<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64" compressor="vtkZLibDataCompressor">
<PolyData><Piece NumberOfPoints="{points}" NumberOfPolys="0">
<Points><DataArray type="Float64" Name="points" NumberOfComponents="3" format="binary">{data}</DataArray></Points>
</Piece></PolyData>
</VTKFile>
""".encode()


def zipped(text):
    """A zip archive with the mesh in it."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(zipfile.ZipInfo("anterior.obj"), text)
    return buffer.getvalue()


NESTED_TOLD = "]" * 100_000 + "\n#^ error: brackets are nested too deeply\n"


def main():
    """Writes all of them."""
    points, faces = anterior()
    text = (FOLDER / "parts/anterior.obj").read_text().strip()
    scene = (FOLDER / "parts/good.toml").read_text()
    files = {
        "stl_cut.stl": stl(points, faces)[:700],
        "stl_solid_binary.stl": stl(points, faces, header=b"solid anterior SPACE=LPS"),
        "stl_trailing_bytes.stl": stl(points, faces) + b"made by hand",
        "stl_count_huge.stl": stl(points, faces, count=0xFFFF_FFFF),
        "ply_cut.ply": ply(points, faces)[:800],
        "ply_count_huge.ply": ply(points, faces, count=353_535_235_358),
        "vertex_infinite.stl": stl([[float("inf"), 0, 0], *points[1:]], faces),
        "ply_trailing_bytes.ply": ply(points, faces) + b"made by hand",
        "crlf_header_binary.ply": ply(points, faces, newline="\r\n"),
        "list_of_2.ply": ply(points, [*faces, faces[0][:2]]),
        "list_of_255.ply": ply(points, faces, lengths={3: 255}),
        "list_of_255_points.ply": ply(points, [*faces, [number % 20 for number in range(255)]]),
        "vtk_binary.vtk": vtk(points, faces),
        "vtk_cut.vtk": vtk(points, faces)[:700],
        "vtk_int64.vtk": vtk(points, faces, ids="vtktypeint64"),
        "vtp_appended_raw.vtp": vtp(points, faces, "raw"),
        "vtp_appended_base64.vtp": vtp(points, faces, "base64"),
        "vtp_big_endian.vtp": vtp(points, faces, "raw", order=">"),
        "vtp_zlib.vtp": vtp(points, faces, "base64", packed=True),
        "vtp_zlib_inline.vtp": vtp(points, faces, "binary", packed=True),
        "vtp_cut.vtp": vtp(points, faces, "raw")[:1200],
        "line_endings_cr.obj": text.replace("\n", "\r").encode(),
        "crlf.obj": text.replace("\n", "\r\n").encode(),
        "latin1_name.obj": ("o Segel ä\n" + text).encode("latin-1"),
        "bom_mesh.obj": b"\xef\xbb\xbf" + text.encode(),
        "utf16_mesh.obj": text.encode("utf-16-be"),
        "utf16_marked_mesh.obj": b"\xff\xfe" + text.encode("utf-16-le"),
        "utf32_mesh.obj": b"\xff\xfe\0\0" + text.encode("utf-32-le"),
        "utf32_unmarked_mesh.obj": text.encode("utf-32-be"),
        "utf16_unmarked_scene.toml": scene.encode("utf-16-le"),
        "bom_scene.json": b"\xef\xbb\xbf" + (FOLDER / "good_in_json.json").read_bytes(),
        "scene_gzip.toml": gzip.compress(scene.encode(), mtime=0),
        "nested_deep.json": b'{"schema_version": 1, "name": ' + b"[" * 100_000,
        "nested_deep_toml.toml": ("schema_version = 1\nname = " + "[" * 100_000 + NESTED_TOLD).encode(),
        "mesh_gzip.obj": gzip.compress(text.encode(), mtime=0),
        "mesh_zip.obj": zipped(text),
        "zlib_bomb.vtp": zlib_bomb(),
        "zlib_bomb_inside.vtp": zlib_bomb(points=100, told=24 * 100),
        "zlib_bomb_ratio.vtp": zlib_bomb(points=10_000_000, told=24 * 10_000_000),
    }
    for name, data in files.items():
        (FOLDER / name).write_bytes(data)


if __name__ == "__main__":
    main()
