"""Closing, repairing, editing: what people do with the package."""

from __future__ import annotations

import json
import pickle

import numpy as np
import pytest

coapt = pytest.importorskip("coapt")

FACES = 160
"""Small enough that a closure takes a fraction of a second, and certified in all presets used here."""


@pytest.fixture(scope="module")
def healthy():
    return coapt.generate("healthy", faces=FACES)


@pytest.fixture(scope="module")
def closed(healthy):
    return healthy.close()


def test_the_healthy_valve_closes_with_a_certificate(closed):
    assert closed.certified and closed.status == "converged"
    assert closed.certificate.stable and closed.certificate.crossings.shape == (0, 3)
    assert closed.certificate.residual <= 1e-6
    # The presets' promise, within the noise of meshes that the README tells.
    assert closed.orifice.area_mm2 < 8.0
    assert len(closed.history) > 5 and closed.history[0].residual > closed.history[-1].residual


def test_forces_balance_to_the_residual(healthy, closed):
    # What supports carry is pressure times the vector area of the annulus' opening; here only that nothing is lost between
    # the arrays and the measures: they sum to the same force, in another order, hence rounding.
    on_annulus = closed.reactions_n[healthy.annulus].sum(axis=0)
    assert np.allclose(on_annulus, closed.annulus_force_n, rtol=0, atol=1e-12)


def test_arrays_are_read_only_and_the_same_each_time(closed):
    positions = closed.positions_mm
    assert positions.dtype == np.float64 and positions.flags.c_contiguous and not positions.flags.writeable
    assert positions.shape == closed.valve.points_mm.shape
    assert closed.positions_mm is positions
    with pytest.raises(ValueError, match="read-only"):
        positions[0, 0] = 1.0
    assert closed.triangles.max() < closed.valve.leaflet_vertex_count
    assert closed.gap_mm.shape == closed.in_contact.shape == closed.strain.shape
    assert closed.chord_forces_n.shape == (len(closed.chords[1]),)


def test_positions_outlive_their_result():
    positions = coapt.generate("healthy", faces=FACES).close().positions_mm
    assert np.isfinite(positions).all()


def test_repairs_are_of_what_was_given_when_they_were_made(healthy):
    size = np.array(30.0)
    ring = coapt.Ring.physio_like(size)
    size[()] = 26.0
    assert ring.size_mm == 30.0 and type(ring.size_mm) is float
    assert healthy.with_repair(ring).repairs[0]["size_mm"] == 30.0
    assert hash(ring) == hash(coapt.Ring.physio_like(np.int64(30)))
    json.dumps(coapt.Ring.physio_like(np.float32(30)).to_dict())
    assert coapt.Ring(family="saddle", size_mm=30, flexible=np.bool_(False)).flexible is False


def test_results_and_valves_are_frozen(healthy, closed):
    for it in (healthy, closed):
        with pytest.raises(AttributeError):
            it.name = "other"
        with pytest.raises(AttributeError):
            it._native = None
    with pytest.raises(AttributeError):
        coapt.Ring.physio_like(30).size_mm = 31


def test_a_ring_brings_the_leaflets_together(healthy, closed):
    repaired = healthy.with_repair(coapt.Ring.physio_like(28))
    assert healthy.repairs == () and repaired.repairs[0]["size_mm"] == 28.0
    after = repaired.close()
    assert after.certified
    assert after.annulus.ap_mm < closed.annulus.ap_mm
    assert after.coaptation.area_mm2 > closed.coaptation.area_mm2


def test_a_second_ring_is_refused_however_it_is_asked_for(healthy):
    ring, other = coapt.Ring.physio_like(32), coapt.Ring.physio_like(30)
    ringed = healthy.with_repair(ring)
    for ask in (
        lambda: healthy.with_repair(ring, other),
        lambda: ringed.with_repair(other),
        lambda: coapt.closure(ringed, other),
        lambda: ringed.interactive().set_ring(other),
        lambda: coapt.plan(ringed, [other]),
    ):
        with pytest.raises(coapt.InputError, match=r"it would be sewn where repair\[0\] has sewn a ring"):
            ask()


def test_pressure_and_settings_make_other_valves(healthy, closed):
    higher = healthy.close(pressure_mmhg=120)
    assert higher.valve.pressure_mmhg == pytest.approx(120, rel=1e-12)
    assert healthy.pressure_mmhg == pytest.approx(100, rel=1e-12)
    assert higher.chord_tensions.total_force_n > closed.chord_tensions.total_force_n
    limited = healthy.close(settings=coapt.Settings(iteration_limit=2))
    assert limited.status == "iteration-limit" and not limited.certified
    with pytest.raises(coapt.InputError, match="residual_tolerance"):
        healthy.with_settings(coapt.Settings(residual_tolerance=-1.0))


