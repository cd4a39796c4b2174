"""Who waits for long work is told how far it has come, in his own thread, and may stop it."""

from __future__ import annotations

import threading

import pytest

coapt = pytest.importorskip("coapt")

from test_process import INTERRUPTED, run  # noqa: E402

FACES = 160


@pytest.fixture(scope="module")
def valve():
    return coapt.generate("healthy", faces=FACES)


class Told:
    """Notes what it is told, and in which thread."""

    def __init__(self) -> None:
        self.counts: list[tuple[int, int]] = []
        self.threads: set[int] = set()

    def __call__(self, done: int, of: int) -> None:
        self.counts.append((done, of))
        self.threads.add(threading.get_ident())

    def stages(self) -> list[list[tuple[int, int]]]:
        """Its counts, parted where they begin at 0."""
        parts: list[list[tuple[int, int]]] = []
        for count in self.counts:
            if count[0] == 0 and (not parts or parts[-1][-1][0] > 0):
                parts.append([])
            parts[-1].append(count)
        return parts


def is_orderly(counts: list[tuple[int, int]]) -> bool:
    """From nothing to all, and never back."""
    done, of = zip(*counts)
    return done[0] == 0 and done[-1] == of[-1] and list(done) == sorted(done) and list(of) == sorted(of)


def test_many_valves_are_counted(valve):
    told = Told()
    with_it = coapt.close_many([valve] * 5, progress=told)
    assert is_orderly(told.counts) and told.counts[-1] == (5, 5)
    assert told.threads == {threading.get_ident()}
    without = coapt.close_many([valve] * 5)
    assert [it.positions_mm.tobytes() for it in with_it] == [it.positions_mm.tobytes() for it in without]


def test_many_slow_valves_are_told_of_one_by_one():
    """Closures of tenths of a second: each is seen, whichever comes first."""
    told = Told()
    valve = coapt.generate("barlow", faces=1300)
    coapt.close_many([valve.with_pressure(100 + n) for n in range(6)], progress=told)
    assert len({done for done, _ in told.counts}) >= 4, told.counts


def test_nothing_is_all_of_nothing():
    told = Told()
    assert coapt.close_many([], progress=told) == []
    assert told.counts == [(0, 0)]


def test_plans_are_counted_stage_by_stage(valve):
    told = Told()
    asked = {
        "repair": [{"kind": "ring", "family": "physio-like", "size_mm": [28, 30, 32]}],
        "uncertainty": {"samples": 4, "seed": 7, "alternatives": 1},
        "search": {"repair": 0, "key": "size_mm", "from": 36, "to": 34, "tolerance": 1, "measure": "coaptation/area_mm2",
                   "at_least": 1.0},
    }
    plan = coapt.plan(valve, asked, progress=told)
    stages = told.stages()
    assert all(is_orderly(stage) for stage in stages) and told.threads == {threading.get_ident()}
    # The valve as it is beside three rings and the answer of the search; four samples of it and of the first-ranked ring.
    assert [stage[-1] for stage in stages] == [(5, 5), (8, 8)]
    assert plan.to_dict() == coapt.plan(valve, asked).to_dict()


def test_alternatives_that_are_refused_count(valve):
    told = Told()
    cleft = coapt.CloseCleft(position=0.35, depth_mm=1.0)
    coapt.plan(valve, [coapt.Ring.physio_like(30), cleft], progress=told)
    assert told.counts[-1] == (3, 3)


@pytest.mark.parametrize(("laws", "count"), [(False, 2 * 2 * 2 + 1 * 2), (True, 2 * 2 * 8)])
def test_studies_are_counted_but_for_their_reference(laws, count):
    told = Told()
    options = {} if laws else {"tolerances": (1e-2, 1e-3), "thicknesses_mm": (0.8,)}
    coapt.study("healthy", laws=laws, faces=(160, 240), reference_faces=300, repeats=2, progress=told, **options)
    assert is_orderly(told.counts) and told.counts[-1] == (count, count)


def test_fits_are_counted_as_far_as_they_know(valve):
    told = Told()
    fit = coapt.personalise(valve, valve.close(pressure_mmhg=110), progress=told)
    assert is_orderly(told.counts)
    # Those of the search, and both states closed once more.
    assert told.counts[-1][1] == fit.to_dict()["closures"] + 2


WORK = {
    "close_many": "coapt.close_many([coapt.generate('barlow', faces=1300)] * 30, progress=told)",
    "plan": "coapt.plan(coapt.generate('barlow', faces=1300), [coapt.Ring.physio_like(24 + 0.5 * i) for i in range(30)], progress=told)",
    "study": "coapt.study('barlow', faces=(1300,), repeats=30, progress=told)",
    "personalise": (
        "(lambda valve: coapt.personalise(valve, valve.close(pressure_mmhg=110), progress=told))"
        "(coapt.generate('barlow', faces=1300))"
    ),
}


@pytest.mark.parametrize("work", WORK)
def test_what_is_raised_stops_the_work(work):
    """The call ends with the exception itself, long before the work would; what it leaves goes on to be used."""
    said = run(f"""
        import time
        import coapt
        class Enough(Exception):
            pass
        at = []
        def told(done, of):
            if done >= 1 or of > 25:
                at.append(time.perf_counter())
                raise Enough(done, of)
        try:
            {WORK[work]}
        except Enough as enough:
            print(time.perf_counter() - at[0], len(at), enough.args[0] < enough.args[1])
        assert coapt.generate("healthy", faces=160).close().certified
    """)
    seconds, times, early = said.split()
    assert float(seconds) < 0.5 and times == "1" and early == "True"


@pytest.mark.parametrize("work", WORK)
def test_ctrl_c_is_honoured_beside_it(work):
    made = "told = lambda done, of: None"
    # 0.2 s is what was promised; the rest is for a machine that others use too.
    assert float(run(INTERRUPTED.format(made=made, work=WORK[work]))) < 0.2 + 0.3


def test_a_call_that_cannot_be_made_is_raised(valve):
    with pytest.raises(TypeError):
        coapt.close_many([valve], progress=lambda: None)
    with pytest.raises(TypeError, match="not callable"):
        coapt.close_many([valve], progress=3)
