"""Films in Python: keys over time, animate, save_film."""

import numpy as np
import pytest

import holotrace as ht

PANEL = {"columns": 64, "rows": 48, "pitch": 8e-6}


def moving(**more):
    """A point quad that moves along x from -0.1 mm to 0.1 mm in 1 s, in tables."""
    return {
        "wavelength": 532e-9,
        "slm": PANEL,
        "object": [{"type": "points", "points": [(0.0, 0.0, 0.0)],
                    "position": {"0 s": (-1e-4, 0, -0.03), "1 s": (1e-4, 0, -0.03)}}],
        "trace": {"phase": "constant"},
        "render": {"rows": 8, "paths": 1},
        "encode": {"method": "phase"},
        "camera": {"distances": 0.03},
        **more,
    }


def test_a_scene_is_that_of_its_time():
    for time, x in ((0, -1e-4), ("250 ms", -0.5e-4), (0.5, 0), (7, 1e-4)):
        waves = ht.trace(ht.Scene(moving(), time=time))[0]
        assert np.asarray(waves.positions)[0] == pytest.approx([x, 0, -0.03], abs=1e-15)
    assert ht.Scene(moving(), time="250 ms").time == 0.25
    assert ht.Scene(moving(time="500 ms")).time == 0.5


def test_animate_gives_the_run_of_each_time():
    runs = list(ht.animate(moving(), fps=4))
    assert [one.time for one in runs] == [0, 0.25, 0.5, 0.75]
    alone = ht.run(ht.Scene(moving(), time=0.5))
    assert np.array_equal(np.asarray(runs[2].holograms[0]), np.asarray(alone.holograms[0]))
    assert not np.array_equal(np.asarray(runs[1].holograms[0]), np.asarray(alone.holograms[0]))
    again = list(ht.animate(moving(animate={"times": [0.5]})))
    assert [one.time for one in again] == [0.5]


def test_a_function_of_time_moves_what_it_likes():
    def scene(time):
        tables = moving()
        tables["object"][0]["position"] = (1e-4 * np.cos(time), 0, -0.03)
        return ht.Scene(tables)

    runs = ht.animate(scene, times="0 1 s", stages={"camera": {"distances": 0.031}})
    assert [round(one.time, 9) for one in runs] == [0, 1]


def bright_bar(x):
    """A luminous bar, 0.1 mm wide, 30 mm behind the panel."""
    return {
        "wavelength": 532e-9,
        "slm": PANEL,
        "materials": {"lamp": {"type": "diffuse", "reflectance": 0, "emission": 1}},
        "object": [{"type": "quad", "width": 1e-4, "height": 1e-3, "position": x, "material": "lamp"}],
        "render": {"rows": 48, "columns": 64, "paths": 64},
        "encode": {"method": "phase"},
        "camera": {"distances": 0.03},
    }


def test_an_open_shutter_blurs_what_moves():
    keys = {"0 s": (-1e-4, 0, -0.03), "1 s": (1e-4, 0, -0.03)}
    still = np.asarray(ht.render(ht.Scene(bright_bar(keys), time=0.5)))[24, :, 0]
    blurred = np.asarray(ht.render(ht.Scene(bright_bar(keys), shutter="1 s")))[24, :, 0]
    # The light is the same; over the bar and its way of 0.2 mm it is a trapezoid whose top is half as bright as the bar.
    # Times are known to 1/32 and 1/64 (moments, paths).
    assert blurred.sum() == pytest.approx(still.sum(), rel=1 / 32)
    assert still.max() == pytest.approx(1, abs=1e-6)
    assert blurred.max() == pytest.approx(0.5, abs=1 / 32 + 1 / 64)
    from_table = ht.render(ht.Scene(bright_bar(keys), shutter=1.0))
    assert np.array_equal(np.asarray(from_table)[24, :, 0], blurred)

    def scene(time):
        return ht.Scene(bright_bar((-1e-4 + 2e-4 * time, 0, -0.03)))

    stages = {"render": {"reference": "full"}}
    for moving_bar in (scene, bright_bar(keys), bright_bar(keys) | {"shutter": "500 ms"}):
        shutter = None if isinstance(moving_bar, dict) and "shutter" in moving_bar else "180 deg"
        first = list(ht.animate(moving_bar, fps=1, seconds=1, shutter=shutter, stages=stages))[0]
        half = np.asarray(first.renders[0])[24, :, 0]
        # Half of the way, 0.1 mm, is as long as the bar: a triangle that reaches its brightness in one pixel.
        assert half.sum() == pytest.approx(still.sum(), rel=1 / 32)
        assert 0.5 < half.max() <= 1


def test_bad_shutters_are_refused():
    with pytest.raises(ht.Error, match="expected a shutter of 0 s or more"):
        ht.Scene(moving(), shutter=-1)
    with pytest.raises(ht.Error, match='such as "20 ms" or "180 deg"'):
        ht.Scene(moving(), shutter="20 mm")


def test_what_does_not_move_is_refused():
    with pytest.raises(ht.Error, match="expected what moves"):
        ht.animate(ht.Scene(moving()), seconds=1)
    tables = moving()
    tables["object"][0]["position"] = (0, 0, -0.03)
    with pytest.raises(ht.Error, match="expected the duration of the film"):
        ht.animate(tables)
    with pytest.raises(ht.Error, match="at most 100000 times"):
        ht.animate(tables, seconds=1e9)
    with pytest.raises(ht.Error, match="expected a time in seconds"):
        ht.Scene(moving(), time=[1])
    with pytest.raises(ht.Error, match='unknown parameter "second"'):
        ht.animate(tables, second=1)


