"""`calibrate_magnitude` for one arc, `calibrate_flights` for several of one satellite."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fieldline.errors import InputError, NoEstimateError, nearest
from fieldline.estimation.calibration.clock import ClockScan, scan_clock
from fieldline.estimation.calibration.covariance import FIELD_MODEL_STD_TESLA, clipped, covariance_of, effective_samples
from fieldline.estimation.calibration.fit import OUTLIER_SIGMAS, Fit, fit, prior_of
from fieldline.estimation.calibration.ladder import BASIC, best_fit, flight_splines
from fieldline.estimation.calibration.model import Samples, Terms, field_std, magnitudes
from fieldline.estimation.calibration.record import COLUMNS, Calibration, only_flight
from fieldline.estimation.calibration.selection import Candidate, choose
from fieldline.estimation.calibration.spline import KNOT_SPACING_S, UniformSpline
from fieldline.estimation.calibration.words import with_sentences

FEWEST_SAMPLES = 30
THINNED = 4000  # samples that decide between candidates; all are used for the final fit
EXTENSIONS = {
    "gain": {"gain": "reading"},
    "field-gain": {"gain": "field"},
    "temperature": {"temperature": True},
    "drift": {"drift": True},
    "dipole": {"dipole": True},
    "current": {"current": True},
    "sunlit": {"sunlit": True},
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Flight:
    """One arc's readings and the model's magnitude at its times."""

    seconds: np.ndarray
    field_s: np.ndarray
    magnitude_tesla: np.ndarray
    usable: np.ndarray | None = None
    temperature_k: np.ndarray | None = None
    dipole_command_b: np.ndarray | None = None
    solar_current: np.ndarray | None = None
    sunlit: np.ndarray | None = None
    epoch_utc: np.datetime64 | None = None
    name: str = ""


@dataclass(frozen=True, slots=True)
class Units:
    """What the scaled samples are multiples of."""

    field_tesla: float
    arc_s: float
    reference_s: float
    temperature_reference_k: float
    temperature_k: float
    dipole_a_m2: float
    current_a: float
    sunlit: float


def calibrate_magnitude(
    seconds,
    field_s,
    magnitude_tesla,
    *,
    usable=None,
    model: str = "auto",
    temperature_k=None,
    dipole_command_b=None,
    solar_current=None,
    sunlit=None,
    epoch_utc=None,
    knot_spacing_s: float = KNOT_SPACING_S,
    field_model_std_tesla: float = FIELD_MODEL_STD_TESLA,
    magnitude_at: Callable[[float], np.ndarray] | None = None,
    clock_scan: bool = False,
    clock_apply: bool = False,
) -> Calibration:
    """Bias, matrix and, where the data support them, a slow gain, drift and couplings: from magnitudes, without attitude.

    Parameters
    ----------
    seconds : (n,) [s], increasing.      field_s : (n, 3) [T] raw reading, sensor axes.
    magnitude_tesla : (n,) [T] magnitude of the model's field at those times.
    usable : (n,) bool, samples that may be used; rows that are not finite never are.
    model : "auto" (the data decide), "none", "bias", "bias+scale", "full" (nine parameters), or "full" with "+gain"
        (slow gain of the whole reading), "+field-gain" (of the field without the bias), "+temperature", "+drift",
        "+dipole", "+current", "+sunlit" after it.
    temperature_k (n,) [K], dipole_command_b (n, 3) [A m^2], solar_current (n,) [A], sunlit (n,) [0..1, share of the Sun's
        disc that is seen]: columns that terms may use; only what is given and changes is tried.
    epoch_utc : the time of seconds = 0, kept for use on other files.      knot_spacing_s : [s] of the slow gain.
    field_model_std_tesla : [T] slow error of `magnitude_tesla` itself, part of the covariance.
    clock_scan : also scan an offset of the clock over +-120 s and report it; needs `magnitude_at(offset_s)` -> (n,) [T], the
        model's magnitude at the samples' times plus the offset.      clock_apply : and calibrate with the best offset.

    Returns
    -------
    Calibration

    Errors: InputError for shapes, times and names; NoEstimateError where fewer than 30 samples are usable, where the field
    does not vary, or where the model asked for cannot be seen in these data.
    """
    flight = Flight(
        seconds=seconds, field_s=field_s, magnitude_tesla=magnitude_tesla, usable=usable, temperature_k=temperature_k,
        dipole_command_b=dipole_command_b, solar_current=solar_current, sunlit=sunlit, epoch_utc=epoch_utc,
    )  # fmt: skip
    settings = {"knot_spacing_s": knot_spacing_s, "field_model_std_tesla": field_model_std_tesla}
    found = calibrate_flights([flight], model=model, **settings)[0]
    if not (clock_scan or clock_apply):
        return found
    if magnitude_at is None:
        raise InputError("a clock scan needs magnitude_at(offset_s): the model's magnitude at shifted times.")
    scan = scan_of(found, flight, magnitude_at)
    if clock_apply and np.isfinite(scan.std_s):
        shifted = replace(flight, magnitude_tesla=magnitude_at(scan.best_s))
        found, scan = calibrate_flights([shifted], model=model, **settings)[0], replace(scan, applied=True)
    return replace(found, clock=scan, sentences=(*found.sentences, scan.sentence()))


def scan_of(found: Calibration, flight: Flight, magnitude_at: Callable[[float], np.ndarray]) -> ClockScan:
    """The clock scan of a calibrated flight, with the terms that its calibration fitted."""
    samples, units = gather([flight])
    terms = terms_named(found.model, samples, found.terms.splines, 1)
    one = climb(terms, samples.thinned(THINNED))
    return scan_clock(one, lambda offset: gather([replace(flight, magnitude_tesla=magnitude_at(offset))])[0], units.field_tesla)


def calibrate_flights(
    flights: list[Flight] | tuple[Flight, ...],
    *,
    model: str = "auto",
    knot_spacing_s: float = KNOT_SPACING_S,
    field_model_std_tesla: float = FIELD_MODEL_STD_TESLA,
) -> tuple[Calibration, ...]:
    """One matrix and one bias for all flights of a satellite, and the gain's level and course for each.

    Returns one Calibration per flight, in order; they share everything but the gain. Arguments and errors are those of
    `calibrate_magnitude`.
    """
    samples, units = gather(flights)
    unsure = field_model_std_tesla / units.field_tesla
    splines = flight_splines(samples, knot_spacing_s)
    wanted = None if model == "auto" else terms_named(model, samples, splines, len(flights))
    if wanted is not None and wanted.size == 0:
        best, table = fit(wanted, np.zeros(0), samples, prior_of(wanted, samples)), []
    else:
        refuse_unfit(samples)
        thin = samples.thinned(THINNED)
        if wanted is None:
            first, table = choose(thin, splines, len(flights), units.field_tesla, unsure)
        else:
            first, table = climb(wanted, thin), []
        best = fit(first.terms, first.theta, samples, prior_of(first.terms, samples))
    common = covariance_of(best, samples, unsure)
    return tuple(_record(best, samples, units, flights[k], k, table, model, common) for k in range(len(flights)))


def climb(wanted: Terms, samples: Samples) -> Fit:
    """Fit the model that was asked for, from the nine-parameter fit upwards."""
    base = replace(wanted, gain="none", splines=(), temperature=False, drift=False, dipole=False, current=False, sunlit=False)
    first = best_fit(base, samples)
    return first if base == wanted else best_fit(wanted, samples, first)


def terms_named(model: str, samples: Samples, splines: tuple[UniformSpline, ...], flights: int) -> Terms:
    """The candidate of a name such as "full+gain+drift"."""
    base, *words = model.replace("bias+scale", "bias-scale").split("+")
    base = base.replace("-", "+")
    if base not in BASIC:
        raise InputError(f'unknown calibration model "{model}"; {nearest(base, [*BASIC, "auto"])}')
    terms = BASIC[base]
    for word in words:
        if word not in EXTENSIONS:
            raise InputError(f'unknown term "+{word}" in calibration model "{model}"; {nearest(word, EXTENSIONS)}')
        terms = replace(terms, **EXTENSIONS[word])
    for name in COLUMNS:
        if getattr(terms, name) and getattr(samples, name) is None:
            raise InputError(
                f'model "{model}" needs the column "{name}" of every flight; it was not given or never changes within one.'
            )
    if terms.gain != "none" and not splines:
        raise NoEstimateError(f'model "{model}": an arc of {np.ptp(samples.seconds):.0f} s is too short for a slow gain.')
    if terms.drift and flights > 1:
        raise InputError(f'model "{model}": a drift belongs to one arc; calibrate the files apart for it.')
    return replace(terms, name=model, splines=splines if terms.gain != "none" else ())


def gather(flights: list[Flight] | tuple[Flight, ...]) -> tuple[Samples, Units]:
    """All usable samples, checked and scaled."""
    if not flights:
        raise InputError("no flight to calibrate: give at least one.")
    checked = [_checked(flight, k) for k, flight in enumerate(flights)]
    join = lambda name: np.concatenate([getattr(c, name) for c in checked])
    unit = float(np.median(join("magnitude")))
    seconds = join("seconds")
    low, high = float(seconds.min()), float(seconds.max())
    arc_s, middle = max(high - low, 1e-9), 0.5 * (low + high)

    def column(name: str, centred: bool = False) -> tuple[np.ndarray | None, float, float]:
        if any(getattr(c, name) is None for c in checked):
            return None, 0.0, 1.0
        values = join(name)
        shift = float(values.mean()) if centred else 0.0
        size = float(np.abs(values - shift).max())
        # A column that never moves cannot tell its coupling from a bias.
        return (None, shift, 1.0) if np.ptp(values, axis=0).max() <= 1e-12 * size else ((values - shift) / size, shift, size)

    temperature, temperature_mean, temperature_size = column("temperature", centred=True)
    dipole, _, dipole_size = column("dipole")
    current, _, current_size = column("current")
    sunlit, _, sunlit_size = column("sunlit")
    if sunlit is not None and not any(np.ptp(c.sunlit) > 0.0 for c in checked):
        sunlit = None  # light and dark flights without an edge: a step is not seen
    samples = Samples(
        seconds, join("field_s") / unit, join("magnitude") / unit, join("flight"), (seconds - middle) / arc_s,
        temperature, dipole, current, sunlit,
    )  # fmt: skip
    return samples, Units(unit, arc_s, middle, temperature_mean, temperature_size, dipole_size, current_size, sunlit_size)


def _checked(flight: Flight, number: int) -> Samples:
    """One flight's usable samples in SI."""
    called = f'flight "{flight.name}": ' if flight.name else ""
    seconds = np.asarray(flight.seconds, dtype=float)
    field_s, magnitude = np.asarray(flight.field_s, dtype=float), np.asarray(flight.magnitude_tesla, dtype=float)
    n = len(seconds) if seconds.ndim == 1 else -1
    if field_s.shape != (n, 3) or magnitude.shape != (n,):
        raise InputError(
            f"{called}seconds (n,), field_s (n, 3) and magnitude_tesla (n,) must agree; "
            f"got {seconds.shape}, {field_s.shape} and {magnitude.shape}."
        )
    good = np.isfinite(seconds) & np.isfinite(field_s).all(axis=1) & np.isfinite(magnitude) & (magnitude > 0.0)
    good &= True if flight.usable is None else np.asarray(flight.usable, dtype=bool)
    extras = {}
    for name, (argument, _) in COLUMNS.items():
        value, shape = getattr(flight, argument), (n, 3) if name == "dipole" else (n,)
        extras[name] = None if value is None else np.asarray(value, dtype=float)
        if value is not None:
            if extras[name].shape != shape:
                raise InputError(f"{called}{argument} must be {shape}; got {extras[name].shape}.")
            good &= np.isfinite(extras[name].reshape(n, -1)).all(axis=1)
    if not good.any():
        raise InputError(f"{called}none of the {n} samples is usable: all are missing, not finite or marked unusable.")
    if np.any(np.diff(seconds[good]) <= 0.0):
        raise InputError(f"{called}seconds must increase; sort the samples and drop repeated ones.")
    count = int(good.sum())
    return Samples(
        seconds[good], field_s[good], magnitude[good], np.full(count, number), np.zeros(count),
        **{name: None if value is None else value[good] for name, value in extras.items()},
    )  # fmt: skip


