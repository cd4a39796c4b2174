"""pandas, PyVista and Matplotlib: used where they are, not needed where they are not."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

coapt = pytest.importorskip("coapt")


@pytest.fixture(scope="module")
def closed():
    return coapt.generate("healthy", faces=160).close()


def test_nothing_optional_is_imported_unasked():
    code = (
        "import sys, coapt; coapt.generate('healthy', faces=160).close()._repr_html_();"
        "print([name for name in ('pandas', 'pyvista', 'vtk', 'matplotlib') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize(
    ("call", "package"),
    [
        ("closed.to_dataframe()", "pandas"),
        ("coapt.plan(closed.valve, [coapt.Ring.physio_like(30)]).to_dataframe()", "pandas"),
        ("closed.to_pyvista()", "pyvista"),
        ("closed.chords_to_pyvista()", "pyvista"),
        ("closed.valve.to_pyvista()", "pyvista"),
        ("closed.plot()", "matplotlib"),
        ("closed.valve.panel()", "anywidget"),
    ],
)
def test_what_is_not_there_is_named_with_how_to_get_it(closed, monkeypatch, call, package):
    # A module of None is one that is not there.
    for module in [name for name in sys.modules if name.partition(".")[0] == package]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.delitem(sys.modules, "coapt._panel", raising=False)
    with pytest.raises(ModuleNotFoundError, match=f"needs {package}: pip install {package}$") as caught:
        eval(call)
    assert caught.value.name == package


def test_tables_are_dataframes(closed):
    pytest.importorskip("pandas")
    table = closed.to_dataframe().set_index("measure")
    assert table.loc["circumference", "value"] == closed.annulus.circumference_mm
    assert table.loc["circumference", "unit"] == "mm"
    both = coapt.closure(closed.valve, coapt.Clip(site="A2P2")).to_dataframe()
    assert list(both.columns) == ["group", "measure", "unit", "before", "after"]
    # Only the repaired valve has sutures.
    sutures = both[both["group"] == "Sutures and clips"]
    assert sutures["before"].isna().all() and sutures["after"].notna().all()
    plan = coapt.plan(closed.valve, [coapt.Ring.physio_like(30)])
    assert len(plan.to_dataframe()) == 2


def test_meshes_go_to_pyvista_and_back(closed):
    pytest.importorskip("pyvista")
    mesh = closed.to_pyvista()
    assert mesh.n_points == closed.valve.leaflet_vertex_count and mesh.n_cells == len(closed.triangles)
    assert np.array_equal(mesh.point_data["gap_mm"], closed.gap_mm)
    assert mesh.point_data["displacement_mm"].shape == (mesh.n_points, 3)
    chords = closed.chords_to_pyvista()
    assert np.array_equal(chords.cell_data["force_n"], closed.chord_forces_n)
    valve = coapt.Valve.from_pyvista(closed.valve.to_pyvista())
    assert valve.leaflet_names == ("anterior", "posterior") and len(valve.annulus) == len(closed.valve.annulus)
    with pytest.raises(coapt.InputError, match="no segments"):
        coapt.Valve.from_pyvista(closed.valve.to_pyvista(), chordae={"marginal": mesh})


def test_pictures_are_drawn_with_their_notice(closed, tmp_path):
    pytest.importorskip("matplotlib")
    for color_by in ("gap_mm", "contact", "strain", "leaflet"):
        figure = closed.plot(color_by=color_by)
        assert coapt.NOTICE in figure.get_suptitle()
    # Notebooks ask for this.
    assert figure._repr_png_().startswith(b"\x89PNG")
    figure.savefig(tmp_path / "closed.png")
    assert (tmp_path / "closed.png").stat().st_size > 10_000
    with pytest.raises(ValueError, match="expected one of"):
        closed.plot(color_by="colour")
