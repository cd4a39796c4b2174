"""Packages that coapt uses where they are, and does without where they are not."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def needed(package: str, what: str, module: str | None = None) -> Iterator[None]:
    """Says which package is not there, where an import within fails for lack of it. Its module, unless named, is called as it is."""
    try:
        yield
    except ModuleNotFoundError as error:
        wanted = module or package
        if error.name is None or error.name.partition(".")[0] != wanted:
            raise
        raise ModuleNotFoundError(f"{what} needs {package}: pip install {package}", name=wanted) from error
