"""Editing a closed valve as by a slider."""

from __future__ import annotations

from typing import final

import coapt._coapt as _core
from coapt._closed import Closed
from coapt._given import A_CLOSED, of_type
from coapt._plain import natives_of_repairs
from coapt._repairs import RelocatePapillary, Ring


@final
class Live:
    """A closed valve that follows edits of its supports; each closure begins where the last one ended.

    Made by :meth:`coapt.Valve.interactive`. Far faster than closing anew, but where several stable shapes are possible, the
    one that is found depends on the edits before; each is certified on its own.

    Edits replace each other: ``live.set_ring(a)`` and then ``live.set_ring(b)`` is the valve with ``b``.

    Parameters
    ----------
    closed : Closed
        Where to begin.

    Raises
    ------
    TypeError
        What is no closed valve.
    """

    __slots__ = ("_native",)

    def __init__(self, closed: Closed) -> None:
        self._native = _core.Live(of_type(Closed, "closed", closed, A_CLOSED)._native)

    def __repr__(self) -> str:
        return f"<coapt.Live {self.closed!r}>"

    def __reduce__(self) -> tuple[object, tuple[object, ...]]:
        raise TypeError("a Live is a running solver and cannot be pickled; pickle its `closed`")

    @property
    def closed(self) -> Closed:
        """The valve as it now is."""
        return Closed._of(self._native.closed)

    def set(self, *repairs: Ring | RelocatePapillary) -> Closed:
        """Closes the valve with these edits instead of the last ones. Without any, the valve is closed as it was given, beginning
        where the last edit ended: where several shapes are stable it may come to another than before.

        Returns
        -------
        Closed
            Also where the solver did not converge: ask ``certified`` and ``status``.

        Raises
        ------
        InputError
            Why a repair cannot be carried out; a repair that changes more than where annulus and papillary tips end.
        KeyboardInterrupt
            Within 0.2 s of Ctrl-C; the valve goes on from where it came to.
        """
        return Closed._of(self._native.set(natives_of_repairs(repairs)))

    def set_ring(self, ring: Ring) -> Closed:
        """Closes the valve with this ring instead of the last edits: ``set(ring)``."""
        return self.set(ring)
