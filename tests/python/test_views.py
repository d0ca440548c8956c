"""view, pictures with depths, stereo pairs and the files of a run: as the program's, bit by bit."""

import json
import pickle

import numpy as np
import pytest

import holotrace as ht
from holotrace import _core
from test_waves import equal

PANEL = dict(columns=64, rows=48, pitch=8e-6)


def hologram_at(wavelength, seed=1, name=""):
    field = ht.Field(np.exp(2j * np.pi * np.random.default_rng(seed).uniform(size=(48, 64))), 8e-6, wavelength, name=name)
    return ht.encode(field, ht.Slm("pluto", columns=64, rows=48))


def same_files(one, other, *, apart_from=()):
    """Both folders hold the same files, byte by byte."""
    names = {path.name for path in one.iterdir()}
    assert names == {path.name for path in other.iterdir()}
    for name in names - set(apart_from):
        assert (one / name).read_bytes() == (other / name).read_bytes(), name
    return names


@pytest.fixture
def folders(tmp_path):
    for name in ("program", "package"):
        (tmp_path / name).mkdir()
    return tmp_path / "program", tmp_path / "package"


def test_view_of_frames_and_colours_is_the_program_bit_by_bit(tmp_path, program, folders):
    """Two frames of green light and one hologram of red: their mean and their colour."""
    holograms = [hologram_at(532e-9, 1), hologram_at(532e-9, 2), hologram_at(638e-9, 3)]
    for number, hologram in enumerate(holograms):
        hologram.save(tmp_path / f"h{number}.png")
    program("show", "h0.png", "h1.png", "h2.png", "--distance", "90 100 mm", "--pupil", "2 mm", "--eye", "0, 0, 200 mm",
            "--subpixels", 3, "-o", "program/v.png", "--report", "report.json")
    views = ht.view(holograms, distances=[0.09, "100 mm"], pupil="2 mm", eye=(0, 0, 0.2), show={"subpixels": 3})
    views.save(folders[1] / "v.png")
    assert same_files(*folders) == {"v.png", "v_2.png"}
    assert len(views.images) == 2 and views.image.channels == 3
    stages = json.loads((tmp_path / "report.json").read_text())["stages"]
    assert [one["stage"] for one in views.report["stages"]] == [one["stage"] for one in stages]


def test_views_are_a_sequence_of_pictures_and_an_array():
    views = ht.view(hologram_at(532e-9), distances="90, 100 mm")
    assert len(views) == 2 and views[0] is views.image and list(views) == views.images
    np.testing.assert_array_equal(np.asarray(views), np.stack([np.asarray(one) for one in views]))
    one = ht.view(hologram_at(532e-9), distances="90 mm")
    np.testing.assert_array_equal(np.asarray(one, dtype=np.float64), np.asarray(one[0]).astype(np.float64))
    assert repr(one) == f"Views({one[0]})"


@pytest.mark.parametrize("name, count", [("v.png", 6), ("v.gif", 1), ("v.webp", 1), ("v_##.png", 3)])
def test_view_of_a_sweep_is_the_program_bit_by_bit(tmp_path, program, folders, name, count):
    """A view, three pictures, their animation and their chart; or the animation or the pictures alone."""
    hologram_at(532e-9).save(tmp_path / "h.png")
    program("show", "h.png", "--distance", "100 mm", "--sweep", "focus", "--sweep-from", "90 mm", "--sweep-to", "110 mm",
            "--sweep-views", 3, "-o", f"program/{name}")
    views = ht.view(ht.load_hologram(tmp_path / "h.png"), distances="100 mm", sweep="focus", sweep_from="90 mm",
                    sweep_to="110 mm", sweep_views=3)
    views.save(folders[1] / name)
    assert len(same_files(*folders)) == count and len(views.sweep) == 3


def test_an_animation_needs_a_sweep(tmp_path):
    with pytest.raises(ht.Error, match="expected a sweep for the animated file .*v.gif, got none"):
        ht.view(hologram_at(532e-9)).save(tmp_path / "v.gif")


def test_a_stereo_pair_is_two_eyes():
    """Each picture is that of an eye half the separation to the left or to the right."""
    hologram = hologram_at(532e-9)
    camera = dict(distances="100 mm", pupil="2 mm")
    pair = ht.view(hologram, eye=(1e-3, 0, 0.2), eye_separation="6 mm", **camera).stereo
    for picture, x in zip(pair, (-2e-3, 4e-3)):
        assert equal(picture.pixels, ht.view(hologram, eye=(x, 0, 0.2), **camera).image.pixels)


