"""Scenes from files, dicts and arrays, and the verbs on them, bit by bit as the program's files."""

import copy
import json
import pickle

import numpy as np
import pytest

import holotrace as ht

SMALL = """
wavelength = "532 nm"
[slm]
columns = 64
rows = 48
[materials.red]
reflectance = [0.8, 0.2, 0.1]
[[object]]
type = "quad"
width = "6 mm"
height = "5 mm"
material = "red"
position = "0 0 -100 mm"
[[object]]
type = "wireframe_cube"
size = "2 mm"
points_per_edge = 3
position = "0 0 -90 mm"
[[light]]
type = "point"
position = "0 0 -50 mm"
intensity = 0.01
[trace]
columns = 12
rows = 10
paths = 2
[render]
rows = 20
paths = 2
[camera]
distances = "100 mm"
"""


@pytest.fixture
def path(tmp_path):
    (tmp_path / "scene.toml").write_text(SMALL)
    return tmp_path / "scene.toml"


@pytest.fixture
def scene(path):
    return ht.load_scene(path)


def same(a, b):
    a, b = np.asarray(a), np.asarray(b)
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


def test_render_is_the_program_bit_by_bit(scene, tmp_path, program):
    program("render", "scene.toml", "-o", "r.exr", "--paths", 3)
    assert same(ht.render(scene, paths=3), ht.load_image(tmp_path / "r.exr"))


def test_focal_stack_is_the_program_bit_by_bit(scene, tmp_path, program):
    program("render", "scene.toml", "--focal-stack", "90, 100 mm", "-o", "s.h5")
    stack = ht.focal_stack(scene, "90, 100 mm")
    written = ht.load_focal_stack(tmp_path / "s.h5")
    assert same(stack, written) and stack.distances == written.distances == [0.09, 0.1]


def test_trace_is_the_program_bit_by_bit(scene, tmp_path, program):
    program("trace", "scene.toml", "-o", "s.ply", "--phase", "surface")
    (sources,) = ht.trace(scene, phase="surface")
    written = ht.load_sources(tmp_path / "s.ply")
    for name in ("positions", "amplitudes", "phases"):
        assert same(getattr(sources, name), getattr(written, name))


def test_fields_are_the_program_bit_by_bit(scene, tmp_path, program):
    program("field", "scene.toml", "-o", "f.npy", "--frame", 2, "--method", "exact")
    (field,) = ht.fields(scene, frame=2, method="exact")
    assert same(field, np.load(tmp_path / "f.npy"))


def test_run_is_the_program_bit_by_bit(scene, tmp_path, program):
    program("run", "scene.toml", "-o", "out", "--paths", 3, "--phase", "surface")
    result = ht.run(scene, trace={"paths": 3, "phase": "surface"})
    assert same(result.fields[0][0], np.load(tmp_path / "out" / "field.npy"))
    assert same(result.holograms[0], ht.load_hologram(tmp_path / "out" / "hologram.png"))
    result.views[0].save(tmp_path / "view.png", white=result.white)
    assert same(ht.load_image(tmp_path / "view.png"), ht.load_image(tmp_path / "out" / "view.png"))
    written = json.loads((tmp_path / "out" / "report.json").read_text())
    for report in (result.report, written):
        for stage in report["stages"]:
            del stage["seconds"]
    assert result.report["stages"] == written["stages"]


def test_estimate_has_the_figures_of_the_program(scene, program):
    figures = ht.estimate(scene)
    assert set(figures) == set(json.loads(program("estimate", "scene.toml", "--json")))
    assert figures["waves"] > 0


def test_limits_are_the_program(scene, program):
    written = json.loads(program("limits", "--slm", "gaea", "--wavelength", "532 nm", "--distance", "0.2 m", "--json"))
    assert ht.limits("gaea", wavelength=532e-9, distance=0.2) == written
    assert ht.limits(wavelength=532e-9, scene=scene)["scene"]["points"] == 4 + 20  # corners, and points on edges


