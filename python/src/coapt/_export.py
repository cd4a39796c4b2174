"""Valves for other engines, and their answers."""

from __future__ import annotations

import os
from typing import Literal

import coapt._coapt as _core
from coapt._errors import Fault, fault_of
from coapt._given import A_VALVE, of_type
from coapt._valve import Valve

Engine = Literal["calculix", "febio"]


def export(
    valve: Valve,
    out: str | os.PathLike[str],
    *,
    format: Engine | None = None,
    results: str | os.PathLike[str] | None = None,
) -> tuple[Fault, ...]:
    """Writes a valve as input of another engine, or that engine's result as a surface: ``coapt export``.

    Parameters
    ----------
    valve : Valve
        The open valve. One that is sewn together, by a clip say, is refused.
    out : path
        The file to write; an old one is replaced, and stays where the new one cannot be written.
    format : {"calculix", "febio"}, optional
        Write the valve as input of this engine: of CalculiX 2.20 (.inp), without contact; of FEBio, format 4.0 (.feb), with FEBio's
        own contact. Units are mm, N, MPa; node v + 1 is vertex v.
    results : path, optional
        Write instead the closed leaflets (.vtp) as this result of an engine places them: .dat or .frd of CalculiX, FEBio's log of
        nodes, or a table with commas.

    Returns
    -------
    tuple of Fault
        What of the result was repaired or doubted; empty for a ``format``.

    Raises
    ------
    ValueError
        Neither or both of ``format`` and ``results``; another format.
    TypeError
        What is no valve.
    InputError
        A law, a load or sutures that the engine has no equal of; a result that is none of this valve.
    OSError
        What the file system says.
    """
    native = of_type(Valve, "valve", valve, A_VALVE)._native
    if format is not None and results is None:
        _core.export_model(native, out, format)
        return ()
    if results is not None and format is None:
        return tuple(fault_of(told) for told in _core.export_results(native, out, results))
    given = "neither" if format is None else "both"
    raise ValueError(f"{given} of format and results is given; expected one of them")
