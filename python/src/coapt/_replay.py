"""Recordings made again."""

from __future__ import annotations

import os
from dataclasses import dataclass, field

import coapt._coapt as _core


@dataclass(frozen=True)
class FrameDifference:
    """The first frame of a recording that does not come out the same.

    Attributes
    ----------
    topic : str
        The film's topic.
    frame : int
        Number of the frame, from 0.
    what : str
        What differs in it.
    vertex : int or None
        The first leaflet vertex that differs; None where vertices agree or are not as many.
    gap_mm : float or None
        How far it lies from where it was recorded [mm].
    """

    topic: str
    frame: int
    what: str
    vertex: int | None
    gap_mm: float | None


@dataclass(frozen=True)
class ReplayResult:
    """How a recording compares with itself made again. Made by :func:`coapt.replay`.

    Attributes
    ----------
    frames : int
        Frames that were compared: all that the recording has.
    different : int
        Of these, frames that are not the same to the last bit.
    first : FrameDifference or None
        The first of these.
    farthest_mm : float
        How far a vertex lies from where it was recorded, at most [mm].
    doubts : tuple of str
        What makes a difference likely: another version, a recording that is cut off.
    """

    frames: int
    different: int
    first: FrameDifference | None
    farthest_mm: float
    doubts: tuple[str, ...]
    _text: str = field(repr=False)

    @property
    def agrees(self) -> bool:
        """Whether every frame is the same to the last bit."""
        return self.first is None

    def text(self) -> str:
        """What ``coapt replay`` prints."""
        return self._text


def replay(path: str | os.PathLike[str]) -> ReplayResult:
    """Makes a recording again, from the scene and the repairs in it, and compares every frame, bit for bit: ``coapt replay``.

    Parameters
    ----------
    path : path
        An MCAP file, as :meth:`Closed.record` writes it.

    Raises
    ------
    InputError
        A file that cannot be read, or that is no recording of coapt.
    KeyboardInterrupt
        Within 0.2 s of Ctrl-C.
    """
    frames, different, first, farthest_mm, doubts, text = _core.replay(path)
    told = None
    if first is not None:
        topic, frame, what, vertex = first
        told = FrameDifference(topic, frame, what, *(vertex or (None, None)))
    return ReplayResult(frames, different, told, farthest_mm, tuple(doubts), text)
