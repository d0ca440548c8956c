// The sentences of docs/explanation/conventions.md that no room tests by itself; each sentence must have a test.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>

#include "end_to_end/scenes.h"
#include "holotrace/base/units.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/shapes.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/trace/render.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/sum_exact.h"
#include "support/build_paths.h"
#include "support/fields.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

using namespace literals;
using Complex = std::complex<double>;

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Names in backquotes in the "Test:" part of a sentence.
std::set<std::string> names_of_tests(const std::string& text) {
  static const std::regex name("`([A-Z][A-Za-z0-9]*)\\.([A-Z][A-Za-z0-9]*)`");
  std::set<std::string> names;
  for (std::sregex_iterator i(text.begin(), text.end(), name), end; i != end; ++i)
    names.insert((*i)[1].str() + "." + (*i)[2].str());
  return names;
}

TEST(Conventions, EverySentenceNamesTestsThatExist) {
  const std::filesystem::path source = HOLOTRACE_SOURCE_DIR;
  std::set<std::string> existing;
  static const std::regex test("TEST(_P|_F)?\\(\\s*([A-Za-z0-9]+),\\s*([A-Za-z0-9]+)\\s*\\)");
  for (const auto& entry : std::filesystem::recursive_directory_iterator(source / "tests")) {
    if (entry.path().extension() != ".cpp") continue;
    const std::string text = text_of(entry.path());
    for (std::sregex_iterator i(text.begin(), text.end(), test), end; i != end; ++i)
      existing.insert((*i)[2].str() + "." + (*i)[3].str());
  }
  const std::string document = text_of(source / "docs" / "explanation" / "conventions.md");
  static const std::regex sentence("\n(\\d+)\\. ");
  std::vector<size_t> begins;
  for (std::sregex_iterator i(document.begin(), document.end(), sentence), end; i != end; ++i) {
    begins.push_back(size_t(i->position()));
    EXPECT_EQ((*i)[1].str(), std::to_string(begins.size())) << "sentences are numbered in order";
  }
  ASSERT_GE(begins.size(), 15U);  // fewer means that the pattern no longer matches
  for (size_t s = 0; s < begins.size(); ++s) {
    const size_t end = s + 1 < begins.size() ? begins[s + 1] : document.size();
    const auto names = names_of_tests(document.substr(begins[s], end - begins[s]));
    EXPECT_FALSE(names.empty()) << "sentence " << s + 1 << " has no test";
    for (const std::string& name : names) EXPECT_TRUE(existing.contains(name)) << "sentence " << s + 1 << ": " << name;
  }
}

TEST(Conventions, TheGridIsCentredOnTheOrigin) {
  const Grid odd{5, 3, 8e-6}, even{4, 2, 8e-6};
  EXPECT_EQ(odd.x(2), 0);
  EXPECT_EQ(odd.y(1), 0);
  EXPECT_EQ(even.x(1), -4e-6);  // half a pitch to each side
  EXPECT_EQ(even.x(2), 4e-6);
  EXPECT_EQ(even.y(0), 4e-6);
  EXPECT_EQ(even.y(1), -4e-6);
}

TEST(Conventions, XGrowsWithTheColumnAndYFallsWithTheRow) {
  const Grid grid{1920, 1080, 8e-6};
  EXPECT_DOUBLE_EQ(grid.x(0), -959.5 * 8e-6);  // (0 − 1919/2)·pitch
  EXPECT_DOUBLE_EQ(grid.x(1919), 959.5 * 8e-6);
  EXPECT_DOUBLE_EQ(grid.y(0), 539.5 * 8e-6);  // ((1079/2) − 0)·pitch: the top
  EXPECT_DOUBLE_EQ(grid.y(1079), -539.5 * 8e-6);
}

TEST(Conventions, TheFrameIsRightHandedWithZTowardTheViewer) {
  // A point on the right, rotated about z by 90°, is above; the picture, which looks along −z, shows it on top.
  Scene scene;
  scene.points.push_back({transform_point(rotation_z(90_deg), {0.001, 0, -0.1}), 1, 0});
  EXPECT_NEAR(scene.points[0].position.y, 0.001, 1e-15);
  RenderParams params;
  params.rows = 65;
  const Image image = render(scene, small_panel, test_wavelength, params);
  int brightest = 0;
  for (int i = 0; i < int(image.values.size()); ++i)
    if (image.values[size_t(i)] > image.values[size_t(brightest)]) brightest = i;
  const int row = brightest / 3 / image.nx, column = brightest / 3 % image.nx;
  EXPECT_EQ(column, 32);  // on the axis
  EXPECT_LT(row, 32);     // above it
}

