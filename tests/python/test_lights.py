"""Lights by name, wherever a wavelength is asked for."""

import json

import numpy as np
import pytest

import holotrace as ht


def test_the_list_is_the_one_of_the_program(program):
    listed = json.loads(program("info", "--lights", "--json"))["lights"]
    assert ht.Light.names() == [one["name"] for one in listed]
    for one in listed:
        light = ht.Light(one["name"])
        assert (light.wavelength, light.bandwidth, light.source) == (
            one["wavelength_m"], one["bandwidth_m"], one["source"])


def test_names_stand_for_wavelengths():
    array = np.ones((4, 5), np.complex64)
    assert repr(ht.Light("he-ne")) == "Light('HeNe', wavelength=632.8 nm)"
    assert ht.Field(array, pitch="8 um", wavelength="HeNe").wavelength == 632.8e-9
    cube = [{"type": "wireframe_cube", "size": "1 mm", "position": "0 0 -100 mm"}]
    assert ht.Scene(wavelength="HeNe, DPSS 532, 450 nm", object=cube).wavelengths == [632.8e-9, 532e-9, 450e-9]
    assert ht.Scene(wavelength=["HeNe", 532e-9], object=cube).replace(wavelength=["Ruby"]).wavelengths == [694.3e-9]
    assert ht.limits("pluto", wavelength="HeNe, DPSS 532") == ht.limits("pluto", wavelength=(632.8e-9, 532e-9))
    hologram = ht.Hologram(np.zeros((4, 5), int), pitch="8 um", wavelength="DPSS 532")
    shown = ht.show(hologram, wavelength="HeNe")
    assert shown.wavelength == 632.8e-9


def test_only_wavelengths_take_them_and_unknown_ones_are_refused():
    array = np.ones((4, 5), np.complex64)
    with pytest.raises(ht.Error, match=r'or a known light \(did you mean "HeNe"\?\), got "HeNi" for "wavelength"'):
        ht.Field(array, pitch="8 um", wavelength="HeNi")
    with pytest.raises(ht.Error, match='expected a length with its unit, such as "8 um", got "HeNe" for "pitch"'):
        ht.Field(array, pitch="HeNe", wavelength="HeNe")
    with pytest.raises(ht.Error, match='got "HeNe" for "distance"'):
        ht.propagate(ht.Field(array, pitch="8 um", wavelength="HeNe"), distance="HeNe")
    with pytest.raises(ht.Error, match="did you mean"):
        ht.Light("HeNi")
