"""An orbit from mean element sets (TLE or OMM), propagated by SGP4.

    (r_t, v_t) = SGP4(elements, t - epoch),   r_i = dcm_it r_t                          (1)

Which set serves a sample: if the samples span no more than three days, one set serves them all, the one whose epoch
is nearest to their middle, so that no jump falls inside an arc; over longer spans each sample has the set of nearest
epoch, and `describe` tells where it changes and by how many metres.

TEME turns by 50 arcseconds a year against GCRS; the velocity of that turn, under 0.1 mm/s, is left out.
Error of the elements: about 1 km at epoch in low orbit, growing by 1 to 3 km a day along the track.
Source: Vallado, Crawford, Hujsak and Kelso (2006), AIAA 2006-6753, with their WGS72 constants; the `sgp4` package.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fieldline.errors import InputError
from fieldline.frames.earth_rotation import dcm_it
from fieldline.frames.time import as_utc, iso_utc, utc_julian
from fieldline.orbit.element_set import ElementSet
from fieldline.orbit.orbit import MAX_AGE_DAYS, Orbit

ONE_SET_DAYS = 3.0  # an arc up to this long is served by one set
WARN_AGE_DAYS = 3.0
NS_PER_DAY = 86_400_000_000_000

SGP4_WORDS = {
    1: "the mean eccentricity leaves 0 to 1",
    2: "the mean motion falls below zero",
    3: "the perturbed eccentricity leaves 0 to 1",
    4: "the semi-latus rectum falls below zero",
    5: "the elements lie below the ground",
    6: "the satellite has decayed: its orbit meets the ground",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class ElementOrbit(Orbit):
    """Orbit of one satellite from one or more mean element sets, ordered by epoch."""

    sets: tuple[ElementSet, ...]
    _epochs: np.ndarray = field(init=False, repr=False)

    def __post_init__(self):
        object.__setattr__(self, "_epochs", np.array([s.epoch_utc for s in self.sets], dtype="datetime64[ns]"))

    def check(self, time_utc, max_age_days: float = MAX_AGE_DAYS) -> list[str]:
        """Warnings where elements are over 3 days from a sample; InputError where over `max_age_days`."""
        flat = as_utc(time_utc).reshape(-1)
        age = self._age_days(flat)
        if age.size and np.abs(age).max() > max_age_days:
            raise InputError(self._refusal(flat, age, max_age_days))
        return self._warnings(flat)

    def _plan(self, flat: np.ndarray) -> np.ndarray:
        """(n,) which set serves each time."""
        if flat.size == 0:
            return np.zeros(0, dtype=np.int64)
        first, last = flat.min(), flat.max()
        if (last - first) <= np.timedelta64(int(ONE_SET_DAYS * NS_PER_DAY), "ns"):
            middle = first + (last - first) // 2
            return np.full(flat.size, np.argmin(np.abs(self._epochs - middle)), dtype=np.int64)
        changes = self._epochs[:-1] + (self._epochs[1:] - self._epochs[:-1]) // 2
        return np.searchsorted(changes, flat, side="right")

    def _states(self, flat: np.ndarray, plan: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """SGP4 and equation (1)."""
        r_t, v_t = np.empty((2, flat.size, 3))
        for index in np.unique(plan):
            mine = plan == index
            r_t[mine], v_t[mine] = propagate(self.sets[index], flat[mine])
        turn = dcm_it(flat)
        return np.einsum("nij,nj->ni", turn, r_t), np.einsum("nij,nj->ni", turn, v_t)

    def _age_days(self, flat: np.ndarray) -> np.ndarray:
        """(n,) [days] from the epoch of the set that serves each sample to the sample."""
        return (flat - self._epochs[self._plan(flat)]).astype(np.int64) / NS_PER_DAY

    def _account(self, flat: np.ndarray) -> dict:
        """Epochs used, age, and the jumps where the set changes."""
        plan, age = self._plan(flat), self._age_days(flat)
        return {
            "element_sets": len(self.sets),
            "element_epochs_used": [iso_utc(self.sets[k].epoch_utc) for k in np.unique(plan)],
            "age_days": [float(age.min()), float(age.max())] if age.size else [],
            "changes": self._changes(np.unique(plan)),
            "theory": "SGP4, WGS72; about 1 km at epoch in low orbit, growing by 1 to 3 km a day along the track",
        }

    def _changes(self, used: np.ndarray) -> list[dict]:
        """When the serving set changes over a long arc, and the jump [m] there."""
        changes = []
        for before in used[:-1]:
            epoch, after = self._epochs[before], self._epochs[before + 1]
            when = epoch + (after - epoch) // 2
            jump = propagate(self.sets[before + 1], when[None])[0] - propagate(self.sets[before], when[None])[0]
            changes.append({"time_utc": iso_utc(when), "jump_m": float(np.linalg.norm(jump))})
        return changes

    def _warnings(self, flat: np.ndarray) -> list[str]:
        """One sentence when samples lie over three days from their elements."""
        age = np.abs(self._age_days(flat))
        if not age.size or age.max() <= WARN_AGE_DAYS:
            return []
        return [
            f"the elements of {self.name} are up to {age.max():.1f} days from the samples; SGP4 loses 1 to 3 km a day "
            "in low orbit, more when the Sun is active. Elements within 3 days are better."
        ]

    def _refusal(self, flat: np.ndarray, age: np.ndarray, max_age_days: float) -> str:
        """Why the elements are too far from the samples, with a guess."""
        worst = int(np.abs(age).argmax())
        epoch = self._epochs[self._plan(flat)[worst]]
        side = "after" if age[worst] > 0 else "before"
        years = abs(int(str(flat[worst])[:4]) - int(str(epoch)[:4]))
        guess = (
            f" The samples are from {str(flat[worst])[:4]}, the elements from {str(epoch)[:4]}: elements of another year, "
            "or a wrong clock?"
            if years
            else ""
        )
        return (
            f"{self.kind} of {self.name}: the sample of {iso_utc(flat[worst], 0)} lies {abs(age[worst]):.1f} days {side} the "
            f"nearest element epoch, {iso_utc(epoch, 0)}; the limit is {max_age_days:g} days.{guess} "
            "Get elements of the samples' days, or raise the limit with --max-orbit-age-days (max_age_days)."
        )


def propagate(elements: ElementSet, flat: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Position [m] and velocity [m/s], (n, 3), TEME axes, of one set at (n,) times."""
    day, fraction = utc_julian(flat)
    error, r_km, v_km_s = elements.satrec().sgp4_array(day, fraction)
    lost = (error != 0) | ~np.isfinite(r_km).all(axis=1)
    if lost.any():
        first = int(lost.argmax())
        words = SGP4_WORDS.get(int(error[first]), "the result is not a number")
        raise InputError(
            f"SGP4 cannot carry the elements of {elements.label} to {iso_utc(flat[first], 0)}: {words}. "
            f"Their epoch is {iso_utc(elements.epoch_utc, 0)}; take elements nearer to the samples."
        )
    return r_km * 1000.0, v_km_s * 1000.0