def test_a_dict_is_the_scene_of_its_file(scene):
    tables = {
        "wavelength": 532e-9,
        "slm": {"columns": 64, "rows": np.int64(48)},
        "materials": {"red": {"reflectance": (0.8, 0.2, 0.1)}},
        "object": [
            {"type": "quad", "width": 6e-3, "height": "5 mm", "material": "red", "position": np.array([0, 0, -0.1])},
            {"type": "wireframe_cube", "size": 2e-3, "points_per_edge": 3, "position": "0 0 -90 mm"},
        ],
        "light": [{"type": "point", "position": [0, 0, -0.05], "intensity": 0.01}],
        "trace": {"columns": 12, "rows": 10, "paths": 2},
        "render": {"rows": 20, "paths": 2},
        "camera": {"distances": [0.1]},
    }
    made = ht.Scene(tables)
    assert same(ht.render(made), ht.render(scene))
    assert made.parameters("trace") == scene.parameters("trace")
    assert same(ht.render(ht.Scene(**tables)), ht.render(scene))


def quad(width, height):
    x, y = width / 2, height / 2
    vertices = np.array([[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]])
    return {"type": "mesh", "vertices": vertices, "faces": [[0, 1, 2], [0, 2, 3]],
            "uv": [[0, 0], [1, 0], [1, 1], [0, 1]]}


def lit(**more):
    return ht.Scene(
        wavelength="532 nm", slm={"columns": 64, "rows": 48},
        render={"rows": 20, "columns": 20, "field_of_view": "1.9 deg", "paths": 4},
        light=[{"type": "point", "position": "0 0 -50 mm", "intensity": 0.01}], **more)


def test_an_angle_without_a_unit_is_in_radians():
    assert same(ht.render(lit(object=[{**quad(6e-3, 5e-3), "position": (0, 0, -0.1)}], analyser=np.pi / 2)), ht.render(lit(object=[{**quad(6e-3, 5e-3), "position": (0, 0, -0.1)}], analyser="90 deg")))
    with pytest.raises(ht.Error, match='expected radians for "analyser", got 90; write "90 deg", or "90 rad" if you mean it'):
        lit(analyser=90)


def test_errors_count_the_objects():
    with pytest.raises(ht.Error, match=r"^\[object\[1\]\]: expected"):
        lit(object=[{**quad(6e-3, 5e-3), "position": (0, 0, -0.1)}, {"type": "sphere", "size": -1}])


def test_a_mesh_of_arrays_is_the_mesh_itself():
    """Four corners and two triangles are the program's own rectangle, so the pictures are the same to rounding."""
    place = {"position": (0, 0, -0.1), "rotation": "y 20 deg"}
    arrays = ht.render(lit(object=[{**quad(6e-3, 5e-3), **place}]))
    own = ht.render(lit(object=[{"type": "quad", "width": "6 mm", "height": "5 mm", **place}]))
    assert np.allclose(arrays, own, rtol=1e-5, atol=0) and np.asarray(own).any()


def test_a_texture_is_an_array(tmp_path):
    """The left half is black, the right half red: so is the picture; EXR files have the same values."""
    texture = np.zeros((8, 8, 3), np.float32)
    texture[:, 4:, 0] = 0.5
    ht.Image(texture).save(tmp_path / "t.exr")
    entry = {**quad(6e-3, 5e-3), "position": "0 0 -100 mm", "material": "m"}
    pictures = [
        np.asarray(ht.render(lit(object=[entry], materials={"m": {"texture": given}})))
        for given in (texture, ht.Image(texture), tmp_path / "t.exr")
    ]
    assert same(pictures[0], pictures[1]) and same(pictures[0], pictures[2])
    red = pictures[0][:, :, 0]
    assert red[10, 15] > 0 and red[10, 3] == 0 and not pictures[0][:, :, 1].any()


def test_points_of_arrays_are_waves():
    places = np.array([[1e-3, 0, -0.1], [0, 1e-3, -0.2]])
    scene = ht.Scene(wavelength="532 nm", object=[{"type": "points", "points": places, "amplitudes": [1.0, 2.0]}])
    (sources,) = ht.trace(scene)
    assert np.allclose(sources.positions, places)
    assert sources.amplitudes[1] > 0 and len(sources) == 2


@pytest.mark.parametrize(
    "entry, message",
    [
        ({"faces": [[0, 1, 4]]}, "expected indices of 4 vertices in faces, got 4"),
        ({"faces": [[0, 1]]}, r"expected faces of the shape \(n, 3\)"),
        ({"faces": [[0.0, 1, 2]]}, "expected whole numbers in faces"),
        ({"vertices": np.full((4, 3), np.nan)}, "expected finite numbers in vertices"),
        ({"normals": np.ones((3, 3))}, "expected one of normals for each of 4 vertices, got 3"),
        ({"material": "gold"}, r'\[object\[0\]\]: unknown material "gold"'),
        ({"colour": 1}, r'\[object\[0\]\]: unknown key "colour"'),
        ({"position": (0, 0, 0)}, r"\[object\[0\]\]: expected the object behind the panel"),
    ],
)
def test_bad_arrays_of_a_scene_are_refused(entry, message):
    with pytest.raises(ht.Error, match=message):
        lit(object=[{**quad(6e-3, 5e-3), "position": (0, 0, -0.1), **entry}])


