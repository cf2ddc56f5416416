"""The calibration of a magnetometer: what was found, how well it is known, and how to apply it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fieldline.errors import InputError
from fieldline.estimation.calibration.clock import ClockScan
from fieldline.estimation.calibration.model import Samples, Terms, corrected, field_std, gain_of
from fieldline.estimation.calibration.selection import Candidate

COLUMNS = {
    "temperature": ("temperature_k", "temperature"),
    "dipole": ("dipole_command_b", "dipole command"),
    "current": ("solar_current", "solar current"),
    "sunlit": ("sunlit", "share of sunlight"),
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Calibration:
    """A magnetometer's calibration.

        field_b = gain_b(t) D (gain_s(t) field_s - bias - drift (t - t_r) - C dipole - c current
                               - p sunlit)

    `values` and `covariance` belong to `parameter_names` (SI). They hold bias and matrix also where the model did not fit
    them: then the value is that of an ideal sensor and the covariance says how far from ideal this one may be.
    The rotation between the magnetometer's axes and the body's is not part of it: magnitudes do not see it.
    """

    model: str
    terms: Terms
    values: np.ndarray
    covariance: np.ndarray
    epoch_utc: np.datetime64 | None
    reference_s: float
    temperature_reference_k: float
    fitted: int
    samples: int
    outliers: int
    effective_samples: float
    residual_rms_tesla: float
    scale_tesla: float
    candidates: tuple[Candidate, ...] = ()
    sentences: tuple[str, ...] = ()
    clock: ClockScan | None = None

    @property
    def bias_s(self) -> np.ndarray:
        """(3,) T, at `reference_s`."""
        return self.values[self.terms.layout["bias"]].copy()

    @property
    def matrix(self) -> np.ndarray:
        """D (3, 3), symmetric."""
        return self.terms.matrix_of(self.values)

    @property
    def bias_std_s(self) -> np.ndarray:
        """(3,) T, 1 sigma."""
        return self.std[self.terms.layout["bias"]]

    @property
    def std(self) -> np.ndarray:
        """(parameters,) 1 sigma of each parameter."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))

    @property
    def gain_knots_s(self) -> np.ndarray:
        """(k,) s: the knots of the slow gain; empty without one."""
        return self.terms.splines[0].knots_s if self.terms.gain != "none" else np.empty(0)

    @property
    def gain_values(self) -> np.ndarray:
        """(k,) gain at the knots."""
        return self.gain(self.gain_knots_s) if self.terms.gain != "none" else np.empty(0)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names of `values`, with units."""
        return parameter_names(self.terms)

    def gain(self, seconds: np.ndarray) -> np.ndarray:
        """(n,) slow gain of the spline alone; 1 where none was fitted and farther than one knot from the arc."""
        seconds = np.atleast_1d(np.asarray(seconds, dtype=float))
        if self.terms.gain == "none":
            return np.ones(len(seconds))
        return 1.0 + self.terms.splines[0].values(seconds, self.values[self.terms.layout["gain"]])

    def apply(
        self, seconds, field_s, *, temperature_k=None, dipole_command_b=None, solar_current=None, sunlit=None, epoch_utc=None
    ) -> np.ndarray:
        """(n, 3) T: the calibrated field in body (magnetometer) axes; NaN where the reading is.

        Parameters
        ----------
        seconds : (n,) [s] since `epoch_utc`, which is the calibration's own epoch unless given.
        field_s : (n, 3) [T] raw reading.
        temperature_k, dipole_command_b, solar_current, sunlit : (n,) [K], (n, 3) [A m^2], (n,) [A], (n,) [0..1]: needed by
            the models that use them.

        Errors: InputError for shapes that do not fit and for a column that the model needs and that is missing.
        """
        samples = self._samples(seconds, field_s, temperature_k, dipole_command_b, solar_current, sunlit, epoch_utc)
        out = np.empty((len(samples), 3))
        for piece, part in samples.chunks():
            out[piece] = corrected(self.terms, self.values, part)[0]
        return out

    def gain_at(
        self, seconds, *, temperature_k=None, dipole_command_b=None, solar_current=None, sunlit=None, epoch_utc=None
    ) -> np.ndarray:
        """(n,) the whole gain, slow and by temperature, at samples; arguments as of `apply`."""
        readings = np.zeros((len(np.atleast_1d(seconds)), 3))
        samples = self._samples(seconds, readings, temperature_k, dipole_command_b, solar_current, sunlit, epoch_utc)
        return gain_of(self.terms, self.values, samples)

    def propagated_std(
        self, seconds, field_s, *, temperature_k=None, dipole_command_b=None, solar_current=None, sunlit=None, epoch_utc=None
    ) -> np.ndarray:
        """(n, 3) T: 1-sigma error of `apply` along each axis that the parameters' covariance causes.

        It is constant or slow, not noise: averaging over samples does not lessen it. Where the gain was never fitted
        (far from the arc) its own scatter over the arc is added.
        """
        samples = self._samples(seconds, field_s, temperature_k, dipole_command_b, solar_current, sunlit, epoch_utc)
        out = field_std(self.terms, self.values, self.covariance, samples)
        if self.terms.gain != "none":
            spline = self.terms.splines[0]
            far = np.abs(samples.seconds - np.mean(spline.knots_s[[0, -1]])) > spline.spacing_s * (0.5 * spline.intervals + 1.0)
            scatter = float(np.std(self.gain_values))
            out[far] = np.hypot(out[far], scatter * np.abs(samples.field_s[far] @ self.matrix))
        return out

    def _samples(self, seconds, field_s, temperature_k, dipole_command_b, solar_current, sunlit, epoch_utc) -> Samples:
        """The arguments, checked, in SI."""
        seconds = np.atleast_1d(np.asarray(seconds, dtype=float))
        field_s = np.asarray(field_s, dtype=float)
        n = len(seconds)
        if field_s.shape != (n, 3):
            raise InputError(f"field_s must be ({n}, 3) [T], one row per time; got {field_s.shape}.")
        if epoch_utc is not None and self.epoch_utc is not None:
            seconds = seconds + (np.datetime64(epoch_utc, "ns") - self.epoch_utc) / np.timedelta64(1, "s")
        given = {"temperature": temperature_k, "dipole": dipole_command_b, "current": solar_current, "sunlit": sunlit}
        columns = {}
        for name, value in given.items():
            columns[name] = None
            if getattr(self.terms, name):
                argument, words = COLUMNS[name]
                if value is None:
                    raise InputError(f'the calibration "{self.model}" needs the {words} of every sample: give {argument}.')
                columns[name] = np.asarray(value, dtype=float)
                if columns[name].shape != ((n, 3) if name == "dipole" else (n,)):
                    raise InputError(f"{argument} must have one row per time ({n}); got {columns[name].shape}.")
        if columns["temperature"] is not None:
            columns["temperature"] = columns["temperature"] - self.temperature_reference_k
        return Samples(seconds, field_s, np.ones(n), np.zeros(n, dtype=int), seconds - self.reference_s, **columns)

    def to_json(self) -> str:
        """JSON text that `from_json` reads back."""
        from fieldline.estimation.calibration.storage import to_json

        return to_json(self)

    @staticmethod
    def from_json(text: str, name: str = "calibration") -> Calibration:
        """The record of `to_json`'s text; InputError (with `name`) for anything else."""
        from fieldline.estimation.calibration.storage import from_json

        return from_json(text, name)

    def summary(self) -> dict:
        """Plain types for a report or a file's attributes: microtesla where the key says so."""
        std = self.std
        at = self.terms.layout
        six = std[at["matrix"]][[[0, 3, 4], [3, 1, 5], [4, 5, 2]]]
        return {
            "model": self.model,
            "sentence": " ".join(self.sentences),
            "bias_ut": [float(b) * 1e6 for b in self.bias_s],
            "bias_std_ut": [float(s) * 1e6 for s in self.bias_std_s],
            "matrix": self.matrix.tolist(),
            "matrix_std": six.tolist(),
            "gain_on": self.terms.gain,
            "gain_knots_s": self.gain_knots_s.tolist(),
            "gain_values": self.gain_values.tolist(),
            **self._gain_curve(),
            "parameters": [
                {"name": n, "value": float(v), "std": float(s)}
                for n, v, s in zip(self.parameter_names, self.values, std, strict=True)
            ],
            "rms_nt": self.residual_rms_tesla * 1e9,
            "fitted_parameters": self.fitted,
            "clock": None
            if self.clock is None
            else {
                "offsets_s": list(self.clock.offsets_s),
                "rms_nt": [float(r) * 1e9 for r in self.clock.rms_tesla],
                "best_s": self.clock.best_s,
                "std_s": self.clock.std_s if np.isfinite(self.clock.std_s) else None,
                "sigmas": self.clock.sigmas,
                "applied": self.clock.applied,
            },
            "samples": self.samples,
            "outliers": self.outliers,
            "effective_samples": self.effective_samples,
            "candidates": [
                {
                    "model": c.model, "parameters": c.parameters, "rms_nt": c.rms_tesla * 1e9,
                    "held_out_rms_nt": c.held_out_rms_tesla * 1e9, "criterion": c.criterion, "chosen": c.chosen, "why": c.why,
                }
                for c in self.candidates
            ],
        }  # fmt: skip

    def _gain_curve(self) -> dict:
        """The gain's course between its knots, for drawing; nothing without a gain."""
        if self.terms.gain == "none":
            return {}
        seconds = np.linspace(self.gain_knots_s[0], self.gain_knots_s[-1], 200)
        return {"gain_curve_s": seconds.tolist(), "gain_curve": self.gain(seconds).tolist()}


