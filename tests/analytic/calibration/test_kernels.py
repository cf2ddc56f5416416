"""The compiled sums are those of the equations written out."""

import numpy as np
import pytest
from scipy.stats import wilcoxon

from fieldline.estimation.calibration.arrow import empty_arrow
from fieldline.estimation.calibration.covariance import score_spread
from fieldline.estimation.calibration.distance import distances, information_of, matrix9, problem_of, row_at
from fieldline.estimation.calibration.fit import DEGREES, normal_equations, weights_of
from fieldline.estimation.calibration.model import Samples, Terms, corrected, field_jacobian
from fieldline.estimation.calibration.signed_rank import chance_of_lead
from fieldline.estimation.calibration.spline import spline_over

SCALE = 0.01


def two_flights(gain):
    """Samples of two flights with every column, a candidate with every term, and parameters at random."""
    rng = np.random.default_rng(0)
    seconds = np.concatenate([np.arange(0.0, 3000.0, 60.0), np.arange(9000.0, 12000.0, 60.0)])
    n, flight = len(seconds), np.repeat([0, 1], 50)
    samples = Samples(
        seconds, rng.standard_normal((n, 3)), rng.uniform(0.6, 1.2, n), flight, np.linspace(-0.5, 0.5, n),
        rng.standard_normal(n), rng.standard_normal((n, 3)), rng.standard_normal(n), rng.uniform(0.0, 1.0, n),
    )  # fmt: skip
    terms = Terms(
        "all", bias=True, matrix="full", gain=gain, temperature=True, drift=True, dipole=True, current=True, sunlit=True,
        splines=(spline_over(0.0, 2940.0), spline_over(9000.0, 11940.0)),
    )  # fmt: skip
    theta = 0.02 * rng.standard_normal(terms.size)
    theta[:9] += [2.0, -0.7, -0.7, 1.1, 1.0, 0.95, 0.01, 0.02, 0.03]
    return terms, theta, samples


def jacobian_of(terms, theta, samples):
    """(n, parameters) derivatives of the distances, row by row from the kernel."""
    problem, shared = problem_of(terms, samples), terms.layout["gain"].start
    out, row = np.zeros((len(samples), terms.size)), np.empty(shared + 4)
    for k in range(len(samples)):
        _, first = row_at(k, theta, matrix9(terms, theta), *problem, row)
        out[k, :shared], out[k, first : first + 4] = row[:shared], row[shared:]
    return out


@pytest.mark.kernels
@pytest.mark.parametrize("gain", ["reading", "field"])
def test_derivatives_are_those_of_differences(gain):
    terms, theta, samples = two_flights(gain)
    jacobian = jacobian_of(terms, theta, samples)
    for k in range(terms.size):
        step = np.zeros(terms.size)
        step[k] = 1e-5
        slope = (distances(terms, theta + step, samples) - distances(terms, theta - step, samples)) / 2e-5
        assert np.abs(slope - jacobian[:, k]).max() < 1e-7 * max(1.0, np.abs(jacobian[:, k]).max())


@pytest.mark.parametrize("gain", ["reading", "field"])
def test_derivatives_of_the_field_are_those_of_differences(gain):
    terms, theta, samples = two_flights(gain)
    part = samples.take(slice(50, None))
    where, slopes = field_jacobian(terms, theta, part)
    for column, k in enumerate(where):
        step = np.zeros(terms.size)
        step[k] = 1e-5
        slope = (corrected(terms, theta + step, part)[0] - corrected(terms, theta - step, part)[0]) / 2e-5
        assert np.abs(slope - slopes[:, :, column]).max() < 1e-7


@pytest.mark.kernels
@pytest.mark.parametrize("gain", ["reading", "field"])
def test_distances_are_those_of_the_corrected_field(gain):
    terms, theta, samples = two_flights(gain)
    expected = []
    for _, part in samples.chunks():
        field_b, _, _ = corrected(terms, theta, part)
        length = np.linalg.norm(field_b, axis=1)
        stretch = np.linalg.norm(field_b @ terms.matrix_of(theta), axis=1) / length
        expected.append((length - part.magnitude) / stretch)
    assert distances(terms, theta, samples) == pytest.approx(np.concatenate(expected), abs=1e-13)


@pytest.mark.kernels
def test_sums_are_those_of_the_whole_jacobian():
    terms, theta, samples = two_flights("reading")
    jacobian, d = jacobian_of(terms, theta, samples), distances(terms, theta, samples)
    weight = weights_of(d, SCALE) / SCALE**2
    matrix, gradient = normal_equations(terms, theta, samples, SCALE)
    close = lambda one, other: np.abs(one - other).max() <= 1e-11 * np.abs(other).max()
    assert close(matrix.dense(), (jacobian * weight[:, None]).T @ jacobian)
    assert close(gradient, jacobian.T @ (weight * d))
    scores = jacobian * (weight * d)[:, None]
    assert close(information_of(terms, theta, samples, SCALE, DEGREES, squared=True)[0].dense(), scores.T @ scores)
    for error in (None, 0.3):
        told = scores if error is None else jacobian * (weight * error)[:, None]
        sums = np.concatenate([np.add.reduceat(told[half], np.arange(0, 50, 7)) for half in (slice(0, 50), slice(50, 100))])
        assert close(score_spread(terms, theta, samples, SCALE, 7, error), sums.T @ sums)


@pytest.mark.kernels
@pytest.mark.parametrize(("shared", "banded"), [(9, 0), (12, 2), (9, 40), (0, 5)])
def test_an_arrow_is_solved_as_its_dense_matrix_is(shared, banded):
    rng = np.random.default_rng(shared + banded)
    arrow = empty_arrow(shared, banded)
    for part in arrow:
        part += rng.standard_normal(part.shape)
    arrow = arrow.with_diagonal(np.full(shared + banded, 60.0))
    right = rng.standard_normal((shared + banded, 2))
    assert arrow.dense() @ arrow.solve(right) == pytest.approx(right, abs=1e-12)
    assert np.array_equal(arrow.dense(), arrow.dense().T)


@pytest.mark.parametrize("n", [1, 3, 19, 50, 51, 400])
def test_signed_ranks_agree_with_scipy(n):
    x = np.random.default_rng(n).normal(0.3, 1.0, n)
    assert chance_of_lead(x) == pytest.approx(wilcoxon(x, alternative="greater", correction=True).pvalue, rel=1e-9)
    assert chance_of_lead(np.zeros(n)) == 1.0