def test_errors_of_a_dict_name_its_table():
    with pytest.raises(ht.Error, match=r'^\[slm\]: unknown key "row"; did you mean "rows"'):
        ht.Scene(wavelength="532 nm", slm={"row": 3})
    with pytest.raises(ht.Error, match="^the scene: expected at least one object in the scene"):
        ht.Scene(object=[])  # without a wavelength there is a default one
    with pytest.raises(ht.Error, match=r"^\[trace\]: .*\"paths\""):
        ht.Scene(wavelength="532 nm", object=[{"type": "quad", "width": 1e-3, "height": 1e-3, "position": (0, 0, -1)}],
                 trace={"paths": -1})


def test_an_error_of_a_file_is_the_sentence_of_the_program(path, program_error):
    path.write_text(SMALL.replace('"quad"', '"quat"'))
    sentence = program_error("render", path, "-o", "r.exr")
    with pytest.raises(ht.Error) as raised:
        ht.load_scene(path)
    assert str(raised.value) == sentence


def test_wavelengths_that_are_given_are_not_said_to_be_chosen():
    scene = ht.Scene(
        object=[{"type": "quad", "width": 2e-4, "height": 2e-4, "position": (0, 0, -0.03)}],
        light=[{"type": "directional", "direction": (0, 0, -1), "irradiance": 1}],
        slm={"columns": 64, "rows": 48, "pitch": 8e-6},
        render={"paths": 1},
        encode={"iterations": 2},
    )
    for tried, is_chosen in ((scene, True), (scene.replace(wavelength="600 nm"), False)):
        chosen = [one["parameter"] for one in ht.run(tried).report.get("chosen", [])]
        assert ("wavelength" in chosen) == is_chosen


def test_scenes_survive_pickle_and_copy(scene):
    expected = ht.render(scene)
    for other in (pickle.loads(pickle.dumps(scene)), copy.copy(scene), copy.deepcopy(scene)):
        assert same(ht.render(other), expected)
        assert repr(other) == repr(scene)


def test_every_noun_survives_pickle_and_copy(scene):
    """All that pickle keeps of a noun is the same in the copy, and the copy has memory of its own."""
    result = ht.run(scene)
    stack = ht.focal_stack(scene, [0.1])
    plan = ht.calibration_patterns(ht.Slm("pluto", columns=400, rows=300), level_patterns=1)
    depths = ht.DepthImage(np.ones((3, 4), np.float32), np.ones((3, 4)))
    light_field = ht.LightField(np.ones((2, 3, 4, 5), np.float32), "1 mm", "10 um", "300 mm")
    nouns = [scene, result.sources[0], result.fields[0][0], result.holograms[0], result.views[0], stack, ht.Slm("pluto"), plan,
             depths, light_field]
    kinds = {kind for kind in vars(ht).values() if isinstance(kind, type) and hasattr(kind, "copy")}
    assert {type(noun) for noun in nouns} == kinds
    for noun in nouns:
        for other in (pickle.loads(pickle.dumps(noun)), copy.copy(noun), copy.deepcopy(noun)):
            assert repr(other) == repr(noun) and type(other) is type(noun) and other.facts == noun.facts
            assert other._core.__getstate__() == noun._core.__getstate__() and other._core is not noun._core
    views = ht.view(result.holograms, distances="100 mm")
    for made in (result, views):
        for other in (pickle.loads(pickle.dumps(made)), copy.copy(made), copy.deepcopy(made)):
            assert other.report == made.report and repr(other) == repr(made)


def test_replace_leaves_the_scene_as_it_is(scene):
    other = scene.replace(trace={"paths": 7}, wavelength=("638 nm", 450e-9), slm="gaea")
    assert other.parameters("trace")["paths"] == 7 and other.wavelengths == [638e-9, 450e-9]
    assert scene.parameters("trace")["paths"] == 2 and scene.slm.name != other.slm.name
    with pytest.raises(ht.Error, match='unknown stage "tracing"; did you mean "trace"'):
        scene.replace(tracing={})


