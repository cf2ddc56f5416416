"""A line of a run as the arrays that figures and numbers take: its shape, its pull, its ends."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fieldline.analysis.line_shape import LineShape, Skiprope, skiprope_of
from fieldline.report.run_record import DEG, RunRecord
from fieldline.simulate.line_shape import POSITION, ends_of_line, lines_in_run, shape_in_run

MOST_LINES = 4  # of a run that have figures of their own
LEAST_LEVER_M = 1e-6


@dataclass(frozen=True)
class LineRecord:
    """One line of a run."""

    run: RunRecord
    name: str

    @cached_property
    def ends(self) -> tuple[int, int]:
        """Indices of from_body and to_body."""
        return ends_of_line(self.run.scenario, self.name)

    @cached_property
    def line(self):
        """The scenario's record of it."""
        lines = self.run.scenario.line
        return next(line for k, line in enumerate(lines, start=1) if self.name in (line.name, f"line_{k}"))

    @cached_property
    def shape(self) -> LineShape:
        """Its shape in orbital axes."""
        return shape_in_run(self.run.dataset, self.name, self.run.scenario)

    @cached_property
    def skiprope(self) -> Skiprope | None:
        """How its bow goes round, where it does."""
        return skiprope_of(self.shape, self.run.seconds)

    @cached_property
    def tension(self) -> np.ndarray:
        """(n, s) [N], NaN for segments that are not out."""
        return self.run.values(f"tension_{self.name}")

    @cached_property
    def slack(self) -> np.ndarray:
        """(n,) whether a segment is without pull; at the start, where a line may be laid out unstretched, it is not asked."""
        slack = np.nanmin(self.tension, axis=1) <= 0.0
        slack[0] &= slack[1]
        return slack

    @cached_property
    def length(self) -> np.ndarray:
        """(n,) [m] unstretched length that is out."""
        return self.run.values(f"deployed_length_{self.name}")

    @property
    def reels(self) -> bool:
        """Whether its length changes."""
        return bool(np.ptp(self.length) > 1e-6 * self.length.max())

    @cached_property
    def height(self) -> np.ndarray:
        """(n, p) [m] height of the points over the ellipsoid, NaN for those that are not out."""
        from fieldline.frames.earth_rotation import geodetic_from_itrs

        points = self.run.values(POSITION + self.name)
        ends = self.run.values("position_i")[:, [self.ends[0]]]
        known = np.isfinite(points)
        stand_in = np.where(known, points, ends)
        # heights over axes that do not follow the pole are 50 m off, their differences along a line are not
        above = geodetic_from_itrs(stand_in)[2] - geodetic_from_itrs(ends)[2]
        return np.where(known[..., 0], above + self.run.of("altitude_m", self.ends[0])[:, None], np.nan)

    @cached_property
    def spacing_m(self) -> float:
        """Unstretched length of a full segment [m]."""
        return float(self.line.whole_length_m / self.tension.shape[1])

    def has(self, kind: str) -> bool:
        """Whether the run holds temperature, current, emf or power of it."""
        return self.run.has(f"{kind}_{self.name}")

    def values(self, kind: str) -> np.ndarray:
        """temperature, current, emf or power of it."""
        return self.run.values(f"{kind}_{self.name}")

    def lever_angle_deg(self, end: int) -> np.ndarray | None:
        """(n,) [deg] between the lever of the attachment (from the centre of mass) and the line there; None without one.

        Zero where the line leaves the body straight away from its centre of mass.
        """
        b = self.ends[end]
        if self.run.scenario.body[b].kind != "rigid":
            return None
        points = self.run.values(POSITION + self.name)
        attachment = points[:, -1 if end else 0]
        lever = attachment - self.run.of("position_i", b)
        size = np.linalg.norm(lever, axis=1)
        if size.max() < LEAST_LEVER_M:
            return None
        away = self.neighbour(points, end) - attachment
        cosine = np.sum(lever * away, axis=1) / np.maximum(size * np.linalg.norm(away, axis=1), 1e-12)
        return DEG * np.arccos(np.clip(cosine, -1.0, 1.0))

    def pull_i(self, end: int) -> np.ndarray:
        """(n, 3) [N] with which it pulls at the body of an end."""
        points, rows = self.run.values(POSITION + self.name), np.arange(len(self.tension))
        away = self.neighbour(points, end) - points[:, -1 if end else 0]
        out = np.isfinite(self.tension).sum(axis=1) - 1
        size = self.tension[rows, out if end else 0 * out]
        return away * (size / np.maximum(np.linalg.norm(away, axis=1), 1e-12))[:, None]

    @staticmethod
    def neighbour(points: np.ndarray, end: int) -> np.ndarray:
        """(n, 3) the point next to an end: of those that are out, the second or the last but one."""
        if not end:
            return np.where(np.isfinite(points[:, 1, :1]), points[:, 1], points[:, -1])
        inner = np.isfinite(points[:, :-1, 0]).sum(axis=1) - 1  # from_body's attachment and the nodes that are out
        return points[np.arange(len(points)), inner]


def lines_of(record: RunRecord) -> list[LineRecord]:
    """The lines that have figures, the first few."""
    return [LineRecord(record, name) for name in lines_in_run(record.dataset)[:MOST_LINES]]
