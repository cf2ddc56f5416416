"""Filter and smoother against textbook algebra written out in full matrices, and against limits."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fieldline.estimation import covariance as cov
from fieldline.estimation.kalman import Noise, filter_forward, prior_blocks, smooth_backward
from fieldline.estimation.motion import propagate, random_walk, rigid_body
from fieldline.estimation.series import make_series, part
from fieldline.estimation.smoothing import NO_PATH, _smooth_once, innovations, smooth
from fieldline.frames.attitude import rotation_error_b

pytestmark = pytest.mark.kernels

SIZE = 3e-5


def flight(n=60, step=5.0, noise=2e-7, seed=0, rate=(0.004, -0.009, 0.006)):
    """A constant body rate under a reference field that turns once in 4,000 s; one sample left out, one spike."""
    rng = np.random.default_rng(seed)
    seconds = step * np.arange(n)
    angle = 2 * np.pi * seconds / 4000.0
    field_i = SIZE * np.stack([np.cos(angle), 0.6 * np.sin(angle), 0.5 + 0.3 * np.cos(2 * angle)], axis=1)
    attitude = Rotation.random(random_state=seed) * Rotation.from_rotvec(np.outer(seconds, rate))
    field_b = attitude.inv().apply(field_i) + noise * rng.standard_normal((n, 3))
    used = np.ones(n, bool)
    used[7] = False
    position_i = 7e6 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    return make_series(seconds, field_b, field_i, position_i, used), attitude, np.array(rate)


def blocks_to_matrix(row):
    aa, ar, rr, ac, rc, cc = (np.reshape(block, (3, 3)) for block in np.reshape(row, (6, 9)))
    return np.block([[aa, ar, ac], [ar.T, rr, rc], [ac.T, rc.T, cc]])


def textbook_filter(series, start, noise, model):
    """The same filter in 9 x 9 matrices, and the Rauch-Tung-Striebel smoother on its output."""
    q, w, c = start[:4].copy(), start[4:7].copy(), np.zeros(3)
    p = blocks_to_matrix(prior_blocks(0.05, 0.001, noise.coloured)[0])
    states, covariances, predicted = [], [], []
    for k in range(len(series.seconds)):
        f = np.eye(9)
        if k:
            h = series.seconds[k] - series.seconds[k - 1]
            row = k - 1
            q, w, phi, psi, lam = propagate(
                tuple(q), tuple(w), (0.0, 0.0, 0.0), tuple(series.field_i[row]), tuple(series.pull_i[row]), h, model
            )
            q, w = np.array(q), np.array(w)
            fade = np.exp(-h / noise.coloured_time)
            f[:3, :3], f[:3, 3:6], f[3:6, 3:6] = (np.reshape(m, (3, 3)) for m in (phi, psi, lam))
            f[6:, 6:] = fade * np.eye(3)
            s2, i3 = model.noise**2, np.eye(3)
            process = np.zeros((9, 9))
            process[:3, :3], process[3:6, 3:6] = s2 * h**3 / 3 * i3, s2 * h * i3
            process[:3, 3:6] = process[3:6, :3] = s2 * h**2 / 2 * i3
            process[6:, 6:] = (1 - fade**2) * noise.coloured**2 * i3
            p = f @ p @ f.T + process
            c = fade * c
        predicted.append((q.copy(), w.copy(), c.copy(), p.copy(), f))
        if series.used[k]:
            body = Rotation.from_quat(q).inv().apply(series.field_i[k])
            hm = np.hstack([np.cross(np.eye(3), body).T @ -np.eye(3), np.zeros((3, 3)), np.eye(3)])
            hm[:, :3] = np.array([[0, -body[2], body[1]], [body[2], 0, -body[0]], [-body[1], body[0], 0]])
            s = hm @ p @ hm.T + noise.white**2 * np.eye(3)
            gain = p @ hm.T @ np.linalg.inv(s)
            dx = gain @ (series.field_b[k] - body - c)
            q = (Rotation.from_quat(q) * Rotation.from_rotvec(dx[:3])).as_quat()
            w, c = w + dx[3:6], c + dx[6:]
            p = p - gain @ hm @ p
        states.append((q.copy(), w.copy(), c.copy()))
        covariances.append(p.copy())
    return states, covariances, predicted


def run(series, start, noise, model):
    n = len(series.seconds)
    row = np.zeros((1, 10))
    row[0, :7] = start
    prior = prior_blocks(0.05, 0.001, noise.coloured)
    first, states, errors, blocks = row.copy(), np.empty((n, 10)), np.empty((n, 9)), np.empty((n, cov.BLOCKS))
    kept = prior.copy()
    filter_forward(
        series, True, 0.0, first, np.zeros((1, 9)), kept, noise, model, NO_PATH, states, errors, blocks, np.empty((0, 3))
    )
    return row, prior, states, errors, blocks


@pytest.mark.parametrize("coloured", [0.0, 3e-7])
@pytest.mark.parametrize("model", [random_walk(1e-5), rigid_body(np.diag([1.0, 1.3, 1.5]), 1e-5)], ids=["walk", "rigid"])
def test_filter_equals_full_matrices(model, coloured):
    series, attitude, rate = flight()
    noise = Noise(white=2e-7, coloured=coloured, coloured_time=100.0, gate=1e9)
    start = np.r_[(attitude[0] * Rotation.from_rotvec([0.01, -0.02, 0.015])).as_quat(), rate + 2e-4]
    _, _, states, _, blocks = run(series, start, noise, model)
    expected, covariances, _ = textbook_filter(series, start, noise, model)
    scale = np.r_[np.full(3, 1e-3), np.full(3, 1e-5), np.full(3, 1e-7)]
    for k in (0, 6, 7, 30, 59):
        q, w, c = expected[k]
        assert np.abs(rotation_error_b(q, states[k, :4])).max() < 1e-10
        assert np.abs(w - states[k, 4:7]).max() < 1e-12
        assert np.abs(c - states[k, 7:]).max() < 1e-16
        difference = (blocks_to_matrix(blocks[k]) - covariances[k]) / np.outer(scale, scale)
        assert np.abs(difference[: 9 if coloured else 6, : 9 if coloured else 6]).max() < 1e-7


@pytest.mark.parametrize("coloured", [0.0, 3e-7])
def test_smoother_equals_rauch_tung_striebel(coloured):
    """Two smoothers of different algebra agree to the curvature of the attitude, which a start near the truth makes small."""
    series, attitude, rate = flight(noise=2e-8)
    noise = Noise(white=2e-8, coloured=coloured / 10, coloured_time=100.0, gate=1e9)
    model = random_walk(1e-6)
    start = np.r_[attitude[0].as_quat(), rate]
    row, prior, states, errors, blocks = run(series, start, noise, model)
    expected, covariances, predicted = textbook_filter(series, start, noise, model)
    adjoint = (np.zeros(9), np.zeros((1, cov.BLOCKS)))
    smooth_backward(series, True, 0.0, row, np.zeros((1, 9)), prior, noise, model, NO_PATH, states, errors, blocks, *adjoint)
    size = 9 if coloured else 6
    q, w, c = expected[-1]
    p = covariances[-1]
    for k in range(len(series.seconds) - 2, -1, -1):
        qp, wp, cp, pp, f = predicted[k + 1]
        gain = covariances[k][:size, :size] @ f[:size, :size].T @ np.linalg.inv(pp[:size, :size])
        dx = gain @ np.r_[rotation_error_b(q, qp), w - wp, c - cp][:size]
        q0, w0, c0 = expected[k]
        q = (Rotation.from_quat(q0) * Rotation.from_rotvec(dx[:3])).as_quat()
        w = w0 + dx[3:6]
        c = c0 + dx[6:] if coloured else c0
        p = covariances[k][:size, :size] + gain @ (p[:size, :size] - pp[:size, :size]) @ gain.T
        std = np.sqrt(np.diag(p))
        # the states differ by the curvature that each leaves out; the covariances are linear algebra and do not
        assert np.abs(rotation_error_b(q, states[k, :4])).max() < 0.05 * std[:3].min()
        assert np.abs(w - states[k, 4:7]).max() < 0.05 * std[3:6].min()
        ours = blocks_to_matrix(blocks[k])[:6, :6]
        assert np.abs((ours - p[:6, :6]) / np.outer(std[:6], std[:6])).max() < 1e-7


def test_chunks_do_not_change_the_result(monkeypatch):
    series, attitude, rate = flight(n=200)
    start = np.r_[attitude[0].as_quat(), rate]
    noise, model = Noise(white=2e-7, coloured=1e-7, coloured_time=300.0), random_walk(1e-6)
    whole = _smooth_once(series, start, noise, model, NO_PATH)
    monkeypatch.setattr("fieldline.estimation.smoothing.CHUNK", 37)
    pieces = _smooth_once(series, start, noise, model, NO_PATH)
    assert np.array_equal(whole.q_bi, pieces.q_bi)
    assert np.array_equal(whole.attitude_covariance_b, pieces.attitude_covariance_b)
    assert np.isclose(whole.log_likelihood, pieces.log_likelihood, rtol=1e-12)


def test_chunks_do_not_change_a_pass_about_a_path(monkeypatch):
    series, attitude, rate = flight(n=200)
    start = np.r_[attitude[0].as_quat(), rate]
    noise, model = Noise(white=2e-7, coloured=1e-7, coloured_time=300.0), random_walk(1e-6)
    path = _smooth_once(series, start, noise, model, NO_PATH).path
    whole = _smooth_once(series, path[0, :7], noise, model, path)
    monkeypatch.setattr("fieldline.estimation.smoothing.CHUNK", 37)
    pieces = _smooth_once(series, path[0, :7], noise, model, path)
    assert np.array_equal(whole.q_bi, pieces.q_bi)
    assert np.array_equal(whole.attitude_covariance_b, pieces.attitude_covariance_b)


def truth_path(attitude, rate):
    """What `smooth` takes as the path to linearise about, from the truth."""
    n = len(attitude)
    return SimpleNamespace(path=np.hstack([attitude.as_quat(), np.tile(rate, (n, 1)), np.zeros((n, 3))]))


def test_running_backwards_finds_the_same_motion():
    series, attitude, rate = flight(noise=0.0)
    back = part(series, slice(None, None, -1))
    start = np.r_[attitude[-1].as_quat(), rate]
    result = smooth(back, start, Noise(white=1e-8), random_walk(1e-9), about=truth_path(attitude[::-1], rate))
    assert np.degrees(np.abs(rotation_error_b(attitude.as_quat()[::-1], result.q_bi)).max()) < 1e-6


def test_innovations_are_white_and_of_unit_size_when_the_model_holds():
    series, attitude, rate = flight(n=3000, noise=2e-7, seed=3)
    white, total = innovations(series, np.r_[attitude[0].as_quat(), rate], Noise(white=2e-7), random_walk(1e-9))
    rows = white[np.isfinite(white).all(axis=1)][50:]
    assert np.isfinite(total)
    # 3 n squares of unit variance: 4 sigma of their mean
    assert abs((rows**2).mean() - 1.0) < 4 * np.sqrt(2 / rows.size)
    assert abs((rows[1:] * rows[:-1]).mean()) < 4 / np.sqrt(rows.size)


def test_a_spike_moves_the_state_no_more_than_the_gate_allows():
    series, attitude, rate = flight(n=400)
    start, noise, model = np.r_[attitude[0].as_quat(), rate], Noise(white=2e-7), random_walk(1e-7)
    clean = smooth(series, start, noise, model)
    spoiled = series._replace(field_b=series.field_b.copy())
    spoiled.field_b[200] += 1e-3
    moved = smooth(spoiled, start, noise, model)
    shift = np.linalg.norm(rotation_error_b(clean.q_bi, moved.q_bi), axis=1).max()
    assert shift < 3 * np.sqrt(np.trace(clean.attitude_covariance_b[200]))


def test_passes_about_the_path_before_settle_where_one_pass_has_not():
    """From a start turned by 30 deg about the field one pass stays many of its own sigma off; the iterated ones do not."""
    series, attitude, rate = flight(n=150, seed=4)
    about_field = series.field_b[0] / np.linalg.norm(series.field_b[0])
    turned = (attitude[0] * Rotation.from_rotvec(np.radians(30.0) * about_field)).as_quat()
    start, noise, model = np.r_[turned, rate], Noise(white=2e-7), random_walk(1e-8)
    once, often = (smooth(series, start, noise, model, passes) for passes in (1, 6))

    def square(result):
        error = rotation_error_b(attitude[75].as_quat(), result.q_bi[75])
        return error @ np.linalg.solve(result.attitude_covariance_b[75], error)

    assert square(once) > 100.0
    assert square(often) < 16.3  # 99.9 % of chi-square with 3 degrees of freedom


def test_smoothed_errors_agree_with_their_covariance():
    """NEES over 40 flights: the mean of 3 n chi-squares within its 99.9 % band at one row of each."""
    nees = []
    for seed in range(40):
        series, attitude, rate = flight(n=150, seed=seed)
        start, truth = np.r_[attitude[0].as_quat(), rate], truth_path(attitude, rate)
        result = smooth(series, start, Noise(white=2e-7), random_walk(1e-8), about=truth)
        error = rotation_error_b(attitude[75].as_quat(), result.q_bi[75])
        nees.append(error @ np.linalg.solve(result.attitude_covariance_b[75], error))
    assert abs(np.mean(nees) / 3 - 1) < 3.3 * np.sqrt(2 / (3 * 40))
