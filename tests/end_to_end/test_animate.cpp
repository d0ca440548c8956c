// Films by the command line: holotrace animate.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <sstream>
#include <thread>

#include "end_to_end/expect_error.h"
#include "end_to_end/mpirun.h"
#include "end_to_end/scenes.h"
#include "holotrace/io/picture/image_file.h"
#include "support/build_paths.h"
#include "support/gif.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

using Json = nlohmann::json;

// A cube of points that moves along x for 0.4 s, 30 mm behind the small panel, and then rests, before a white wall; it is
// shown by a kinoform.
std::string moving_scene() {
  return scene_head(small_panel, "background = 0.1\n") +
         "[render]\nrows = 32\npaths = 2\n[encode]\nmethod = \"phase\"\n[camera]\ndistances = \"30 mm\"\n"
         "[animate]\nfps = 5\n"
         "[[object]]\ntype = \"wireframe_cube\"\nsize = \"0.5 mm\"\npoints_per_edge = 3\namplitude = 2\n"
         "position = { \"0 s\" = \"-0.4 0 -30 mm\", \"400 ms\" = \"0.4 0 -30 mm\" }\n"
         "[[object]]\ntype = \"quad\"\nwidth = \"2 mm\"\nheight = \"2 mm\"\nposition = \"0 0 -32 mm\"\n"
         "[trace]\ncolumns = 16\nrows = 16\npaths = 2\n";
}

