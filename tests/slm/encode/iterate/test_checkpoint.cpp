#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/slm/encode/iterate/gradient_descent.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "support/targets.h"

namespace holotrace {
namespace {

// A checkpoint in memory that stops a descent after some updates. It is due after every third one.
struct Kept {
  std::optional<IterationState> state{};
  int stop_after = -1;
  std::vector<int> saved{};  // updates of each state that was saved
  int updates = 0;

  Checkpoint checkpoint() {
    return {.load =
                [this](const IterationState& job) {
                  if (state) {
                    EXPECT_EQ(state->job, job.job);
                  }
                  updates = state ? state->updates : 0;
                  return state;
                },
            .save =
                [this](const IterationState& now) {
                  state = now;
                  saved.push_back(now.updates);
                },
            .is_due = [this] { return ++updates % 3 == 0; },
            .is_stopping = [this] { return updates + 1 == stop_after; }};
  }
};

// What a job gives: levels, illumination and all that it reports.
struct Result {
  std::vector<Array2D<uint16_t>> levels, moduli;
  std::vector<double> numbers, convergence;
};

bool operator==(const Result& a, const Result& b) {
  for (size_t m = 0; m < a.levels.size(); ++m)
    if (a.levels[m].values != b.levels[m].values || a.moduli[m].values != b.moduli[m].values) return false;
  return a.numbers == b.numbers && a.convergence == b.convergence;
}

// A job of gradient descent.
struct CheckpointCase {
  std::string name;
  Slm slm = make_panel(48, 32);
  int frames = 3;
  bool has_two_colours = false, has_views = false;
  int updates = 10;
  std::vector<int> stops{1, 4, 9};
  EncodeParams params{.method = Encoding::sgd, .target_distances = {0.01, 0.011, 0.012}, .iterations = 10};

  TargetSet targets() const {
    TargetSet set{picture_targets(slm, params)};
    if (has_two_colours)
      for (const TargetPlane& target : picture_targets(slm, params, 633e-9)) set.planes.push_back(target);
    if (has_views)
      set.draw_views = [this](int update, double wavelength) {
        CounterRandom random(3, 0, uint64_t(update));
        ViewTargets views{.z = -0.01,
                          .wavelength = wavelength,
                          .window = window_of_pupils(slm.grid, 3e-4),
                          .picture = {},
                          .pupils = {},
                          .amplitudes = {}};
        views.pupils.push_back({{2e-4 * random.uniform(), 0, 0.02}, 3e-4});
        views.picture =
            picture_grid(slm.grid, slm.grid.width(), slm.grid.height(), views.pupils.front(), wavelength, views.z);
        views.amplitudes.emplace_back(views.picture.ny, views.picture.nx, 0.5F);
        return views;
      };
    return set;
  }

