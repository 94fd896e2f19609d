"""Readers: every format gives the same scan, and damage is reported in one line."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clerestory.errors import InputError
from clerestory.gonio.angles import from_degrees
from clerestory.gonio.measurement_files import FORMATS, read_measurement
from clerestory.gonio.scattering_measurement import Measurement, merge_scans

# A scan from θ 30°, φ 20° that leaves at five directions.
THETA = np.array([0.0, 10, 20, 30, 40])
PHI = np.array([0.0, 90, 180, 200, 270])
VALUE = np.array([0.5, 0.4, 0.3, 0.2, 0.1])
LEAVING = from_degrees(THETA, PHI)
SOURCE = from_degrees(30.0, 20.0)


def rows(*columns, separator=" "):
    return "\n".join(
        separator.join(f"{n:g}" for n in row) for row in zip(*columns, strict=True)
    )


def pabopto(theta=THETA, phi=PHI, *, head="", value=VALUE, kind="BRDF"):
    return (
        f'#sample_name "glass"\n#format: theta phi {kind}\n#upphi 90\n{head}\n'
        + rows(theta, phi, value)
        + "\n"
    )


def columns(kind="brdf"):
    n = len(THETA)
    table = rows(np.full(n, 30), np.full(n, 20), THETA, PHI, VALUE, separator=",")
    return f"theta_i,phi_i,theta_s,phi_s,{kind}\n{table}\n"


def viavi():
    return "!!EDS 30-200   RPC\n!!BSDF Data\n30 200\n" + rows(THETA, PHI, VALUE) + "\n"


def fred():
    head = "type bsdf_data\nformat angles=deg bsdf=value scale=1\n30 200\n"
    return head + rows(THETA, PHI, VALUE) + "\n"


def astm():
    n = len(THETA)
    angles = np.radians([np.full(n, 30), np.full(n, 20), THETA, PHI])
    table = rows(*np.round(angles, 9), VALUE, separator=",")
    return f"TITLE glass\nVARS theta_i,phi_i,theta_s,phi_s,BRDF\n{table}\n"


def write(tmp_path, text, name="scan.txt"):
    path = tmp_path / name
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    "text",
    [pabopto(head="#incident_angle 30 20"), columns(), viavi(), fred(), astm()],
    ids=["pabopto", "columns", "viavi", "fred", "astm"],
)
def test_every_format_gives_the_same_scan(tmp_path, text):
    (measurement,) = read_measurement(write(tmp_path, text))
    (scan,) = measurement.scans
    assert scan.incident == pytest.approx(SOURCE, abs=1e-5)
    assert scan.leaving == pytest.approx(LEAVING, abs=1e-4)
    assert scan.values == pytest.approx(VALUE)


@pytest.mark.parametrize(
    ("theta_in", "theta_out", "function"),
    [
        (150, THETA, "transmission_front"),
        (150, 180 - THETA, "reflection_front"),
        (30, THETA, "reflection_back"),
        (30, 180 - THETA, "transmission_back"),
    ],
)
def test_angles_of_pabopto_files_determine_the_function(
    tmp_path, theta_in, theta_out, function
):
    """The sample's normal faces the room: θ below 90° is the room."""
    text = pabopto(theta_out, head=f"#intheta {theta_in}\n#inphi 20")
    (measurement,) = read_measurement(write(tmp_path, text))
    assert measurement.function == function
    assert measurement.name == "glass"
    assert measurement.scans[0].incident == pytest.approx(SOURCE, abs=1e-9)
    assert measurement.scans[0].leaving == pytest.approx(LEAVING, abs=1e-9)


def test_a_sample_that_faces_the_sky_is_turned_about_its_up_axis(tmp_path):
    text = pabopto(180 - THETA, head="#incident_angle 30 20")
    (measurement,) = read_measurement(write(tmp_path, text), facing="sky")
    assert measurement.function == "transmission_front"
    mirror = np.array([-1, 1, 1.0])
    assert measurement.scans[0].incident == pytest.approx(SOURCE * mirror, abs=1e-9)
    assert measurement.scans[0].leaving == pytest.approx(LEAVING * mirror, abs=1e-9)


def test_up_is_at_phi_zero_if_the_file_does_not_say(tmp_path):
    text = pabopto(head="#incident_angle 30 20").replace("#upphi 90\n", "")
    (measurement,) = read_measurement(write(tmp_path, text))
    assert measurement.scans[0].phi_deg == pytest.approx(110)


def test_dsf_is_bsdf_times_the_cosine(tmp_path):
    text = pabopto(
        head="#incident_angle 30 20",
        kind="DSF",
        value=VALUE * np.cos(np.radians(THETA)),
    )
    (measurement,) = read_measurement(write(tmp_path, text))
    assert measurement.scans[0].values == pytest.approx(VALUE, rel=1e-5)


def test_tristimulus_files_give_three_channels(tmp_path):
    head = "#incident_angle 30 20\n#format: theta phi BRDF\n#colorimetry: CIE-XYZ\n"
    text = head + rows(THETA, PHI, 0.9 * VALUE, VALUE, 0.8 * VALUE)
    found = {m.channel: m for m in read_measurement(write(tmp_path, text))}
    assert set(found) == {"cie-x", "visible", "cie-z"}
    assert found["visible"].scans[0].values == pytest.approx(VALUE)