// The wave of a point on the axis, summed in double precision.
FieldDouble wave_of(double depth, float amplitude = 1, const Grid& grid = small_panel) {
  return sum_exact({test_wavelength, {{{0, 0, -depth}, amplitude, 0}}}, grid);
}

TEST(Conventions, LightTravelsTowardPlusZ) {
  // After 5 mm along +z, the wave of a point 40 mm behind is that of a point 45 mm behind, weaker by 40/45. The panel
  // cuts it off, and the fringes of that edge lower the correlation. The phase, 9398 turns in 5 mm, is kept.
  const FieldDouble moved = propagate(wave_of(0.040), 0.005);
  const FieldDouble expected = wave_of(0.045, 40.F / 45);
  Complex sum = 0;
  double a = 0, b = 0;
  for (int j = 48; j < 144; ++j)  // the middle, where the edge's fringes are weak
    for (int i = 64; i < 192; ++i) {
      sum += moved.samples(j, i) * std::conj(expected.samples(j, i));
      a += std::norm(moved.samples(j, i));
      b += std::norm(expected.samples(j, i));
    }
  EXPECT_GT(std::abs(sum) / std::sqrt(a * b), 0.95);
  EXPECT_NEAR(std::arg(sum), 0, 0.05);
  EXPECT_NEAR(moved.z, 0.005, 1e-18);
}

TEST(Conventions, ArraysAreRowMajorFromTheTopLeft) {
  Field field({3, 2, 8e-6}, 532_nm);  // 3 columns, 2 rows
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 3; ++i) field.samples(j, i) = {float(j), float(i)};
  EXPECT_EQ(field.samples.values[1], std::complex<float>(0, 1));  // the next sample is to the right
  EXPECT_EQ(field.samples.values[3], std::complex<float>(1, 0));  // and the next row below
  const Workplace work;
  save_field(work.path("f.npy"), field);
  const std::string bytes = work.read("f.npy");
  EXPECT_NE(bytes.find("'shape': (2, 3)"), std::string::npos);
  EXPECT_NE(bytes.find("'fortran_order': False"), std::string::npos);
}

TEST(Conventions, APointsPhaseGrowsWithDistance) {
  const double depth = 0.03, k = 2 * pi / test_wavelength;
  const FieldDouble field = wave_of(depth);
  for (const int column : {130, 180, 230}) {
    const double x = field.grid.x(column), y = field.grid.y(96);
    const double r = std::sqrt(x * x + y * y + depth * depth);
    // exp(+ikr) and not its conjugate: in double precision k·r = 3.5e5 rad is correct to 1e-10.
    EXPECT_NEAR(std::arg(field.samples(96, column) * std::polar(1.0, -k * r)), 0, 1e-9) << column;
  }
}

TEST(Conventions, AConvergingLensFocusesAtItsFocalLength) {
  const Grid grid{129, 129, 8e-6};
  const double f = 0.03, k = 2 * pi / test_wavelength, side = grid.width();
  const auto on_axis = [&](double sign) {
    const FieldDouble lens = holotrace::test::make_field(grid, test_wavelength, [&](double x, double y) {
      return std::polar(1.0, sign * k * (x * x + y * y) / (2 * f));
    });
    return std::norm(propagate(lens, f).samples(64, 64));
  };
  // The whole aperture in phase: (S²/λf)² = 4451. The term k·ρ⁴/8f³ of a sphere, which a thin lens lacks, is 0.015 rad
  // at the corner and costs 1e-4; the angular spectrum's band and the obliquity cos θ ≥ 0.9997 cost less than 1 %.
  EXPECT_NEAR(on_axis(-1) / std::pow(side * side / (test_wavelength * f), 2), 1, 0.01);
  // The opposite sign diverges: at +f the light fills twice the width, and |u|² is about 1/4, up to edge fringes.
  EXPECT_LT(on_axis(+1), 1);
}

