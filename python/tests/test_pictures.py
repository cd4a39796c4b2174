"""Tests of `python/tools/pictures.py` and its reader; they need numpy and matplotlib."""

from __future__ import annotations

import struct
import sys
from pathlib import Path

import pytest

np = pytest.importorskip("numpy")
pytest.importorskip("matplotlib")
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tools"))

import matplotlib.pyplot as plt  # noqa: E402
import painter  # noqa: E402
import pictures  # noqa: E402
from scene_files import data_array, polydata  # noqa: E402
from tables import InputFault  # noqa: E402
from vtp_reader import read_vtp  # noqa: E402

SQUARE = [(-10.0, -10.0, 0.0), (10.0, -10.0, 0.0), (10.0, 10.0, 0.0), (-10.0, 10.0, 0.0)]


def square(path: Path, height: float = 0.0, half: float = 10.0, leaflet: int = 0, **arrays) -> Path:
    """A horizontal square, normal up, as a surface file."""
    points = [(x / 10.0 * half, y / 10.0 * half, height) for x, y, _ in SQUARE]
    extra = [data_array(name, values) for name, values in arrays.items()]
    cells = [data_array("leaflet", [leaflet])]
    path.write_text(polydata("LPS", points, polys=[[0, 1, 2, 3]], point_arrays=extra, cell_arrays=cells))
    return path


def appended(path: Path, header: str = 'header_type="UInt64"', cut: int = 0, extra: str = "") -> Path:
    """The same square as coapt writes it, appended raw arrays after their lengths; one quad, one line."""
    blocks = [
        struct.pack("<12d", *(value for point in SQUARE for value in point)),
        struct.pack("<2q", 0, 2),
        struct.pack("<1q", 2),
        struct.pack("<4i", 0, 1, 2, 3),
        struct.pack("<1q", 4),
        struct.pack("<4B", 1, 0, 1, 0),
        struct.pack("<2d", 7.0, 8.0),
    ]
    offsets, data = [], b""
    for block in blocks:
        offsets.append(len(data))
        data += struct.pack("<Q", len(block)) + block
    array = '<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="appended" offset="{}"/>'
    text = f"""<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" {header} {extra}><PolyData>
<Piece NumberOfPoints="4" NumberOfVerts="0" NumberOfLines="1" NumberOfStrips="0" NumberOfPolys="1">
<PointData>{array.format("UInt8", "annulus", 1, offsets[5])}</PointData>
<CellData>{array.format("Float64", "value", 1, offsets[6])}</CellData>
<Points>{array.format("Float64", "Points", 3, offsets[0])}</Points>
<Lines>{array.format("Int64", "connectivity", 1, offsets[1])}
{array.format("Int64", "offsets", 1, offsets[2])}</Lines>
<Polys>{array.format("Int32", "connectivity", 1, offsets[3])}
{array.format("Int64", "offsets", 1, offsets[4])}</Polys>
</Piece></PolyData><AppendedData encoding="raw">_"""
    tail = b"" if cut else b"</AppendedData></VTKFile>"
    path.write_bytes(text.encode() + data[: len(data) - cut] + tail)
    return path


# ---------------------------------------------------------------- reader


def test_appended_raw_is_read(tmp_path):
    data = read_vtp(appended(tmp_path / "raw.vtp"))
    assert data.points.tolist() == [list(point) for point in SQUARE]
    assert data.triangles.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert data.segments.tolist() == [[0, 2]]
    assert data.point_arrays["annulus"].tolist() == [1, 0, 1, 0]
    # Cell arrays count lines before polygons: the quad has the second value.
    assert data.triangle_arrays["value"].tolist() == [8.0, 8.0]


def test_ascii_is_read_to_the_last_digit(tmp_path):
    values = [0.1, 1 / 3, 1e-300, 2.0]
    data = read_vtp(square(tmp_path / "ascii.vtp", height=0.30000000000000004, strain=values))
    assert data.point_arrays["strain"].tolist() == values
    assert data.points[:, 2].tolist() == [0.30000000000000004] * 4


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda p: appended(p, cut=9), "array 'value' of 16 bytes is cut short"),
        (lambda p: appended(p, extra='compressor="vtkZLibDataCompressor"'), "compressed"),
        (lambda p: p.write_text("not xml"), "not XML"),
        (lambda p: p.write_text("<VTKFile/>"), "no PolyData piece"),
        (
            lambda p: p.write_text(polydata("LPS", SQUARE, polys=[[0, 1, 9]])),
            "Polys: point 9 of 4 does not exist",
        ),
        (lambda p: p.write_text(polydata("LPS", [(0.0, float("nan"), 0.0)])), "point 0 is not finite"),
        (lambda p: square(p, strain=[1.0, 2.0]), "array 'strain' has 2 values for 4 points"),
        (lambda p: None, "No such file"),
    ],
)
def test_what_cannot_be_read_is_named(tmp_path, capsys, make, message):
    path = tmp_path / "wrong.vtp"
    make(path)
    with pytest.raises(InputFault, match=message):
        read_vtp(path)
    assert pictures.main([str(path), "-o", str(tmp_path / "a.png")]) == 2
    assert capsys.readouterr().err.count("\n") == 1


