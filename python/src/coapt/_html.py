"""The table of a report for notebooks: no scripts, nothing from elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING

from coapt._tables import Row

if TYPE_CHECKING:
    from coapt._closed import Closed


def page(name: str, states: Sequence[tuple[str, Closed]], rows: Sequence[Row]) -> str:
    """A heading, how far each state is to be trusted, a row per measure, and what it is not for."""
    from coapt._certificate import NOTICE

    trust = "".join(f"<p>{_trust(word, closed)}</p>" for word, closed in states)
    heads = [word for word, _ in states] + (["change"] if len(states) == 2 else [])
    head = "".join(f"<th>{escape(word)}</th>" for word in heads)
    body = "".join(_row(row, len(states)) for row in rows)
    return (
        f"<div><h4>{escape(name)}</h4>{trust}"
        f"<table><thead><tr><th>measure</th><th>unit</th>{head}</tr></thead><tbody>{body}</tbody></table>"
        f"<p><em>{NOTICE}</em></p></div>"
    )


def _trust(word: str, closed: Closed) -> str:
    told = f"{escape(word)}: " if word else ""
    certificate = closed.certificate
    if not certificate.certified:
        reason = closed.status if closed.status != "converged" else "not stable, or surfaces cross"
        return f"<strong>{told}NOT CERTIFIED</strong> ({escape(reason)}): figures of such a shape are no prediction"
    return f"{told}certified; mesh error up to {certificate.discretisation_mm:.2f} mm (estimate)"


def _row(row: Row, states: int) -> str:
    title, name, unit, digits, before, after = row
    cells = [before, after][:states]
    if states == 2:
        cells.append(None if before is None or after is None else after - before)
    told = "".join(f'<td style="text-align:right">{_number(cell, digits)}</td>' for cell in cells)
    return f"<tr><td>{escape(title)}: {escape(name)}</td><td>{escape(unit)}</td>{told}</tr>"


def _number(value: float | None, digits: int) -> str:
    return "–" if value is None else f"{value + 0.0:.{digits}f}"
