"""Attitude as a CCSDS Attitude Ephemeris Message (AEM), KVN, version 1.0.

Each line is a time and q1 q2 q3 qc, scalar last, of the rotation from frame A (GCRF) to frame B (the body):

    v_b = M(q) v_a,   M = | q1^2-q2^2-q3^2+qc^2   2 (q1 q2 + q3 qc)      2 (q1 q3 - q2 qc)    |
                          | 2 (q1 q2 - q3 qc)     -q1^2+q2^2-q3^2+qc^2   2 (q2 q3 + q1 qc)    |     (1)
                          | 2 (q1 q3 + q2 qc)     2 (q2 q3 - q1 qc)      -q1^2-q2^2+q3^2+qc^2 |

which is A(q_bi) of `fieldline.frames.attitude`, so the message's quaternion is q_bi itself. Signs are chosen so that
neighbours lie on one side, as readers interpolate between them.

Source: CCSDS 504.0-B-1 (2008), Attitude Data Messages, sections 3.2 and 4.2; version 1.0, as every reader knows it and
it states the direction (ATTITUDE_DIR) and the order (QUATERNION_TYPE), which version 2.0 leaves implied.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fieldline.errors import InputError
from fieldline.files import write_whole
from fieldline.telemetry.delimited import iso_text, write_rows

ORIGINATOR = "FIELDLINE"
IN_ASCII = str.maketrans({"°": " deg", "σ": " sigma", "µ": "u", "μ": "u", "−": "-", "·": ",", "±": "+-", "…": "..."})


def write_attitude_aem(dataset, path: str | Path, *, object_name: str = "", object_id: str = "") -> Path:
    """Write the attitude of `dataset` (of `estimate_attitude`) to `path`: whole or not at all.

    object_name, object_id : as the message wants them, the latter as 2022-033AL; by default the Dataset's attributes of
    these names, else UNKNOWN. Samples without a finite quaternion are left out.
    """
    if "q_bi" not in dataset.variables:
        raise InputError("the Dataset has no q_bi; an AEM is written from the Dataset of estimate_attitude.")
    q_bi = dataset["q_bi"].values
    good = np.isfinite(q_bi).all(axis=1)
    if not good.any():
        raise InputError("no sample of the Dataset has a finite quaternion; there is no attitude to write.")
    time_utc = dataset["time"].values[good]
    stamps = iso_text(time_utc, zone="")
    head = _head(
        object_name or str(dataset.attrs.get("object_name", "UNKNOWN")),
        object_id or str(dataset.attrs.get("object_id", "UNKNOWN")),
        stamps,
        str(dataset.attrs.get("verdict", "")),
    )
    q_bi = np.round(one_sided(q_bi[good]), 12)
    columns = {"time": stamps, **{name: q_bi[:, k] for k, name in enumerate(("q1", "q2", "q3", "qc"))}}

    def write(beside: Path) -> None:
        with open(beside, "wb") as sink:
            sink.write(head.encode("ascii", errors="replace"))
            write_rows(sink, columns, delimiter=" ", header=False)
            sink.write(b"DATA_STOP\n")

    return write_whole(path, write)


def one_sided(q: np.ndarray) -> np.ndarray:
    """Quaternions (n, 4) with signs such that each lies on the side of the one before it."""
    sign = np.where(np.sum(q[1:] * q[:-1], axis=1) < 0.0, -1.0, 1.0)
    return q * np.concatenate(([1.0], np.cumprod(sign)))[:, None]


def _head(object_name: str, object_id: str, stamps: np.ndarray, verdict: str) -> str:
    """Header, comments and metadata, up to the first line of data."""
    comments = ["Rotation from GCRF to the magnetometer's axes as the telemetry gives them.", verdict]
    lines = [
        "CCSDS_AEM_VERS = 1.0",
        f"CREATION_DATE = {_now()}",
        f"ORIGINATOR = {ORIGINATOR}",
        "",
        "META_START",
        *(f"COMMENT {' '.join(comment.translate(IN_ASCII).split())[:240]}" for comment in comments if comment),
        f"OBJECT_NAME = {object_name}",
        f"OBJECT_ID = {object_id}",
        "CENTER_NAME = EARTH",
        "REF_FRAME_A = GCRF",
        "REF_FRAME_B = SC_BODY_1",
        "ATTITUDE_DIR = A2B",
        "TIME_SYSTEM = UTC",
        f"START_TIME = {stamps[0]}",
        f"STOP_TIME = {stamps[-1]}",
        "ATTITUDE_TYPE = QUATERNION",
        "QUATERNION_TYPE = LAST",
        "META_STOP",
        "",
        "DATA_START",
    ]
    return "\n".join(lines) + "\n"


def _now() -> str:
    """The present, UTC, to the second."""
    return str(np.datetime64("now", "s"))