def parameter_names(terms: Terms) -> tuple[str, ...]:
    """Names of a parameter vector, each with its unit."""
    pairs = ("xx", "yy", "zz", "xy", "xz", "yz")
    names = {
        "bias": [f"bias_{a}_tesla" for a in "xyz"],
        "matrix": [f"matrix_{p}" for p in pairs] if terms.matrix == "full" else ["matrix_scale"],
        "temperature": ["gain_per_kelvin"],
        "drift": [f"drift_{a}_tesla_s" for a in "xyz"],
        "dipole": [f"dipole_{a}{b}_tesla_a_m2" for a in "xyz" for b in "xyz"],
        "current": [f"current_{a}_tesla_a" for a in "xyz"],
        "sunlit": [f"sunlit_{a}_tesla" for a in "xyz"],
        "gain": [f"gain_{k}" for k in range(terms.splines[0].size)] if len(terms.splines) == 1 else [],
    }
    return tuple(name for term in terms.layout for name in names[term])


def only_flight(terms: Terms, flight: int) -> tuple[Terms, np.ndarray]:
    """The terms as one flight sees them, and where their parameters lie in the vector of all flights."""
    if "gain" not in terms.layout:
        return replace(terms, splines=()), np.arange(terms.size)
    shared = np.arange(terms.layout["gain"].start)
    own = terms.gain_slice(flight)
    return replace(terms, splines=(terms.splines[flight],)), np.concatenate([shared, np.arange(own.start, own.stop)])
