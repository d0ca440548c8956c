"""What a newcomer writes first, and what the package says to it."""

import numpy as np
import pytest

import holotrace as ht

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"
SMALL = {"columns": 96, "rows": 54}
TARGET = dict(wavelength="532 nm", target_distances="50 mm", method="gerchberg-saxton", iterations=1)
LIT = dict(wavelength="532 nm", slm=SMALL, background=1,
           object=[{"type": "sphere", "size": "0.3 mm", "position": "0 0 -20 mm", "segments": 8}])


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "square.obj"
    path.write_text(SQUARE)
    return path


def test_a_model_is_placed_for_the_panel_that_is_given(model):
    panel = ht.Slm("pluto", columns=480, rows=270)
    distance = ht.run(ht.load_scene(model, slm=panel, floor="none"), encode={"iterations": 1}, render={"paths": 1},
                      progress=False).report["chosen"]
    assert ht.load_scene(model, slm=panel).slm.columns == 480
    # 19.5 panel widths of 480 * 8 um are 75 mm; for pluto they would be 300 mm.
    millimetres = [float(one["value"].split()[0]) for one in distance if one["parameter"] == "camera.distances"]
    assert all(60 < one < 90 for one in millimetres)


def test_a_model_takes_its_parameters_by_name(model):
    pictures = [ht.render(ht.load_scene(model, slm=SMALL, floor="none", **given), rows=24, columns=24, paths=1)
                for given in ({}, {"fit": 0.2}, {"edits": {"fit": "0.2"}})]
    lit = [float(np.mean(np.asarray(one) > 0)) for one in pictures]
    assert lit[1] == lit[2] < lit[0]
    scene = model.parent / "scene.toml"
    scene.write_text('wavelength = "532 nm"\nbackground = 1\n[[object]]\ntype = "sphere"\nsize = "1 mm"\nposition = "0 0 -1 m"\n')
    with pytest.raises(ht.Error, match="expected up with a model, got the scene"):
        ht.load_scene(scene, up="z")


def test_another_panel_for_a_placed_model_is_a_warning(model):
    scene = ht.load_scene(model)
    with pytest.warns(ht.ResultWarning, match=r"stays where it was placed .*ht.load_scene\(path, slm=...\)"):
        assert scene.replace(slm={"preset": "pluto", "columns": 480, "rows": 270}).slm.columns == 480


def test_a_dict_is_a_panel():
    assert ht.Scene(**LIT).replace(slm={"columns": 48, "rows": 27}).slm.shape == (27, 48)
    assert ht.encode(np.ones((54, 96)), SMALL, **TARGET).slm.pitch == ht.Scene(**LIT).slm.pitch
    with pytest.raises(ht.Error, match="expected a panel: an Slm, its name, a file or a dict, got int"):
        ht.encode(np.ones((54, 96)), 5, **TARGET)


def test_millimetres_without_a_unit_are_an_error(points):
    hologram = ht.encode(ht.synthesize(points, SMALL), SMALL)
    for name in ("pupil", "width", "pixel"):
        with pytest.raises(ht.Error, match=f'expected metres for "{name}", got 3; write "3 mm"'):
            ht.view(hologram, distances="100 mm", **{name: 3})
    with pytest.raises(ht.Error, match='expected metres for "positions", got 100'):
        ht.Sources([[0, 0, -100]], wavelength="532 nm")
    with pytest.raises(ht.Error, match='expected metres for "points", got 100'):
        ht.Scene(object=[{"type": "points", "points": [[0, 0, -100]]}])
    with pytest.raises(ht.Error, match='expected metres for "position", got -200; write "-200 mm"'):
        ht.Scene(object=[{"type": "sphere", "size": "3 mm", "position": (0, 0, -200)}])


def test_an_eye_without_a_pupil_is_a_warning(points):
    hologram = ht.encode(ht.synthesize(points, SMALL), SMALL)
    with pytest.warns(ht.ResultWarning, match='the eye has no effect without a pupil; give its diameter'):
        ht.view(hologram, distances="100 mm", eye="5 3 250 mm")


def test_a_scene_without_light_is_a_warning():
    dark = ht.Scene(**{**LIT, "background": 0})
    with pytest.warns(ht.ResultWarning, match="the scene has no light: add"):
        ht.render(dark, rows=8, columns=8, paths=1)
    assert not any("no light" in one for one in ht.Scene(**LIT).warnings)


def test_a_film_may_be_of_functions_that_give_tables():
    runs = list(ht.animate(lambda time: LIT, fps=2, seconds=1, stages={"encode": {"iterations": 1}, "render": {"paths": 1}}))
    assert [one.time for one in runs] == [0, 0.5]
    with pytest.raises(ht.Error, match="expected a Scene, or its tables, at 0 s, got int"):
        ht.animate(lambda time: 3, fps=2, seconds=1)


def test_a_film_of_views(tmp_path):
    picture = ht.Image(np.ones((8, 8)))
    with pytest.raises(ht.Error, match=r"expected one picture for each moment of the film, got a list of views; take"):
        ht.save_film(tmp_path / "f.gif", [[picture]])


def test_whatever_is_an_array_is_a_target_picture():
    class Wrapped:
        def __array__(self, dtype=None, copy=None):
            return np.eye(54, 96)

    made = [ht.encode(one, SMALL, **TARGET).level for one in (np.eye(54, 96), np.eye(54, 96).tolist(), Wrapped())]
    assert np.array_equal(made[0], made[1]) and np.array_equal(made[0], made[2])


def test_errors_say_what_to_write_instead():
    for call, words in (
        (lambda: ht.encode("x.png", SMALL, **TARGET), r"read it with ht.load_image\('x.png'\)"),
        (lambda: ht.encode(np.ones((54, 96), np.uint8), SMALL, **TARGET), r"give array.astype\(float\), or read a picture"),
        (lambda: ht.encode(np.ones((27, 48)), SMALL, **TARGET), "in Python resample=True"),
        (lambda: ht.encode(np.full((54, 96), -0.5), SMALL, **TARGET), "got -0.5 at row 0, column 0"),
        (lambda: ht.run(LIT), r"make one with ht.Scene\(tables\)"),
        (lambda: ht.Scene("model.glb"), r"read it with ht.load_scene\('model.glb'\)"),
        (lambda: ht.Scene(object={"type": "sphere"}), 'expected a list of dicts'),
    ):
        with pytest.raises(ht.Error, match=words):
            call()


def test_one_hologram_is_enough_for_the_panels_files(points, tmp_path):
    hologram = ht.encode(ht.synthesize(points, SMALL), SMALL)
    assert ht.save_panel_images(hologram, tmp_path / "p.bmp") == [str(tmp_path / "p.bmp")]
