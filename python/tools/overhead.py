"""How much time the Python package adds to the library: cold closures and edits of a ring, at 650 triangles.

    python python/tools/overhead.py

Prints medians [ms] of what a caller waits, of what of that the library itself took (to lay the ring and close the valve), and of the
rest, with the least of it: what a machine does that nobody else uses. Then how much longer two threads wait for two valves than one
for one.
"""

from __future__ import annotations

import statistics
import time
from concurrent.futures import ThreadPoolExecutor

import coapt

CLOSURES = 15
SIZES_MM = (31.0, 30.75, 30.5, 30.25, 30.0, 30.25, 30.5, 30.75)


def main() -> None:
    valve = coapt.generate("healthy", faces=650)
    tell("cold closure", [timed(valve.close) for _ in range(CLOSURES)])
    live = valve.interactive()
    live.set_ring(coapt.Ring.physio_like(SIZES_MM[-1]))
    rings = [coapt.Ring.physio_like(size) for size in SIZES_MM] * 3
    tell("edit of a ring", [timed(lambda ring=ring: live.set_ring(ring)) for ring in rings])
    closed = live.closed
    tell("repair alone", [(timed_alone(lambda ring=ring: valve.with_repair(ring)), 0.0) for ring in rings])
    again = [fresh(closed) for _ in range(CLOSURES)]
    tell("positions, first asked for", [(timed_alone(lambda it=it: it.positions_mm), 0.0) for it in again])
    two_threads(valve)
    tell("measures, first asked for", [(timed_alone(lambda it=it: it.measures), 0.0) for it in again])


def two_threads(valve) -> None:
    """Rounds of one closure and of two at once, in turn, so that both meet the same machine."""
    ratios = []
    with ThreadPoolExecutor(2) as threads:
        for _ in range(CLOSURES):
            alone = timed_alone(valve.close)
            ratios.append(timed_alone(lambda: list(threads.map(lambda _: valve.close(), range(2)))) / alone)
    print(f"two threads, two valves: {statistics.median(ratios):.2f} times one alone, at least {min(ratios):.2f}")


def timed(work) -> tuple[float, float]:
    """What a caller waits for a closure, and what the library took [ms]."""
    begun = time.perf_counter()
    closed = work()
    return (time.perf_counter() - begun) * 1e3, closed.wall_ms


def timed_alone(work) -> float:
    begun = time.perf_counter()
    work()
    return (time.perf_counter() - begun) * 1e3


def fresh(closed):
    """The same result with nothing of it made yet."""
    rebuild, parts = closed.__reduce__()
    return rebuild(*parts)


def tell(what: str, times: list[tuple[float, float]]) -> None:
    waited, closing = (statistics.median(part) for part in zip(*times))
    added = sorted(whole - part for whole, part in times)
    told = f"added {statistics.median(added):6.3f} ms, at least {added[0]:6.3f} ms"
    print(f"{what:28} waited {waited:8.2f} ms, of it closing {closing:8.2f} ms, {told}")


if __name__ == "__main__":
    main()
