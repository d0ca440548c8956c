// Films: holograms that are found from those of the last picture, and frames that are found beside fixed ones.

#include <cmath>
#include <vector>

#include "holotrace/slm/encode/iterate/shared_frames.h"
#include "slm/encode/iterate/descent_gradients.h"
#include "slm/encode/iterate/thread_links.h"

namespace holotrace {
namespace {

using test::are_same;
using test::descent_cases;
using test::DescentCase;
using test::Gradient;
using test::gradient_of;
using test::relative;

// A pattern of smooth waves that moves across the panel, in planes at these distances.
TargetSet picture_at(double shift, const Slm& slm, const std::vector<double>& distances) {
  TargetSet targets;
  for (const double distance : distances) {
    TargetPlane& plane = targets.planes.emplace_back();
    plane.z = -distance;
    plane.wavelength = test_wavelength;
    plane.amplitude = Array2D<float>(slm.grid.ny, slm.grid.nx);
    for (int j = 0; j < slm.grid.ny; ++j)
      for (int i = 0; i < slm.grid.nx; ++i)
        plane.amplitude(j, i) = float(1 + 0.6 * std::sin(2 * pi * (i - shift) / 24) * std::cos(2 * pi * j / 32) +
                                      0.3 * std::cos(2 * pi * (i - shift + j) / 17));
  }
  return targets;
}

EncodeParams iterations_of_still(int iterations) {
  EncodeParams params{.method = Encoding::sgd};
  params.iterations = iterations;
  return params;
}

// PSNR of the frames' mean light in the targets [dB], by the panel and the propagations that judgements use.
double psnr_of(const std::vector<Hologram>& frames, const TargetSet& targets, const Slm& slm) {
  Heard heard;
  std::vector<Hologram> shown = frames;
  judge(targets.planes, slm, {.method = Encoding::sgd}, heard.observer(), shown);
  return heard.number("psnr_db");
}

struct Film {
  std::vector<Hologram> frames;
  double psnr;         // of the last picture [dB]
  int64_t iterations;  // for it
};

// The last of several pictures, each from the levels of the one before, a quarter of a pixel further.
Film film_of(int pictures, const Slm& slm, int frames, const EncodeParams& params,
             const std::vector<double>& distances) {
  Film film{};
  for (int k = 0; k < pictures; ++k) {
    const TargetSet targets = picture_at(0.25 * k, slm, distances);
    Heard heard;
    film.frames =
        encode_frames(targets, test_wavelength, frames, slm, params, heard.observer(), {}, nullptr, film.frames);
    film.iterations = std::get<int64_t>(heard.facts.at("iterations"));
    film.psnr = psnr_of(film.frames, targets, slm);
  }
  return film;
}

// After four pictures that each moved by a quarter of a pixel, a film is better than a fresh start with as many iterations for the
// picture, on every kind of panel. The planes ask for more than the frames can show, as scenes do. Measured: 4 to 5 dB on panels of
// phase, where a fresh start is far off after so few; 0.4 dB or more on panels of amplitude.
TEST(NextPicture, IsBetterThanAfterAFreshStartWithAsManyIterations) {
  for (const Modulation modulation : {Modulation::phase, Modulation::amplitude, Modulation::complex})
    for (const int frames : {1, 3}) {
      Slm slm = make_panel(96, 64);
      slm.modulation = modulation;
      EncodeParams params = iterations_of_still(60);
      const std::vector<double> distances{0.009, 0.01, 0.011, 0.012};
      const Film film = film_of(5, slm, frames, params, distances);
      params.iterations = int(film.iterations);
      const TargetSet last = picture_at(0.25 * 4, slm, distances);
      const double of_fresh = psnr_of(encode_frames(last, test_wavelength, frames, slm, params), last, slm);
      EXPECT_LT(film.iterations, 60) << int(modulation) << " " << frames;
      EXPECT_GT(film.psnr, of_fresh + (modulation == Modulation::amplitude ? 0 : 2))
          << int(modulation) << " " << frames;
    }
}

// After a cut the levels of the last picture are no start: the hologram is that of a fresh one. With a number of iterations, it goes
// on in any case.
TEST(NextPicture, StartsAfreshAfterACut) {
  const Slm slm = make_panel(48, 32);
  EncodeParams params = iterations_of_still(20);
  TargetSet dark_half = picture_at(0, slm, {0.01}), other = picture_at(0, slm, {0.01});
  for (int j = 0; j < 32; ++j)
    for (int i = 0; i < 48; ++i) (i < 24 ? dark_half : other).planes.front().amplitude(j, i) = 0;
  const std::vector<Hologram> last = encode_frames(dark_half, test_wavelength, 1, slm, params);
  Heard heard;
  const auto next = [&](const Observer& observer) {
    return encode_frames(other, test_wavelength, 1, slm, params, observer, {}, nullptr, last);
  };
  EXPECT_TRUE(are_same(next(heard.observer()), encode_frames(other, test_wavelength, 1, slm, params)));
  EXPECT_EQ(std::get<std::string>(heard.facts.at("start")), "fresh");
  EXPECT_EQ(std::get<int64_t>(heard.facts.at("iterations")), 20);
  params.next_iterations = 4;
  next(heard.observer());
  EXPECT_EQ(std::get<std::string>(heard.facts.at("start")), "last");
  EXPECT_EQ(std::get<int64_t>(heard.facts.at("iterations")), 4);
}

// 3 at least, and as many as asked for.
TEST(NextPicture, TakesTheIterationsThatAreAskedFor) {
  EncodeParams params = iterations_of_still(20);
  EXPECT_EQ(next_iterations_of(params), 4);
  params.iterations = 5;
  EXPECT_EQ(next_iterations_of(params), 3);
  params.iterations = 200;
  EXPECT_EQ(next_iterations_of(params), 40);
  params.next_iterations = 2;
  EXPECT_EQ(next_iterations_of(params), 2);
}

// No update at all leaves the levels as they are, so that the picture does not jump; the illumination is fitted.
TEST(NextPicture, StartsFromTheLevelsOfTheLastOne) {
  const Slm slm = make_panel(48, 32);
  EncodeParams params = iterations_of_still(10);
  const TargetSet targets = picture_at(0, slm, {0.01});
  const std::vector<Hologram> still = encode_frames(targets, test_wavelength, 2, slm, params);
  params.step = 1e-6;  // far below half a level
  const std::vector<Hologram> next = encode_frames(targets, test_wavelength, 2, slm, params, {}, {}, nullptr, still);
  EXPECT_TRUE(are_same(next, still));
  EXPECT_NEAR(next.front().illumination, still.front().illumination, 1e-6 * still.front().illumination);
}

// A hologram of one field goes on in the same way.
TEST(NextPicture, OfATargetIsThatOfOneFrame) {
  const Slm slm = make_panel(48, 32);
  const EncodeParams params = iterations_of_still(40);
  const TargetSet first = picture_at(0, slm, {0.01}), second = picture_at(1, slm, {0.01});
  const std::vector<Hologram> still = encode_frames(first, test_wavelength, 1, slm, params);
  const Hologram next = encode_targets(second.planes, Field(slm.grid, test_wavelength), slm, params, {}, {}, still);
  EXPECT_TRUE(are_same({next}, encode_frames(second, test_wavelength, 1, slm, params, {}, {}, nullptr, still)));
}

// With light for eyes and with several colours in one hologram, too: of a picture that rests, the loss does not grow by more than the
// 5 % by which single updates, each of which knows one plane or view, move it.
TEST(NextPicture, GoesOnForViewsAndColours) {
  for (DescentCase one : descent_cases()) {
    if (one.name != "two colours" && one.name != "crosstalk") continue;
    const std::vector<Hologram> still = encode_frames(one.targets(), test_wavelength, one.frames, one.slm, one.params);
    const auto loss_after = [&](int iterations, double step) {
      Heard heard;
      EncodeParams params = one.params;
      params.next_iterations = iterations;
      params.step = step;
      encode_frames(one.targets(), test_wavelength, one.frames, one.slm, params, heard.observer(), {}, nullptr, still);
      EXPECT_EQ(std::get<std::string>(heard.facts.at("start")), "last");
      return heard.number("loss_last");
    };
    EXPECT_LT(loss_after(20, 0.02), 1.05 * loss_after(1, 1e-9)) << one.name;
  }
}

// Rolling frames: the first of the window goes, the others stay, and a new one is found. As it starts from the one that it
// replaces, the still picture of any window is as good as that of frames that were found together; measured, it gains.
TEST(RollingFrames, AreAsGoodInAnyWindowAsFramesFoundTogether) {
  const Slm slm = make_panel(96, 64);
  EncodeParams params = iterations_of_still(60);
  const std::vector<double> distances{0.009, 0.011};
  const TargetSet targets = picture_at(0, slm, distances);
  std::vector<Hologram> window = encode_frames(targets, test_wavelength, 4, slm, params);
  const double together = psnr_of(window, targets, slm);
  params.is_rolling = true;
  for (int k = 0; k < 6; ++k) {
    const std::vector<Hologram> next = encode_frames(targets, test_wavelength, 4, slm, params, {}, {}, nullptr, window);
    for (size_t m = 0; m + 1 < next.size(); ++m) {
      EXPECT_EQ(next[m].level.values, window[m + 1].level.values) << "a frame that was shown stays";
      EXPECT_EQ(next[m].illumination, next.back().illumination);
    }
    EXPECT_NE(next.back().level.values, window.front().level.values);
    window = next;
    EXPECT_GT(psnr_of(window, targets, slm), together - 0.1) << k;  // rounding of drives to levels
  }
}

// Light that goes out takes the frames that are shown already with it one by one.
TEST(RollingFrames, StayWhenThePictureIsDark) {
  const Slm slm = make_panel(96, 64);
  EncodeParams params = iterations_of_still(10);
  TargetSet targets = picture_at(0, slm, {0.01});
  const std::vector<Hologram> window = encode_frames(targets, test_wavelength, 3, slm, params);
  params.is_rolling = true;
  for (TargetPlane& plane : targets.planes)
    std::fill(plane.amplitude.values.begin(), plane.amplitude.values.end(), 0.0F);
  const std::vector<Hologram> next = encode_frames(targets, test_wavelength, 3, slm, params, {}, {}, nullptr, window);
  for (size_t m = 0; m < 2; ++m) {
    EXPECT_EQ(next[m].level.values, window[m + 1].level.values) << m;
    EXPECT_EQ(next[m].illumination, window[m + 1].illumination) << m;
  }
  EXPECT_EQ(next[2].illumination, 0);
}

// Of a moving picture the frames of a window belong to several pictures. Its error is above that of frames found together for
// the last picture, but far below that of the old frames.
TEST(RollingFrames, FollowAMovingPicture) {
  const Slm slm = make_panel(96, 64);
  EncodeParams params = iterations_of_still(60);
  const std::vector<double> distances{0.01};
  std::vector<Hologram> window = encode_frames(picture_at(0, slm, distances), test_wavelength, 4, slm, params);
  const std::vector<Hologram> old = window;
  params.is_rolling = true;
  params.next_iterations = 6;
  for (int k = 1; k <= 8; ++k)
    window =
        encode_frames(picture_at(0.25 * k, slm, distances), test_wavelength, 4, slm, params, {}, {}, nullptr, window);
  const TargetSet last = picture_at(2, slm, distances);
  EXPECT_GT(psnr_of(window, last, slm), psnr_of(old, last, slm) + 3);
}

// Fixed frames have no slopes; those of the others are as if none were fixed.
template <class MakeArrays>
void expect_slopes_of_the_others(const MakeArrays& make) {
  for (DescentCase one : descent_cases()) {
    one.frames = 3;
    const std::vector<Hologram> start = one.start();
    const size_t fixed = 2, arrays = one.slm.modulation == Modulation::complex ? 2 : 1;
    ProcessorFrames all(one.slm, one.params, start);
    const Gradient expected = gradient_of(one, all, {}), found = make(one, start, fixed);
    ASSERT_EQ(found.slopes.size(), expected.slopes.size()) << one.name;
    for (size_t k = 0; k < found.slopes.size(); ++k) {
      if (k >= fixed * arrays)
        EXPECT_LT(relative(found.slopes[k], expected.slopes[k]), 1e-5) << one.name;  // as in descent_gradients.h
      else
        for (const float slope : found.slopes[k].values) ASSERT_EQ(slope, 0) << one.name;
    }
    for (size_t k = 0; k < expected.numbers.size(); ++k)
      EXPECT_NEAR(found.numbers[k], expected.numbers[k], 2e-6 * std::abs(expected.numbers[k])) << one.name;
  }
}

TEST(FixedFrames, LeaveTheSlopesOfTheOthers) {
  expect_slopes_of_the_others([](const DescentCase& one, const std::vector<Hologram>& start, size_t fixed) {
    ProcessorFrames arrays(one.slm, one.params, start, {}, fixed);
    return gradient_of(one, arrays, {});
  });
}

TEST(FixedFrames, LeaveTheSlopesOfTheOthersInSeveralProcesses) {
  expect_slopes_of_the_others([](const DescentCase& one, const std::vector<Hologram>& start, size_t fixed) {
    test::ThreadLinks links(2, optimise_frames_for_first_process);
    SharedFrames frames(links, {one.slm, one.params, {.is_near = true, .fixed = fixed}}, {}, start,
                        [&](const std::vector<Hologram>& own, const OtherFrames& others, size_t fixed_here) {
                          return std::make_unique<ProcessorFrames>(one.slm, one.params, own, others, fixed_here);
                        });
    Gradient gradient = gradient_of(one, frames, {});
    frames.finish();
    return gradient;
  });
}

class FixedFramesOnDevices : public test::DescentsOnDevices {};
HOLOTRACE_FOR_ALL_DEVICES(FixedFramesOnDevices);

TEST_P(FixedFramesOnDevices, LeaveTheSlopesOfTheOthers) {
  expect_slopes_of_the_others([&](const DescentCase& one, const std::vector<Hologram>& start, size_t fixed) {
    DeviceFrames arrays({&device_}, one.slm, one.params, start, {}, fixed);
    return gradient_of(one, arrays, {});
  });
}

TEST(NextPicture, RefusesHologramsThatDoNotFit) {
  const Slm slm = make_panel(48, 32);
  const EncodeParams params = iterations_of_still(4);
  const TargetSet targets = picture_at(0, slm, {0.01});
  const std::vector<Hologram> still = encode_frames(targets, test_wavelength, 2, slm, params);
  const auto error_for = [&](const std::vector<Hologram>& last, int frames = 2) {
    return error_of([&] { encode_frames(targets, test_wavelength, frames, slm, params, {}, {}, nullptr, last); });
  };
  EXPECT_EQ(error_for(still, 3), "expected 3 frame(s) of the last picture, as many as the new one has, got 2");
  std::vector<Hologram> other = still;
  other[1].level = Array2D<uint16_t>(32, 40);
  EXPECT_EQ(error_for(other), "expected a last hologram of 48 × 32 pixels, as the panel has, got 40 × 32");
  other = still;
  other[0].levels = 16;
  EXPECT_EQ(
      error_for(other),
      "expected a last hologram of 256 levels of phase, got 16 levels of phase; give one that was made for this panel");
  other = still;
  other[0].wavelength = 633e-9;
  EXPECT_EQ(
      error_for(other),
      "expected a last hologram at 532 nm, got one at 633 nm; give the holograms of each wavelength in the order of "
      "the new ones");
  EncodeParams projections = params;
  projections.method = Encoding::gerchberg_saxton;
  EXPECT_EQ(error_of([&] {
              encode_targets(targets.planes, Field(slm.grid, test_wavelength), slm, projections, {}, {}, {still[0]});
            }),
            "expected the method sgd for a start from the last holograms, got \"gerchberg-saxton\"");
}

}  // namespace
}  // namespace holotrace
