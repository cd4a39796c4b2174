"""What repairs, tissues and settings have in common: plain frozen data that scenes and plans are made of."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields, replace
from typing import TYPE_CHECKING, ClassVar, TypeAlias, Union, cast

import numpy as np
from numpy.typing import NDArray

import coapt._coapt as _core
from coapt._errors import Fault, InputError

if TYPE_CHECKING:
    # Of every type checker; Python itself has it from 3.11 on.
    from typing_extensions import Self

#: What a scene or a plan may hold.
Value: TypeAlias = Union[bool, int, float, str, Sequence["Value"], Mapping[str, "Value"]]

#: What a report holds.
Json: TypeAlias = Union[None, bool, int, float, str, list["Json"], dict[str, "Json"]]

#: A point or a vector in space [mm].
Vector: TypeAlias = Sequence[float]

#: A curve in space [mm], shape ``(n, 3)``.
Curve: TypeAlias = Union[Sequence[Vector], NDArray[np.float64]]


class PlainData:
    """Frozen data with the keys of a scene or a plan. What is left out is as usual; see each key."""

    __slots__ = ()

    #: Key and value that tell kinds apart, where there are several.
    _TAG: ClassVar[tuple[str, str] | None] = None
    #: Keys that hold a list: words, a point, or points of shape ``(n, 3)``.
    _LISTS: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        for key in _keys(type(self)):
            value = getattr(self, key)
            if isinstance(value, (np.generic, np.ndarray)) and value.ndim == 0:
                # A number of Python, which nobody can change.
                object.__setattr__(self, key, value.item())
            elif value is not None and key in self._LISTS:
                # Tuples are frozen too, and can be compared.
                object.__setattr__(self, key, _frozen(value))
        self._check()

    def _check(self) -> None:
        """Refuses what the type in the library refuses; by default left to whoever takes it."""

    def to_dict(self) -> dict[str, Value]:
        """The keys and values of a scene or a plan; what was left out is left out."""
        made: dict[str, Value] = {}
        if self._TAG is not None:
            key, name = self._TAG
            made[key] = name
        for key in _keys(type(self)):
            value = getattr(self, key)
            if value is not None:
                made[key] = value.to_dict() if isinstance(value, PlainData) else value
        return made

    def replace(self, **changes: Value | PlainData | None) -> Self:
        """The same with some keys changed."""
        kept = {key: getattr(self, key) for key in _keys(type(self))}
        return type(self)(**{**kept, **changes})


class RepairData(PlainData):
    """A repair, read by the library when it is made: what is wrong with it is told then, and no edit has to read it again."""

    __slots__ = ("_read",)
    _read: _core.Repair

    #: Shapes of the points and curves among the lists; None is any length.
    _SHAPES: ClassVar[Mapping[str, tuple[int | None, ...]]] = {}

    def _check(self) -> None:
        try:
            object.__setattr__(self, "_read", _core.Repair(self.to_dict()))
        except InputError as error:
            told = [self._with_shape(fault) for fault in error.faults]
            raise InputError(told) from None

    def _with_shape(self, fault: Fault) -> Fault:
        """What the library tells of a list, whose type says little, with its shape where that is the fault."""
        key = fault.place.rpartition(".")[2]
        expected = self._SHAPES.get(key)
        found = None if expected is None else _shape(getattr(self, key))
        if expected is None or found is None or _fits(found, expected):
            return fault
        return replace(fault, message=f"has shape {_told(found)}; expected {_told(expected)}")

    @property
    def _native(self) -> _core.Repair:
        if not hasattr(self, "_read"):
            # Copies and pickles hold the keys alone.
            self._check()
        return self._read


#: Looked up once for each kind: they are asked for with every move of a slider.
_KEYS: dict[type[PlainData], tuple[str, ...]] = {}


def _keys(kind: type[PlainData]) -> tuple[str, ...]:
    keys = _KEYS.get(kind)
    if keys is None:
        keys = tuple(field.name for field in fields(kind))  # type: ignore[arg-type]  # every subclass is a dataclass
        _KEYS[kind] = keys
    return keys


def _frozen(value: object) -> object:
    """Lists, and lists in them, as tuples; anything else as it is, so that the library tells what is wrong with it."""
    if isinstance(value, np.ndarray):
        return _frozen(value.tolist())
    if isinstance(value, Iterable) and not isinstance(value, str):
        return tuple(_frozen(item) for item in value)
    return value


def _shape(value: object) -> tuple[int, ...] | None:
    """The shape of a tuple of items, or of tuples as long as each other; None of what has none."""
    if not isinstance(value, tuple):
        return None
    try:
        return np.shape(cast("Sequence[float]", value))
    except ValueError:
        return None


def _fits(found: tuple[int, ...], expected: tuple[int | None, ...]) -> bool:
    return len(found) == len(expected) and all(of in (None, count) for count, of in zip(found, expected))


def _told(shape: tuple[int | None, ...]) -> str:
    """A shape as NumPy writes it, with n for any length."""
    return str(tuple("n" if count is None else count for count in shape)).replace("'", "")


def keys_of_repairs(given: Sequence[object]) -> list[dict[str, Value]]:
    """Repairs as plans hold them.

    Raises
    ------
    InputError
        What is no repair.
    """
    return [repair.to_dict() for repair in _repairs(given)]


def natives_of_repairs(given: Sequence[object]) -> list[_core.Repair]:
    """Repairs as the library has read them.

    Raises
    ------
    InputError
        What is no repair.
    """
    return [repair._native for repair in _repairs(given)]


def _repairs(given: Sequence[object]) -> Sequence[RepairData]:
    wrong = [
        Fault(f"repair[{number}]", f"is {repair!r}; expected a repair, such as coapt.Ring.physio_like(30)")
        for number, repair in enumerate(given)
        if not isinstance(repair, RepairData)
    ]
    if wrong:
        raise InputError(wrong)
    return cast("Sequence[RepairData]", given)
