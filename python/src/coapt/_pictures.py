"""Pictures with Matplotlib, which is imported when one is asked for."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

import numpy as np

from coapt._arrays import FloatArray
from coapt._optional import needed

if TYPE_CHECKING:
    import matplotlib.figure

    from coapt._closed import Closed

#: Title, the two coordinates that are seen, the one that is looked along and from which side. Patient LPS of an upright heart.
VIEWS = (("from the atrium", (0, 1), (2, 1.0)), ("from the front", (0, 2), (1, -1.0)))


def picture(closed: Closed, color_by: str) -> matplotlib.figure.Figure:
    """The closed leaflets, nearest triangles last, in two views."""
    with needed("matplotlib", "plot()"):
        from matplotlib.collections import PolyCollection
        from matplotlib.figure import Figure

    from coapt._certificate import NOTICE

    class Picture(Figure):
        """Notebooks show it by itself, also where nobody imported pyplot."""

        def _repr_png_(self) -> bytes:
            drawn = io.BytesIO()
            self.savefig(drawn, format="png", dpi=72)
            return drawn.getvalue()

    corners = closed.positions_mm[closed.triangles]
    colours = _of_triangles(closed, color_by)
    figure = Picture(figsize=(9.0, 4.2), layout="constrained")
    axes = figure.subplots(1, 2)
    for ax, (title, seen, (along, side)) in zip(axes, VIEWS):
        order = np.argsort(side * corners[:, :, along].mean(axis=1))
        drawn = PolyCollection(list(corners[order][:, :, list(seen)]), array=colours[order], edgecolors="face")
        ax.add_collection(drawn)
        ax.autoscale_view()
        ax.set(title=title, aspect="equal", xlabel=f"{'LPS'[seen[0]]} [mm]", ylabel=f"{'LPS'[seen[1]]} [mm]")
        if title == VIEWS[0][0]:
            # With the aorta on top, the patient's left is on the left: the anterolateral commissure at 9 o'clock.
            ax.invert_yaxis()
            ax.invert_xaxis()
    figure.colorbar(drawn, ax=axes, label=color_by)
    trust = "certified" if closed.certified else f"NOT CERTIFIED ({closed.status})"
    figure.suptitle(f"{closed.valve.name}: {trust} – {NOTICE}", fontsize="small")
    return figure


def _of_triangles(closed: Closed, color_by: str) -> FloatArray:
    if color_by == "leaflet":
        return closed.valve.triangle_leaflet.astype(np.float64)
    arrays = dict(zip(("gap_mm", "contact", "strain"), closed._native.at_points()))
    if color_by not in arrays:
        raise ValueError(f"color_by is {color_by!r}; expected one of gap_mm, contact, strain, leaflet")
    values = np.asarray(arrays[color_by], dtype=np.float64)
    return np.asarray(values[closed.triangles].mean(axis=1))
