"""Tables for pandas, which is imported when one is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from coapt._optional import needed

if TYPE_CHECKING:
    import pandas

Row = tuple[str, str, str, int, "float | None", "float | None"]


def of_rows(rows: Sequence[Row], columns: Sequence[str]) -> pandas.DataFrame:
    """The rows of a report's table; what a state does not have is missing."""
    with needed("pandas", "to_dataframe()"):
        import pandas

    table = [(title, name, unit, *values[: len(columns)]) for title, name, unit, _, *values in rows]
    made: pandas.DataFrame = pandas.DataFrame(table, columns=["group", "measure", "unit", *columns])
    for column in columns:
        made[column] = made[column].astype("float64")
    return made


def of_csv(text: str) -> pandas.DataFrame:
    """A table that the library wrote as comma-separated values."""
    import io

    with needed("pandas", "to_dataframe()"):
        import pandas

    return pandas.read_csv(io.StringIO(text))
