"""Speed against error."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, cast, final

import coapt._coapt as _core
from coapt._plain import Json
from coapt._result import Result
from coapt._valve import Preset, Valve, generate

if TYPE_CHECKING:
    import pandas

#: Mesh sizes as of ``coapt study``.
FACES: tuple[int, ...] = tuple(_core.STUDY_FACES)


@final
class StudyResult(Result[_core.Study]):
    """One valve closed at many settings, with error and time of each. Made by :func:`coapt.study`."""

    __slots__ = ()
    _MADE_BY = "closing valves: coapt.study()"

    def __repr__(self) -> str:
        return f"<coapt.StudyResult of {len(self.rows)} closures>"

    def _repr_svg_(self) -> str:
        return self._native.svg()

    @property
    def rows(self) -> tuple[dict[str, Json], ...]:
        """Each closure as ``study.json`` tells it."""
        return tuple(cast("list[dict[str, Json]]", self.to_dict()["rows"]))

    def to_dataframe(self) -> pandas.DataFrame:
        """A row per closure, as ``study.csv``; needs pandas."""
        from coapt._tables import of_csv

        return of_csv(self._native.csv())


def study(
    valve: Preset | str | Valve | Sequence[Valve] = "healthy",
    *,
    faces: Sequence[int] = FACES,
    reference_faces: int | None = None,
    reference: Valve | None = None,
    tolerances: Sequence[float] | None = None,
    thicknesses_mm: Sequence[float] | None = None,
    repeats: int | None = None,
) -> StudyResult | None:
    """Closes a valve at many mesh sizes and settings, and sets error against time, as ``coapt study``.

    Parameters
    ----------
    valve : preset, Valve, or sequence of Valve
        A preset at the sizes of ``faces``; or a valve, or the same valve in several meshes, coarsest first.
    faces : sequence of int
        Mesh sizes of a preset, in triangles.
    reference_faces : int, optional
        Mesh size of the reference of a preset. Default: four times the finest mesh.
    reference : Valve, optional
        The reference of valves. Default: the last of them.
    tolerances : sequence of float, optional
        Residuals to stop at, each tried on every mesh [1]. Default: 1e-1 to 1e-6.
    thicknesses_mm : sequence of float, optional
        Contact thicknesses, each tried on the mesh nearest to 650 triangles [mm]. Default: 0.3, 0.5, 0.8.
    repeats : int, optional
        Closures of each setting, of which the median time counts. Default: 3.

    Returns
    -------
    StudyResult or None
        None where the reference does not close to a certified state.

    Raises
    ------
    InputError
        As of :func:`coapt.generate`.
    KeyboardInterrupt
        Within 0.2 s of Ctrl-C.
    """
    if isinstance(valve, str):
        sizes = sorted(set(faces))
        valves = [generate(valve, faces=size) for size in sizes]
        finest = generate(valve, faces=reference_faces or _core.STUDY_REFERENCE_FINER * sizes[-1])
    else:
        valves = [valve] if isinstance(valve, Valve) else list(valve)
        finest = reference or valves[-1]
    made = _core.study([it._native for it in valves], finest._native, tolerances, thicknesses_mm, repeats)
    return None if made is None else StudyResult._of(made)
