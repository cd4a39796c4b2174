"""Arrays that come and go."""

from __future__ import annotations

from typing import TypeAlias, Union

import numpy as np
from numpy.typing import NDArray

#: Points [mm] or numbers: float64, C-contiguous. What coapt returns is read-only.
FloatArray: TypeAlias = NDArray[np.float64]

#: Numbers of points, from 0, as coapt returns them: read-only.
IndexArray: TypeAlias = NDArray[np.uint32]

#: Numbers of points, from 0, as coapt takes them: C-contiguous.
GivenIndices: TypeAlias = Union[
    NDArray[np.int32], NDArray[np.int64], NDArray[np.uint32], NDArray[np.uint64]
]


def read_only(array: FloatArray | IndexArray) -> None:
    """Forbids to write to an array of a result; pickles forget that."""
    array.flags.writeable = False