def test_reprs_state_what_they_are(scene):
    assert repr(scene) == "Scene(1 meshes of 2 triangles, 20 points, 1 lights, 'custom', 532 nm)"
    assert "data:image/png" in ht.render(scene)._repr_html_()
    assert "data:image/png" in ht.run(scene)._repr_html_()


def test_values_take_the_place_of_those_of_a_file(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text('wavelength = "532 nm"\n[[object]]\ntype = "wireframe_cube"\nsize = "20 mm"\nposition = "0 0 -300 mm"\n')
    scene = ht.load_scene(path, edits={"camera.pupil": "3 mm", "render.paths": 3, "wavelength": ["633 nm", "450 nm"]})
    assert scene.parameters("camera")["pupil"] == 3e-3 and scene.parameters("render")["paths"] == 3
    assert list(scene.wavelengths) == [633e-9, 450e-9]
    with pytest.raises(ht.Error, match="^--set object.2.position: expected the number of an element from 1 to 1"):
        ht.load_scene(path, edits={"object.2.position": "0 0 -1 mm"})


def test_densities_of_a_medium_may_be_an_array():
    box = ["-1 -1 -301 mm", "1 1 -299 mm"]
    tables = {"wavelength": "532 nm", "background": 1.0, "render": {"rows": 8, "paths": 4, "field_of_view": "0.1 deg"}}
    with pytest.raises(ht.Error, match=r"shape \(planes, rows, columns\), got \(2, 2\)"):
        ht.Scene(tables, media={"smoke": {"mean_free_path": "1 mm", "box": box, "density": np.ones((2, 2))}})
    with pytest.raises(ht.Error, match="densities of 0 or more, got -1 in plane 1, row 0, column 2"):
        values = np.ones((2, 3, 4))
        values[1, 0, 2] = -1
        ht.Scene(tables, media={"smoke": {"mean_free_path": "1 mm", "box": box, "density": values}})
    # Absorbing and 2 mm deep: exp(-2) of a background of 1 is left on average, of 256 paths: 4·sqrt(0.117/256) = 0.09.
    picture = ht.render(
        ht.Scene(tables, media={"smoke": {"mean_free_path": "1 mm", "albedo": 0, "box": box, "density": np.ones((2, 3, 4))}})
    )
    assert abs(np.asarray(picture).mean() - np.exp(-2)) < 0.09


def test_temperatures_of_a_medium_may_be_an_array():
    box = ["-1 -1 -301 mm", "1 1 -299 mm"]
    tables = {"wavelength": "532 nm", "render": {"rows": 4, "paths": 4, "field_of_view": "0.1 deg"}}
    with pytest.raises(ht.Error, match="temperatures from 0 to 100000 K, got -1 in plane 0, row 0, column 0"):
        ht.Scene(tables, media={"fire": {"mean_free_path": "1 mm", "box": box, "temperature": np.full((1, 1, 1), -1.0)}})
    # So thick that nothing is seen through it: Planck's radiance of a nanometre at 532 nm, hc/(λkT) = 0.0143878/(532e-9·1800).
    thick = {"mean_free_path": "0.02 mm", "albedo": 0, "box": box, "temperature": np.full((2, 3, 4), 1800.0)}
    picture = ht.render(ht.Scene(tables, media={"fire": thick}))
    assert np.asarray(ht.render(ht.Scene(tables, media={"fire": {**thick, "temperature": 1800}}))) == pytest.approx(np.asarray(picture))
    assert np.asarray(picture)[..., 1] == pytest.approx(1.191043e-25 / 532e-9**5 / np.expm1(0.01438777 / (532e-9 * 1800)), rel=1e-4)


# A box of 2 by 4 by 6 mm whose middle moves along x from 0 to 8 mm in 1 s, at 0.25 s.
def test_meshes_are_those_of_the_time():
    box = {"type": "box", "size": "2 4 6 mm", "position": {"0 s": "0 0 -300 mm", "1 s": "8 0 -300 mm"}}
    scene = ht.Scene(wavelength="532 nm", slm="pluto", object=[box], time=0.25)
    ((_, vertices, faces),) = scene.meshes
    assert np.allclose(vertices.min(axis=0), [1e-3, -2e-3, -303e-3], atol=1e-15)
    assert np.allclose(vertices.max(axis=0), [3e-3, 2e-3, -297e-3], atol=1e-15)
    assert faces.shape == (12, 3) and faces.max() == len(vertices) - 1