def test_a_saved_stereo_pair_is_the_program_bit_by_bit(tmp_path, program, folders):
    """Saved twice: the second time in place of the files that are there, of which none is set aside."""
    hologram_at(532e-9).save(tmp_path / "h.png")
    program("show", "h.png", "--distance", "100 mm", "--pupil", "2 mm", "--eye", "1 mm, 0, 200 mm", "--eye-separation", "6 mm",
            "-o", "program/v.png")
    views = ht.view(ht.load_hologram(tmp_path / "h.png"), distances="100 mm", pupil="2 mm", eye=(1e-3, 0, 0.2), eye_separation=6e-3)
    for _ in range(2):
        views.save(folders[1] / "v.png")
        assert same_files(*folders) == {"v.png", "v_left.png", "v_right.png", "v_anaglyph.png"}


def test_view_without_a_hologram_or_with_another_noun_is_refused(field):
    with pytest.raises(ht.Error, match="expected one hologram or more to view, got none"):
        ht.view([])
    with pytest.raises(ht.Error, match="expected a Hologram to view, got Field"):
        ht.view([field])
    with pytest.raises(ht.Error, match='unknown parameter "subpixel"; did you mean "subpixels"'):
        ht.view(hologram_at(532e-9), show={"subpixel": 3})


def test_a_picture_with_depths_is_the_program_bit_by_bit(tmp_path, program):
    rng = np.random.default_rng(4)
    ht.Image(rng.uniform(size=(20, 30, 3)).astype(np.float32)).save(tmp_path / "p.exr")
    depth = np.where(rng.uniform(size=(20, 30)) < 0.2, 0, rng.uniform(0.195, 0.205, (20, 30))).astype(np.float32)
    ht.Image(depth).save(tmp_path / "d.exr")
    program("field", "p.exr", "--depth", "d.exr", "--slm", "pluto", "--columns", 64, "--rows", 48, "--width", "0.4 mm",
            "--wavelength", "638 nm, 532 nm", "--slices", 3, "--frame", 2, "-o", "f.npy")
    panel = ht.Slm("pluto", columns=64, rows=48)
    image = ht.DepthImage(ht.load_image(tmp_path / "p.exr"), depth)
    assert image.depth.shape == (20, 30) and "depths 195." in repr(image)
    for given in (image, ht.load_depth_image(tmp_path / "p.exr", tmp_path / "d.exr"), pickle.loads(pickle.dumps(image))):
        fields = ht.depth_image_fields(
            given, panel, wavelength="638 nm, 532 nm", width="0.4 mm", synthesize={"slices": 3}, frame=2)
        assert equal(np.stack([one.samples for one in fields]), np.load(tmp_path / "f.npy"))


def test_bad_depths_are_refused():
    picture = np.ones((4, 5), np.float32)
    for depth, message in (
        (np.ones((4, 4)), "4"),
        (np.full((4, 5), np.nan), "expected finite numbers in depths, got NaN"),
        (np.zeros((4, 5)), "expected a pixel with a depth other than 0 m"),
        (np.ones(5), "expected depths of the shape"),
    ):
        with pytest.raises(ht.Error, match=message):
            ht.DepthImage(picture, depth)
    with pytest.raises(ht.Error, match="expected the method layers for a picture with depths, got tiled"):
        ht.depth_image_fields(ht.DepthImage(picture, np.ones((4, 5))), ht.Slm(**PANEL), synthesize={"method": "tiled"})


SCENE = """
wavelength = ["638 nm", "532 nm"]
slm = { preset = "pluto", columns = 48, rows = 36 }
trace = { columns = 16, rows = 16, paths = 2 }
render = { rows = 24, paths = 2, eye = "0, 0, 250 mm", eye_separation = "6 mm" }
camera = { distances = "95 100 mm", pupil = "2 mm", eye = "0, 0, 250 mm", sweep = "parallax", sweep_from = "-1 mm", sweep_to = "1 mm", sweep_views = 3 }
object = [{ type = "quad", width = "4 mm", height = "3 mm", position = "0, 0, -100 mm" }]
light = [{ type = "directional", direction = [0.2, -0.3, -1], irradiance = 3.0 }]
"""