def test_tabular_files_are_given_about_the_mirrored_direction(tmp_path):
    """Radius 30° at azimuth 0 from a mirror at 30° is the normal."""
    text = (
        "Source Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\n"
        "ScatterType BRDF\nSampleRotation 1\n0\nAngleOfIncidence 1\n30\n"
        "ScatterAzimuth 3\n0 90 180\nScatterRadial 3\n0 10 30\n\nMonochrome\n"
        "DataBegin\nTIS 0.1\n5 4 3\n5 2 1\n5 0.5 0.2\nDataEnd\n"
    )
    (measurement,) = read_measurement(write(tmp_path, text, "a.bsdf"))
    (scan,) = measurement.scans
    assert measurement.claimed == "isotropic"
    assert scan.incident == pytest.approx(from_degrees(30.0, 180.0), abs=1e-9)
    values = {
        tuple(np.round(d, 6)): v for d, v in zip(scan.leaving, scan.values, strict=True)
    }
    assert values[tuple(np.round(from_degrees(30.0, 0.0), 6))] == 5
    assert values[0.0, 0.0, 1.0] == 3
    assert values[tuple(np.round(from_degrees(40.0, 0.0), 6))] == 0.5
    # Azimuth 90 and its mirror image
    sides = [d for d, v in values.items() if v == 2]
    assert len(sides) == 2
    assert sides[0][1] == pytest.approx(-sides[1][1])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (pabopto(), "no incident direction"),
        (pabopto(head="#intheta x"), "scan.txt:4: 'x'; an angle"),
        (
            pabopto(head="#incident_angle 30 20", kind="XYZ"),
            "one of DSF, BSDF, BRDF, BTDF",
        ),
        (pabopto(PHI, THETA, head="#incident_angle 30 20"), "swapped"),
        (
            pabopto(head="#incident_angle 30 20", value=0 * VALUE),
            "no value is above zero",
        ),
        (pabopto(head="#incident_angle 30 20").replace("0.3", "nan"), ":7: 'nan'"),
        (
            pabopto(head="#incident_angle 30 20").replace("0.3", "0.3 1"),
            "is 4; 3 expected",
        ),
        ("#incident_angle 30 20\n#format: theta phi BSDF\n", "no data"),
        (columns("watts"), "theta_i, phi_i, theta_s"),
        (columns().replace(",40,", ",140,"), "swapped"),
        (viavi().replace("30 200", "30"), "scan.txt:3: number of columns is 1; 2"),
        (fred().replace("30 200\n", ""), "no incident direction"),
        (fred().replace("angles=deg", "angles=rad"), "angles is 'rad'"),
        (astm().replace(",BRDF", ""), "4 columns; four angles and one or more values"),
        ("hello\nworld\n", "not a goniophotometer file"),
        ("", "not a goniophotometer file"),
    ],
)
def test_damage_is_reported_in_one_line(tmp_path, text, words):
    path = write(tmp_path, text)
    with pytest.raises(InputError) as error:
        read_measurement(path)
    message = str(error.value)
    assert words in message
    assert message.startswith(str(path))
    assert "\n" not in message


def test_a_direction_given_twice_is_refused_unless_merged(tmp_path):
    head = "#incident_angle 30 20"
    paths = [
        write(tmp_path, pabopto(head=head), "a.txt"),
        write(tmp_path, pabopto(head=head), "b.txt"),
    ]
    with pytest.raises(InputError, match=r"b\.txt.*also measured in .*a\.txt"):
        read_measurement(*paths)
    (measurement,) = read_measurement(*paths, merge=True)
    assert len(measurement.scans[0].values) == 2 * len(VALUE)


def test_merging_keeps_other_directions_apart(tmp_path):
    one = read_measurement(write(tmp_path, pabopto(head="#incident_angle 30 20")))[0]
    two = read_measurement(write(tmp_path, pabopto(head="#incident_angle 40 20")))[0]
    merged = merge_scans([*one.scans, *two.scans, *one.scans])
    assert [len(scan.values) for scan in merged] == [10, 5]
    with pytest.raises(InputError, match="one scan per direction"):
        Measurement(one.scans + one.scans, "reflection_front")


@settings(
    max_examples=150,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(st.sampled_from([None, *FORMATS]), st.binary(max_size=200), st.integers(0, 6))
def test_random_bytes_are_refused_in_one_line(tmp_path, form, noise, start):
    texts = [columns(), viavi(), fred(), astm(), pabopto(head="#incident_angle 3 4")]
    head = texts[start].encode()[:60] if start < len(texts) else b""
    path = tmp_path / "noise"
    path.write_bytes(head + noise)
    try:
        measurements = read_measurement(path, form=form)
    except InputError as error:
        refusal = str(error)
        measurements = ()
    else:
        refusal = ""
    assert "\n" not in refusal
    assert all(len(m.scans) for m in measurements)


def test_the_virtual_instruments_files_come_back(tmp_path):
    from goniometer import Goniophotometer, film, write_pabopto

    directions = from_degrees(np.array([0.0, 30, 50]), np.array([0.0, 20, 70]))
    measurement = Goniophotometer(points=60).measure(film, directions)
    (found,) = read_measurement(*write_pabopto(measurement, tmp_path))
    assert found.function == "transmission_front"
    for one, other in zip(found.scans, measurement.scans, strict=True):
        assert one.incident == pytest.approx(other.incident, abs=2e-6)
        assert one.leaving == pytest.approx(other.leaving, abs=2e-6)
        assert one.values == pytest.approx(other.values, rel=1e-5)
