#include <gtest/gtest.h>

#include <vector>

#include "holotrace/run/choose.h"
#include "holotrace/run/estimate/film_estimate.h"

// What films cost, from costs of a still that are made up: no time of this machine is in these tests.

namespace holotrace {
namespace {

constexpr double exact = 1e-12;  // relative: some sums and products of doubles

Job still_job() {
  Job job;
  job.slm.grid = {256, 128, 8e-6};
  job.slm.levels = 256;
  job.wavelengths = {638e-9, 532e-9, 450e-9};
  job.camera.distances = {0.3};
  job.render.rows = 10;
  job.render.columns = 20;
  job.encode.method = Encoding::sgd;
  job.encode.iterations = 100;
  return job;
}

// A run of 10 s: 1 s of tracing, 2 s of sums, 5 s of encoding, 2 s of everything else.
CostAnswer cost_of_still() {
  CostAnswer answer;
  answer.estimate.sets = 3;
  answer.estimate.frames = 4;
  answer.estimate.mean_path_length = 2.5;
  answer.estimate.waves_pixels = 7e9;
  answer.estimate.stages = {{"render", 1.5}, {"trace", 1}, {"synthesize", 2}, {"encode", 5}, {"show", 0.5}};
  answer.ours.paths = 1e6;
  answer.real.times = 2;
  answer.real.multiply_adds_per_second = 2e11;  // the peak of the machine is 1e11/s
  return answer;
}

TEST(FilmEstimate, SecondsAreThoseOfWhatEachTimeComputes) {
  const FilmCounts counts{.times = 10, .afresh = 2, .continued = 3, .reused = 1, .equal = 4};
  const FilmEstimate film = estimate_film(cost_of_still(), still_job(), counts, 25);
  // A fifth of the iterations: 6 s; only views: 2 s.
  EXPECT_NEAR(film.seconds, 2 * 10 + 3 * 6 + 1 * 2, exact * film.seconds);
  EXPECT_EQ(film.first_seconds, 10);
  // Trace, sum and encode: 2·8 s + 3·4 s in 10 times.
  EXPECT_NEAR(film.real.seconds_per_frame, 2.8, exact);
  EXPECT_NEAR(film.real.times, 70, 70 * exact);
  EXPECT_NEAR(film.real.multiply_adds_per_second, 70e11, 70e11 * exact);
}

// 4 frames × 3 colours × 25/s of 8 bits: 300 holograms, 2400 bit planes and 300·256·128 bytes per second.
TEST(FilmEstimate, TheDisplayShowsFramesColoursAndBitPlanes) {
  const FilmEstimate film = estimate_film(cost_of_still(), still_job(), {.times = 50, .afresh = 50}, 25);
  EXPECT_EQ(film.holograms(), 600);
  EXPECT_EQ(film.holograms_per_second(), 300);
  EXPECT_EQ(film.bit_planes_per_second(), 2400);
  EXPECT_EQ(film.bytes_per_second(), 300.0 * 256 * 128);
  Job binary = still_job();
  binary.slm.levels = 2;
  EXPECT_EQ(estimate_film(cost_of_still(), binary, {.times = 50, .afresh = 50}, 25).bytes_per_second(),
            300.0 * 256 * 128 / 8);
  binary.slm.levels = 240;  // of a panel: 8 bits, too
  EXPECT_EQ(estimate_film(cost_of_still(), binary, {.times = 50, .afresh = 50}, 25).bits, 8);
}

// Each time 12 holograms of 256 × 128 bytes; a view of three channels and a render of 20 × 10, each as bytes and, for the
// films, as numbers of four bytes.
TEST(FilmEstimate, BytesOnDiskAreHologramsAndPictures) {
  const FilmEstimate film = estimate_film(cost_of_still(), still_job(), {.times = 50, .afresh = 50}, 25);
  EXPECT_EQ(film.bytes_on_disk, 50 * (12.0 * 256 * 128 + 3.0 * 256 * 128 * 5 + 3.0 * 200 * 5));
}

// Eq. 17 with Eq. 23: F·N·(1 + l_avg) rays per second, of which a part is traced again.
TEST(FilmEstimate, RaysPerSecondAreThoseOfEquation17) {
  const FilmCounts counts{.times = 10, .afresh = 2, .continued = 3, .reused = 1, .equal = 4};
  const FilmEstimate film = estimate_film(cost_of_still(), still_job(), counts, 25);
  EXPECT_NEAR(film.rays_per_second, 25 * 1e6 * 3.5, 1e8 * exact);
  EXPECT_NEAR(film.new_rays_per_second, 25 * 1e6 * 3.5 / 2, 1e8 * exact);
  EXPECT_NEAR(film.waves_pixels_per_second, 25 * 4 * 7e9 * 0.2, 1e12 * exact);
}

Job job_at(double brightness, double eye, Encoding method = Encoding::phase) {
  Job job = still_job();
  job.encode.method = method;
  if (method == Encoding::sgd) job.encode.target = EncodeTarget::render;
  job.scene.background = {brightness, brightness, brightness};
  job.camera.eye = {eye, 0, 0.25};
  return job;
}

TEST(FilmEstimate, TimesAreCountedByWhatChanges) {
  const std::vector<double> times{0, 1, 2, 3, 4};
  // The scene changes until 2 s, then the eye moves until 3 s.
  const auto moving = [](double time) { return job_at(std::min(time, 2.0), time > 2 ? 1e-3 : 0); };
  const FilmCounts counts = count_film_times(times, moving, false);
  EXPECT_EQ(counts.afresh, 3);
  EXPECT_EQ(counts.reused, 1);
  EXPECT_EQ(counts.equal, 1);
  EXPECT_EQ(counts.continued, 0);
  // Optimised holograms depend on what the camera sees.
  const auto optimised = [](double time) { return job_at(0, 1e-3 * time, Encoding::sgd); };
  EXPECT_EQ(count_film_times(times, optimised, false).afresh, 5);
  EXPECT_EQ(count_film_times(times, optimised, true).continued, 4);
}

// Of 1001 times, 100 pairs are compared: a scene that rests in its second half has half of them equal.
TEST(FilmEstimate, LongFilmsAreCountedByEvenlySpacedPairs) {
  std::vector<double> times;
  for (int i = 0; i <= 1000; ++i) times.push_back(i);
  size_t loaded = 0;
  const FilmCounts counts = count_film_times(
      times,
      [&](double time) {
        ++loaded;
        return job_at(std::min(time, 500.0), 0);
      },
      false);
  EXPECT_LE(loaded, 2 * most_pairs);
  EXPECT_NEAR(counts.equal, 500, 10);  // one pair stands for ten
  EXPECT_NEAR(counts.afresh + counts.equal, 1001, 1e-9);
}

}  // namespace
}  // namespace holotrace
