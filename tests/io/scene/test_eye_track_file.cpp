#include <gtest/gtest.h>

#include "holotrace/io/scene/eye_track_file.h"
#include "holotrace/io/scene/scene_file.h"
#include "io/scene/scene_text.h"
#include "support/error_of.h"
#include "support/temporary.h"

// Files of eye tracks, and scenes that name one.

namespace holotrace {
namespace {

using test::make_file;

EyeTrack track_of(const std::string& text) { return load_eye_track(make_file("walk.csv", text)); }

// The error of a file without its path.
std::string track_error(const std::string& text) {
  const std::string path = make_file("walk.csv", text);
  const std::string error = error_of([&] { load_eye_track(path); });
  return error.starts_with(path + ":") ? error.substr(path.size() + 1) : error;
}

TEST(EyeTrackFile, ColumnsAreTimeAndPlaceInSecondsAndMillimetres) {
  const EyeTrack track = track_of("0,-5,1.5,250\n0.5,5,0,300\n");
  EXPECT_EQ(track.times, (std::vector<double>{0, 0.5}));
  EXPECT_EQ(track.places, (std::vector<Vec3>{{-0.005, 0.0015, 0.25}, {0.005, 0, 0.3}}));
}

TEST(EyeTrackFile, AHeadingNamesColumnsAndUnitsInAnyOrder) {
  const EyeTrack track = track_of(
      "# a tracker's file\n\nblink;Z_m; time_ms;x_cm;y_um\n0;0.25;0;-0.5;100  # at the left\n1;0.25;500;0.5;0\n");
  EXPECT_EQ(track.times, (std::vector<double>{0, 0.5}));
  EXPECT_LT(length(track.places[0] - Vec3{-0.005, 0.0001, 0.25}), 1e-15);
}

TEST(EyeTrackFile, WhatIsWrongIsSaidWithItsLine) {
  EXPECT_EQ(track_error("time_s,x_mm,y_mm\n0,0,0\n"),
            "1: expected one column z_mm, as in time_s,x_mm,y_mm,z_mm, got \"time_s,x_mm,y_mm\"");
  EXPECT_EQ(track_error("0,0,0,250\n0.2,0,0,250\n0.1,0,0,250\n"),
            "3: expected the times of an eye track in their order, got 100 ms after 200 ms");
  EXPECT_EQ(track_error("0,0,0,250\n0,0,0,250\n"),
            "2: expected the times of an eye track in their order, got 0 s after 0 s");
  EXPECT_EQ(track_error("0,0,0,250\n0.1,nan,0,250\n"),
            "2: expected 4 finite numbers, such as \"0.25,-5,0,250\" for time_s,x_mm,y_mm,z_mm, got \"0.1,nan,0,250\"");
  EXPECT_EQ(track_error("nan,0,0,250\n"),
            "1: expected 4 finite numbers, such as \"0.25,-5,0,250\" for time_s,x_mm,y_mm,z_mm, got \"nan,0,0,250\"");
  EXPECT_EQ(track_error("0,0,250\n"),
            "1: expected 4 finite numbers, such as \"0.25,-5,0,250\" for time_s,x_mm,y_mm,z_mm, got \"0,0,250\"");
  EXPECT_EQ(track_error("0,0,0,-250\n"), "1: expected an eye in front of the panel (z above 0 m), got z = -250 mm");
  EXPECT_EQ(track_error("0,0,0,250\n"), " expected two or more places of an eye over time, got 1");
  EXPECT_EQ(track_error(""), " expected two or more places of an eye over time, got 0");
}

Job walking_job(const std::string& lines, double time, const std::string& encode = "") {
  make_file("walk.csv", "0,-5,0,250\n1,5,0,250\n");
  return load_job(make_file("scene.toml", "wavelength = \"532 nm\"\n[encode]\nmethod = \"sgd\"\n" + encode +
                                              "[eye]\ntrack = \"walk.csv\"\n" + lines + test::cube),
                  Outside::refused, {}, "", time);
}

// 10 mm/s · 50 ms = 0.5 mm.
TEST(EyeTrackFile, TheCameraHasTheEyeAndHologramsTheMeasuredOne) {
  const Job job = walking_job("latency = \"50 ms\"\n", 0.5, "target = \"render\"\n");
  ASSERT_TRUE(job.tracked.has_value());
  EXPECT_EQ(job.camera.eye, (Vec3{0, 0, 0.25}));
  EXPECT_NEAR(job.encode.eye.at(0), -0.5e-3, 1e-15);
  EXPECT_EQ(job.camera.pupil, eye_pupil);
  EXPECT_FALSE(job.last_key.has_value()) << "nothing in the scene itself changes";
  EXPECT_EQ(last_change(job), 1);
  const Job at_once = walking_job("", 0.5, "target = \"render\"\n");
  EXPECT_EQ(at_once.encode.eye, (std::vector<double>{0, 0, 0.25}));
  EXPECT_FALSE(at_once.tracked->is_off());
  EXPECT_TRUE(walking_job("", 0.5, "target = \"field\"\n").encode.eye.empty());
}

// As --eye-track does.
TEST(EyeTrackFile, AnotherTrackEndsWhereItEnds) {
  Job job = walking_job("", 0.2);
  job.eye.track = make_file("short.csv", "\"time_s\",\"x_mm\",\"y_mm\",\"z_mm\"\n0;1;0;250\n0.4;1;0;250\n");
  follow_eye_track(job);
  EXPECT_EQ(last_change(job), 0.4);
  EXPECT_EQ(job.camera.eye, (Vec3{1e-3, 0, 0.25}));
}

TEST(EyeTrackFile, ScenesThatDoNotFitAreErrors) {
  const auto error = [](const std::string& lines, double time, const std::string& encode = "") {
    const std::string text = error_of([&] { walking_job(lines, time, encode); });
    return text.substr(text.find("expected"));
  };
  EXPECT_TRUE(error("", 1.5).starts_with("expected an eye track that lasts until 1.5 s, got one that ends at 1 s: "));
  EXPECT_EQ(error("latency = \"-1 ms\"\n", 0.5), "expected a time of 0 s or more for \"latency\", got -1 ms");
  EXPECT_EQ(error("", 0.5, "target = \"render\"\neye = [\"-30 0 250 mm\", \"30 0 250 mm\"]\n"),
            "expected one eye in [encode] beside an eye track, which has the places of one, got 2; leave eye out");
}

}  // namespace
}  // namespace holotrace