# ---------------------------------------------------------------- frame


@pytest.mark.parametrize("view", sorted(pictures.VIEWS))
def test_views_are_rotations(view):
    """A mirrored view would show a left for a right commissure."""
    axes = pictures.VIEWS[view]
    assert np.allclose(axes @ axes.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(axes) == pytest.approx(1.0, abs=1e-14)


def test_frame_follows_the_annulus_wherever_it_lies(tmp_path):
    rng = np.random.default_rng(1)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    angles = np.linspace(0.0, 2 * np.pi, 12, endpoint=False)
    ring = np.stack([15 * np.cos(angles), 12 * np.sin(angles), 0 * angles], axis=1)
    points = np.concatenate([ring, 0.5 * ring - [0, 0, 9.0]]) @ turn.T + [40.0, -7.0, 100.0]
    polys = [[i, (i + 1) % 12, 12 + (i + 1) % 12, 12 + i] for i in range(12)]
    path = tmp_path / "turned.vtp"
    arrays = [data_array("annulus", [1] * 12 + [0] * 12)]
    path.write_text(polydata("LPS", [tuple(map(float, p)) for p in points], polys=polys, point_arrays=arrays))
    (valve,) = pictures.read_valves([path])
    origin, axes = pictures.valve_frame(valve, turn[:, 1])
    assert np.allclose(origin, [40.0, -7.0, 100.0], atol=1e-12)
    assert np.allclose(axes, turn.T, atol=1e-12)


def test_the_anterior_leaflets_file_sets_the_direction(tmp_path):
    marks = {"annulus": [1, 1, 1, 1]}
    for name, shift in (("anterior", 30.0), ("posterior", 0.0)):
        points = [(x + shift, y, z) for x, y, z in SQUARE]
        arrays = [data_array("annulus", marks["annulus"])]
        text = polydata("LPS", points, polys=[[0, 1, 2, 3]], point_arrays=arrays)
        (tmp_path / f"leaflet_{name}.vtp").write_text(text)
    (valve,) = pictures.read_valves([tmp_path])
    assert painter.unit(valve.anterior).tolist() == [1.0, 0.0, 0.0]


def test_leaflets_that_share_an_edge_have_no_seam(tmp_path):
    for name, shift in (("a", 0.0), ("b", 20.0)):
        points = [(x + shift, y, z) for x, y, z in SQUARE]
        (tmp_path / f"leaflet_{name}.vtp").write_text(polydata("LPS", points, polys=[[0, 1, 2, 3]]))
    (valve,) = pictures.read_valves([tmp_path])
    border, _ = pictures.boundary_segments(valve.surface)
    assert len(valve.surface.points) == 6 and len(border) == 6
    assert valve.leaflet.tolist() == [0, 0, 1, 1]


# ---------------------------------------------------------------- picture


def middle_colour(paths: list[Path], picture: Path, *options: str) -> np.ndarray:
    """RGB at the middle of a picture of one valve from above, which is nearly all of it.

    The median of 15 x 15 pixels: antialiasing at triangle edges lets a little of what lies below through.
    """
    arguments = [*map(str, paths), "-o", str(picture), "--views=above", "--dpi=100", *options]
    assert pictures.main(arguments) == 0
    image = plt.imread(picture)
    row, column = image.shape[0] // 2, image.shape[1] // 2
    return np.median(image[row - 7 : row + 8, column - 7 : column + 8, :3], axis=(0, 1))


def test_the_nearer_leaflet_covers_the_farther(tmp_path):
    found = []
    for near, far in ((0, 1), (1, 0)):
        folder = tmp_path / f"near{near}"
        folder.mkdir()
        square(folder / "leaflet_a.vtp", height=5.0, half=7.0, leaflet=near)
        square(folder / "leaflet_b.vtp", height=-5.0, half=10.0, leaflet=far)
        found.append(middle_colour([folder], folder / "p.png"))
    alone = [
        middle_colour([square(tmp_path / f"alone{leaflet}.vtp", leaflet=leaflet)], tmp_path / "alone.png")
        for leaflet in (0, 1)
    ]
    for leaflet in (0, 1):
        own, other = (np.abs(found[leaflet] - alone[which]).max() for which in (leaflet, 1 - leaflet))
        # Same normal, same light: the same colour but for rounding to 8 bits.
        assert own <= 2 / 255 and other > 20 / 255


def test_the_ventricular_side_has_another_colour(tmp_path):
    up = square(tmp_path / "up.vtp")
    down = tmp_path / "down.vtp"
    down.write_text(polydata("LPS", SQUARE, polys=[[3, 2, 1, 0]]))
    above, below = (middle_colour([path], tmp_path / "p.png") for path in (up, down))
    assert above[0] > above[2] and below[2] > below[0], "warm from the atrium, cold from the ventricle"


def test_colour_follows_the_array_and_its_limits(tmp_path):
    low, high = (square(tmp_path / f"{v}.vtp", strain=[v] * 4) for v in (0.0, 1.0))
    options = ("--color=strain", "--limits", "0", "1")
    dark, bright = (middle_colour([path], tmp_path / "p.png", *options) for path in (low, high))
    # cividis runs from dark blue to bright yellow.
    assert dark[2] > dark[0] and bright[0] > bright[2] and bright.sum() > 2 * dark.sum()


def test_an_unknown_array_is_refused_with_what_there_is(tmp_path, capsys):
    path = square(tmp_path / "a.vtp", gap_mm=[0.0] * 4)
    assert pictures.main([str(path), "-o", str(tmp_path / "a.png"), "--color=strain"]) == 2
    assert "no surface has an array 'strain'; they have gap_mm, leaflet" in capsys.readouterr().err
    assert not (tmp_path / "a.png").exists()


def test_missing_values_are_drawn_grey(tmp_path):
    values = [float("nan"), float("inf"), float("nan"), float("inf")]
    path = square(tmp_path / "a.vtp", gap_mm=values)
    colour = middle_colour([path], tmp_path / "a.png", "--color=gap_mm")
    assert np.ptp(colour) < 0.02


def test_the_same_input_gives_the_same_bytes(tmp_path):
    valve = square(tmp_path / "closed.vtp", annulus=[1, 1, 1, 1])
    chords = tmp_path / "chords.vtp"
    chords.write_text(polydata("LPS", [(0.0, 0.0, 0.0), (0.0, 0.0, -20.0)], lines=[[0, 1]]))
    for name in ("one", "two"):
        arguments = [
            str(valve),
            str(chords),
            "-o",
            str(tmp_path / f"{name}.png"),
            "--views=above,front,side,oblique",
        ]
        assert pictures.main([*arguments, "--dpi=40"]) == 0
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "two.png").read_bytes()


