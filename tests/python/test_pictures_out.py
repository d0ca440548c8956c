"""JPEGs, animations and films as other programs read them: Pillow, ffprobe and ffmpeg."""

import dataclasses
import json
import re
import shutil
import subprocess

import numpy as np
import pytest

import holotrace as ht

Image = pytest.importorskip("PIL.Image")
ImageSequence = pytest.importorskip("PIL.ImageSequence")


def srgb_codes(light):
    """IEC 61966-2-1, in 8 bits."""
    light = np.clip(light, 0, 1)
    return 255 * np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def waves(k=0):
    """Smooth colours on odd sides, in linear light of 0 to 3 W/m2, of picture k of a sweep."""
    rows, columns = np.mgrid[0:49, 0:63]
    colours = [np.sin(0.1 * columns + 0.5 * k), np.sin(0.13 * rows + 0.3 * k), np.sin(0.07 * (columns - rows) - 0.4 * k)]
    return (1.5 + 1.5 * np.stack(colours, axis=-1)).astype(np.float32)


def test_a_jpeg_is_what_pillow_reads_with_full_colours(tmp_path):
    picture = waves()
    ht.Image(picture).save(tmp_path / "p.jpg", white=3.0)
    with Image.open(tmp_path / "p.jpg") as opened:
        assert (opened.format, opened.mode, opened.size) == ("JPEG", "RGB", (63, 49))
        assert [part[1:3] for part in opened.layer] == [(1, 1)] * 3  # 4:4:4
        # Annex K of the standard begins with 16 and 17; libjpeg scales by (200 - 2*95) % and rounds.
        assert [opened.quantization[table][0] for table in (0, 1)] == [2, 2]
        error = np.asarray(opened).astype(float) - srgb_codes(picture / 3)
    # Steps of 2 codes leave 2/sqrt(12) = 0.6 in each of three components, with weights of at most 1.8, and 0.3 of rounding.
    assert np.sqrt(np.mean(error**2)) < 1.5
    ht.Image(picture[:, :, 0]).save(tmp_path / "g.jpeg", white=3.0)
    with Image.open(tmp_path / "g.jpeg") as opened:
        assert opened.mode == "L"
        assert np.abs(np.asarray(opened) - srgb_codes(picture[:, :, 0] / 3)).mean() < 1


def test_a_hologram_is_never_a_jpeg(tmp_path, field):
    with pytest.raises(ht.Error, match="got .*h.jpg, and a JPEG would change the levels of its pixels"):
        ht.encode(field, ht.Slm("pluto", columns=48, rows=33)).save(tmp_path / "h.jpg")


@pytest.fixture
def views(field):
    """Four pictures as the sweep of a view, in 0.6 s: six frames of 100 ms."""
    hologram = ht.encode(field, ht.Slm("pluto", columns=48, rows=33))
    seen = ht.view(hologram, distances="0.1 m", sweep="focus", sweep_from="90 mm", sweep_to="120 mm", sweep_views=4,
                   sweep_seconds=0.6)
    return dataclasses.replace(seen, sweep=[ht.Image(waves(k)) for k in range(4)], sweep_white=3.0)


FORWARD_AND_BACK = [0, 1, 2, 3, 2, 1]


def frames():
    """What an animation must show, by numpy."""
    return [srgb_codes(waves(k).astype(float) / 3) for k in FORWARD_AND_BACK]


def test_a_webp_plays_forward_and_back_without_end_in_exact_colours(tmp_path, views):
    views.save(tmp_path / "v.webp")
    with Image.open(tmp_path / "v.webp") as opened:
        assert (opened.format, opened.size, opened.n_frames, opened.info["loop"]) == ("WEBP", (63, 49), 6, 0)
        for frame, codes in zip(ImageSequence.Iterator(opened), frames()):
            pixels = np.asarray(frame.convert("RGB")).astype(float)
            assert frame.info["duration"] == 100
            assert np.abs(pixels - codes).max() < 0.51  # rounded to a code, and floats
    views.save(tmp_path / "again.webp")
    assert (tmp_path / "v.webp").read_bytes() == (tmp_path / "again.webp").read_bytes()


def test_a_series_is_the_sweep_once(tmp_path, views):
    views.save(tmp_path / "v_###.png")
    assert sorted(path.name for path in tmp_path.iterdir()) == [f"v_00{k}.png" for k in (1, 2, 3, 4)]
    for k, codes in enumerate(frames()[:4]):
        with Image.open(tmp_path / f"v_00{k + 1}.png") as opened:
            assert np.abs(np.asarray(opened) - codes).max() < 0.51


@pytest.mark.parametrize("ending, codec, container", [("mp4", "h264", "mp4"), ("webm", "vp9", "webm")])
def test_a_film_has_every_frame_for_the_same_time_in_its_colours(tmp_path, views, ending, codec, container):
    if not shutil.which("ffprobe"):
        pytest.skip("ffmpeg is not installed")
    path = tmp_path / f"v.{ending}"
    views.save(path)
    words = ["ffprobe", "-v", "error", "-count_packets", "-show_streams", "-show_format", "-show_packets", "-of", "json", path]
    probed = json.loads(subprocess.run(words, capture_output=True, check=True).stdout)
    stream, = probed["streams"]
    assert container in probed["format"]["format_name"].split(",")
    assert (stream["codec_name"], stream["width"], stream["height"], stream["pix_fmt"]) == (codec, 64, 50, "yuv420p")
    assert {stream[f"color_{name}"] for name in ("space", "primaries", "transfer")} == {"bt709"}
    assert stream["color_range"] == "tv" and stream["r_frame_rate"] == "10/1" and stream["nb_read_packets"] == "6"
    times = sorted(float(packet["pts_time"]) for packet in probed["packets"])
    assert np.allclose(np.diff(times), 0.1, atol=1e-3)
    assert float(probed["format"]["duration"]) == pytest.approx(0.6, abs=2e-3)
    # Decoded by ffmpeg's own conversion, by the tags of the file.
    words = ["ffmpeg", "-v", "error", "-i", path, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    shown = np.frombuffer(subprocess.run(words, capture_output=True, check=True).stdout, np.uint8).reshape(6, 50, 64, 3)
    for frame, codes in zip(shown.astype(float), frames()):
        # Luma has a sample for each pixel: its weights in BT.709. At crf 15, steps of waves are at most 10 codes: 10/sqrt(12).
        luma = (frame[:49, :63] - codes) @ [0.2126, 0.7152, 0.0722]
        assert np.sqrt(np.mean(luma**2)) < 3
        # 2 x 2 pixels share chroma, so the hue is compared by means over 16 x 16. The matrix of BT.601 would be off by 20.
        hue = (frame[:48, :48] - codes[:48, :48]).reshape(3, 16, 3, 16, 3).mean(axis=(1, 3))
        assert np.abs(hue).max() < 4
        # The odd column and row are there twice: black ones would differ by 100 on average.
        assert np.abs(frame[:49, 63] - frame[:49, 62]).mean() < 10 and np.abs(frame[49] - frame[48]).mean() < 10


def test_other_endings_are_listed(tmp_path, views):
    endings = ".png or .jpg or .jpeg or .exr or .gif or .webp or .mp4 or .webm"
    with pytest.raises(ht.Error, match=re.escape(f"expected an output file {endings}, got")):
        views.save(tmp_path / "v.avi")
