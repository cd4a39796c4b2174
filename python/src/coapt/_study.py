"""Speed against error."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal, cast, final, overload

import coapt._coapt as _core
from coapt._plain import Json
from coapt._progress import Progress
from coapt._result import Result
from coapt._valve import Preset, Valve, generate

if TYPE_CHECKING:
    import pandas

#: Mesh sizes as of ``coapt study``.
FACES: tuple[int, ...] = tuple(_core.STUDY_FACES)

#: Mesh sizes as of ``coapt study --laws``.
FACES_OF_LAWS: tuple[int, ...] = (650,)


@final
class StudyResult(Result[_core.Study]):
    """One valve closed at many settings, with error and time of each. Made by :func:`coapt.study`."""

    __slots__ = ()
    _MADE_BY = "closing valves: coapt.study()"

    @classmethod
    def _of_bytes(cls, stored: bytes) -> StudyResult:
        return cls._of(_core.Study.from_stored(stored))

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


@final
class LawStudyResult(Result[_core.StudyOfLaws]):
    """One valve closed under every tissue law, with what each costs and how far it is off. Made by :func:`coapt.study`."""

    __slots__ = ()
    _MADE_BY = "closing valves: coapt.study(..., laws=True)"

    @classmethod
    def _of_bytes(cls, stored: bytes) -> LawStudyResult:
        return cls._of(_core.StudyOfLaws.from_stored(stored))

    def __repr__(self) -> str:
        return f"<coapt.LawStudyResult of {len(self.rows)} closures>"

    @property
    def rows(self) -> tuple[dict[str, Json], ...]:
        """Each closure as ``laws.json`` tells it."""
        return tuple(cast("list[dict[str, Json]]", self.to_dict()["rows"]))

    def to_dataframe(self) -> pandas.DataFrame:
        """A row per closure, as ``laws.csv``; needs pandas."""
        from coapt._tables import of_csv

        return of_csv(self._native.csv())


@overload
def study(
    valve: Preset | str | Valve | Sequence[Valve] = "healthy",
    *,
    laws: Literal[False] = False,
    faces: Sequence[int] | None = None,
    reference_faces: int | None = None,
    reference: Valve | None = None,
    tolerances: Sequence[float] | None = None,
    thicknesses_mm: Sequence[float] | None = None,
    repeats: int | None = None,
    progress: Progress | None = None,
) -> StudyResult | None: ...
@overload
def study(
    valve: Preset | str | Valve | Sequence[Valve] = "healthy",
    *,
    laws: Literal[True],
    faces: Sequence[int] | None = None,
    reference_faces: int | None = None,
    reference: Valve | None = None,
    repeats: int | None = None,
    progress: Progress | None = None,
) -> LawStudyResult: ...
def study(
    valve: Preset | str | Valve | Sequence[Valve] = "healthy",
    *,
    laws: bool = False,
    faces: Sequence[int] | None = None,
    reference_faces: int | None = None,
    reference: Valve | None = None,
    tolerances: Sequence[float] | None = None,
    thicknesses_mm: Sequence[float] | None = None,
    repeats: int | None = None,
    progress: Progress | None = None,
) -> StudyResult | LawStudyResult | None:
    """Closes a valve at many mesh sizes and settings, and sets error against time, as ``coapt study``; or under every tissue law, as
    ``coapt study --laws``.

    Parameters
    ----------
    valve : preset, Valve, or sequence of Valve
        A preset at the sizes of ``faces``; or a valve, or the same valve in several meshes, coarsest first.
    laws : bool
        Study tissue laws instead: one tissue told in each law, at the valve's own residual and contact thickness.
    faces : sequence of int, optional
        Mesh sizes of a preset, in triangles. Default: 160, 320, 650, 1300, 2600; of laws 650.
    reference_faces : int, optional
        Mesh size of the reference of a preset. Default: four times the finest mesh.
    reference : Valve, optional
        The reference of valves. Default: the last of them; of laws none, so that errors of the mesh are not told.
    tolerances : sequence of float, optional
        Residuals to stop at, each tried on every mesh [1]. Default: 1e-1 to 1e-6.
    thicknesses_mm : sequence of float, optional
        Contact thicknesses, each tried on the mesh nearest to 650 triangles [mm]. Default: 0.3, 0.5, 0.8.
    repeats : int, optional
        Closures of each setting, of which the median time counts. Default: 3.
    progress : callable, optional
        Called in this thread, some times in a second, with how many closures are done and of how many, those of the reference left
        out.

    Returns
    -------
    StudyResult or None
        None where the reference does not close to a certified state.
    LawStudyResult
        Of ``laws``.

    Raises
    ------
    ValueError
        Tolerances or thicknesses beside ``laws``.
    InputError
        As of :func:`coapt.generate`.
    KeyboardInterrupt
        Within 0.2 s of Ctrl-C.
    Exception
        What ``progress`` raises; the work ends then.
    """
    if laws and (tolerances is not None or thicknesses_mm is not None):
        raise ValueError("tolerances and thicknesses_mm are not tried beside laws; expected one or the other")
    finest = reference
    if isinstance(valve, str):
        sizes = sorted(set(faces or (FACES_OF_LAWS if laws else FACES)))
        valves = [generate(valve, faces=size) for size in sizes]
        finest = generate(valve, faces=reference_faces or _core.STUDY_REFERENCE_FINER * sizes[-1])
    else:
        valves = [valve] if isinstance(valve, Valve) else list(valve)
    natives = [it._native for it in valves]
    if laws:
        last = None if finest is None else finest._native
        return LawStudyResult._of(_core.study_laws(natives, last, repeats, progress))
    last = (finest or valves[-1])._native
    made = _core.study(natives, last, tolerances, thicknesses_mm, repeats, progress)
    return None if made is None else StudyResult._of(made)
