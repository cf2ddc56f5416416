"""Every bad file gives a message that says what is wrong and what to do, or a usable result; never a traceback."""

import gzip
from importlib.resources import files

import numpy as np
import pytest

from fieldline.errors import InputError
from fieldline.telemetry import read_telemetry

SAMPLE = files("fieldline") / "data" / "suchai3_2023-08-24.csv"
LINES = SAMPLE.read_text().splitlines()[:400]


def write(tmp_path, lines, name="flight.csv"):
    path = tmp_path / name
    path.write_text("\n".join(lines) + "\n")
    return path


def with_cell(row, column, text):
    lines = list(LINES)
    cells = lines[row].split(",")
    cells[column] = text
    lines[row] = ",".join(cells)
    return lines


def refuse(path, words, **options):
    with pytest.raises(InputError, match=words) as caught:
        read_telemetry(path, **options)
    assert "Traceback" not in str(caught.value)
    assert len(str(caught.value)) < 1500


def test_the_sample_itself():
    telemetry = read_telemetry(SAMPLE)
    assert (len(telemetry), telemetry.quality.gaps, telemetry.quality.missing_s) == (5586, 5, 14.0)
    assert telemetry.usable.all()
    assert sorted(telemetry.sun_sensor) == ["-x", "-y", "-z"]
    assert np.degrees(np.median(telemetry.rate_b[:, 1])) == pytest.approx(-45.35, abs=0.1)
    assert telemetry.median_step_s == 1.0


def test_missing_file_and_folder(tmp_path):
    refuse(tmp_path / "no.csv", "does not exist")
    refuse(tmp_path, "is a folder")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "is empty"),
        (b"\n\n\n", "no table"),
        (b"# only a comment\n", "no table"),
        (bytes(range(256)) * 40, "binary"),
        (b"\x00" * 100, "binary"),
        (b"PK\x03\x04 a spreadsheet", "export the sheet as CSV"),
        (b"PAR1 and nothing", "Parquet"),
        (b"\x89HDF\r\n\x1a\n and nothing", "NetCDF"),
        (b"CDF\x01 and nothing", "NetCDF"),
        (b"\xcd\xf3\x00\x01\x00\x00\xff\xff and nothing", "CDF"),
        (gzip.compress(b"unix_s,mag_x_nT\n", mtime=0)[:-6], "damaged"),
        (b"just a sentence without any table", "time column|no samples"),
        (LINES[0].encode(), "no samples"),
        (b"<!DOCTYPE html><html></html>\n", "web page"),
        (b'[{"time": 1}]\n', "JSON"),
        (b"1 52191U 22033AL  23236.44460393  .00026275  00000+0  73805-3 0  9994\n2 52191 ...\n", "TLE; give it as --orbit"),
        (b"SUCHAI-3\n1 52191U 22033AL  23236.44460393  .00026275  00000+0\n", "TLE; give it as --orbit"),
        (b"CCSDS_OEM_VERS = 2.0\n", "orbit message"),
    ],
)
def test_no_table(tmp_path, content, words):
    path = tmp_path / "flight.csv"
    path.write_bytes(content)
    refuse(path, words)


def test_a_missing_axis(tmp_path):
    lines = [",".join(line.split(",")[:6]) for line in LINES]
    refuse(write(tmp_path, lines), "no z axis.*--mag-columns")


def test_text_in_a_number_is_named_or_dropped(tmp_path):
    path = write(tmp_path, with_cell(100, 5, "ERROR"))
    refuse(path, 'line 101, column "mag_y_nT": "ERROR" is not a number.*repair')
    telemetry = read_telemetry(path, repair=True)
    assert (len(telemetry), telemetry.quality.unreadable) == (398, 1)


def test_a_line_that_is_cut(tmp_path):
    path = write(tmp_path, [*LINES[:-1], LINES[-1][:25]])
    refuse(path, "line 400: .* columns where the header has 10")
    assert len(read_telemetry(path, repair=True)) == 398


def test_mixed_units(tmp_path):
    lines = [LINES[0].replace("mag_z_nT", "mag_z_uT"), *LINES[1:]]
    refuse(write(tmp_path, lines), "different units: .*mag_z_uT in uT")


