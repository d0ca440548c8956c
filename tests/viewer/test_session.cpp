// What people see in the viewer: the pictures of `holotrace show`, and what belongs to them.

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "holotrace/base/random.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/field/sources_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/new_file.h"
#include "holotrace/io/picture/animation.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/run/view_holograms.h"
#include "holotrace/run/viewing.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/camera.h"
#include "holotrace/viewer/session.h"
#include "support/png.h"
#include "support/temporary.h"
#include "viewer/holograms.h"

namespace holotrace::test {
namespace {

using Json = nlohmann::json;

struct Expected {
  Image image;
  double white;
};

// The picture of holograms as `holotrace show` makes it.
Expected as_show_makes_it(const std::vector<Hologram>& holograms, const ViewState& state) {
  const auto from = viewpoints(state.camera);
  Report report;
  const StageObserver watch;
  RepeatedStages repeat(1, 1, 1, report, watch);
  std::vector<CombinedViews> sums(1);
  for (const Hologram& hologram : holograms)
    view_hologram(hologram, {*hologram.slm, state.show, {}, from}, repeat, sums);
  ViewSeries series = expose_series(from, sums, ViewKind::distance, state.camera);
  return {series.images.front(), series.white};
}

const std::vector<std::pair<const char*, Query>> settings{
    {"all light", {}},
    {"a focus", {{"distance", "20 mm"}}},
    {"an eye", {{"distance", "15 mm"}, {"pupil", "0.4 mm"}, {"eye", "0.02 -0.03 12 mm"}}},
    {"an eye on the panel", {{"pupil", "0.3 mm"}, {"eye", "0.05 0 0 mm"}}},
    {"a lens", {{"pupil", "0.4 mm"}, {"eye", "0 0 100 mm"}, {"focal-length", "17 mm"}}},
    {"orders and effects", {{"subpixels", "3"}, {"effects", "gaps"}}},
    {"partly coherent light", {{"bandwidth", "5 nm"}, {"source-angle", "0.2 mrad"}, {"illumination-states", "5"}}},
    {"a noisy sensor", {{"electrons", "1000"}, {"read-noise", "3"}, {"exposure", "2"}}},
    {"other pixels", {{"width", "0.3 mm"}, {"pixel", "12 um"}, {"centre-x", "0.05 mm"}}}};

TEST(Session, ShowsThePicturesOfShowBitForBit) {
  std::vector<Hologram> holograms{random_hologram(532e-9, 0), random_hologram(532e-9, 1),
                                  random_hologram(638e-9, 0, 2)};
  Session session({folder_of(holograms)});
  for (const auto& [name, query] : settings) {
    const ViewState state = session.state_of(query);
    const Expected expected = as_show_makes_it(holograms, state);
    for (int again = 0; again < 2; ++again) {  // from the files, and from the light that is kept
      session.view(session.state_of({{"distance", "33 mm"}}));
      const TakenView view = *session.view(state);
      EXPECT_EQ(view.image.values, expected.image.values) << name;
      EXPECT_EQ(view.white, expected.white) << name;
    }
  }
}

TEST(Session, ADraftShowsTheFirstFrameOfEachColourAndName) {
  std::vector<Hologram> holograms{random_hologram(532e-9, 0), random_hologram(532e-9, 1), random_hologram(638e-9, 0, 2),
                                  random_hologram(638e-9, 1)};
  Hologram named = random_hologram(532e-9, 2);
  named.label.name = "lamp";
  holograms.push_back(named);
  Session session({folder_of(holograms)});
  ViewState state = session.state_of({{"distance", "20 mm"}});
  state.is_draft = true;
  const TakenView draft = *session.view(state);
  state.camera.sampling = PixelSampling::point;  // as a draft reads its pixels
  EXPECT_EQ(draft.image.values, as_show_makes_it({holograms[0], holograms[2], holograms[4]}, state).image.values);
}

TEST(Session, ShowsThemWithAStopToo) {
  Hologram hologram = random_hologram(532e-9, 0);
  hologram.filter = SpectralFilter{1e4, 0, 2e4, 3e4};
  Session session({folder_of({hologram})});
  for (const Query& query : {Query{}, Query{{"pupil", "0.4 mm"}, {"eye", "0 0 12 mm"}, {"distance", "15 mm"}}}) {
    const ViewState state = session.state_of(query);
    EXPECT_EQ(session.view(state)->image.values, as_show_makes_it({hologram}, state).image.values);
  }
}

TEST(Session, ShowsSomeOfTheHolograms) {
  std::vector<Hologram> holograms{random_hologram(532e-9, 0), random_hologram(532e-9, 1), random_hologram(638e-9, 0)};
  Session session({folder_of(holograms)});
  const ViewState state = session.state_of({{"items", "1"}});
  EXPECT_EQ(session.view(state)->image.values, as_show_makes_it({holograms[1]}, state).image.values);
}

TEST(Session, KeepsNoMoreLightThanAllowed) {
  LightCache cache(2.5 * 64 * 48 * 8);  // two and a half fields of 64 × 48 complex floats
  const auto make = [](const Observer&) { return Field({64, 48, 8e-6}, 5e-7); };
  cache.get("a", {}, make);
  cache.get("b", {}, make);
  cache.get("a", {}, [&](const Observer&) -> Field { throw Error("it is kept"); });
  cache.get("c", {}, make);
  EXPECT_EQ(cache.bytes(), 2.0 * 64 * 48 * 8);
  EXPECT_NO_THROW(cache.get("a", {}, [&](const Observer&) -> Field { throw Error("it was used last"); }));
  EXPECT_THROW(cache.get("b", {}, [&](const Observer&) -> Field { throw Error("it is gone"); }), Error);
  LightCache none(1);
  EXPECT_EQ(none.get("a", {}, make)->grid.nx, 64);  // larger than all: computed each time
  EXPECT_EQ(none.bytes(), 0);
}

TEST(Session, KeptLightWarnsAgain) {
  LightCache cache(1e6);
  const auto make = [](const Observer& observer) {
    observer.warn("the eye is outside the eyebox");
    return Field({8, 8, 8e-6}, 5e-7);
  };
  for (int time = 0; time < 2; ++time) {  // a draft, then the still view
    std::vector<std::string> warnings;
    Observer observer;
    observer.on_warning = [&](const std::string& sentence) { warnings.push_back(sentence); };
    cache.get("a", observer, make);
    EXPECT_EQ(warnings, std::vector<std::string>{"the eye is outside the eyebox"}) << time;
  }
}

// 64 × 48 pixels do not divide into bins of 5: the page says so as show does, each time.
TEST(Session, TheSensorWarns) {
  Session session({folder_of({random_hologram(532e-9, 0)})});
  const std::vector<std::string> expected{
      "the field of 64 × 48 samples does not divide into bins of 5 × 5: only 60 × 45 samples of it are used; choose a "
      "binning that divides both numbers"};
  for (const char* distance : {"20 mm", "21 mm"})
    EXPECT_EQ(session.view(session.state_of({{"distance", distance}, {"binning", "5"}}))->warnings, expected);
}

TEST(Session, AFileThatVanishesIsASentenceAndComesBack) {
  const std::string folder = folder_of({random_hologram(532e-9, 0)}), path = folder + "/hologram.png";
  Session session({path});
  const int before = session.refresh();
  std::filesystem::rename(path, folder + "/away.png");
  EXPECT_GT(session.refresh(), before);
  EXPECT_NE(session.describe().find("does not exist"), std::string::npos) << session.describe();
  std::filesystem::rename(folder + "/away.png", path);
  session.refresh();
  EXPECT_TRUE(session.view(session.state_of({}), {}));
}

TEST(Session, FilesThatCannotBeViewedAreNamed) {
  const std::string path = make_file("notes.doc", "a text");
  EXPECT_NE(error_of([&] {
              Session({path});
            }).find("notes.doc: expected a folder, holograms (.png, .bmp, .tif, .npy, .csv), a field"),
            std::string::npos);
}

TEST(Session, GivesUpWhatIsOutdated) {
  Session session({folder_of({random_hologram(532e-9, 0)})});
  EXPECT_FALSE(session.view(session.state_of({}), [] { return true; }));
  EXPECT_TRUE(session.view(session.state_of({}), [] { return false; }));
}

TEST(Session, ADraftShowsOneFrameWithTheWhiteOfTheStill) {
  std::vector<Hologram> holograms{random_hologram(532e-9, 0), random_hologram(532e-9, 1)};
  Session session({folder_of(holograms)});
  const double white = session.view(session.state_of({}))->white;
  const TakenView draft = *session.view(session.state_of({{"draft", "1"}}));
  EXPECT_EQ(draft.white, white);
  ViewState state = session.state_of({});
  state.camera.sampling = PixelSampling::point;
  const Image expected = as_show_makes_it({holograms[0]}, state).image;
  EXPECT_EQ(draft.image.values, expected.values);
  const TakenView half = *session.view(session.state_of({{"draft", "2"}}));
  EXPECT_EQ(half.step, 2);
  ASSERT_EQ(half.image.nx, 32);  // of 64 × 48 pixels
  ASSERT_EQ(half.image.ny, 24);
  for (int j = 0; j < 24; ++j)
    for (int i = 0; i < 32; ++i) ASSERT_EQ(half.image(j, i), expected(2 * j, 2 * i)) << j << " " << i;
}

TEST(Session, WritesTheFilesOfShow) {
  const std::vector<Hologram> holograms{random_hologram(532e-9, 0)};
  Session session({folder_of(holograms)});
  const ViewState state = session.state_of({{"distance", "20 mm"}});
  const Expected expected = as_show_makes_it(holograms, state);
  for (const std::string ending : {".png", ".exr"}) {
    const std::string path = temporary("view" + ending);
    save_image(path, expected.image, expected.white, 8);
    std::ifstream in(path, std::ios::binary);
    EXPECT_EQ(session.file(state, ending), std::string(std::istreambuf_iterator<char>(in), {})) << ending;
  }
}

// Their white is that of the brightest view; a draft keeps the white of the still that was shown before.
TEST(Session, FilmsAreSweepsAndLeaveTheViewAsItWas) {
  const std::vector<Hologram> holograms{random_hologram(532e-9, 0)};
  Session session({folder_of(holograms)});
  const ViewState state = session.state_of({{"distance", "20 mm"}, {"pupil", "0.2 mm"}, {"eye", "0 0 5 mm"}});
  const double white = session.view(state)->white;
  for (const auto& [sweep, from, to] : {std::tuple{Sweep::focus, 20e-3, 31.5e-3}, {Sweep::parallax, -1e-4, 1e-4}}) {
    std::vector<Image> images;
    double brightest = 0;
    for (int i = 0; i < 24; ++i) {
      ViewState at = state;
      (sweep == Sweep::focus ? at.camera.distances.front() : at.camera.eye.x) = from + i / 23.0 * (to - from);
      Expected view = as_show_makes_it(holograms, at);
      brightest = std::max(brightest, view.white);
      images.push_back(std::move(view.image));
    }
    for (const std::string ending : {".gif", ".webp"}) {
      const std::string path = temporary("film" + ending);
      save_animation(path, images, brightest, 2);
      EXPECT_EQ(session.film(state, sweep, from, to, ending), read_text(path)) << ending;
    }
  }
  ViewState draft = state;
  draft.is_draft = true;
  EXPECT_EQ(session.view(draft)->white, white);
  EXPECT_NE(error_of([&] { session.film(state, Sweep::focus, 20e-3, 20e-3, ".gif"); }).find("two places that differ"),
            std::string::npos);
  EXPECT_NE(
      error_of([&] { session.film(state, Sweep::focus, 20e-3, 21e-3, ".png"); }).find("expected an animated file"),
      std::string::npos);
}

TEST(Session, ShowsAFieldAsItIs) {
  const Hologram hologram = random_hologram(532e-9, 0);
  const Field field = show(hologram, *hologram.slm, ShowParams());
  const std::string path = temporary("field.npy");
  save_field(path, field);
  Session session({path});
  const ViewState state = session.state_of({{"distance", "20 mm"}});
  Slm plain;
  plain.grid = field.grid;
  EXPECT_EQ(session.view(state)->image.values, look(field, plain, 0.02, {}, state.camera).values);
  EXPECT_EQ(session.command_line({}), "");  // holotrace show takes no field
}

TEST(Session, SumsSources) {
  Sources sources{.wavelength = 532e-9};
  sources.waves = {{{0, 0, -0.3}, 1, 0}, {{0.001, 0, -0.2}, 0.5, 0}};
  const std::string path = temporary("sources.ply");
  save_sources(path, sources);
  Session session({path});
  const Json json = Json::parse(session.describe());
  EXPECT_EQ(json["items"].size(), 1u);
  EXPECT_EQ(json["panel"]["columns"], 1920);  // pluto
  EXPECT_DOUBLE_EQ(json["depths_m"][0], 0.2);
  EXPECT_DOUBLE_EQ(json["depths_m"][1], 0.3);
  EXPECT_EQ(session.points(), (std::vector<float>{0, 0, -0.3F, 1, 0.001F, 0, -0.2F, 0.5F}));
  const std::string panel = make_file("panel.toml", "[slm]\ncolumns = 80\nrows = 60\npitch = \"8 um\"\n");
  Session on_another({path}, {.slm = panel});
  EXPECT_EQ(Json::parse(on_another.describe())["panel"]["columns"], 80);
}

// Levels without metadata, as another program writes them: flags say the rest.
TEST(Session, ShowsHologramsOfOtherProgramsAsTheirFlagsSay) {
  Hologram hologram = random_hologram(532e-9, 0);
  hologram.image = ImageSide::real_image;
  hologram.grid.pitch = 6e-6;
  const std::string path = folder_of({hologram}) + "/hologram.png";
  drop_metadata(path);
  const std::string panel = make_file("panel.toml", "[slm]\ncolumns = 64\nrows = 48\npitch = \"6 um\"\n");
  hologram.slm = load_slm(panel);
  hologram.slm->phase_range = 3;
  const std::map<std::string, std::string> flags{{"image", "real"}, {"wavelength", "532 nm"}, {"range", "3 rad"}};
  Session session({path}, {.slm = panel, .hologram = flags});
  const ViewState state = session.state_of({{"distance", "-20 mm"}});
  EXPECT_EQ(session.view(state)->image.values, as_show_makes_it({hologram}, state).image.values);
  EXPECT_EQ(session.command_line({{"distance", "-20 mm"}}),
            "holotrace show " + shell_word(path) + " --slm " + shell_word(panel) +
                " --distance '-20 mm' --image real --range '3 rad' --wavelength '532 nm' -o view.png");
  EXPECT_NE(Session({path}).why_empty().find("has no metadata; give --wavelength"), std::string::npos);
  EXPECT_EQ(error_of([&] { Session({panel}, {.hologram = flags}); }),
            "--image is for holograms, but " + panel + " is none; leave out --image");
}

TEST(Session, LeavesOutFarImagesFromItsDepths) {
  Sources sources{.wavelength = 532e-9};
  for (int i = 0; i < 400; ++i) sources.waves.push_back({{0, 0, -0.2 - 0.0001 * i}, 1, 0});
  sources.waves.push_back({{0, 0, -50}, 1, 0});
  sources.waves.push_back({{0, 0, -0.001}, 1, 0});
  const std::string path = temporary("sources.ply");
  save_sources(path, sources);
  Session session({path});
  const Json depths = Json::parse(session.describe())["depths_m"];
  EXPECT_NEAR(depths[0], 0.2003, 1e-9);  // 4 of 402 points at either end, one of them far off
  EXPECT_NEAR(depths[1], 0.2396, 1e-9);
}

TEST(Session, TracesASceneForThePanelThatIsGiven) {
  const std::string path = make_file("scene.toml", R"(wavelength = "532 nm"
background = 1
[slm]
columns = 64
rows = 48
[trace]
columns = 8
rows = 8
paths = 1
[[object]]
type = "quad"
width = "2 mm"
height = "2 mm"
position = "0 0 -30 mm"
)");
  const std::string panel = make_file("panel.toml", "columns = 80\nrows = 60\npitch = \"6 um\"\n");
  Session session({path}, {.slm = panel});
  const Json json = Json::parse(session.describe());
  EXPECT_EQ(json["problems"], Json::array());
  EXPECT_EQ(json["panel"]["columns"], 80);
  EXPECT_DOUBLE_EQ(json["panel"]["pitch_m"], 6e-6);
}

TEST(Session, TracesASceneAndItsRenderAtTheSameFocus) {
  const std::string path = make_file("scene.toml", R"(wavelength = "532 nm"
[slm]
columns = 96
rows = 64
pitch = "8 um"
[trace]
columns = 32
rows = 24
field_of_view = "1 deg"
paths = 2
[render]
paths = 2
[[light]]
type = "rectangle"
corner = "-5 -5 5 mm"
edge_u = "0 10 0 mm"
edge_v = "10 0 0 mm"
radiance = 5
[[object]]
type = "quad"
width = "0.2 mm"
height = "0.2 mm"
position = "0.15 0.1 -30 mm"
)");
  Session session({path});
  const Json json = Json::parse(session.describe());
  EXPECT_EQ(json["kind"], "scene");
  EXPECT_TRUE(json["has_render"].get<bool>());
  EXPECT_NEAR(json["defaults"]["distance_m"].get<double>(), 0.03, 1e-9);
  const ViewState state = session.state_of({});
  EXPECT_FALSE(Json::parse(session.metrics(state)).contains("psnr_db"));  // it is not traced for that alone
  const TakenView view = *session.view(state), render = *session.reference(state);
  EXPECT_TRUE(Json::parse(session.metrics(state)).contains("psnr_db"));
  ASSERT_EQ(render.image.nx, view.image.nx);
  ASSERT_EQ(render.image.ny, view.image.ny);
  // The square, at its place on the sensor: its mean is twice that elsewhere and more, in the view through its speckle.
  for (const Image* image : {&render.image, &view.image}) {
    double inside = 0, outside = 0;
    int pixels = 0;
    for (int j = 0; j < image->ny; ++j)
      for (int i = 0; i < image->nx; ++i) {
        const double x = (i - 47.5) * 8e-6, y = (31.5 - j) * 8e-6;
        const bool is_inside = std::abs(x - 0.15e-3) < 0.09e-3 && std::abs(y - 0.1e-3) < 0.09e-3;
        (is_inside ? inside : outside) += (*image)(j, i);
        pixels += is_inside;
      }
    EXPECT_GT(inside / pixels, 2 * outside / (96 * 64 - pixels));
  }
  // Equal greys for equal light: the white of the render is that of the view times the ratio of their light.
  double cross = 0, square = 0;
  for (size_t i = 0; i < view.image.values.size(); ++i) {
    cross += double(view.image.values[i]) * double(render.image.values[i]);
    square += double(view.image.values[i]) * double(view.image.values[i]);
  }
  EXPECT_NEAR(render.white / view.white, cross / square, 1e-9 * cross / square);
  const ViewState far = session.state_of({{"distance", "60 mm"}});  // out of focus, the square is blurred
  const float bright = *std::max_element(render.image.values.begin(), render.image.values.end());
  // Tracing ends when the request is outdated: at once, or in the middle.
  EXPECT_FALSE(session.reference(far, [] { return true; }).has_value());
  std::atomic<int> asked = 0;
  EXPECT_FALSE(session.reference(far, [&] { return ++asked > 3; }).has_value());
  EXPECT_FALSE(Json::parse(session.metrics(far)).contains("psnr_db"));
  const Image blurred = session.reference(far)->image;
  EXPECT_LT(*std::max_element(blurred.values.begin(), blurred.values.end()), 0.8F * bright);
}

TEST(Session, TellsValuesOfPixels) {
  Session session({folder_of({random_hologram(532e-9, 0)})});
  const ViewState state = session.state_of({});
  const Image image = session.view(state)->image;
  const Json json = Json::parse(session.values(state, 3, 5, 2, 1));
  EXPECT_EQ(json["rows"][0][0].get<float>(), image(5, 3));
  EXPECT_EQ(json["rows"][0][1].get<float>(), image(5, 4));
  const std::string expected =
      "expected a window of at most 64 × 64 pixels inside the view of 64 × 48, got 1 × 1 at 64, 0";
  EXPECT_EQ(error_of([&] { session.values(state, 64, 0, 1, 1); }), expected);
  EXPECT_NO_THROW(session.values(state, 0, 0, 64, 48));
  for (const auto [x, y, w, h] : {std::array{-1, 0, 1, 1}, {0, 48, 1, 1}, {0, 0, 65, 1}, {60, 0, 5, 1}, {0, 0, 0, 1}})
    EXPECT_THROW(session.values(state, x, y, w, h), Error) << x << ' ' << y << ' ' << w << ' ' << h;
}

TEST(Session, ShowsLevelsAmplitudesAndPhases) {
  const Hologram hologram = random_hologram(532e-9, 0);
  Session session({folder_of({hologram})});
  const BytePicture levels = session.panel(0, PanelQuantity::level, session.state_of({}));
  ASSERT_EQ(levels.values.size(), 64u * 48);
  for (size_t i = 0; i < levels.values.size(); ++i) ASSERT_EQ(levels.values[i], hologram.level.values[i]);  // of 256
  const Field shown = show(hologram, *hologram.slm, ShowParams());
  const BytePicture phases = session.panel(0, PanelQuantity::phase, session.state_of({}));
  const double cycles = std::arg(shown.samples(7, 9)) / (2 * 3.14159265358979) + 1;
  EXPECT_EQ(phases.values[7 * 64 + 9], int((cycles - std::floor(cycles)) * 256));
  // Twice the rms amplitude is white.
  const BytePicture amplitudes = session.panel(0, PanelQuantity::amplitude, session.state_of({}));
  const double rms = std::sqrt(power(shown) / (shown.grid.width() * shown.grid.height()));
  for (const size_t i : {size_t(0), size_t(457), size_t(3000)})
    EXPECT_EQ(amplitudes.values[i], std::min(255, int(256 * std::abs(shown.samples.values[i]) / (2 * rms)))) << i;
  EXPECT_EQ(error_of([&] { session.panel(1, PanelQuantity::level, session.state_of({})); }),
            "expected a hologram number below 1, got 1");
}

TEST(Session, BoundsTheSensor) {
  Session session({folder_of({random_hologram(532e-9, 0)})});
  EXPECT_EQ(error_of([&] {
              session.view(session.state_of({{"width", "10 mm"}, {"height", "10 mm"}, {"pixel", "1 um"}}));
            }),
            "expected a sensor of at most 32 million pixels here, got 10000 × 10000; use holotrace show");
}

TEST(Session, SaysWhatItCannotRead) {
  const std::string folder = folder_of({random_hologram(532e-9, 0), random_hologram(532e-9, 1)});
  std::filesystem::resize_file(folder + "/hologram_2.png", 300);  // its end is missing
  Session session({folder});
  Json json = Json::parse(session.describe());
  EXPECT_EQ(json["items"].size(), 1u);
  ASSERT_EQ(json["problems"].size(), 1u);
  EXPECT_NE(json["problems"][0].get<std::string>().find("hologram_2.png"), std::string::npos);
  EXPECT_TRUE(session.view(session.state_of({})));
  Session empty({make_file("nothing.png", "text")});
  EXPECT_NE(error_of([&] { empty.view(empty.state_of({})); }).find("nothing.png"), std::string::npos);
  EXPECT_EQ(error_of([] { Session missing({"/nonexistent"}); }),
            "expected a folder, holograms, a field, sources or a scene to view, but /nonexistent does not exist");
}

TEST(Session, ReadsAFolderAgainOnceARunHasWrittenIt) {
  const std::string folder = temporary("out");
  std::filesystem::create_directories(folder);
  Session session({folder});
  EXPECT_EQ(Json::parse(session.describe())["problems"].size(), 1u);
  EXPECT_EQ(session.refresh(), 1);
  save_hologram(folder + "/hologram.png", random_hologram(532e-9, 0));
  EXPECT_EQ(session.refresh(), 2);
  EXPECT_TRUE(session.view(session.state_of({})));
  EXPECT_EQ(session.refresh(), 2);
}

TEST(Session, NamesTheRunsOfAFilmInTheirOrder) {
  const std::string folder = temporary("film");
  std::string runs;
  for (int time = 9; time > 0; --time) {
    const std::string run = folder + "/t_000" + std::to_string(time);
    std::filesystem::create_directories(run);
    write_text(run + "/hologram.png", "");
    runs = run + (runs.empty() ? "" : ", " + runs);
  }
  const Json problems = Json::parse(Session({folder}).describe())["problems"];
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_TRUE(problems[0].get<std::string>().ends_with(": " + runs)) << problems[0];
}

// A link that another user or an archive puts into a folder does not show other files to everybody who sees the page.
TEST(Session, DoesNotFollowLinksOutOfAFolder) {
  namespace fs = std::filesystem;
  const fs::path folder = folder_of({random_hologram(532e-9, 0), random_hologram(638e-9, 1)});
  const fs::path outside = temporary("elsewhere");
  fs::create_directories(outside);
  const auto shown = [&] {
    const auto told = nlohmann::json::parse(Session({folder.string()}).describe());
    return std::pair(told["items"].size(), told["problems"].dump());
  };
  fs::rename(folder / "hologram_2.png", outside / "secret.png");
  fs::create_symlink(outside / "secret.png", folder / "hologram_2.png");
  write_text((outside / "r.json").string(), "{\"secret\": 1}");
  fs::create_symlink(outside / "r.json", folder / "report.json");
  const auto [items, problems] = shown();
  EXPECT_EQ(items, 1U);
  EXPECT_NE(problems.find("hologram_2.png is a symbolic link out of this folder"), std::string::npos) << problems;
  EXPECT_EQ(Session({folder.string()}).report().find("secret"), std::string::npos);
  fs::remove(folder / "hologram_2.png");  // a link inside is no matter
  fs::rename(outside / "secret.png", folder / "kept.png");
  fs::create_symlink("kept.png", folder / "hologram_2.png");
  EXPECT_EQ(shown().first, 2U);
}

// The progress of a job is a file of another program: what is nested deeper than memory allows to write is left out.
TEST(Session, LeavesOutProgressThatIsNestedTooDeep) {
  const std::string folder = temporary("out");
  std::filesystem::create_directories(folder);
  Session session({folder});
  const size_t levels = 500'000;  // of two bytes each: the file is read up to 1 MiB
  for (const std::string& history : {std::string("[]"), std::string(levels, '[') + std::string(levels, ']')}) {
    NewFile file(folder + "/job.progress");
    const std::string text = R"({"stage": "encode", "history": )" + history + "}";
    file.put(text.data(), text.size());
    file.seek(0);
    const Json progress = Json::parse(session.describe())["progress"];
    EXPECT_EQ(progress.is_null(), history != "[]");
  }
}

TEST(Session, PrintsTheCommandOfAView) {
  const std::string folder = folder_of({random_hologram(532e-9, 0), random_hologram(532e-9, 1)});
  Session session({folder});
  EXPECT_EQ(
      session.command_line({{"distance", "20 mm"}, {"items", "1"}, {"draft", "1"}, {"effects", "gaps"}}),
      "holotrace show " + shell_word(folder + "/hologram_2.png") + " --distance '20 mm' --effects gaps -o view.png");
}

}  // namespace
}  // namespace holotrace::test
