"""Many surgical alternatives for one valve."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, TypeAlias, Union, cast, final

import coapt._coapt as _core
from coapt._arrays import FloatArray
from coapt._given import A_VALVE, counted, from_least, of_type, wrong_type
from coapt._plain import Json, Value, keys_of_repairs
from coapt._progress import Progress
from coapt._repairs import Repair
from coapt._result import Result
from coapt._valve import SCHEMA_VERSION, Valve

if TYPE_CHECKING:
    import pandas

#: Repairs of one alternative.
Repairs: TypeAlias = Union[Repair, Sequence[Repair]]


@final
class PlanResult(Result[_core.Plan]):
    """Alternatives closed and ranked. Made by :func:`coapt.plan`.

    What is not certified is never ranked. Research use, not a medical device.
    """

    __slots__ = ()
    _MADE_BY = "comparing alternatives: coapt.plan()"

    @classmethod
    def _of_bytes(cls, stored: bytes) -> PlanResult:
        return cls._of(_core.Plan.from_stored(stored))

    def __repr__(self) -> str:
        return f"<coapt.PlanResult of {counted(len(self.alternatives), 'alternative')}>"

    def _repr_html_(self) -> str:
        from html import escape

        return f"<pre>{escape(self.text())}</pre>"

    @property
    def certified(self) -> bool:
        """Whether all that was computed may be used."""
        return self._native.certified

    @property
    def alternatives(self) -> tuple[dict[str, Json], ...]:
        """Each alternative as ``plan.json`` tells it: ranked ones first, the best first; then what only takes chordae away;
        then what closed without a certificate; then what could not be carried out."""
        return tuple(cast("list[dict[str, Json]]", self.to_dict()["alternatives"]))

    @property
    def positions_mm(self) -> tuple[FloatArray | None, ...]:
        """Closed positions of each alternative [mm], shape (n, 3), read-only; None unless ``keep_shapes``, or refused."""
        return tuple(self._native.positions_mm())

    def report(self, path: str | os.PathLike[str], *, most: int = _core.PAGE_ALTERNATIVES) -> None:
        """Writes one HTML page of the comparison, to be opened in any browser without a network: what ``coapt report`` makes of the
        folder that :meth:`write` writes.

        Parameters
        ----------
        path : path
            The page, ``page.html`` say; an old one is replaced, and stays where the new one cannot be written.
        most : int
            Show the shapes of so many alternatives, the first-ranked first; the table has all.

        Raises
        ------
        InputError
            A comparison without ``keep_shapes``, or whose annulus has no plane.
        ValueError
            A number below zero.
        OSError
            What the file system says.
        """
        self._native.report(path, from_least("most", most, 0))

    def to_dataframe(self) -> pandas.DataFrame:
        """A row per alternative, a column per measure, as ``plan.csv``; needs pandas."""
        from coapt._tables import of_csv

        return of_csv(self._native.csv())


def plan(
    valve: Valve,
    alternatives: str | os.PathLike[str] | Mapping[str, Value] | Sequence[Repairs],
    *,
    keep_shapes: bool = False,
    max_alternatives: int = 10_000,
    progress: Progress | None = None,
) -> PlanResult:
    """Closes a valve as it is and after each alternative, each from the open valve unless the plan says ``warm``, and ranks the alternatives.

    Parameters
    ----------
    valve : Valve
        The valve before any of these repairs.
    alternatives : path, mapping, or sequence
        A plan file; a mapping with the keys of one (lists and ranges of values, ``uncertainty``, ``search``,
        ``sensitivities``, ``ranking`` as there); or a sequence with a repair, or a sequence of repairs, for each alternative.
    keep_shapes : bool
        Whether closed shapes are kept: of thousands of large valves they fill the memory.
    max_alternatives : int
        Refuse plans of more alternatives, before any is made; from 1.
    progress : callable, optional
        Called in this thread, some times in a second, with how many closures are done and of how many: first of the alternatives and
        the valve as it is, then, from 0 anew, of the samples of an ensemble. A search is not counted.

    Raises
    ------
    InputError
        A plan that cannot be read, or without a repair; alternatives that are wrong in themselves; none that can be carried out.
    TypeError
        What is no valve; alternatives that are no path, mapping or sequence, such as a single repair.
    ValueError
        ``max_alternatives`` below 1.
    KeyboardInterrupt
        Within 0.2 s of Ctrl-C.
    Exception
        What ``progress`` raises; the work ends then.

    Examples
    --------
    >>> import coapt
    >>> valve = coapt.generate("dilated", faces=160)
    >>> sizes = [coapt.Ring.physio_like(size) for size in (28, 32)]
    >>> len(coapt.plan(valve, sizes).alternatives)
    2
    """
    native = of_type(Valve, "valve", valve, A_VALVE)._native
    limit = from_least("max_alternatives", max_alternatives, 1)
    if isinstance(alternatives, (str, os.PathLike)):
        made = _core.plan_of_file(native, alternatives, keep_shapes, limit, progress)
    else:
        made = _core.plan_of_dict(native, _keys(alternatives), keep_shapes, limit, progress)
    return PlanResult._of(made)


def _keys(alternatives: Mapping[str, Value] | Sequence[Repairs]) -> dict[str, Value]:
    if isinstance(alternatives, Mapping):
        return {"schema_version": SCHEMA_VERSION, **alternatives}
    if not isinstance(alternatives, Iterable):
        expected = "a plan file, a mapping with its keys, or a sequence of alternatives, such as [coapt.Ring.physio_like(30)]"
        raise wrong_type("alternatives", alternatives, expected)
    each = [[it] if not isinstance(it, Sequence) else list(it) for it in alternatives]
    blocks = [{"repair": keys_of_repairs(repairs)} for repairs in each]
    return {"schema_version": SCHEMA_VERSION, "alternative": cast("list[Value]", blocks)}
