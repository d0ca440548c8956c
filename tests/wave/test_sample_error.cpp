#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/sum_exact.h"
#include "support/fields.h"

namespace holotrace {
namespace {

using namespace literals;
using test::make_random_sources;
using test::relative_error;

const Grid sampled_panel{96, 61, 8_um};

TEST(SampledError, IsThatOfAFieldOffByAFactor) {
  // Every pixel is wrong by the same factor, so any draw gives that factor. In double: rounding of 1e-16 each.
  const Sources sources = make_random_sources(40, sampled_panel, 532_nm, 0.1_m, 0.3_m);
  FieldDouble field = sum_exact(sources, sampled_panel);
  for (auto& u : field.samples.values) u *= 1.003;
  EXPECT_NEAR(sampled_error(field, sources, 1), 0.003, 1e-11);
  EXPECT_NEAR(sampled_error(field, sources, 500), 0.003, 1e-11);
}

TEST(SampledError, OfNoiseIsThatOfTheWholeField) {
  const Sources sources = make_random_sources(40, sampled_panel, 532_nm, 0.1_m, 0.3_m);
  const FieldDouble exact = sum_exact(sources, sampled_panel);
  FieldDouble field = exact;
  CounterRandom random(5, 0, 0);
  for (auto& u : field.samples.values) u += std::polar(1e-2 * random.uniform(), 2 * pi * random.uniform());
  const double whole = relative_error(field, exact), sampled = sampled_error(field, sources, 2000);
  // The squares of both sums scatter by about 1/√2000 each, the root of their ratio by 1.6 %: five times that.
  EXPECT_NEAR(sampled / whole, 1, 0.08);
}

TEST(SampledError, FollowsTheAmplitudesOfTiles) {
  Sources sources = make_random_sources(6, sampled_panel, 532_nm, 0.1_m, 0.3_m);
  sources.tiles = {.columns = 3, .rows = 2, .values = {}};
  CounterRandom random(6, 0, 0);
  for (size_t k = 0; k < 6 * sources.waves.size(); ++k) sources.tiles.values.push_back(float(random.uniform()));
  // Both sums are in double, with the same terms in the same order.
  EXPECT_LT(sampled_error(sum_exact(sources, sampled_panel), sources, 3000), 1e-14);
}

TEST(SampledError, OfNothingAgainstNothingIsNothing) {
  // The wave's box lies outside the panel.
  const Sources beside{532_nm, {{{0.5_m, 0, -0.1_m}, 1.0F, 0.0F}}};
  Field field(sampled_panel, 532_nm);
  EXPECT_EQ(sampled_error(field, beside, 50), 0);
  for (auto& u : field.samples.values) u = 1;
  EXPECT_TRUE(std::isinf(sampled_error(field, beside, 50)));
}

TEST(SampledError, RefusesWhatCannotBeCompared) {
  const Sources sources = make_random_sources(2, sampled_panel, 532_nm, 0.1_m, 0.3_m);
  EXPECT_THROW(sampled_error(Field(sampled_panel, sources.wavelength), sources, 0), Error);
  EXPECT_THROW(sampled_error(Field(sampled_panel, 633_nm), sources, 5), Error);
}

}  // namespace
}  // namespace holotrace
