"""Arguments of the wrong type, told by name with what was got and what was expected."""

from __future__ import annotations

from collections.abc import Iterable
from reprlib import Repr
from typing import SupportsFloat, TypeVar

Kind = TypeVar("Kind")

#: A valve, as told where there is none.
A_VALVE = 'a coapt.Valve, such as coapt.generate("healthy")'
#: A closed valve, as told where there is none.
A_CLOSED = "a coapt.Closed, such as valve.close()"
#: A pressure, as told where there is none.
A_PRESSURE = "a number [mmHg], such as 100.0"

# Of arrays and long lists, enough to know them again.
_short = Repr()
_short.maxother = _short.maxstring = 80


def wrong_type(name: str, given: object, expected: str) -> TypeError:
    """What is raised for an argument called so: ``valve is 'dilated'; expected a coapt.Valve, ...``."""
    # Arrays tell themselves on several lines.
    got = " ".join(_short.repr(given).split())
    return TypeError(f"{name} is {got}; expected {expected}")


def of_type(kind: type[Kind], name: str, given: object, expected: str) -> Kind:
    """The argument, known to be of its type.

    Raises
    ------
    TypeError
        Anything else, with the name, what was got and what was expected.
    """
    if not isinstance(given, kind):
        raise wrong_type(name, given, expected)
    return given


def each_of_type(kind: type[Kind], name: str, given: Iterable[object], expected: str) -> list[Kind]:
    """The items of an argument, each known to be of its type.

    Raises
    ------
    TypeError
        Anything else, with its place: ``leaflets[1] is 3; expected a coapt.Leaflet``.
    """
    if not isinstance(given, Iterable):
        raise wrong_type(name, given, f"a sequence, each {expected}")
    return [of_type(kind, f"{name}[{number}]", item, expected) for number, item in enumerate(given)]


def number(name: str, given: object, expected: str) -> float:
    """A number, NumPy's among them.

    Raises
    ------
    TypeError
        Anything else, text and truth among them.
    """
    if isinstance(given, (str, bool)) or not isinstance(given, SupportsFloat):
        raise wrong_type(name, given, expected)
    return float(given)


def from_least(name: str, given: int, least: int) -> int:
    """A whole number, NumPy's among them, that is no smaller than the least one.

    Raises
    ------
    TypeError
        What is no whole number.
    ValueError
        A smaller one.
    """
    expected = f"a whole number from {least}"
    if not hasattr(given, "__index__"):
        raise wrong_type(name, given, expected)
    number = given.__index__()
    if number < least:
        raise ValueError(f"{name} is {number}; expected {expected}")
    return number


def counted(count: int, word: str) -> str:
    """So many of something: ``1 closure``, ``2 closures``."""
    return f"{count} {word}" if count == 1 else f"{count} {word}s"