TEST(Conventions, PowerIsTheSumOfSquaredModuliTimesThePixelsArea) {
  Field field({10, 20, 8e-6}, 532_nm);
  for (auto& u : field.samples.values) u = {3, 4};      // 25 W/m²
  EXPECT_NEAR(power(field), 25 * 200 * 64e-12, 1e-20);  // the rounding of 200 additions is far below
  // The same for a wave on the SLM: 1 W/m² on 256 × 192 pixels of 64 µm².
  Hologram hologram{small_panel, {small_panel.ny, small_panel.nx}, 256, Modulation::phase, 532_nm, {}, {}, "", {}};
  const Field shown = show(hologram, {.grid = small_panel, .fill_factor = 1}, {});
  EXPECT_NEAR(power(shown) / (49152 * 64e-12), 1, 1e-6);  // a flat panel of fill factor 1 loses nothing
}

TEST(Conventions, PhaseIsReducedBeforeItBecomesAFloat) {
  // At 0.3 m one float ulp of r is 0.2 rad; reduced in double precision, a complex64 has its phase to 2⁻²³ rad.
  const double depth = 0.3;
  const Field field = convert<float>(wave_of(depth));
  const long double k = 2 * std::numbers::pi_v<long double> / 532e-9L;
  for (const int column : {0, 100, 255}) {
    const long double x = field.grid.x(column), y = field.grid.y(10);
    const long double r = std::sqrt(x * x + y * y + (long double)(depth)*depth);
    const auto u = Complex(field.samples(10, column));
    const double phase = double(std::remainder(k * r, 2 * std::numbers::pi_v<long double>));
    EXPECT_NEAR(std::arg(u * std::polar(1.0, -phase)), 0, std::ldexp(1, -23)) << column;
  }
}

TEST(Conventions, AnEightBitGreyShowsItsPartOfACycle) {
  const Grid panel{256, 2, 8e-6};
  Hologram hologram{panel, {panel.ny, panel.nx}, 256, Modulation::phase, 532_nm, {}, {}, "", {}};
  for (int i = 0; i < 256; ++i) hologram.level(0, i) = hologram.level(1, i) = uint16_t(i);
  // Through a file, where a level is a grey, onto a panel without gaps. One sample per pixel is smoothed by the pixel's
  // sinc, so the test compares the only line of the spectrum: the ramp's own order, 1 cycle in 256 pixels.
  const Workplace work;
  save_hologram(work.path("h.png"), hologram);
  const Hologram loaded = load_hologram(work.path("h.png"));
  const Field shown = show(loaded, {.grid = panel, .fill_factor = 1}, {});
  for (const int grey : {0, 1, 64, 128, 200, 255}) {
    EXPECT_EQ(loaded.level(0, grey), grey);
    const auto u = Complex(shown.samples(0, grey));
    EXPECT_NEAR(std::arg(u * std::polar(1.0, -2 * pi * grey / 256)), 0, 1e-6) << grey;  // a few float rounding errors
  }
}

TEST(Conventions, TheRealImageIsTheConjugate) {
  const Field field = convert<float>(wave_of(0.03));
  const Slm slm{.grid = small_panel};
  EncodeParams shown_as_real;
  shown_as_real.image = ImageSide::real_image;
  const Hologram direct = encode(field, slm, {}), conjugate = encode(field, slm, shown_as_real);
  EXPECT_EQ(direct.image, ImageSide::virtual_image);
  EXPECT_EQ(conjugate.image, ImageSide::real_image);
  for (size_t i = 0; i < direct.level.size(); ++i) {
    // −2πℓ/256 is level (256 − ℓ) mod 256; a phase halfway between two levels may round either way.
    const int sum = (direct.level.values[i] + conjugate.level.values[i]) % 256;
    EXPECT_TRUE(sum == 0 || sum == 1 || sum == 255) << i;
  }
}

TEST(Conventions, TheVirtualImageIsBehindThePanelAndTheRealOneInFront) {
  const Grid grid{129, 129, 8e-6};  // odd: the point is at pixel (64, 64)
  const FieldDouble u = wave_of(0.03, 1, grid);
  FieldDouble conjugate = u;
  for (auto& sample : conjugate.samples.values) sample = std::conj(sample);
  const auto middle = [](const FieldDouble& field) { return std::norm(field.samples(64, 64)); };
  const double behind = middle(propagate(u, -0.03)), in_front = middle(propagate(conjugate, 0.03));
  EXPECT_GT(behind, 100 * middle(propagate(u, 0.03)));  // in focus 4451 times, diverging once, as with the lens above
  EXPECT_GT(in_front, 100 * middle(propagate(conjugate, -0.03)));
  EXPECT_NEAR(behind / in_front, 1, 1e-9);  // mirror images of each other, up to double rounding
}

}  // namespace
}  // namespace holotrace::test
