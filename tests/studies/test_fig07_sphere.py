"""The study of the sphere's centre: what its rows are made of."""

from studies import fig07_sphere


def test_laws_of_contacts_heat_the_centre_too_early():
    row = fig07_sphere.run("dem", law="calibrated", particles=500, seed=99)
    # Wall temperatures act in centres, a radius inside of a sphere of some five: found 8.7 K; exact is 182.
    assert 3.0 < row["error_10s"] < 17.0
    assert 0.6 < row["calibration"] < 0.9
