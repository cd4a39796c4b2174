"""What comparisons, plans, studies and fits have in common: a frozen result, made by a function of the package, with a report."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, ClassVar, Generic, Protocol, TypeVar, cast

from coapt._plain import Json

if TYPE_CHECKING:
    # Of every type checker; Python itself has it from 3.11 on.
    from typing_extensions import Self


class _Storing(Protocol):
    def stored(self) -> bytes: ...


class _Reporting(_Storing, Protocol):
    def report_json(self) -> str: ...
    def text(self) -> str: ...
    def write(self, folder: str | os.PathLike[str]) -> None: ...


Made = TypeVar("Made", bound=_Storing)
Native = TypeVar("Native", bound=_Reporting)


class Frozen(Generic[Made]):
    """What the native half made; it never changes."""

    __slots__ = ("_native",)
    _native: Made

    #: What makes one, for who tries to.
    _MADE_BY: ClassVar[str]

    def __init__(self) -> None:
        raise TypeError(f"a {type(self).__name__} is made by {self._MADE_BY}")

    @classmethod
    def _of(cls, made: Made) -> Self:
        result = cls.__new__(cls)
        object.__setattr__(result, "_native", made)
        return result

    @classmethod
    def _of_bytes(cls, stored: bytes) -> Self:
        """A pickled result."""
        raise NotImplementedError

    def __reduce__(self) -> tuple[object, tuple[bytes]]:
        return self._of_bytes, (self._native.stored(),)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a result does not change; cannot set {name!r}")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"a result does not change; cannot delete {name!r}")


class Result(Frozen[Native]):
    """A result with a report; see the classes made of it."""

    __slots__ = ()

    def text(self) -> str:
        """The table as the program prints it."""
        return self._native.text()

    def to_dict(self) -> dict[str, Json]:
        """The report as the program's JSON file holds it; units are in the names."""
        return cast("dict[str, Json]", json.loads(self._native.report_json()))

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Writes what the program writes with ``--out``.

        Raises
        ------
        OSError
            What the file system says.
        """
        self._native.write(folder)
