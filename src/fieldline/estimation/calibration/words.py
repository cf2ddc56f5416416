"""The calibration in sentences."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fieldline.estimation.calibration.record import Calibration

POOR = 0.15  # of the field: three degrees already take 0.05


def with_sentences(found: Calibration, error_tesla: float, field_tesla: float, asked: str) -> Calibration:
    """The record with its verdict in words; `error_tesla` is the RMS uncertainty of the calibrated field per axis."""
    lines = [_result(found)]
    if asked == "auto":
        chosen = next(c for c in found.candidates if c.chosen)
        lines.append(f"Chosen by the data: it {chosen.why}." if found.fitted else "The data support no term of a calibration.")
    if asked == "none":
        lines.append("Its parameters are taken as exact, as asked for.")
    else:
        lines.append(
            f"Its parameters leave the field uncertain by {error_tesla * 1e9:.0f} nT per axis "
            f"({error_tesla / field_tesla:.1%} of the field)."
        )
    if error_tesla > POOR * field_tesla:
        lines.append("The readings leave directions unseen: a longer arc, or one on which the satellite turns, is needed.")
    return replace(found, sentences=tuple(lines))


def _result(found: Calibration) -> str:
    """Bias and residual."""
    rms = f"residual {found.residual_rms_tesla * 1e9:.0f} nT RMS over {found.samples} samples"
    if found.outliers:
        rms += f" ({found.outliers} outliers aside)"
    if not found.fitted:
        return f'Calibration "{found.model}": nothing fitted, {rms}.'
    pairs = ", ".join(f"{b * 1e6:.2f} ± {s * 1e6:.2f}" for b, s in zip(found.bias_s, found.bias_std_s, strict=True))
    gain = ""
    if found.terms.sunlit:
        step = found.values[found.terms.layout["sunlit"]]
        gain = ", in sunlight (" + ", ".join(f"{s * 1e6:+.2f}" for s in step) + ") µT more"
    if found.terms.gain != "none":
        gain += f", gain {np.min(found.gain_values):.3f} to {np.max(found.gain_values):.3f}"
    return f'Calibration "{found.model}": bias ({pairs}) µT{gain}, {rms}.'
