"""Reads the `.vtp` files that coapt and its tools write, with numpy alone.

VTK XML PolyData, little endian, arrays either ASCII or appended raw with UInt64 (or UInt32) lengths,
uncompressed. Every other encoding is refused by name; ParaView and 3D Slicer can save one of these.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from tables import InputFault

NUMPY_TYPES = {
    "Float64": "<f8",
    "Float32": "<f4",
    "Int64": "<i8",
    "Int32": "<i4",
    "Int16": "<i2",
    "Int8": "<i1",
    "UInt64": "<u8",
    "UInt32": "<u4",
    "UInt16": "<u2",
    "UInt8": "<u1",
}


@dataclass
class PolyData:
    """Points [mm] (n, 3); triangles (m, 3); lines (k, 2), polylines cut into segments; arrays by name."""

    path: Path
    points: np.ndarray
    triangles: np.ndarray
    segments: np.ndarray
    point_arrays: dict[str, np.ndarray] = field(default_factory=dict)
    triangle_arrays: dict[str, np.ndarray] = field(default_factory=dict)


def read_vtp(path: Path) -> PolyData:
    """Reads one file. Polygons are cut into fans; cell arrays follow their triangles."""
    try:
        content = Path(path).read_bytes()
    except OSError as error:
        raise InputFault(f"{path}: {error.strerror or error}") from None
    root, appended = parse(path, content)
    piece = root.find("PolyData/Piece")
    if piece is None:
        raise InputFault(f"{path}: no PolyData piece; is this a .vtp surface?")
    read = Reader(path, root, appended)
    points = read.named(piece.find("Points"), None)
    if points is None or points.ndim != 2 or points.shape[1] != 3:
        raise InputFault(f"{path}: Points are missing or do not have 3 components")
    if not np.isfinite(points).all():
        raise InputFault(f"{path}: point {int(np.argwhere(~np.isfinite(points))[0, 0])} is not finite")
    vertices, lines, polygons = (
        read.cells(piece.find(kind), len(points)) for kind in ("Verts", "Lines", "Polys")
    )
    triangles, owner = fans(polygons)
    before = len(vertices) + len(lines)
    cell_arrays = {
        name: values[before:][owner]
        for name, values in read.all(piece.find("CellData")).items()
        if len(values) >= before + len(polygons)
    }
    point_arrays = read.all(piece.find("PointData"))
    for name, values in point_arrays.items():
        if len(values) != len(points):
            raise InputFault(f"{path}: array '{name}' has {len(values)} values for {len(points)} points")
    pairs = [pair for line in lines for pair in zip(line, line[1:])]
    segments = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    return PolyData(Path(path), points.astype(float), triangles, segments, point_arrays, cell_arrays)


def parse(path: Path, content: bytes) -> tuple[ElementTree.Element, bytes]:
    """The XML without its appended bytes, and those bytes."""
    opening = re.search(rb"<AppendedData[^>]*>\s*_", content)
    appended = b""
    if opening:
        if b'encoding="raw"' not in opening.group():
            raise InputFault(f"{path}: appended data are not raw; save without base64")
        closing = content.rfind(b"</AppendedData>")
        appended = content[opening.end() : closing if closing > opening.end() else len(content)]
        content = content[: opening.start()] + b"</VTKFile>"
    try:
        root = ElementTree.fromstring(content)
    except ElementTree.ParseError as error:
        raise InputFault(f"{path}:{error.position[0]}: not XML: {error}") from None
    if root.get("compressor"):
        raise InputFault(f"{path}: compressed ({root.get('compressor')}); save without compression")
    if root.get("byte_order", "LittleEndian") != "LittleEndian":
        raise InputFault(f"{path}: big endian; save as little endian")
    return root, appended


@dataclass
class Reader:
    """What is needed to turn a DataArray into numbers."""

    path: Path
    root: ElementTree.Element
    appended: bytes

    def array(self, element: ElementTree.Element) -> np.ndarray:
        """One DataArray, (n,) or (n, components)."""
        name, kind = element.get("Name", "?"), element.get("type", "?")
        if kind not in NUMPY_TYPES:
            raise InputFault(f"{self.path}: array '{name}' has type {kind}, which is not read")
        if element.get("format") == "ascii":
            try:
                values = np.array((element.text or "").split(), dtype=NUMPY_TYPES[kind])
            except (ValueError, OverflowError) as error:
                raise InputFault(f"{self.path}: array '{name}': {error}") from None
        elif element.get("format") == "appended":
            values = self.raw(name, kind, element.get("offset", ""))
        else:
            raise InputFault(
                f"{self.path}: array '{name}' is {element.get('format')}; save ascii or appended raw"
            )
        width = int(element.get("NumberOfComponents", "1"))
        if width > 1 and len(values) % width:
            raise InputFault(
                f"{self.path}: array '{name}': {len(values)} numbers do not fill {width} components"
            )
        return values.reshape(-1, width) if width > 1 else values

    def raw(self, name: str, kind: str, offset: str) -> np.ndarray:
        """One array from the appended bytes: its length in bytes, then itself."""
        head = np.dtype("<u4" if self.root.get("header_type", "UInt32") == "UInt32" else "<u8")
        start = int(offset) if offset.isdigit() else len(self.appended)
        if start + head.itemsize > len(self.appended):
            raise InputFault(f"{self.path}: array '{name}' begins beyond the end of the file")
        size = int(np.frombuffer(self.appended, head, 1, start)[0])
        start += head.itemsize
        dtype = np.dtype(NUMPY_TYPES[kind])
        if start + size > len(self.appended) or size % dtype.itemsize:
            raise InputFault(f"{self.path}: array '{name}' of {size} bytes is cut short")
        return np.frombuffer(self.appended, dtype, size // dtype.itemsize, start)

    def named(self, parent: ElementTree.Element | None, name: str | None) -> np.ndarray | None:
        """The array of that name, or the first, inside an element."""
        for element in [] if parent is None else parent.findall("DataArray"):
            if name is None or element.get("Name") == name:
                return self.array(element)
        return None

    def all(self, parent: ElementTree.Element | None) -> dict[str, np.ndarray]:
        """All arrays of numbers inside an element; strings are passed over."""
        elements = [] if parent is None else parent.findall("DataArray")
        return {e.get("Name", ""): self.array(e) for e in elements if e.get("type") in NUMPY_TYPES}

    def cells(self, parent: ElementTree.Element | None, point_count: int) -> list[list[int]]:
        """The cells of one kind as lists of point numbers."""
        connectivity, offsets = self.named(parent, "connectivity"), self.named(parent, "offsets")
        if connectivity is None or offsets is None:
            return []
        ends = [0, *offsets.tolist()]
        if any(a > b for a, b in zip(ends, ends[1:])) or ends[-1] != len(connectivity):
            raise InputFault(f"{self.path}: {parent.tag}: offsets do not match the connectivity")
        outside = (connectivity < 0) | (connectivity >= point_count)
        if outside.any():
            wrong = int(connectivity[outside][0])
            raise InputFault(f"{self.path}: {parent.tag}: point {wrong} of {point_count} does not exist")
        numbers = connectivity.tolist()
        return [numbers[a:b] for a, b in zip(ends, ends[1:])]


def fans(polygons: list[list[int]]) -> tuple[np.ndarray, np.ndarray]:
    """Polygons as triangles, and the polygon each came from."""
    triangles, owner = [], []
    for number, corners in enumerate(polygons):
        for b, c in zip(corners[1:], corners[2:]):
            triangles.append((corners[0], b, c))
            owner.append(number)
    return np.array(triangles, dtype=np.int64).reshape(-1, 3), np.array(owner, dtype=np.int64)
