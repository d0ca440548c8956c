// Holograms of a scene whose values are changed while one looks.

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "holotrace/io/files/new_file.h"
#include "holotrace/viewer/live_scene.h"
#include "holotrace/viewer/session.h"
#include "support/temporary.h"

namespace holotrace::test {
namespace {

// A lit square before black, on a small panel.
std::string square_scene(const std::string& more = "", const std::string& wavelength = "\"532 nm\"") {
  return make_file("square.toml",
                   "wavelength = " + wavelength +
                       "\n[slm]\ncolumns = 256\nrows = 256\npitch = \"8 um\"\n"
                       "[camera]\ndistances = \"100 mm\"\n" +
                       more +
                       "\n[[light]]\ntype = \"rectangle\"\ncorner = \"-5 -5 5 mm\"\nedge_u = \"0 10 0 mm\"\n"
                       "edge_v = \"10 0 0 mm\"\nradiance = 5\n[[object]]\ntype = \"quad\"\nwidth = \"0.4 mm\"\n"
                       "height = \"0.4 mm\"\nposition = \"0 0 -100 mm\"\n");
}

ViewState at(const std::string& position, bool is_draft) {
  ViewState state;
  state.camera.distances = {0.1};
  state.is_draft = is_draft;
  if (!position.empty()) state.edits = {{"object.1.position", position}};
  return state;
}

// The centre of a picture's light [pixels].
Vec2 centre_of(const Image& image) {
  Vec2 sum{0, 0};
  double all = 0;
  for (int j = 0; j < image.ny; ++j)
    for (int i = 0; i < image.nx; ++i) {
      const double value = double(image(j, i)) * double(image(j, i));  // weighs the square more than noise around it
      sum.x += value * i;
      sum.y += value * j;
      all += value;
    }
  return {sum.x / all, sum.y / all};
}

// 0.16 mm to the right and 0.08 mm up are 20 pixels of 8 um to the right and 10 rows up. Speckle moves the centre of 50 × 50 pixels by
// some of them at most.
TEST(LiveScene, AMovedObjectIsSeenAtItsNewPlace) {
  Session session({square_scene()}, {.is_live = true});
  for (const bool is_draft : {true, false}) {
    const Vec2 before = centre_of(session.view(at("", is_draft))->image);
    const Vec2 after = centre_of(session.view(at("0.16 0.08 -100 mm", is_draft))->image);
    EXPECT_NEAR(after.x - before.x, 20, 4) << is_draft;
    EXPECT_NEAR(after.y - before.y, -10, 4) << is_draft;
  }
}

TEST(LiveScene, ThePictureDependsOnTheQuestionAlone) {
  const std::string path = square_scene();
  Session session({path}, {.is_live = true}), other({path}, {.is_live = true});
  const Image first = session.view(at("0.1 0 -100 mm", false))->image;
  session.view(at("0.2 0 -100 mm", true));
  session.view(at("", false));
  EXPECT_EQ(session.view(at("0.1 0 -100 mm", false))->image.values, first.values);
  EXPECT_EQ(other.view(at("0.1 0 -100 mm", false))->image.values, first.values);
}

TEST(LiveScene, GradesFollowEachOther) {
  Session session({square_scene("[encode]\niterations = 5\n")}, {.is_live = true});
  const auto made_of = [&](const ViewState& state) { return session.view(state)->made_of; };
  EXPECT_TRUE(made_of(at("", true)).starts_with("draft of "));
  EXPECT_TRUE(made_of(at("", false)).ends_with(" waves"));
  EXPECT_TRUE(made_of(at("", true)).ends_with(" waves"));  // what is there is better than a draft
  EXPECT_FALSE(made_of(at("", true)).starts_with("draft"));
  EXPECT_TRUE(session.improve(at("", false)));
  EXPECT_TRUE(made_of(at("", false)).starts_with("optimised"));
  EXPECT_TRUE(made_of(at("", true)).starts_with("optimised"));
  EXPECT_TRUE(made_of(at("0.1 0 -100 mm", true)).starts_with("draft of "));
  ViewState with_eye = at("", false);
  with_eye.camera.pupil = 2e-3;
  with_eye.camera.eye = {0, 0, 0.2};
  EXPECT_TRUE(made_of(with_eye).ends_with(" waves"));  // the optimised ones are not for that eye
}

// Waves that arrive at the eye together, in a hologram of double phases, show a smooth picture: waves of random phases give
// speckle, whose contrast is near 1. Those that arrive elsewhere leave most of a square of 1.6 mm dark.
// Joint frames have all colours in one hologram, waves one for each: a choice among three is none among one.
TEST(LiveScene, AChoiceOfColoursHoldsForEveryGrade) {
  Session session({square_scene("[encode]\nmethod = \"sgd\"\ntarget = \"render\"\njoint = true\niterations = 2\n",
                                R"(["638 nm", "532 nm", "450 nm"])")},
                  {.is_live = true});
  ViewState state = at("", false);
  state.shown = {2};
  EXPECT_TRUE(session.view(state).has_value());
  EXPECT_TRUE(session.improve(state));
  EXPECT_TRUE(session.view(state).has_value());
}

TEST(LiveScene, AnEyeSeesNoSpeckle) {
  const std::vector<SceneEdit> large{{"object.1.width", "1.6 mm"}, {"object.1.height", "1.6 mm"}};
  Session session({square_scene("[trace]\ncolumns = 200\nrows = 200\nfield_of_view = \"0.6 deg\"\n")},
                  {.is_live = true});
  const auto contrast_inside = [&](double z) {
    ViewState state = at("", false);
    state.camera.pupil = 1.5e-3;
    state.camera.eye = {0, 0, z};
    state.edits = large;
    const Image image = session.view(state)->image;
    double sum = 0, squares = 0;
    int count = 0;
    for (int j = image.ny / 2 - 80; j < image.ny / 2 + 80; ++j)
      for (int i = image.nx / 2 - 80; i < image.nx / 2 + 80; ++i, ++count) {
        sum += double(image(j, i));
        squares += double(image(j, i)) * double(image(j, i));
      }
    const double mean = sum / count;
    return std::sqrt(squares / count - mean * mean) / mean;
  };
  EXPECT_LT(contrast_inside(0.2), 0.25);
  EXPECT_GT(contrast_inside(0), 0.4);  // a pupil in the plane of the panel is no eye: random phases
}

TEST(LiveScene, EndsWhatIsOutdated) {
  LiveScene scene(square_scene(), {});
  const auto at_once = [] { return true; };
  EXPECT_EQ(scene.contents({{"light.1.radiance", "4"}}, {}, false, at_once), nullptr);
  EXPECT_FALSE(scene.improve({{"light.1.radiance", "4"}}, {}, at_once));
  EXPECT_NE(scene.contents({{"light.1.radiance", "4"}}, {}, false), nullptr);
}

TEST(LiveScene, SaysWhatIsWrong) {
  Session session({square_scene()}, {.is_live = true});
  const auto error = [&](const SceneEdit& edit) {
    ViewState state = at("", true);
    state.edits = {edit};
    return error_of([&] { session.view(state); });
  };
  EXPECT_EQ(error({"object.1.position", "0 0 mm"}).substr(0, 25), "--set object.1.position: ");
  for (const char* key : {"camera.pupil", "object.1.type", "object.2.position", "object.1.mesh", ""})
    EXPECT_EQ(error({key, "0 0 1 mm"}), fmt::format("expected a value of the scene that may be changed, got {}", key));
  for (const char* value : {"/etc/passwd", "index.txt", "", "{ a = 1 }", "['x']"})  // no request can name a file
    EXPECT_EQ(error({"object.1.width", value}),
              fmt::format("expected a number, or a text that begins with one, for object.1.width, got \"{}\"", value));
  EXPECT_TRUE(session.view(at("", true)).has_value());  // it goes on after that
  Session still({square_scene()});
  EXPECT_EQ(error_of([&] { still.view(at("0 0 -90 mm", true)); }),
            "expected no values of a scene, because it is not shown live; use --live");
}

// The command is that of the picture's scene, with the time and the eye.
TEST(LiveScene, GivesTheCommandOfItsRun) {
  const std::string path = square_scene();
  Session session({path}, {.is_live = true});
  EXPECT_EQ(
      session.command_line(
          {{"set.light.1.radiance", "2"}, {"distance", "90 mm"}, {"pupil", "2 mm"}, {"eye", "0 0 0.2 m"}}),
      "holotrace run " + path + " --set light.1.radiance=2 --distance '90 mm' --pupil '2 mm' --eye '0 0 0.2 m' -o out");
  EXPECT_NE(session.describe().find("\"object.1.position\""), std::string::npos);
}

// A file that is written again is read again.
TEST(LiveScene, FollowsItsFile) {
  const std::string path = square_scene();
  Session session({path}, {.is_live = true});
  EXPECT_EQ(session.describe().find("materials.red"), std::string::npos);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // file times are that coarse
  square_scene("[materials.red]\ntype = \"diffuse\"\nreflectance = 0.5\n");
  session.refresh();
  EXPECT_NE(session.describe().find("materials.red.reflectance"), std::string::npos);
}

}  // namespace
}  // namespace holotrace::test
