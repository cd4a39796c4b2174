"""Reading the tables that a scene is made from: CSV files and Abaqus keyword cards.

Whatever is wrong is an `InputFault` whose text is one line naming file, line and column.
"""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path


class InputFault(Exception):
    """Something wrong in what was given; the text is one line for the reader."""


@dataclass(frozen=True)
class Row:
    """One line of a table."""

    path: Path
    line: int
    cells: dict[str, str]

    def text(self, column: str) -> str:
        """The cell as it stands, without surrounding blanks."""
        return self.cells[column].strip()

    def number(self, column: str) -> float:
        """The cell as a finite number; an empty cell is a fault."""
        text = self.text(column)
        try:
            value = float(text)
        except ValueError:
            raise self.fault(column, f"{text!r} is not a number") from None
        if not math.isfinite(value):
            raise self.fault(column, f"{text!r} is not finite")
        return value

    def positive(self, column: str) -> float:
        """The cell as a finite number above zero."""
        value = self.number(column)
        if value <= 0.0:
            raise self.fault(column, f"{value!r} must be above 0")
        return value

    def vector(self, columns: list[str]) -> tuple[float, ...]:
        """Several cells as finite numbers."""
        return tuple(self.number(column) for column in columns)

    def vector_or_zero(self, columns: list[str]) -> tuple[float, ...]:
        """Several cells as finite numbers; all of them empty is zero."""
        if not any(self.text(column) for column in columns):
            return (0.0,) * len(columns)
        return self.vector(columns)

    def fault(self, column: str, message: str) -> InputFault:
        """A fault in this cell."""
        return InputFault(f"{self.path}:{self.line}: column '{column}': {message}")


def read_lines(path: Path) -> list[str]:
    """All lines of a UTF-8 text file, with or without a byte order mark."""
    try:
        return path.read_text(encoding="utf-8-sig").splitlines()
    except OSError as error:
        raise InputFault(f"{path}: {error.strerror or error}") from None
    except UnicodeDecodeError as error:
        raise InputFault(f"{path}: not UTF-8 at byte {error.start}; save the table as UTF-8") from None


def read_table(path: Path, columns: list[str]) -> list[Row]:
    """A comma-separated table with a header line that names at least `columns`."""
    lines = read_lines(path)
    if not lines:
        raise InputFault(f"{path}:1: empty file; expected a header line")
    header = [name.strip() for name in next(csv.reader(lines[:1]))]
    for column in columns:
        if header.count(column) != 1:
            found = "missing" if column not in header else "named twice"
            raise InputFault(f"{path}:1: column '{column}' is {found}; the header has {', '.join(header)}")
    rows = []
    for line, text in enumerate(lines[1:], start=2):
        if not text.strip():
            continue
        try:
            cells = next(csv.reader([text]))
        except csv.Error as error:
            raise InputFault(f"{path}:{line}: {error}") from None
        if len(cells) != len(header):
            hint = " (decimal commas? write 1.5)" if len(cells) > len(header) else ""
            raise InputFault(f"{path}:{line}: {len(cells)} cells, the header has {len(header)}{hint}")
        rows.append(Row(path, line, dict(zip(header, cells))))
    if not rows:
        raise InputFault(f"{path}: no lines below the header")
    return rows


@dataclass(frozen=True)
class Card:
    """One Abaqus keyword with its parameters and the numbers or words on its data lines."""

    line: int
    keyword: str
    parameters: dict[str, str]
    data: list[str]


def read_cards(path: Path) -> list[Card]:
    """The keyword cards of an Abaqus input file or of an excerpt of one."""
    cards: list[Card] = []
    for line, text in enumerate(read_lines(path), start=1):
        text = text.strip()
        if text.startswith("**") or not text:
            continue
        if text.startswith("*"):
            parts = [part.strip() for part in text[1:].split(",")]
            pairs = (part.partition("=") for part in parts[1:] if part)
            parameters = {key.strip().lower(): value.strip() for key, _, value in pairs}
            cards.append(Card(line, parts[0].lower(), parameters, []))
        elif cards:
            cards[-1].data.extend(part.strip() for part in text.split(",") if part.strip())
    return cards


def card_numbers(path: Path, card: Card, count: int) -> list[float]:
    """The first `count` data entries of a card as finite numbers."""
    place = f"{path}:{card.line}: *{card.keyword}"
    if len(card.data) < count:
        raise InputFault(f"{place}: {len(card.data)} numbers, expected {count}")
    try:
        numbers = [float(text) for text in card.data[:count]]
    except ValueError as error:
        raise InputFault(f"{place}: {error}") from None
    if not all(math.isfinite(number) for number in numbers):
        raise InputFault(f"{place}: not finite")
    return numbers


def material_card(path: Path, cards: list[Card], material: str, keyword: str) -> Card:
    """The `keyword` card that belongs to the named material."""
    inside = False
    for card in cards:
        if card.keyword == "material":
            inside = card.parameters.get("name", "").lower() == material.lower()
        elif inside and card.keyword == keyword:
            return card
    raise InputFault(f"{path}: no *{keyword} card for material {material}")
