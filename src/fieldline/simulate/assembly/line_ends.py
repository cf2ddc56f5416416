"""Where a line's ends are in their bodies at the start."""

from __future__ import annotations

import numpy as np

from fieldline.simulate.assembly.lines import sliders


def attachment_point(scenario, k: int, end: str) -> np.ndarray:
    """(3,) [m] of line k's attachment, "from" or "to", with its slider where it starts; body axes."""
    point = np.array(getattr(scenario.line[k], f"{end}_point_b_m"), dtype=float)
    for owner, one in sliders(scenario):
        if owner == k and one.end == end:
            point += one.start_m * np.array(one.axis_b)
    return point