  Result run(const Checkpoint& checkpoint = {}) const {
    Result result;
    Observer observer;
    observer.on_fact = [&](const std::string&, const Fact& value) {
      if (const double* number = std::get_if<double>(&value)) result.numbers.push_back(*number);
    };
    observer.on_curve = [&](const std::string&, const std::vector<double>& values) { result.convergence = values; };
    for (const Hologram& hologram :
         encode_frames(targets(), test_wavelength, frames, slm, params, observer, checkpoint)) {
      result.levels.push_back(hologram.level);
      result.moduli.push_back(hologram.modulus_level);
      result.numbers.push_back(hologram.illumination);
    }
    return result;
  }
};

std::vector<CheckpointCase> checkpoint_cases() {
  CheckpointCase plain{.name = "planes"}, many{.name = "diagonals"}, complex{.name = "complex"},
      colours{.name = "colours"}, views{.name = "views"}, two{.name = "two planes per update"},
      soft{.name = "soft levels"}, early{.name = "ends early"};
  many.frames = 4;
  complex.slm.modulation = Modulation::complex;
  colours.has_two_colours = true;
  views.has_views = true;
  two.params.planes_per_update = 2;
  soft.slm.levels = 4;
  early.params.target_distances = {0.01};
  early.params.iterations = 60;
  early.params.least_gain = 100;  // never gained: begins to end after two windows of 10, and ends after a third
  early.updates = 30;
  early.stops = {5, 20, 26};
  return {plain, many, complex, colours, views, two, soft, early};
}

// Stopped after any number of updates, in the middle of a round of planes and at its end, and once more later.
TEST(DescentCheckpoint, GoesOnToTheSameBytes) {
  for (const CheckpointCase& c : checkpoint_cases()) {
    const Result whole = c.run();
    for (const int stop : c.stops) {
      Kept kept;
      kept.stop_after = stop;
      EXPECT_EQ(error_of([&] { c.run(kept.checkpoint()); }),
                "stopped after " + std::to_string(stop) + " of " + std::to_string(c.params.iterations) +
                    " iterations, which the checkpoint keeps; give the same command again to go on");
      ASSERT_TRUE(kept.state);
      EXPECT_EQ(kept.state->updates, stop);
      kept.stop_after = stop < 5 ? stop + 3 : -1;
      if (stop < 5) {
        EXPECT_NE(error_of([&] { c.run(kept.checkpoint()); }), "no error");
      }
      kept.stop_after = -1;
      EXPECT_TRUE(c.run(kept.checkpoint()) == whole) << c.name << ", stopped after " << stop;
      EXPECT_EQ(kept.state->updates, c.updates);
      EXPECT_TRUE(c.run(kept.checkpoint()) == whole) << c.name << ", from a finished job";
    }
  }
}

TEST(DescentCheckpoint, IsSavedBeforeTheFirstUpdateWhenItIsDueAndAtTheEnd) {
  Kept kept;
  CheckpointCase{}.run(kept.checkpoint());
  EXPECT_EQ(kept.saved, (std::vector<int>{0, 3, 6, 9, 10}));
}

TEST(DescentCheckpoint, KnowsEverythingThatTheResultDependsOn) {
  const auto job = [](const CheckpointCase& c, int level = 0) {
    std::vector<Hologram> frames(size_t(c.frames), make_hologram(c.slm, c.slm.modulation, [&](int) { return level; }));
    return descent_job(c.targets(), {c.slm, c.params}, frames).job;
  };
  const CheckpointCase plain;
  using Change = std::function<void(CheckpointCase&)>;
  const std::map<std::string, Change> changes{
      {"frames", [](CheckpointCase& c) { c.frames = 2; }},
      {"iterations", [](CheckpointCase& c) { c.params.iterations = 11; }},
      {"step", [](CheckpointCase& c) { c.params.step = 0.3; }},
      {"least gain", [](CheckpointCase& c) { c.params.least_gain = 0.1; }},
      {"stop", [](CheckpointCase& c) { c.params.stop = 0.5; }},
      {"seed", [](CheckpointCase& c) { c.params.seed = 2; }},
      {"subpixels", [](CheckpointCase& c) { c.params.subpixels = 3; }},
      {"planes per update", [](CheckpointCase& c) { c.params.planes_per_update = 2; }},
      {"distances", [](CheckpointCase& c) { c.params.target_distances.back() = 0.0121; }},
      {"part of the plane", [](CheckpointCase& c) { c.params.target_columns = 24; }},
      {"colours", [](CheckpointCase& c) { c.has_two_colours = true; }},
      {"views", [](CheckpointCase& c) { c.has_views = true; }},
      {"fill factor", [](CheckpointCase& c) { c.slm.fill_factor = 0.9; }},
      {"levels", [](CheckpointCase& c) { c.slm.levels = 128; }},
      {"phase range", [](CheckpointCase& c) { c.slm.phase_range = 6; }},
      {"crosstalk", [](CheckpointCase& c) { c.slm.effects.crosstalk = 0.2; }},
      {"aberration",
       [](CheckpointCase& c) {
         c.slm.effects.aberration = {{2, 0, 0.3}};
       }},
      {"dead pixels",
       [](CheckpointCase& c) {
         c.slm.effects.dead_pixels = {{3, 4, 5}};
       }},
      {"phase map",
       [](CheckpointCase& c) { c.slm.effects.phase_map = std::make_shared<const Array2D<float>>(32, 48, 0.1F); }}};
  EXPECT_EQ(job(plain), job(plain));
  EXPECT_NE(job(plain, 1), job(plain)) << "start";
  // The same map as another effect is another job.
  const auto map = std::make_shared<const Array2D<float>>(32, 48, 0.1F);
  CheckpointCase with_phase, with_light;
  with_phase.slm.effects.phase_map = with_light.slm.effects.light_map = map;
  EXPECT_NE(job(with_phase), job(with_light));
  for (const auto& [name, change] : changes) {
    CheckpointCase other;
    change(other);
    EXPECT_NE(job(other), job(plain)) << name;
  }
}

TEST(DescentCheckpoint, SaysWhatIsWrong) {
  const CheckpointCase c;
  Kept kept;
  c.run(kept.checkpoint());
  using Damage = std::function<void(IterationState&)>;
  const IterationState sound = *kept.state;
  for (const Damage& damage : {Damage([](IterationState& s) { s.updates = -1; }),
                               Damage([](IterationState& s) { s.numbers.front() = std::nan(""); }),
                               Damage([](IterationState& s) { s.numbers.back() = 1e9; }),  // of the order of planes
                               Damage([](IterationState& s) { s.arrays.back().values[7] = INFINITY; })}) {
    kept.state = sound;
    damage(*kept.state);
    EXPECT_NE(error_of([&] { c.run(kept.checkpoint()); }).find("damaged; remove the checkpoint"), std::string::npos);
  }
  kept.state = sound;
  kept.state->arrays.pop_back();
  EXPECT_NE(error_of([&] { c.run(kept.checkpoint()); }).find("remove the checkpoint"), std::string::npos);
  EncodeParams params{.method = Encoding::gerchberg_saxton, .target_distances = {0.01}};
  const Slm slm = make_panel(8, 6);
  EXPECT_EQ(error_of([&] {
              encode_targets(picture_targets(slm, params), Field(slm.grid, test_wavelength), slm, params, {},
                             kept.checkpoint());
            }),
            "expected the method sgd for a checkpoint, got \"gerchberg-saxton\"");
}

}  // namespace
}  // namespace holotrace