def test_a_folder_of_results_is_one_column_each_with_chords_to_the_closed_state(tmp_path):
    for name in ("open", "closed", "after"):
        square(tmp_path / f"{name}.vtp")
    (tmp_path / "chords.vtp").write_text(polydata("LPS", [(0.0, 0.0, 0.0), (0.0, 0.0, -9.0)], lines=[[0, 1]]))
    valves = pictures.read_valves([tmp_path])
    assert [(valve.title, len(valve.chords)) for valve in valves] == [
        ("open", 0),
        ("closed", 1),
        ("after", 0),
    ]


def test_lines_named_for_a_state_belong_to_it(tmp_path):
    """Lines of another length for each state show which went where."""
    for number, name in enumerate(("open", "closed", "after", "x"), start=1):
        square(tmp_path / f"{name}.vtp")
        file = f"chords_{name}.vtp" if name == "after" else f"{name}_chords.vtp"
        points = [(0.0, 0.0, 0.0), (0.0, 0.0, -float(number))]
        (tmp_path / file).write_text(polydata("LPS", points, lines=[[0, 1]]))
    valves = pictures.read_valves([tmp_path])
    found = [(valve.title, [data.points[1, 2] for data in valve.chords]) for valve in valves]
    assert found == [("open", [-1.0]), ("closed", [-2.0]), ("after", [-3.0]), ("x", [-4.0])]


def test_files_of_one_name_are_told_apart_by_their_folders(tmp_path):
    for folder in ("before", "after"):
        (tmp_path / folder).mkdir()
        square(tmp_path / folder / "closed.vtp")
    square(tmp_path / "open.vtp")
    valves = pictures.read_valves([tmp_path / f"{name}.vtp" for name in ("open", "before/closed", "after/closed")])
    assert [valve.title for valve in valves] == ["open", "before: closed", "after: closed"]