def refuse_unfit(samples: Samples) -> None:
    """NoEstimateError where nothing could be fitted."""
    if len(samples) < FEWEST_SAMPLES:
        raise NoEstimateError(
            f"{len(samples)} usable samples cannot calibrate a magnetometer; at least {FEWEST_SAMPLES} are needed. "
            'Use calibration "none" or one from a longer file.'
        )
    if np.ptp(samples.field_s, axis=0).max() < 1e-6:
        raise NoEstimateError(
            "the magnetometer's reading never changes: a stuck sensor, or a body that neither turns nor moves. "
            "Nothing can be calibrated from it."
        )


def physical_units(terms: Terms, units: Units) -> np.ndarray:
    """(parameters,) SI unit of each scaled parameter."""
    sizes = {
        "bias": units.field_tesla, "matrix": 1.0, "temperature": 1.0 / units.temperature_k,
        "drift": units.field_tesla / units.arc_s, "dipole": units.field_tesla / units.dipole_a_m2,
        "current": units.field_tesla / units.current_a, "sunlit": units.field_tesla / units.sunlit, "gain": 1.0,
    }  # fmt: skip
    out = np.ones(terms.size)
    for name, place in terms.layout.items():
        out[place] = sizes[name]
    return out


def _record(
    best: Fit,
    samples: Samples,
    units: Units,
    flight: Flight,
    number: int,
    table: list[Candidate],
    model: str,
    common: tuple[Terms, np.ndarray, np.ndarray],
) -> Calibration:
    """One flight's Calibration from the common fit and its `covariance_of`."""
    terms, theta, covariance = common
    if model == "none":
        covariance = np.zeros_like(covariance)  # whoever asks for no calibration vouches for the sensor
    size = physical_units(terms, units)
    own, where = only_flight(terms, number)
    inside = np.abs(best.residual) < OUTLIER_SIGMAS * best.scale
    mine = samples.flight == number
    kept = samples.take(inside & mine)
    good = magnitudes(best.terms, best.theta, kept) - kept.magnitude if len(kept) else np.empty(0)
    found = Calibration(
        model=best.terms.name,
        terms=own,
        values=(theta * size)[where],
        covariance=(covariance * np.outer(size, size))[np.ix_(where, where)],
        epoch_utc=None if flight.epoch_utc is None else np.datetime64(flight.epoch_utc, "ns"),
        reference_s=units.reference_s,
        temperature_reference_k=units.temperature_reference_k,
        fitted=best.terms.size,
        samples=int(mine.sum()),
        outliers=int((mine & ~inside).sum()),
        effective_samples=effective_samples(clipped(best)),
        residual_rms_tesla=float(np.sqrt(np.mean(good**2))) * units.field_tesla if len(good) else float("nan"),
        scale_tesla=best.scale * units.field_tesla,
        candidates=tuple(table),
    )
    few = samples.take(mine).thinned(500)
    error = float(np.sqrt(np.mean(field_std(terms, theta, covariance, few) ** 2)))
    return with_sentences(found, error * units.field_tesla, units.field_tesla, model)