def test_a_film_is_written_from_pictures(tmp_path):
    pictures = [ht.Image(np.full((4, 6), value, np.float32)) for value in (0.0, 1.0, 2.0)]
    path = tmp_path / "film.gif"
    ht.save_film(path, pictures, fps=10, white=2)
    image = pytest.importorskip("PIL.Image").open(path)
    assert (image.n_frames, image.size, image.info["duration"]) == (3, (6, 4), 100)
    image.seek(1)
    # Half of white in linear light is 0.7354 in sRGB: 187.5 of 255.
    assert abs(int(np.asarray(image.convert("L"))[0, 0]) - 188) <= 1
    with pytest.raises(ht.Error, match="more than 0 pictures per second"):
        ht.save_film(path, pictures, fps=0)
    with pytest.raises(ht.Error, match="expected pictures of 6 × 4 pixels"):
        ht.save_film(path, [pictures[0], ht.Image(np.zeros((2, 2), np.float32))])


def test_a_viewer_who_walks_has_holograms_for_the_measured_eye(tmp_path):
    """10 mm/s x 50 ms = 0.5 mm. The hologram at 0.5 s is that for the eye at 0.45 s, the view that of the eye at 0.5 s."""
    walk = tmp_path / "walk.csv"
    walk.write_text("time_s,x_mm,y_mm,z_mm\n0,-5,0,60\n1,5,0,60\n")
    scene = {
        "wavelength": 532e-9,
        "slm": PANEL,
        "background": 0.1,
        "object": [{"type": "quad", "width": 3e-4, "height": 3e-4, "position": (0, 0, -0.03)}],
        "render": {"rows": 8, "paths": 1},
        "encode": {"method": "sgd", "target": "render", "iterations": 3},
        "camera": {"distances": 0.03, "pupil": 1e-3},
    }
    stages = {"eye": {"track": str(walk), "latency": "50 ms"}}
    (made,) = ht.animate(scene, times=[0.5], stages=stages)
    still = ht.run(ht.Scene({**scene, "encode": {**scene["encode"], "eye": (-0.5e-3, 0, 0.06)},
                             "camera": {**scene["camera"], "eye": (0, 0, 0.06)}}))
    assert np.array_equal(np.asarray(made.holograms[0]), np.asarray(still.holograms[0]))
    assert np.array_equal(np.asarray(made.views[0]), np.asarray(still.views[0]))
    (eye,) = [one for one in made.report["stages"] if one["stage"] == "eye"]
    assert eye["distance_of_measured_eye_m"] == pytest.approx(0.5e-3, rel=1e-9)
    (function,) = ht.animate(lambda time: ht.Scene(scene), times=[0.5], stages=stages)
    assert np.array_equal(np.asarray(function.holograms[0]), np.asarray(made.holograms[0]))
    with pytest.raises(ht.Error, match="lasts until 1.2 s"):
        ht.animate(scene, times=[0.5, 1.2], stages=stages)


def stages_of(one):
    return [stage["stage"] for stage in one.report["stages"]]


def test_holograms_of_waves_are_taken_again_where_only_the_camera_moves():
    still = moving(camera={"distances": 0.03, "pupil": 2e-4, "eye": {"0 s": (0, 0, 0.005), "1 s": (1e-4, 0, 0.005)}})
    still["object"][0]["position"] = (0, 0, -0.03)
    first, second = ht.animate(still, fps=2)
    assert "synthesize" in stages_of(first) and "reuse" not in stages_of(first)
    assert "reuse" in stages_of(second) and "synthesize" not in stages_of(second)
    fresh = ht.run(ht.Scene(still, time=0.5))
    assert np.array_equal(np.asarray(second.holograms[0]), np.asarray(fresh.holograms[0]))
    assert np.array_equal(np.asarray(second.views[0]), np.asarray(fresh.views[0]))
    assert np.array_equal(np.asarray(second.fields[0][0]), np.asarray(fresh.fields[0][0]))
    # What moves is computed again.
    assert all("synthesize" in stages_of(one) for one in ht.animate(moving(), fps=2))


def bright_wall(frames=1, **encode):
    scene = bright_bar((0, 0, -0.03))
    scene["render"] = {"rows": 12, "columns": 16, "paths": 2}
    scene["encode"] = {"method": "sgd", "target": "render", "iterations": 6, "target_distances": 0.03, **encode}
    scene["trace"] = {"frames": frames}
    return scene


def test_a_film_that_goes_on_has_one_number_of_frames():
    def grows(time):
        return bright_wall(1 if time < 0.5 else 2)

    made = ht.animate(grows, times="0 0.5 s", from_last=True)
    assert len(next(made).holograms) == 1
    with pytest.raises(ht.Error, match=r"expected as many frames at all times of a film .* got 1 at first and 2 at 500 ms; give \[trace\] frames"):
        next(made)
    assert [len(one.holograms) for one in ht.animate(grows, times="0 0.5 s")] == [1, 2]


def test_rolling_frames_need_the_last_ones():
    with pytest.raises(ht.Error, match="expected rolling frames in a film that goes on from the last time"):
        next(ht.animate(bright_wall(2, rolling=True), times="0 0.5 s"))
    first, second = ht.animate(bright_wall(2, rolling=True), times="0 0.5 s", from_last=True)
    # The first of the new frames is the last one's second: a display has shown it already.
    assert np.array_equal(np.asarray(second.holograms[0]), np.asarray(first.holograms[1]))


def test_holograms_of_waves_cannot_go_on():
    with pytest.raises(ht.Error, match="expected from_last only with the method sgd"):
        next(ht.animate(moving(), fps=2, from_last=True))
