"""Who is told how far long work has come."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

#: Called with how many closures are done, and of how many, some times in a second: in the thread that called, while others work.
#: What it raises stops the work and is raised there.
Progress: TypeAlias = Callable[[int, int], None]