@pytest.fixture
def scene(tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE)
    return ht.load_scene(tmp_path / "scene.toml")


def test_the_files_of_a_run_are_the_program_bit_by_bit(scene, program, folders):
    """Apart from the seconds in the report. A pickled run is saved as well as the run itself."""
    program("run", "scene.toml", "-o", "program")
    result = ht.run(scene)
    pickle.loads(pickle.dumps(result)).save(folders[1])
    names = same_files(*folders, apart_from=["report.json"])
    assert {"render.png", "field.npy", "hologram_2.png", "view_2.png", "view_sweep.gif", "holo_anaglyph.png",
            "stereo_left.png", "report.json"} <= names
    reports = [json.loads((folder / "report.json").read_text()) for folder in folders]
    for report in reports:
        report.pop("seconds")
        for stage in report["stages"]:
            stage.pop("seconds")
    assert reports[0] == reports[1]
    result.save(folders[1])  # in place of the files that are there
    same_files(*folders, apart_from=["report.json"])


def test_the_files_of_a_run_without_waves_are_the_program_bit_by_bit(scene, tmp_path, program, folders):
    """Its places and the radiance of its target are kept with the run, though they are none of its results."""
    (tmp_path / "aims.toml").write_text(
        'extends = "scene.toml"\n[encode]\nmethod = "sgd"\ntarget = "render"\niterations = 2\n')
    program("run", "aims.toml", "-o", "program")
    result = ht.run(ht.load_scene(tmp_path / "aims.toml"))
    pickle.loads(pickle.dumps(result)).save(folders[1])
    names = same_files(*folders, apart_from=["report.json"])
    assert {"points.ply", "render.exr", "hologram.png"} <= names and "sources.ply" not in names


def test_pictures_of_a_run_are_exposed_as_its_files(scene, folders):
    result = ht.run(scene)
    result.save(folders[0])
    for name, picture, white in (
        ("render.png", result.renders[0], result.render_white),
        ("view_sweep_02.png", result.sweep[1], result.sweep_white),
        ("holo_left.png", result.stereo_views[0], result.stereo_white),
    ):
        picture.save(folders[1] / "p.png", white=white)
        assert equal(ht.load_image(folders[0] / name).pixels, ht.load_image(folders[1] / "p.png").pixels)


def test_a_pair_of_renders_is_the_program_bit_by_bit(scene, tmp_path, program, folders):
    program("render", "scene.toml", "-o", "r.exr")
    left, right = ht.render_pair(scene, "6 mm")
    both = ht.anaglyph(left, right)
    for name, picture in (("r_left.exr", left), ("r_right.exr", right), ("r.exr", both)):
        assert equal(picture.pixels, ht.load_image(tmp_path / name).pixels)
    with pytest.raises(ht.Error, match='unknown parameter "eye_separation"; use ht.render_pair'):
        ht.render(scene, eye_separation="6 mm")


def test_a_run_is_loaded_as_its_files_hold_it(scene, folders):
    """Bit by bit; 8-bit pictures to half a step of their code where they are steepest, and no brighter than white."""
    result = ht.run(scene)
    result.save(folders[0])
    loaded = ht.load_run(folders[0])
    for name in ("sources", "renders", "holograms"):
        made, read = getattr(result, name), getattr(loaded, name)
        assert len(made) == len(read) > 0
        for one, other in zip(made, read):
            for values in ("positions", "amplitudes", "phases") if name == "sources" else ("__array__",):
                pair = [getattr(noun, values) for noun in (one, other)]
                pair = [value() if callable(value) else value for value in pair]
                assert equal(*pair), (name, values)
    assert [[field.wavelength for field in group] for group in loaded.fields] == [[638e-9, 532e-9]]
    assert all(equal(one.samples, other.samples) for one, other in zip(result.fields[0], loaded.fields[0]))
    pictures = {"views": result.white, "sweep": result.sweep_white, "stereo_views": result.stereo_white, "stereo_renders": None}
    for name, white in pictures.items():
        made, read = getattr(result, name), getattr(loaded, name)
        assert len(made) == len(read) > 1
        white = white or _core.common_white([one._core for one in made], 0.0)
        for one, other in zip(made, read):
            # Half a code of 255, where the sRGB curve is steepest: its slope at 1 is 2.4 / 1.055.
            assert np.abs(np.clip(one.pixels / white, 0, 1) - other.pixels).max() <= 0.5 / 255 * 2.4 / 1.055
    assert loaded.white == loaded.sweep_white == loaded.stereo_white == 1 and loaded.views_beside == []
    assert loaded.render_white == _core.common_white([one._core for one in result.renders], 0.0)
    assert loaded.report == json.loads((folders[0] / "report.json").read_text()) and loaded.report["complete"]
    assert "data:image/png" in loaded._repr_html_()
    with pytest.raises(ht.Error, match="expected a run that was computed here to save, got one that was loaded; copy its folder"):
        loaded.save(folders[1])
    assert not list(folders[1].iterdir())


