"""A valve closed as it is, and closed again after repairs."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import coapt._coapt as _core
from coapt._closed import Closed, Colour, checked_frames
from coapt._given import A_VALVE, of_type
from coapt._plain import Json
from coapt._repairs import Repair
from coapt._valve import Valve

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, eq=False, repr=False)
class Closure:
    """A valve closed as it is, and closed again after a plan: what ``coapt closure`` reports.

    Attributes
    ----------
    before : Closed
        Without the repairs.
    after : Closed or None
        With them; None where there are none.
    """

    before: Closed
    after: Closed | None

    @property
    def certified(self) -> bool:
        """Whether all that was computed may be used."""
        return self.before.certified and (self.after is None or self.after.certified)

    def __repr__(self) -> str:
        return f"<coapt.Closure before: {self.before!r}, after: {self.after!r}>"

    def text(self) -> str:
        """The report as ``coapt closure`` prints it: certificates, table, warnings, notice."""
        return self.before._native.text(self._after())

    def _repr_html_(self) -> str:
        from coapt._html import page

        states = [("before", self.before)] + ([] if self.after is None else [("after", self.after)])
        return page(self.before.valve.name, states, self.before._native.rows(self._after()))

    def to_dict(self) -> dict[str, Json]:
        """The report as ``report.json`` holds it; units are in the names."""
        return cast("dict[str, Json]", json.loads(self.before._native.report_json(self._after())))

    def to_dataframe(self) -> pandas.DataFrame:
        """The table of the report: title, measure, unit, before, after; needs pandas."""
        from coapt._tables import of_rows

        return of_rows(self.before._native.rows(self._after()), ["before", "after"])

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Writes what ``coapt closure --plan PLAN --out`` writes.

        Raises
        ------
        OSError
            What the file system says.
        """
        self.before._native.write(folder, self._after())

    def record(self, path: str | os.PathLike[str], *, frames: int = _core.FILM_FRAMES) -> None:
        """Writes how the valve closes before and after the repairs as one MCAP file: see :meth:`Closed.record`.

        Parameters
        ----------
        path : path
            The file; its layout for viewers comes beside it.
        frames : int, optional
            How many to each film, from 2 to 10,000. Default: 60.

        Raises
        ------
        ValueError
            Another number of frames.
        OSError
            What the file system says.
        KeyboardInterrupt
            Within 0.2 s of Ctrl-C; nothing is written then.
        """
        self.before._native.record(path, checked_frames(frames), self._after())

    def picture(self, path: str | os.PathLike[str], *, colour: Colour = "gap") -> None:
        """Writes a PNG file with the valve before and after the repairs: see :meth:`Closed.picture`.

        Raises
        ------
        ValueError, InputError, OSError
            As of :meth:`Closed.picture`.
        """
        self.before._native.picture(path, colour, self._after())

    def report(self, path: str | os.PathLike[str], *, recording: str | os.PathLike[str] | None = None) -> None:
        """Writes one HTML page of the valve before and after the repairs: see :meth:`Closed.report`.

        Parameters
        ----------
        path : path
            The page; an old one is replaced, and stays where the new one cannot be written.
        recording : path, optional
            The film of this closure, which :meth:`record` wrote.

        Raises
        ------
        InputError
            As of :meth:`Closed.report`.
        OSError
            What the file system says.
        """
        self.before._native.report(path, recording, self._after())

    def _after(self) -> _core.Closed | None:
        return None if self.after is None else self.after._native


def closure(valve: Valve, *repairs: Repair) -> Closure:
    """Closes a valve as it is and, where there are repairs, after them, side by side: ``coapt closure``.

    Raises
    ------
    InputError
        Why a repair cannot be carried out; before anything is closed.
    TypeError
        What is no valve.
    KeyboardInterrupt
        Within 0.2 s of Ctrl-C.
    """
    of_type(Valve, "valve", valve, A_VALVE)
    valves = [valve] if not repairs else [valve, valve.with_repair(*repairs)]
    closed = [Closed._of(made) for made in _core.close_many([one._native for one in valves], None)]
    return Closure(closed[0], closed[1] if repairs else None)