def test_mixed_units_that_no_name_tells(tmp_path):
    rows = []
    for line in LINES[1:]:
        cells = line.split(",")
        cells[6] = f"{float(cells[6]) * 1e-3:.6g}"
        rows.append(",".join(cells))
    refuse(write(tmp_path, [LINES[0], *rows]), "mag_z_nT reads .* times less than mag_x_nT. Is it in another unit")


def test_units_that_change_from_row_to_row(tmp_path):
    rows = list(LINES[1:])
    for k in range(150, 250):
        cells = rows[k].split(",")
        rows[k] = ",".join([*cells[:4], *(f"{float(cell) * 1e-3:.6g}" for cell in cells[4:7]), *cells[7:]])
    refuse(write(tmp_path, [LINES[0], *rows]), "times less in 100 of 399 rows .* at row 151. Two units in one file")


def test_fill_values_are_no_second_unit(tmp_path):
    rows = list(LINES[1:])
    for k in range(100, 160):
        cells = rows[k].split(",")
        rows[k] = ",".join([*cells[:4], "-999", "-999", "-999", *cells[7:]])
    assert read_telemetry(write(tmp_path, [LINES[0], *rows])).usable.sum() <= 339


def test_a_clock_coarser_than_the_sampling(tmp_path):
    rows = [",".join([str(1692888249 + k // 4), *line.split(",")[1:]]) for k, line in enumerate(LINES[1:])]
    refuse(write(tmp_path, [LINES[0], *rows]), "coarser than the sampling")


@pytest.mark.parametrize(
    ("name", "scale", "words"),
    [
        ("mag_{}_mG", 1.0, "cannot be a field in low orbit.*--unit nT"),
        ("mag_{}_nT", 0.01, "cannot be a field in low orbit.*--unit mG"),
        ("mag_{}", 1.0, "do not say their unit.*nT"),
        ("mag_{}", 0.01, "do not say their unit.*mG"),
        ("mag_{}", 0.001, "do not say their unit.*uT"),
        ("mag_{}", 1e-9, "do not say their unit.*T"),
        ("mag_{}_counts", 0.065, "do not say their unit"),
        ("mag_{}_T", 1.0, "cannot be a field.*nT"),
    ],
)
def test_a_wrong_or_missing_unit_is_a_question(tmp_path, name, scale, words):
    header = LINES[0]
    for axis in "xyz":
        header = header.replace(f"mag_{axis}_nT", name.format(axis))
    rows = []
    for line in LINES[1:]:
        cells = line.split(",")
        cells[4:7] = [f"{float(cell) * scale:.12g}" for cell in cells[4:7]]
        rows.append(",".join(cells))
    path = write(tmp_path, [header, *rows])
    refuse(path, words)
    told = read_telemetry(path, unit=f"{1.0 / scale:.12g} nT")
    np.testing.assert_allclose(told.field_s, read_telemetry(write(tmp_path, LINES, "right.csv")).field_s, rtol=1e-9)


def test_a_unit_that_the_user_insists_on_is_kept_and_said(tmp_path):
    telemetry = read_telemetry(write(tmp_path, LINES), unit="mG")
    assert any("kept as you stated" in line for line in telemetry.quality.sentences())


def test_local_time(tmp_path):
    refuse(write(tmp_path, [LINES[0].replace("unix_s", "local_time"), *LINES[1:]]), "local time")


def test_repeated_and_unordered_stamps(tmp_path):
    repeated = write(tmp_path, [*LINES[:51], LINES[50], *LINES[51:]])
    refuse(repeated, r"row 51 \(line 52 of the file\).*repeats.*repair")
    telemetry = read_telemetry(repeated, repair=True)
    assert (len(telemetry), telemetry.quality.repeated) == (399, 1)
    unordered = write(tmp_path, [*LINES[:20], LINES[30], *LINES[20:30], *LINES[31:]])
    refuse(unordered, "is before")
    telemetry = read_telemetry(unordered, repair=True)
    assert (len(telemetry), telemetry.quality.unordered) == (399, 1)
    straight = read_telemetry(write(tmp_path, LINES))
    assert np.array_equal(telemetry.field_s, straight.field_s)
    assert any("out of order" in line for line in telemetry.quality.sentences())


def test_an_empty_time(tmp_path):
    path = write(tmp_path, with_cell(7, 0, ""))
    refuse(path, r"row 7 \(line 8.*is empty")
    assert len(read_telemetry(path, repair=True)) == 398


@pytest.mark.parametrize("count", [2, 3, 10])
def test_a_few_samples_are_read(tmp_path, count):
    assert len(read_telemetry(write(tmp_path, LINES[: count + 1]))) == count


def test_one_sample(tmp_path):
    refuse(write(tmp_path, LINES[:2]), "at least two|never change")


def test_constant_dead_and_empty_fields(tmp_path):
    def with_field(make):
        rows = []
        for line in LINES[1:]:
            cells = line.split(",")
            cells[4:7] = make(cells[4:7])
            rows.append(",".join(cells))
        return write(tmp_path, [LINES[0], *rows])

    refuse(with_field(lambda _: ["30000", "10000", "-5000"]), "never change")
    refuse(with_field(lambda cells: ["30000", *cells[1:]]), '"?mag_x_nT"? never changes')
    refuse(with_field(lambda _: ["nan", "nan", "nan"]), "no sample with three finite")
    refuse(with_field(lambda _: ["", "", ""]), "no sample with three finite")
    refuse(with_field(lambda cells: ["inf", *cells[1:]]), "no sample with three finite")


def test_nan_is_counted_and_not_used(tmp_path):
    telemetry = read_telemetry(write(tmp_path, with_cell(9, 4, "NaN")))
    assert telemetry.quality.nan == 1
    assert list(np.flatnonzero(~telemetry.usable)) == [8]
    assert telemetry.quality.usable == 398


def test_two_magnetometers_are_a_question(tmp_path):
    header = LINES[0] + ",mag2_x_nT,mag2_y_nT,mag2_z_nT"
    path = write(tmp_path, [header, *(f"{line},1,2,3" for line in LINES[1:])])
    refuse(path, "2 magnetometers.*--mag-columns mag_x_nT,mag_y_nT,mag_z_nT; --mag-columns mag2_x_nT")
    assert len(read_telemetry(path, mag_columns=("mag_x_nT", "mag_y_nT", "mag_z_nT"))) == 399


def test_optional_columns_in_doubt_are_left_out_and_said(tmp_path):
    header = LINES[0].replace("gyro_x_dps,gyro_y_dps,gyro_z_dps", "gyro_x,gyro_y,gyro_z")
    telemetry = read_telemetry(write(tmp_path, [header, *LINES[1:]]))
    assert telemetry.rate_b is None
    assert any("gyro without a unit" in line for line in telemetry.describe())
    told = read_telemetry(write(tmp_path, [header, *LINES[1:]]), units={"gyro": "deg/s"})
    assert told.rate_b is not None


def test_inertial_position_without_a_name(tmp_path):
    header = LINES[0].replace("css_mx,css_my,css_mz", "x_eci_km,y_eci_km,z_eci_km")
    telemetry = read_telemetry(write(tmp_path, [header, *LINES[1:]]))
    assert telemetry.position_e is None
    assert any("inertial axes, but not which" in line for line in telemetry.describe())
    refuse(write(tmp_path, [header, *LINES[1:]]), "from the Earth's centre", mapping={"axes": {"position": "GCRS"}})


@pytest.mark.slow
def test_two_million_rows(tmp_path):
    """Read in seconds; memory is what the columns need, a small multiple of 2e6 x 4 float64."""
    import time

    from fieldline.telemetry.delimited import write_rows

    count = 2_000_000
    angle = 0.3 * np.arange(count)
    columns = {
        "unix_s": 1.6e9 + np.arange(count),
        "mag_x_nT": np.round(3e4 * np.cos(angle)),
        "mag_y_nT": np.round(3e4 * np.sin(angle)),
    }
    columns["mag_z_nT"] = np.round(2e4 * np.cos(angle / 50))
    path = tmp_path / "large.csv"
    with open(path, "wb") as sink:
        write_rows(sink, columns)
    start = time.perf_counter()
    telemetry = read_telemetry(path)
    assert len(telemetry) == count
    assert time.perf_counter() - start < 30.0  # 6 s on two cores, with room for a busy machine