// All files of a film but for its reports, which have the seconds of each stage, with their bytes.
std::map<std::string, std::string> files_of(const Workplace& work, const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const std::string& name : work.names())
    if (name.starts_with(folder + "/") && !name.ends_with("report.json") &&
        std::filesystem::is_regular_file(work.path(name)))
      files[name.substr(folder.size())] = work.read(name);
  return files;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(Animate, EachTimeHasTheBytesOfAFreshRun) {
  const Workplace work;
  work.write("scene.toml", moving_scene());
  const Outcome outcome = work.run({"animate", "scene.toml", "-o", "film", "--seconds", "0.6"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  ASSERT_EQ(work.run({"run", "scene.toml", "-o", "still", "--time", "200 ms", "-q"}).exit_code, 0);
  for (const char* name : {"hologram.png", "view.png", "render.png"})
    EXPECT_EQ(work.read(std::string("film/t_0002/") + name), work.read(std::string("still/") + name)) << name;
  EXPECT_NE(work.read("film/t_0001/hologram.png"), work.read("film/t_0002/hologram.png"));
  EXPECT_FALSE(work.has("film/t_0004"));
  EXPECT_FALSE(work.has("film/t_0002/field.npy"));
  EXPECT_EQ(Json::parse(work.read("still/report.json")).at("time_s"), 0.2);
  const Json report = Json::parse(work.read("film/report.json"));
  ASSERT_EQ(report.at("times").size(), 3u);
  EXPECT_EQ(report.at("times")[1].at("time_s"), 0.2);
  EXPECT_EQ(report.at("times")[1].at("folder"), "t_0002");
  EXPECT_EQ(report.at("times")[1].at("views").size(), 1u);
  EXPECT_TRUE(report.at("times")[1].at("views")[0].contains("psnr_db"));
  EXPECT_EQ(report.at("complete"), true);
}

// A lamp goes out, and an object leaves the view: such times are dark, and the film goes on.
TEST(Animate, DarkTimesAreDark) {
  const Workplace work;
  const std::string scene =
      scene_head(small_panel) +
      "[render]\nrows = 16\npaths = 2\n[camera]\ndistances = \"30 mm\"\n[animate]\nfps = 2\n[[light]]\ntype = \"point\"\n"
      "position = \"0 0 1 mm\"\nintensity = { \"0 s\" = 1, \"1 s\" = 0 }\n[[object]]\ntype = \"quad\"\nwidth = \"0.5 mm\"\n"
      "height = \"0.5 mm\"\nposition = { \"1 s\" = \"0 0 -30 mm\", \"2 s\" = \"90 0 -30 mm\" }\n";
  for (const std::string method : {"phase", "sgd"}) {
    work.write("scene.toml", scene + "[encode]\nmethod = \"" + method + "\"\niterations = 2\n");
    const Outcome outcome = work.run({"animate", "scene.toml", "-o", method, "--times", "0.5, 1, 2 s"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(lines_of(work.read(method + "/timing.csv")).size(), 4U);
    EXPECT_NE(lines_of(work.read(method + "/timing.csv"))[2].find(",0,,t_0002/hologram.png"), std::string::npos);
    EXPECT_NE(lines_of(work.read(method + "/timing.csv"))[3].find(",0,,t_0003/hologram.png"), std::string::npos);
    EXPECT_EQ(lines_of(work.read(method + "/timing.csv"))[1].find(",0,,t_0001/hologram.png"), std::string::npos);
    EXPECT_NE(outcome.err.find("dark"), std::string::npos);
  }
  // A still without light is an error that says so.
  EXPECT_NE(work.run({"run", "scene.toml", "-o", "still", "--method", "phase", "--set", "light.1.intensity=0", "--set",
                      "object.1.position=0 0 -30 mm"})
                .exit_code,
            0);
}

// The pictures of a film that a camera makes whose shutter is open for two times and a half: 1, 1 and 1/2 of three of them. At the end
// there are fewer.
TEST(Animate, ACameraSeesTheMeanOfTheHologramsWhileItsShutterIsOpen) {
  const Workplace work;
  work.write("scene.toml", moving_scene());
  const auto film = [&](const std::string& folder, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"animate", "scene.toml",    "-o", folder, "--seconds",
                                       "0.6",     "--film-format", "png"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = work.run(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  };
  film("sharp", {});
  film("seen", {"--shutter", "500 ms"});
  const double white = Json::parse(work.read("seen/report.json")).at("white_w_per_m2_sr");
  EXPECT_EQ(Json::parse(work.read("seen/report.json")).at("shutter_s"), 0.5);
  EXPECT_FALSE(Json::parse(work.read("sharp/report.json")).contains("shutter_s"));
  for (const std::string kind : {"view", "render"}) {
    std::vector<Image> of_time;
    for (const int t : {1, 2, 3})
      of_time.push_back(load_image(work.path("sharp/t_000" + std::to_string(t) + "/film_" + kind + ".exr")));
    const double weights[3][3] = {{0.4, 0.4, 0.2}, {0, 0.5, 0.5}, {0, 0, 1}};
    for (const int t : {0, 1, 2}) {
      const Image seen = load_image(work.path("seen/" + kind + "_000" + std::to_string(t + 1) + ".png"));
      for (size_t v = 0; v < of_time[0].values.size(); ++v) {
        double mean = 0;
        for (const int k : {0, 1, 2}) mean += weights[t][k] * of_time[size_t(k)].values[v] / white;
        // A grey of 8 bits: half a level of 255, where the sRGB curve is at most 2.4·x^(1.4/2.4)/1.055 steep, below 2.3.
        ASSERT_NEAR(seen.values[v], std::min(1.0, mean), 2.3 * 0.5 / 255 + 1e-4) << kind << " " << t << " " << v;
      }
    }
  }
  // The holograms of waves are sharp at each time, so both films have the same.
  EXPECT_EQ(work.read("sharp/t_0002/hologram.png"), work.read("seen/t_0002/hologram.png"));
  // A shorter shutter blurs the render of each time, which the fingerprint knows, and has the bytes of a run.
  film("seen", {"--shutter", "100 ms"});
  ASSERT_EQ(work.run({"run", "scene.toml", "-o", "still", "--time", "200 ms", "--shutter", "180 deg", "-q"}).exit_code,
            0);
  EXPECT_EQ(work.read("seen/t_0002/render.png"), work.read("still/render.png"));
  EXPECT_NE(work.read("seen/t_0002/render.png"), work.read("sharp/t_0002/render.png"));
}

// At rest a shutter changes nothing.
TEST(Animate, AShutterWithoutMotionChangesNoByte) {
  const Workplace work;
  work.write("scene.toml", moving_scene());
  ASSERT_EQ(work.run({"render", "scene.toml", "--time", "1 s", "-o", "a.exr"}).exit_code, 0);
  ASSERT_EQ(work.run({"render", "scene.toml", "--time", "1 s", "--shutter", "20 ms", "-o", "b.exr"}).exit_code, 0);
  ASSERT_EQ(work.run({"render", "scene.toml", "--time", "0 s", "--shutter", "20 ms", "-o", "c.exr"}).exit_code, 0);
  EXPECT_EQ(work.read("a.exr"), work.read("b.exr"));
  EXPECT_NE(work.read("a.exr"), work.read("c.exr"));
}

TEST(Animate, BadShuttersAreRefused) {
  const Workplace work;
  work.write("scene.toml", moving_scene());
  std::string growing = moving_scene();
  growing.insert(growing.find("distances ="), "width = { \"0 s\" = \"0.2 mm\", \"200 ms\" = \"0.4 mm\" }\n");
  work.write("growing.toml", growing);
  const Outcome film = work.run({"animate", "growing.toml", "-o", "f", "--seconds", "0.4", "--shutter", "500 ms"});
  EXPECT_EQ(film.exit_code, 1);
  EXPECT_NE(film.err.find("expected pictures of one size while the shutter is open, got "), std::string::npos)
      << film.err;
  expect_error(work, {"render", "scene.toml", "-o", "a.exr", "--shutter=-1 ms"},
               {"--shutter: expected a shutter of 0 s or more, got \"-1 ms\""});
  const std::string kinds =
      "--shutter: expected a time or an angle with its unit, such as \"20 ms\" or \"180 deg\", got ";
  expect_error(work, {"run", "scene.toml", "-o", "a", "--shutter", "20"}, {kinds + "\"20\""});
  expect_error(work, {"animate", "scene.toml", "-o", "a", "--shutter", "20 mm"}, {kinds + "\"20 mm\""});
}

// After 0.4 s the cube rests: the times 0.4 and 0.6 s have the same job.
TEST(Animate, TimesThatAreEqualAreComputedOnce) {
  const Workplace work;
  work.write("scene.toml", moving_scene());
  const Outcome outcome = work.run({"animate", "scene.toml", "-o", "film", "--times", "0.2, 0.4, 0.6 s"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<std::string> lines = lines_of(outcome.out);
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[0], "1 of 3, 200 ms: computed");
  EXPECT_EQ(lines[1], "2 of 3, 400 ms: computed");
  EXPECT_EQ(lines[2], "3 of 3, 600 ms: equal to the time before");
  EXPECT_EQ(lines[3], "film of 3 times, 0.6 s at 5 per second, in film: render.webp timing.csv view.webp report.json");
  EXPECT_EQ(work.read("film/t_0002/hologram.png"), work.read("film/t_0003/hologram.png"));
  EXPECT_EQ(Json::parse(work.read("film/t_0003/report.json")).at("time_s"), 0.6);
}

// The second time has the waves and holograms of the first, and the bytes of a run that makes them anew.
TEST(Animate, WhereOnlyTheEyeMovesHologramsAreTakenAgain) {
  const Workplace work;
  std::string scene = moving_scene();
  scene.replace(scene.find("position = { \"0 s\""),
                scene.find("[[object]]\ntype = \"quad\"") - scene.find("position = { \"0 s\""),
                "position = \"0 0 -30 mm\"\n");
  scene.replace(scene.find("[camera]\n"), 9,
                "[camera]\npupil = \"0.5 mm\"\neye = { \"0 s\" = \"-0.5 0 5 mm\", \"400 ms\" = \"0.5 0 5 mm\" }\n");
  work.write("scene.toml", scene);
  ASSERT_EQ(work.run({"animate", "scene.toml", "-o", "film", "-q"}).exit_code, 0);
  ASSERT_EQ(work.run({"run", "scene.toml", "-o", "still", "--time", "200 ms", "-q"}).exit_code, 0);
  for (const char* name : {"hologram.png", "view.png", "render.png"})
    EXPECT_EQ(work.read(std::string("film/t_0002/") + name), work.read(std::string("still/") + name)) << name;
  EXPECT_NE(work.read("film/t_0001/view.png"), work.read("film/t_0002/view.png"));
  const auto stages_of = [&](const std::string& folder) {
    std::vector<std::string> names;
    const Json report = Json::parse(work.read(folder + "/report.json"));
    for (const Json& stage : report.at("stages")) names.push_back(stage.at("stage"));
    return names;
  };
  const std::vector<std::string> again{"render", "reuse", "show", "look at 30 mm"};
  EXPECT_EQ(stages_of("film/t_0002"), again);
  EXPECT_EQ(stages_of("still").size(), 6u);
}

TEST(Animate, AKilledFilmGoesOnToTheSameBytes) {
  const Workplace work;
  work.write("scene.toml", moving_scene());
  ASSERT_EQ(work.run({"animate", "scene.toml", "-o", "whole", "--seconds", "1", "-q"}).exit_code, 0);
  const pid_t child = work.start({"animate", "scene.toml", "-o", "film", "--seconds", "1", "-q"});
  int status = 0;
  while (!work.has("film/t_0002/report.json") && waitpid(child, &status, WNOHANG) == 0)
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  kill(child, SIGKILL);
  waitpid(child, &status, 0);
  ASSERT_TRUE(work.has("film/t_0001/report.json"));
  const auto written = std::filesystem::last_write_time(work.path("film/t_0001/hologram.png"));
  const Outcome outcome = work.run({"animate", "scene.toml", "-o", "film", "--seconds", "1"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(lines_of(outcome.out).at(0), "1 of 5, 0 s: kept from an earlier call");
  EXPECT_EQ(std::filesystem::last_write_time(work.path("film/t_0001/hologram.png")), written);
  EXPECT_EQ(files_of(work, "film"), files_of(work, "whole"));
}

// The white wall alone, which moves along x: its holograms are found for its light. Their loss on this panel is so high that they
// would start afresh if next_iterations were not given.
std::string optimised_scene() {
  return scene_head(small_panel, "background = 0.1\n") +
         "[render]\nrows = 32\npaths = 2\n[encode]\nmethod = \"sgd\"\ntarget = \"render\"\niterations = 60\nnext_iterations = 3\n"
         "[camera]\ndistances = \"32 mm\"\n[animate]\nfps = 5\nfrom_last = true\n"
         "[[object]]\ntype = \"quad\"\nwidth = \"0.5 mm\"\nheight = \"0.5 mm\"\n"
         "position = { \"0 s\" = \"-0.1 0 -32 mm\", \"1 s\" = \"0.1 0 -32 mm\" }\n";
}

// A white square of 40 pixels moves by 4 pixels from one picture to the next: each picture has its own holograms, those of a run at
// that time, and a film goes on after an interruption. The view shows the square where the picture has it: it is 0.5 of the view, which is
// 256 pixels, wide.
TEST(Animate, PicturesThatFollowEachOtherAreAFilm) {
  const Workplace work;
  for (int k = 0; k < 3; ++k) {
    Image picture(96, 128, 1);
    for (int j = 28; j < 68; ++j)
      for (int i = 20 + 4 * k; i < 60 + 4 * k; ++i) picture(j, i) = 1;
    save_image(work.path("p_0" + std::to_string(k + 7) + ".png"), picture, 1, 8);
  }
  work.write("panel.toml", fmt::format("columns = {}\nrows = {}\npitch = \"8 um\"\n", small_panel.nx, small_panel.ny));
  const std::vector<std::string> pictures{
      "p_##.png", "--slm",    "panel.toml", "--series-fps", "10", "--fit",       "0.5",   "--method", "sgd", "--target",
      "render",   "--frames", "1",          "--iterations", "20", "--reference", "quick", "-q"};
  const auto command = [&](const std::vector<std::string>& first, const std::vector<std::string>& last) {
    std::vector<std::string> all = first;
    all.insert(all.end(), pictures.begin(), pictures.end());
    all.insert(all.end(), last.begin(), last.end());
    const Outcome outcome = work.run(all);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  };
  command({"animate"}, {"-o", "film", "--fps", "10"});
  const auto files = files_of(work, "film");
  EXPECT_TRUE(work.has("film/t_0003/hologram.png"));
  EXPECT_FALSE(work.has("film/t_0004"));
  std::filesystem::remove_all(work.path("film/t_0002"));
  command({"animate"}, {"-o", "film", "--fps", "10"});
  EXPECT_EQ(files_of(work, "film"), files);
  command({"run"}, {"-o", "still", "--time", "150 ms"});
  EXPECT_EQ(work.read("still/hologram.png"), work.read("film/t_0002/hologram.png"));
  double before = 0;
  for (int k = 0; k < 3; ++k) {
    const Image view = load_image(work.path("film/t_000" + std::to_string(k + 1) + "/film_view.exr"));
    double light = 0, place = 0;
    for (int j = 0; j < view.ny; ++j)
      for (int i = 0; i < view.nx; ++i) {
        light += view(j, i);
        place += view(j, i) * (i + 0.5 - view.nx / 2.0);
      }
    // Centre (40 + 4k − 64)/128 of 0.5 of the view; light beside the square is even and counts nothing on the left or the right.
    const double step = view.nx * 0.5 * 4 / 128;
    if (k > 0) {
      EXPECT_NEAR(place / light - before, step, 0.25 * step) << k;
    }
    before = place / light;
  }
}

// Films flicker where still parts change. With the error e(x, t) of the view against the render, over the places x of still parts,
//
//     mean over x of var_t e − mean over t of var_x e = var_t (mean over x of e) − var_x (mean over t of e),
//
// so the noise over time is below that over places unless the picture as a whole becomes brighter and darker by more than the errors that
// rest. Views are exposed by their renders, from which the light of the panel follows.
TEST(Animate, StillPartsFlickerLessThanTheyAreNoisy) {
  const Workplace work;
  work.write("scene.toml",
             scene_head(small_panel, "background = 0.5\n") +
                 "[render]\nrows = 96\npaths = 1\n[encode]\nmethod = \"sgd\"\ntarget = \"render\"\n"
                 "iterations = 12\n[trace]\nframes = 1\n[camera]\ndistances = \"32 mm\"\n[animate]\nfps = 5\n"
                 "[[object]]\ntype = \"quad\"\nwidth = \"0.7 mm\"\nheight = \"0.7 mm\"\nposition = \"-0.5 0 -32 mm\"\n"
                 "[[object]]\ntype = \"quad\"\nwidth = \"0.3 mm\"\nheight = \"0.3 mm\"\n"
                 "position = { \"0 s\" = \"0.5 -0.3 -32 mm\", \"1 s\" = \"0.5 0.3 -32 mm\" }\n");
  for (const char* from_last : {"false", "true"}) {
    ASSERT_EQ(work.run({"animate", "scene.toml", "-o", "film", "--from-last", from_last, "-q"}).exit_code, 0);
    std::vector<std::vector<double>> errors;  // of each time, in the middle of the square that rests
    for (int t = 1; t <= 5; ++t) {
      const std::string folder = work.path("film/t_000" + std::to_string(t) + "/");
      const Image view = load_image(folder + "film_view.exr"), render = load_image(folder + "film_render.exr");
      std::vector<double>& of_time = errors.emplace_back();
      for (int j = 0; j < view.ny; ++j)
        for (int i = 0; i < view.nx; ++i) {
          const double x = (i + 0.5) / view.nx - 0.5, y = (j + 0.5) / view.ny - 0.5;  // of 2.048 by 1.536 mm
          if (std::abs(x + 0.5 / 2.048) < 0.12 && std::abs(y) < 0.16)
            of_time.push_back(view(j, i) - render(j * render.ny / view.ny, i * render.nx / view.nx));
        }
    }
    const double times = double(errors.size()), places = double(errors[0].size());
    ASSERT_GT(places, 100);
    double over_time = 0, over_places = 0;
    const auto variance = [](double sum, double squares, double n) { return squares / n - sum * sum / n / n; };
    for (const auto& of_time : errors) {
      double sum = 0, squares = 0;
      for (const double e : of_time) sum += e, squares += e * e;
      over_places += variance(sum, squares, places) / times;
    }
    for (size_t i = 0; i < errors[0].size(); ++i) {
      double sum = 0, squares = 0;
      for (const auto& of_time : errors) sum += of_time[i], squares += of_time[i] * of_time[i];
      over_time += variance(sum, squares, times) / places;
    }
    EXPECT_GT(over_time, 0);
    EXPECT_LT(over_time, over_places) << from_last;
  }
}

// Each time but the first is what `run --last` makes of the one before. With times taken away the same command ends with the
// same bytes, although it has the one before from its files alone.
TEST(Animate, FromTheLastTimeTakesFewIterationsAndResumes) {
  const Workplace work;
  work.write("scene.toml", optimised_scene());
  const std::vector<std::string> command{"animate", "scene.toml", "-o", "film", "--seconds", "0.6", "-q"};
  ASSERT_EQ(work.run(command).exit_code, 0);
  const auto files = files_of(work, "film");
  for (const auto& [folder, time, last] :
       {std::array{"t_0001", "0 s", ""}, std::array{"t_0002", "200 ms", "film/t_0001"},
        std::array{"t_0003", "400 ms", "film/t_0002"}}) {
    std::vector<std::string> still{"run", "scene.toml", "-o", "still", "--time", time, "-q"};
    if (*last) still.insert(still.end(), {"--last", last});
    ASSERT_EQ(work.run(still).exit_code, 0);
    EXPECT_EQ(work.read("still/hologram.png"), work.read(std::string("film/") + folder + "/hologram.png")) << time;
  }
  std::filesystem::remove_all(work.path("film/t_0002"));
  std::filesystem::remove_all(work.path("film/t_0003"));
  ASSERT_EQ(work.run(command).exit_code, 0);
  EXPECT_EQ(files_of(work, "film"), files);

  // With another time before it, 200 ms is another result, although its own job is the same.
  for (const char* folder : {"film", "other"})
    ASSERT_EQ(work.run({"animate", "scene.toml", "-o", folder, "--times", "100, 200 ms", "-q"}).exit_code, 0);
  EXPECT_EQ(work.read("film/t_0002/hologram.png"), work.read("other/t_0002/hologram.png"));
  EXPECT_NE(work.read("film/t_0002/hologram.png"), files.at("/t_0002/hologram.png"));

  std::vector<std::string> afresh = command;
  afresh.insert(afresh.end(), {"--from-last", "false"});
  ASSERT_EQ(work.run(afresh).exit_code, 0);
  EXPECT_EQ(files_of(work, "film").at("/t_0001/hologram.png"), files.at("/t_0001/hologram.png"));
  EXPECT_NE(files_of(work, "film").at("/t_0002/hologram.png"), files.at("/t_0002/hologram.png"));
}

TEST(Animate, FromTheLastTimeOnlyWhereTheLightOfTheSceneIsAimedAt) {
  const Workplace work;
  work.write("scene.toml", moving_scene());
  expect_error(work, {"animate", "scene.toml", "-o", "film", "--from-last", "true"},
               {"expected from_last only with the method sgd and the target render"});
}

// A file of another size, a report that is gone, or another scene: the time is computed again.
TEST(Animate, OnlyWholeRunsOfTheSameJobAreKept) {
  const Workplace work;
  work.write("scene.toml", moving_scene());
  const Words film{"animate", "scene.toml", "-o", "film", "--times", "0, 0.1, 0.2 s"};
  ASSERT_EQ(work.run(film).exit_code, 0);
  const auto whole = files_of(work, "film");
  work.write("film/t_0001/view.png", "cut");
  std::filesystem::remove(work.path("film/t_0002/report.json"));
  const Outcome again = work.run(film);
  EXPECT_EQ(lines_of(again.out).at(0), "1 of 3, 0 s: computed");
  EXPECT_EQ(lines_of(again.out).at(1), "2 of 3, 100 ms: computed");
  EXPECT_EQ(lines_of(again.out).at(2), "3 of 3, 200 ms: kept from an earlier call");
  for (const auto& [name, bytes] : whole) EXPECT_EQ(work.read("film" + name), bytes) << name;
  std::string brighter = moving_scene();
  brighter.replace(brighter.find("amplitude = 2"), 13, "amplitude = 3");
  work.write("scene.toml", brighter);
  EXPECT_EQ(lines_of(work.run(film).out).at(2), "3 of 3, 200 ms: computed");
}

// The GIF has one frame for each time, each of 1/5 s. Its pictures have one exposure: the wall is equally bright in all.
TEST(Animate, AFilmHasAPictureForEachTime) {
  const Workplace work;
  work.write("scene.toml", moving_scene());
  ASSERT_EQ(work.run({"animate", "scene.toml", "-o", "film", "--film-format", "gif", "-q"}).exit_code, 0);
  for (const char* name : {"film/view.gif", "film/render.gif"}) {
    const Gif gif = load_gif(work.path(name));
    EXPECT_EQ(gif.frames.size(), 2u) << name;  // up to the last key at 0.4 s
    EXPECT_EQ(gif.hundredths, 20);
    EXPECT_NE(gif.frames.at(0), gif.frames.at(1));
  }
  const Outcome info = work.run({"info", "film", "--json"});
  ASSERT_EQ(info.exit_code, 0) << info.err;
  const Json facts = Json::parse(info.out);
  EXPECT_EQ(facts.at("kind"), "film");
  EXPECT_EQ(facts.at("times"), 2);
  EXPECT_EQ(facts.at("fps"), 5);
  EXPECT_EQ(facts.at("holograms_of_a_time"), 1);
  EXPECT_EQ(facts.at("encoder"), "phase");
  EXPECT_EQ(facts.at("seconds_of_film"), 0.4);
  double least = 1e9;
  for (const char* time : {"film/t_0001/report.json", "film/t_0002/report.json"}) {
    const Json report = Json::parse(work.read(time));
    for (const Json& stage : report.at("stages"))
      if (stage.contains("psnr_db") && stage.contains("distance_m"))
        least = std::min(least, stage.at("psnr_db").get<double>());
  }
  EXPECT_NE(facts.at("psnr").get<std::string>().find(fmt::format("{:.1f} dB at least", least)), std::string::npos)
      << facts.at("psnr");
  const Outcome shown = work.run({"show", "film", "-o", "v.png"});
  EXPECT_NE(shown.err.find("film is that of a film; give that of one of its times, such as film/t_0001"),
            std::string::npos)
      << shown.err;
  ASSERT_EQ(work.run({"animate", "scene.toml", "-o", "film", "--film-format", "png", "-q"}).exit_code, 0);
  EXPECT_FALSE(work.has("film/view.gif"));  // of the earlier call
  const Image first = load_image(work.path("film/render_0001.png")),
              second = load_image(work.path("film/render_0002.png"));
  EXPECT_EQ(first.ny, 32);
  const float wall = first(2, first.nx / 2);
  EXPECT_GT(wall, 0.05F);
  EXPECT_NEAR(wall, second(2, first.nx / 2), 0.01);  // two sRGB codes: light from all around has no noise on the wall
}

// Two frames in two colours: four holograms at each time, in the order in which they are shown.
TEST(Animate, TheTableOfTimesListsEveryHologram) {
  const Workplace work;
  std::string scene = moving_scene();
  scene.replace(scene.find("\"532 nm\""), 8, "[\"638 nm\", \"532 nm\"]");
  scene.insert(scene.find("[render]"), "levels = 2\n");  // of the panel
  work.write("scene.toml", scene);
  const Outcome outcome = work.run({"animate", "scene.toml", "-o", "film", "--frames", "2", "-q"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<std::string> lines = lines_of(work.read("film/timing.csv"));
  ASSERT_EQ(lines.size(), 9u);
  EXPECT_EQ(lines[0], "start_s,duration_s,time_s,frame,wavelengths_nm,bit_plane,illumination_w_per_m2,light,file");
  const auto starts = [&](size_t line, const std::string& begin, const std::string& end) {
    EXPECT_TRUE(lines[line].starts_with(begin) && lines[line].ends_with(end)) << lines[line];
  };
  starts(1, "0,0.05,0,1,638,1,", ",,t_0001/hologram.png");
  starts(2, "0.05,0.05,0,1,532,2,", ",,t_0001/hologram_2.png");
  starts(3, "0.1,0.05,0,2,638,3,", ",,t_0001/hologram_3.png");
  starts(8, "0.35,0.05,0.2,2,532,4,", ",,t_0002/hologram_4.png");
}

// A viewer who walks past a white wall; optimised holograms are for the measured eye.
std::string walking_scene(const std::string& eye_of_encode, const std::string& eye_of_camera) {
  return scene_head(small_panel, "background = 0.1\n") +
         "[render]\nrows = 32\npaths = 2\n[encode]\nmethod = \"sgd\"\ntarget = \"render\"\niterations = 8\n" +
         eye_of_encode + "[camera]\npupil = \"1 mm\"\ndistances = \"32 mm\"\n" + eye_of_camera +
         "[animate]\nfps = 5\n[[object]]\ntype = \"quad\"\nwidth = \"0.5 mm\"\nheight = \"0.5 mm\"\n"
         "position = \"0 0 -32 mm\"\n";
}

// The places of the track are those of keys, so the holograms, views and renders have the same bytes.
TEST(Animate, AnEyeTrackWithoutLatencyIsThatOfKeysOverTime) {
  const Workplace work;
  const std::string keys = "eye = { \"0 s\" = \"-1 0 60 mm\", \"400 ms\" = \"1 0.5 60 mm\" }\n";
  work.write("keys.toml", walking_scene(keys, keys));
  work.write("walk.csv", "time_s,x_mm,y_mm,z_mm\n0,-1,0,60\n0.4,1,0.5,60\n");
  work.write("track.toml", walking_scene("", "") + "[eye]\ntrack = \"walk.csv\"\n");
  ASSERT_EQ(work.run({"animate", "keys.toml", "-o", "keys", "-q"}).exit_code, 0);
  const Outcome outcome = work.run({"animate", "track.toml", "-o", "track", "-q"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  std::map<std::string, std::string> with_track = files_of(work, "track"), with_keys = files_of(work, "keys");
  for (const char* name : {"/track.csv", "/track_distance.png", "/track_psnr.png"})
    EXPECT_EQ(with_track.erase(name), 1u) << name;
  EXPECT_EQ(with_track, with_keys);
}

// With from_last the light of the wall is traced once for the whole walk, so a longer walk makes another film, as a fresh one is; and a
// film whose last times are gone ends with the same bytes.
TEST(Animate, AWalkResumesAndGrowsToTheSameBytes) {
  const Workplace work;
  work.write("walk.csv", "time_s,x_mm,y_mm,z_mm\n0,-0.3,0,60\n1,0.3,0,60\n");
  std::string scene = walking_scene("next_iterations = 2\n", "") + "[eye]\ntrack = \"walk.csv\"\n";
  scene.replace(scene.find("fps = 5\n"), 8, "fps = 5\nfrom_last = true\n");
  work.write("walk.toml", scene);
  const auto make = [&](const char* folder, const char* seconds, std::vector<std::string> more = {}) {
    std::vector<std::string> command{"animate", "walk.toml", "-o", folder, "--seconds", seconds, "-q"};
    command.insert(command.end(), more.begin(), more.end());
    const Outcome outcome = work.run(command);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  };
  make("film", "0.4");
  make("film", "0.6");
  make("fresh", "0.6");
  const auto files = files_of(work, "fresh");
  EXPECT_EQ(files_of(work, "film"), files);
  EXPECT_NE(work.read("fresh/t_0003/report.json").find("kept_light"), std::string::npos);
  for (const char* folder : {"film/t_0002", "film/t_0003"}) std::filesystem::remove_all(work.path(folder));
  make("film", "0.6");
  EXPECT_EQ(files_of(work, "film"), files);

  // The display shows the second of two rolling frames at the next time, too.
  make("rolling", "0.4", {"--frames", "2", "--rolling", "true"});
  const auto levels = [&](const char* file) { return load_image(work.path(std::string("rolling/") + file)).values; };
  EXPECT_EQ(levels("t_0002/hologram.png"), levels("t_0001/hologram_2.png"));
  EXPECT_NE(levels("t_0002/hologram_2.png"), levels("t_0001/hologram.png"));
}

// 5 mm/s · 50 ms = 0.25 mm. At 0.2 s the hologram is that for the eye at 0.15 s, and the view is that of the eye at 0.2 s.
TEST(Animate, TheHologramIsForTheMeasuredEyeAndTheViewIsThatOfTheEye) {
  const Workplace work;
  work.write("walk.csv", "0,-1,0,60\n0.4,1,0,60\n");
  work.write("scene.toml", walking_scene("", ""));
  const Outcome outcome =
      work.run({"animate", "scene.toml", "-o", "film", "--eye-track", "walk.csv", "--eye-latency", "50 ms", "-q"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  work.write("still.toml", walking_scene("eye = \"-0.25 0 60 mm\"\n", "eye = \"0 0 60 mm\"\n"));
  ASSERT_EQ(work.run({"run", "still.toml", "-o", "still", "-q"}).exit_code, 0);
  for (const char* name : {"hologram.png", "view.png", "render.png"})
    EXPECT_EQ(work.read(std::string("film/t_0002/") + name), work.read(std::string("still/") + name)) << name;
  work.write("measured.toml", walking_scene("eye = \"-0.25 0 60 mm\"\n", "eye = \"-0.25 0 60 mm\"\n"));
  ASSERT_EQ(work.run({"run", "measured.toml", "-o", "measured", "-q"}).exit_code, 0);
  const auto figures_of = [&](const std::string& folder) {
    const Json report = Json::parse(work.read(folder + "/report.json"));
    for (const Json& stage : report.at("stages"))
      if (stage.contains("distance_m"))
        return std::pair(stage.at("psnr_db").get<double>(), stage.at("diffraction_efficiency").get<double>());
    return std::pair(0.0, 0.0);
  };
  const std::vector<std::string> lines = lines_of(work.read("film/track.csv"));
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(
      lines[0],
      "time_s,x_mm,y_mm,z_mm,measured_x_mm,measured_y_mm,measured_z_mm,distance_mm,distance_without_prediction_mm,"
      "psnr_db,measured_psnr_db,light,measured_light");
  std::vector<double> row;
  std::istringstream stream(lines[2]);
  for (std::string word; std::getline(stream, word, ',');) row.push_back(std::stod(word));
  ASSERT_EQ(row.size(), 13u);
  const std::vector<double> places{0.2, 0, 0, 60, -0.25, 0, 60, 0.25, 0.25};
  for (size_t i = 0; i < places.size(); ++i) EXPECT_NEAR(row[i], places[i], 1e-9) << i;
  // Six digits are written. The view from the measured eye is that of a run with the camera there, whose reference is the same.
  const auto [psnr, light] = figures_of("still");
  const auto [measured_psnr, measured_light] = figures_of("measured");
  EXPECT_NEAR(row[9], psnr, 1e-4);
  EXPECT_NEAR(row[10], measured_psnr, 1e-4);
  EXPECT_NEAR(row[11], light, 1e-5 * light);
  EXPECT_NEAR(row[12], measured_light, 1e-5 * measured_light);
  const Json report = Json::parse(work.read("film/report.json"));
  EXPECT_NEAR(report.at("eye").at("largest_distance_m").get<double>(), 0.25e-3, 1e-12);
  // The prediction of a straight walk has no error.
  ASSERT_EQ(work.run({"animate", "scene.toml", "-o", "ahead", "--times", "0.2 s", "--eye-track", "walk.csv",
                      "--eye-latency", "50 ms", "--eye-predict", "true", "-q"})
                .exit_code,
            0);
  EXPECT_NEAR(Json::parse(work.read("ahead/report.json")).at("eye").at("largest_distance_m").get<double>(), 0, 1e-12);
}

// An eye far aside sees the panel's frame as one before its middle does. The wall is even, so views are as good there. Its window
// has its middle at −x·d/z in the plane in focus.
TEST(Animate, TheWindowOfTheViewFollowsTheEye) {
  const Workplace work;
  work.write("walk.csv", "0,-1.5,0,60\n0.4,1.5,0.6,60\n");
  std::string scene = walking_scene("", "");
  for (const char* side : {"width", "height"})
    scene.replace(scene.find(std::string(side) + " = \"0.5 mm\""), std::string(side).size() + 11,
                  std::string(side) + " = \"9 mm\"");
  work.write("scene.toml", scene);
  const Outcome outcome =
      work.run({"animate", "scene.toml", "-o", "film", "--eye-track", "walk.csv", "--times", "0, 0.2 s", "-q"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto place_of = [&](const std::string& folder) {
    const Json report = Json::parse(work.read(folder + "/report.json"));
    for (const Json& stage : report.at("stages"))
      if (stage.contains("render_tangent_x")) return stage;
    return Json();
  };
  const Json first = place_of("film/t_0001"), middle = place_of("film/t_0002");
  EXPECT_NEAR(first.at("centre_x_m").get<double>(), 1.5e-3 * 32 / 60, 1e-9);  // digits of the report
  EXPECT_NEAR(first.at("render_tangent_x").get<double>(), 1.5 / 60, 1e-9);
  EXPECT_NEAR(middle.at("centre_y_m").get<double>(), -0.3e-3 * 32 / 60, 1e-9);
  EXPECT_NEAR(middle.at("render_tangent_y").get<double>(), -0.3 / 60, 1e-9);
  // Both see the wall all over the window. A panel of 0.5 mm shows little of it in eight iterations; 3 dB are for the smaller
  // light of order 0 aside, and a view of the axis has 10 dB less.
  EXPECT_NEAR(first.at("lit_fraction_of_render").get<double>(), 1, 1e-9);
  EXPECT_NEAR(first.at("psnr_db").get<double>(), middle.at("psnr_db").get<double>(), 3);
  // The hologram's file says so: show sees the same part, to the rounding of the files' half floats.
  ASSERT_EQ(work.run({"show", "film/t_0001/hologram.png", "-o", "again.exr"}).exit_code, 0);
  const Image film = load_image(work.path("film/t_0001/film_view.exr")), again = load_image(work.path("again.exr"));
  const auto mean = [](const Image& image) {
    return std::accumulate(image.values.begin(), image.values.end(), 0.0) / double(image.values.size());
  };
  ASSERT_EQ(again.values.size(), film.values.size());
  for (size_t i = 0; i < film.values.size(); ++i)
    ASSERT_NEAR(again.values[i] / mean(again), film.values[i] / mean(film), 1e-2) << i;
}

// Holograms of waves are for all eyes: those of the first time are taken again.
TEST(Animate, ATrackedEyeTakesHologramsOfWavesAgain) {
  const Workplace work;
  std::string scene = moving_scene();
  scene.replace(scene.find("position = { \"0 s\""),
                scene.find("[[object]]\ntype = \"quad\"") - scene.find("position = { \"0 s\""),
                "position = \"0 0 -30 mm\"\n");
  work.write("scene.toml", scene);
  work.write("walk.csv", "0,-0.5,0,5\n0.4,0.5,0,5\n");
  ASSERT_EQ(work.run({"animate", "scene.toml", "-o", "film", "--eye-track", "walk.csv", "--eye-latency", "50 ms",
                      "--pupil", "0.5 mm", "-q"})
                .exit_code,
            0);
  std::vector<std::string> names;
  const Json report = Json::parse(work.read("film/t_0002/report.json"));
  for (const Json& stage : report.at("stages")) names.push_back(stage.at("stage"));
  const std::vector<std::string> expected{"render", "eye",           "render for the measured eye", "reuse",
                                          "show",   "look at 30 mm", "look from the measured eye"};
  EXPECT_EQ(names, expected);
}

TEST(Animate, AFilmThatIsLongerThanItsEyeTrackIsAnError) {
  const Workplace work;
  work.write("scene.toml", moving_scene());
  work.write("walk.csv", "0,-0.5,0,5\n0.4,0.5,0,5\n");
  expect_error(
      work, {"animate", "scene.toml", "-o", "film", "--seconds", "1", "--eye-track", "walk.csv"},
      {"expected an eye track that lasts until 800 ms, got one that ends at 400 ms: walk.csv; record a longer one, or make a shorter film"});
  expect_error(
      work, {"animate", "scene.toml", "-o", "film", "--eye-noise", "1 mm"},
      {"expected an eye track beside --eye-latency, --eye-noise, --eye-seed and --eye-predict; give --eye-track"});
}

// Ranks share the times: the files have the bytes of one process, also after an interruption.
TEST(Animate, RanksShareTheTimes) {
  if (!HOLOTRACE_HAS_MPI) GTEST_SKIP() << "this build is without MPI";
  if (!has_mpirun()) GTEST_SKIP() << "there is no mpirun to start ranks with";
  const Workplace work;
  work.write("scene.toml", moving_scene());
  ASSERT_EQ(work.run({"animate", "scene.toml", "-o", "alone", "--seconds", "1", "-q"}).exit_code, 0);
  const std::vector<std::string> job{"animate", "scene.toml", "-o", "film", "--seconds", "1"};
  const Outcome outcome = work.run_under(mpirun(2), job);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<std::string> lines = lines_of(outcome.out);
  ASSERT_EQ(lines.size(), 4u) << outcome.out;  // 2 of 5 times are those of rank 0
  EXPECT_EQ(lines[1], "2 of 5, 200 ms: computed");
  EXPECT_EQ(lines[2], "3 to 5 of 5: by other ranks");
  EXPECT_EQ(files_of(work, "film"), files_of(work, "alone"));
  for (const char* time : {"film/t_0002", "film/t_0005"}) std::filesystem::remove_all(work.path(time));
  const auto written = std::filesystem::last_write_time(work.path("film/t_0004/hologram.png"));
  ASSERT_EQ(work.run_under(mpirun(3), job).exit_code, 0);
  EXPECT_EQ(std::filesystem::last_write_time(work.path("film/t_0004/hologram.png")), written);
  EXPECT_EQ(files_of(work, "film"), files_of(work, "alone"));
}

// Rank 1 cannot write its folder, since a file has its name: rank 0 says so.
TEST(Animate, ARankThatFailsEndsTheFilmWithItsSentence) {
  if (!HOLOTRACE_HAS_MPI) GTEST_SKIP() << "this build is without MPI";
  if (!has_mpirun()) GTEST_SKIP() << "there is no mpirun to start ranks with";
  const Workplace work;
  work.write("scene.toml", moving_scene());
  std::filesystem::create_directory(work.path("film"));
  work.write("film/t_0002", "");
  const Outcome outcome = work.run_under(mpirun(2), {"animate", "scene.toml", "-o", "film", "--times", "0, 0.2 s"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("rank 1: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("t_0002"), std::string::npos) << outcome.err;
}

TEST(Animate, WhatCannotBeAFilmIsRefused) {
  const Workplace work;
  work.write("still.toml",
             scene_head() + "[[object]]\ntype = \"wireframe_cube\"\nsize = \"0.5 mm\"\nposition = \"0 0 -30 mm\"\n");
  work.write("scene.toml", moving_scene());
  expect_error(work, {"animate", "still.toml", "-o", "film"}, {"expected the duration of the film", "give seconds"});
  expect_error(work, {"animate", "scene.toml", "-o", "film", "--seconds", "1e6", "--fps", "1000"},
               {"expected at most 100000 times of a film, got 1e+09"});
  expect_error(work, {"animate", "scene.toml", "-o", "film", "--times", "1, 0.5 s"},
               {"expected the times of a film in their order"});
  expect_error(work, {"animate", "scene.toml", "-o", "film", "--film-start", "1"},
               {"--film-start: expected a time with its unit"});
  expect_error(work, {"animate", "scene.toml", "-o", "film", "--fps", "0"}, {"--fps: expected a number"});
  expect_error(
      work, {"animate", "scene.toml", "-o", "film", "--sweep", "focus", "--sweep-from", "28 mm", "--sweep-to", "32 mm"},
      {"expected a film without a sweep"});
  expect_error(work, {"run", "scene.toml", "-o", "out", "--time", "1 h"},
               {"--time: expected a time in one of the units s, ms"});
}

}  // namespace
}  // namespace holotrace::test
