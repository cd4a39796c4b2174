"""The one exception of coapt, and what it tells."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, cast

Severity = Literal["error", "warning"]


@dataclass(frozen=True)
class Fault:
    """Something wrong, or repaired, or doubted, in what was given.

    Attributes
    ----------
    place : str
        Where: a file with its line (``scene.toml:12``), or the key (``leaflets[0].points_mm``).
    message : str
        What was found, its value, and what was expected.
    severity : {"error", "warning"}
        An error stops; a warning comes with the result.
    """

    place: str
    message: str
    severity: Severity = "error"

    @property
    def found(self) -> str:
        """What was found: the part of the message before what was expected."""
        return self._parts()[0]

    @property
    def expected(self) -> str | None:
        """What was expected; None where the message does not say."""
        return self._parts()[1]

    def _parts(self) -> tuple[str, str | None]:
        found, word, expected = self.message.partition("expected ")
        return (found.rstrip(" ;,:"), expected) if word else (self.message, None)

    def __str__(self) -> str:
        goes_on = self.message.startswith(("is ", "are ", "has ", "lacks ", "`"))
        return f"{self.place} {self.message}" if goes_on else f"{self.place}: {self.message}"


class InputError(ValueError):
    """Wrong input: a scene, a plan, an array or a keyword.

    Attributes
    ----------
    faults : tuple of Fault
        Everything that was found, errors first, then warnings.
    """

    faults: tuple[Fault, ...]

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__(self.faults)

    def __str__(self) -> str:
        return "\n".join(
            f"{fault}" if fault.severity == "error" else f"warning: {fault}" for fault in self.faults
        )


def input_error(told: Iterable[tuple[str, str, str]]) -> InputError:
    """The exception of faults as the native half tells them: severity, place, message."""
    return InputError(fault_of(one) for one in told)


def fault_of(told: tuple[str, str, str]) -> Fault:
    """A fault as the native half tells it."""
    severity, place, message = told
    return Fault(place, message, cast(Severity, severity))