def test_a_run_without_its_other_files_is_loaded(scene, folders):
    """Its places are no sources, its render is a picture, and its report is gone."""
    ht.run(scene).save(folders[0])
    for path in folders[0].iterdir():
        if path.suffix in (".exr", ".ply", ".json", ".npy") or path.name.startswith(("holo_", "stereo_")):
            path.rename(folders[1] / path.name)
    (folders[1] / "sources.ply").rename(folders[0] / "points.ply")
    loaded = ht.load_run(folders[0])
    assert loaded.sources == loaded.fields == loaded.stereo_views == [] and loaded.report == {}
    assert equal(loaded.renders[0].pixels, ht.load_image(folders[0] / "render.png").pixels) and loaded.render_white == 1
    (folders[0] / "report.json").write_text("{")
    with pytest.raises(ht.Error, match="expected a report as JSON in .*report.json: .*; run the scene again"):
        ht.load_run(folders[0])


def test_view_of_the_folder_of_a_run_is_the_program_bit_by_bit(scene, program, folders):
    """Distances, pupil and eye are those of the run where they are not given."""
    program("run", "scene.toml", "-o", "run")
    run = folders[0].parent / "run"
    program("show", "run", "-o", "program/v.png")
    for given in (run, str(run), [run], ht.load_run(run).holograms, [run / "hologram.png", str(run / "hologram_2.png")]):
        ht.view(given).save(folders[1] / "v.png")
        assert same_files(*folders) == {"v.png", "v_2.png"}
    program("show", "run", "run", "--distance", "90 mm", "--pupil", "1 mm", "-o", "program/v.png")
    ht.view([run, run], distances="90 mm", pupil="1 mm").save(folders[1] / "v.png")
    same_files(*folders)


def test_folders_without_a_complete_run_are_refused_as_by_the_program(scene, tmp_path, program_error, folders):
    def refused():
        sentence = program_error("show", folders[0], "-o", "v.png")
        for read in (ht.view, ht.load_run):
            with pytest.raises(ht.Error) as error:
                read(folders[0])
            assert str(error.value) == sentence
        return sentence

    assert "holds no hologram.png" in refused()
    ht.run(scene).save(folders[0])
    report = json.loads((folders[0] / "report.json").read_text())
    (folders[0] / "report.json").write_text(json.dumps({**report, "complete": False}))
    assert "was ended while it wrote its files; run it again" in refused()
    (folders[0] / "report.json").write_text(json.dumps(report))
    ht.run(scene, trace={"frames": 2}).save(folders[1])  # four holograms, whose third is of no series of two
    for path in folders[1].glob("hologram_3*"):
        path.rename(folders[0] / path.name)
    assert "expected holograms of one series" in refused()
    with pytest.raises(ht.Error, match="none.png"):
        ht.view(tmp_path / "none.png")


def test_frames_of_a_field_are_refused_before_the_work(monkeypatch, field):
    monkeypatch.setattr(_core, "encode_fields", lambda *given: pytest.fail("it has begun"))
    with pytest.raises(ht.Error, match="expected frames only with a focal stack or a light field; leave it out"):
        ht.encode_all(field, frames=2)


def test_propagate_keeps_the_cone_of_the_light(scene, tmp_path, program):
    """Red light of a scene with green keeps to the green cone, in files too."""
    red = ht.fields(scene)[0]
    assert (red.wavelength, red.cone_wavelength) == (638e-9, 532e-9)
    moved = ht.propagate(red, "1 mm")
    assert moved.cone_wavelength == 532e-9
    red.save(tmp_path / "f.npy")
    program("propagate", "f.npy", "--distance", "1 mm", "-o", "g.npy")
    assert ht.load_field(tmp_path / "g.npy").cone_wavelength == 532e-9
