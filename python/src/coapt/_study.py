"""Speed against error."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Literal, cast, final, overload

import coapt._coapt as _core
from coapt._errors import Fault, InputError
from coapt._given import A_VALVE, counted, of_type, wrong_type
from coapt._plain import Json
from coapt._progress import Progress
from coapt._result import Result
from coapt._valve import Preset, Valve, generate, natives_of

if TYPE_CHECKING:
    import pandas


@final
class StudyResult(Result[_core.Study]):
    """One valve closed at many settings, with error and time of each. Made by :func:`coapt.study`."""

    __slots__ = ()
    _MADE_BY = "closing valves: coapt.study()"

    @classmethod
    def _of_bytes(cls, stored: bytes) -> StudyResult:
        return cls._of(_core.Study.from_stored(stored))

    def __repr__(self) -> str:
        return f"<coapt.StudyResult of {counted(len(self.rows), 'closure')}>"

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
        return f"<coapt.LawStudyResult of {counted(len(self.rows), 'closure')}>"

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
        Mesh sizes of a preset, in triangles, from 100. Default: 160, 320, 650, 1300, 2600; of laws 650.
    reference_faces : int, optional
        Mesh size of the reference of a preset, no coarser than the finest mesh. Default: four times the finest mesh.
    reference : Valve, optional
        The reference of valves. Default: the last of them; of laws none, so that errors of the mesh are not told.
    tolerances : sequence of float, optional
        Residuals to stop at, each tried on every mesh, above 0 and below 1 [1]. Default: 1e-1 to 1e-6.
    thicknesses_mm : sequence of float, optional
        Contact thicknesses, each tried on the mesh nearest to 650 triangles, above 0 and at most 5; there may be none [mm].
        Default: 0.3, 0.5, 0.8.
    repeats : int, optional
        Closures of each setting, of which the median time counts, from 1 to 1000. Default: 3.
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
        As of :func:`coapt.generate`; numbers that cannot be tried; no valve; mesh sizes of valves, which have their own; a
        valve as the reference of a preset.
    TypeError
        What is no valve.
    KeyboardInterrupt
        Within 0.2 s of Ctrl-C.
    Exception
        What ``progress`` raises; the work ends then.
    """
    if laws and (tolerances is not None or thicknesses_mm is not None):
        raise ValueError("tolerances and thicknesses_mm are not tried beside laws; expected one or the other")
    natives, finest = _meshes(valve, laws, faces, reference_faces, reference)
    if laws:
        return LawStudyResult._of(_core.study_laws(natives, finest, repeats, progress))
    made = _core.study(natives, finest or natives[-1], tolerances, thicknesses_mm, repeats, progress)
    return None if made is None else StudyResult._of(made)


def _meshes(
    valve: Preset | str | Valve | Sequence[Valve],
    laws: bool,
    faces: Sequence[int] | None,
    reference_faces: int | None,
    reference: Valve | None,
) -> tuple[list[_core.Valve], _core.Valve | None]:
    """The valve in each mesh, at least one, and the reference asked for."""
    asked = None if faces is None else _listed(faces)
    if isinstance(valve, str):
        if reference is not None:
            message = f"is {reference!r}, which is for valves; expected none beside a preset, but reference_faces"
            raise InputError([Fault("reference", message)])
        sizes, finest = _core.study_sizes(asked, reference_faces, laws)
        return [generate(valve, faces=size)._native for size in sizes], generate(valve, faces=finest)._native
    _core.study_no_sizes(asked, reference_faces)
    natives = [valve._native] if isinstance(valve, Valve) else natives_of("valve", valve)
    if not natives:
        raise InputError([Fault("valve", "is an empty sequence; expected a preset, a valve, or at least one valve")])
    return natives, None if reference is None else of_type(Valve, "reference", reference, A_VALVE)._native


def _listed(faces: Sequence[int]) -> list[int]:
    if isinstance(faces, str) or not isinstance(faces, Iterable):
        raise wrong_type("faces", faces, "a sequence of mesh sizes, such as [650]")
    return list(faces)