def test_many_valves_close_as_each_alone(healthy, closed):
    others = [healthy.with_repair(coapt.Ring.physio_like(size)) for size in (28, 32)]
    together = coapt.close_many([healthy, *others])
    alone = [closed, *(valve.close() for valve in others)]
    for one, other in zip(together, alone):
        assert one.positions_mm.tobytes() == other.positions_mm.tobytes()


def test_a_closure_starts_where_it_is_told_to(healthy, closed):
    again = healthy.close(start=closed)
    assert len(again.history) <= 2 and again.certified
    other = coapt.generate("healthy", faces=300)
    with pytest.raises(coapt.InputError, match="start has .* expected the"):
        other.close(start=closed)


def test_a_live_valve_follows_its_ring(healthy):
    live = healthy.interactive()
    first = live.closed
    small = live.set_ring(coapt.Ring.physio_like(30))
    assert small.certified and live.closed.positions_mm is small.positions_mm
    assert small.valve.repairs[0]["size_mm"] == 30.0
    # The held vertices are where the ring of a fresh repair puts them, exactly.
    fresh = healthy.with_repair(coapt.Ring.physio_like(30)).close()
    annulus = healthy.annulus
    assert small.positions_mm[annulus].tobytes() == fresh.positions_mm[annulus].tobytes()
    back = live.set()
    assert back.positions_mm[annulus].tobytes() == first.positions_mm[annulus].tobytes()
    with pytest.raises(coapt.InputError, match="expected rings and relocations"):
        live.set(coapt.Alfieri(site="A2P2"))
    with pytest.raises(TypeError, match="cannot be pickled"):
        pickle.dumps(live)


def test_pickles_hold_all(healthy, closed):
    repaired = healthy.with_repair(coapt.Ring.physio_like(28), coapt.Clip(site="A2P2", size="long"))
    back = pickle.loads(pickle.dumps(repaired))
    assert back.repairs == repaired.repairs and back.points_mm.tobytes() == repaired.points_mm.tobytes()
    assert back.warnings == repaired.warnings
    again = pickle.loads(pickle.dumps(closed))
    assert again.to_dict() == closed.to_dict() and again.history == closed.history
    assert again.positions_mm.tobytes() == closed.positions_mm.tobytes()
    assert again.reactions_n.tobytes() == closed.reactions_n.tobytes()
    limited = healthy.close(settings=coapt.Settings(iteration_limit=2))
    assert pickle.loads(pickle.dumps(limited)).status == "iteration-limit"
    ring = coapt.Ring.saddle(30)
    assert pickle.loads(pickle.dumps(ring)) == ring


def test_pickles_of_other_versions_are_refused(healthy):
    rebuild, (stored,) = healthy.__reduce__()
    with pytest.raises(coapt.InputError, match="is `coapt-valve/9`; this version reads `coapt-valve/1`"):
        rebuild(stored.replace(b"coapt-valve/1", b"coapt-valve/9"))
    with pytest.raises(coapt.InputError, match="pickle"):
        rebuild(b"nonsense")


def test_a_closure_reports_before_and_after(healthy, tmp_path):
    done = coapt.closure(healthy, coapt.Ring.physio_like(28))
    assert done.certified
    told = done.to_dict()
    assert told["notice"] == coapt.NOTICE and set(told) >= {"before", "after", "repairs", "warnings"}
    page = done._repr_html_()
    assert coapt.NOTICE in page and "<th>before</th><th>after</th><th>change</th>" in page and "<script" not in page
    assert "before" in done.text() and coapt.NOTICE in done.text()
    done.write(tmp_path / "out")
    assert (tmp_path / "out" / "after" / "ring.vtp").exists()
    with pytest.raises(OSError):
        done.write("/proc/nowhere")


def test_every_measure_of_the_report_is_an_attribute(healthy):
    # Building them refuses unknown keys and misses none; a repair that sews has them all.
    closed = healthy.with_repair(coapt.Clip(site="A2P2")).close()
    told = closed.to_dict()["before"]
    assert closed.sutures[0].name == told["sutures"][0]["name"]
    assert closed.leaflets[0].strain_p95 == told["leaflets"][0]["strain_p95"]
    assert closed.papillary[0].force_n == tuple(told["papillary"][0]["force_n"])
    # How it was found, and what its chords are called, are no measures.
    assert set(told) - {"solve", "chord_groups"} == {field for field in coapt.Measures.__dataclass_fields__}


def test_names_are_no_markup():
    closed = coapt.generate("healthy", faces=FACES, name="<script>alert(1)</script>").close()
    assert "<script" not in closed._repr_html_()


def test_plans_rank_their_alternatives(tmp_path):
    valve = coapt.generate("dilated", faces=FACES)
    done = coapt.plan(valve, [coapt.Ring.physio_like(size) for size in (28, 34)], keep_shapes=True)
    assert [row["rank"] for row in done.alternatives] == [1, 2] and done.certified
    by_keys = coapt.plan(valve, {"repair": [{"kind": "ring", "family": "physio-like", "size_mm": [28, 34]}]})
    of = {row["number"]: row["orifice"] for row in done.alternatives}
    assert of == {row["number"]: row["orifice"] for row in by_keys.alternatives}
    best = done.alternatives[0]
    fresh = valve.with_repair(coapt.Ring.physio_like(best["repairs"][0]["size_mm"])).close()
    assert done.positions_mm[0].tobytes() == fresh.positions_mm.tobytes()
    done.write(tmp_path)
    assert (tmp_path / "plan.csv").exists() and len(list((tmp_path / "shapes").glob("*.vtp"))) == 8
    with pytest.raises(coapt.InputError, match="did you mean `ring`"):
        coapt.plan(valve, {"repair": [{"kind": "rign"}]})
    with pytest.raises(coapt.InputError, match="out of range"):
        coapt.plan(valve, [coapt.Ring.physio_like(280)])


def test_plans_search_and_sample():
    valve = coapt.generate("dilated", faces=FACES)
    asked = {
        "repair": [{"kind": "ring", "family": "physio-like", "size_mm": 30}],
        "uncertainty": {"samples": 3, "seed": 7, "alternatives": 1},
        "sensitivities": True,
        "search": {"repair": 0, "key": "size_mm", "from": 36, "to": 28, "tolerance": 1, "measure": "coaptation/area_mm2",
                   "at_least": 1.0},
    }
    told = coapt.plan(valve, asked).to_dict()
    assert told["search"]["answer"] is not None
    assert told["alternatives"][0]["uncertainty"]["samples"] == 3
    assert told["alternatives"][0]["sensitivities"]


def test_surfaces_are_compared(healthy, closed, tmp_path):
    same = coapt.compare(closed, closed)
    assert same.distance_mm.max() == 0.0
    higher = healthy.close(pressure_mmhg=120)
    as_closed = coapt.compare(higher, closed)
    assert as_closed.distance_mm.max() > 0.0
    higher.write(tmp_path / "higher")
    closed.write(tmp_path / "closed")
    as_files = coapt.compare(tmp_path / "higher", tmp_path / "closed" / "closed.vtp")
    assert as_files.distance_mm.tobytes() == as_closed.distance_mm.tobytes()
    count = healthy.leaflet_vertex_count
    arrays = [(np.ascontiguousarray(it.positions_mm[:count]), it.triangles) for it in (higher, closed)]
    of_arrays = coapt.compare(*arrays, atrial_direction=(0, 0, 1))
    assert of_arrays.distance_mm.tobytes() == as_closed.distance_mm.tobytes()
    with pytest.raises(coapt.InputError, match="No such file"):
        coapt.compare("nowhere.vtp", closed)
    with pytest.raises(coapt.InputError, match=r"result\[0\] is float32"):
        coapt.compare((arrays[0][0].astype(np.float32), healthy.triangles), closed)


def test_studies_set_error_against_time(tmp_path):
    done = coapt.study("healthy", faces=(160, 240), tolerances=(1e-2, 1e-5), thicknesses_mm=(), repeats=1)
    assert len(done.rows) == 4 and all(row["certified"] for row in done.rows)
    of = {(row["faces"], row["residual_tolerance"]): row["error"]["rms_mm"] for row in done.rows}
    # A finer mesh is nearer to the reference, whatever the residual below a hundredth.
    coarse, fine = sorted({faces for faces, _ in of})
    assert of[fine, 1e-5] < of[coarse, 1e-5]
    assert "<svg" in done._repr_svg_()
    done.write(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["SHA256SUMS", "study.csv", "study.json", "study.svg"]
    valve = coapt.generate("healthy", faces=160)
    assert coapt.study(valve, tolerances=(1e-2,), thicknesses_mm=(0.8,), repeats=1).rows[1]["contact_thickness_mm"] == 0.8
    # Two iterations lead to no reference.
    assert coapt.study(valve.with_settings(coapt.Settings(iteration_limit=2)), repeats=1) is None


def test_examples_in_the_documentation_hold():
    import doctest
    import importlib
    import pkgutil

    names = ["coapt", *(f"coapt.{it.name}" for it in pkgutil.iter_modules(coapt.__path__) if it.name != "_coapt")]
    results = [doctest.testmod(importlib.import_module(name)) for name in names]
    assert sum(result.failed for result in results) == 0
    assert sum(result.attempted for result in results) > 5


def test_what_is_no_repair_is_told():
    valve = coapt.generate("dilated", faces=FACES)
    for work in (lambda: valve.with_repair("ring"), lambda: coapt.plan(valve, [1]), lambda: valve.interactive().set("ring")):
        with pytest.raises(coapt.InputError, match=r"repair\[0\] is .*; expected a repair"):
            work()
