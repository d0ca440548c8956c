#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "holotrace/base/units.h"
#include "holotrace/io/describe_file.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/io/scene/slm_file.h"
#include "support/panels.h"
#include "support/png.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

// A folder of user-defined panels for one test.
class UserPanels {
 public:
  explicit UserPanels(const std::string& folder) { setenv("HOLOTRACE_PANELS", folder.c_str(), 1); }
  ~UserPanels() { unsetenv("HOLOTRACE_PANELS"); }
};

std::string file_in(const std::string& folder, const std::string& name, const std::string& text) {
  fs::create_directories(folder);
  write_text(folder + "/" + name, text);
  return folder + "/" + name;
}

std::string fresh_folder(const std::string& name) {
  const std::string folder = fs::path(test::make_file("slm_file_" + name + ".txt", "")).replace_extension("").string();
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

// The sentence of an error, without the folder of the file.
std::string sentence_in(const std::string& folder, const std::function<void()>& call) {
  std::string sentence = error_of(call);
  for (size_t at; (at = sentence.find(folder + "/")) != std::string::npos;) sentence.erase(at, folder.size() + 1);
  return sentence;
}

TEST(SlmFile, ThePanelsThatComeWithItAreThere) {
  for (const char* name : {"gaea", "ideal", "leto", "luna", "pluto"}) {
    const Slm slm = slm_preset(name);
    EXPECT_EQ(slm.name, name);
    EXPECT_EQ(slm.preset, name);
    EXPECT_FALSE(slm.source.empty());
    EXPECT_EQ(error_of([&] { check_slm(slm); }), "no error");
  }
  const Slm pluto = slm_preset("pluto");
  EXPECT_EQ(pluto.grid, (Grid{1920, 1080, 8e-6}));
  EXPECT_EQ(pluto.levels, 256);
  EXPECT_EQ(pluto.fill_factor, 0.93);
  EXPECT_EQ(effects_of(pluto), (std::vector<std::string>{"calibration", "crosstalk", "gaps", "flicker", "aberration"}));
  EXPECT_EQ(slm_preset("gaea").grid, (Grid{4160, 2464, 3.74e-6}));
  EXPECT_EQ(slm_preset("leto").grid.pitch, 6.4e-6);
  EXPECT_EQ(slm_preset("luna").grid.pitch, 4.5e-6);
  const Slm ideal = slm_preset("ideal");
  EXPECT_EQ(ideal.levels, 65536);
  EXPECT_EQ(ideal.fill_factor, 1);
  EXPECT_TRUE(effects_of(ideal).empty());
}

// What holds for every panel that is sold: its figures and where they are from. A pitch is 3 to 40 µm and a panel 5 to 40 mm wide:
// smaller pixels and larger chips are not made. `lcos`, `dmd` and `ideal` stand for kinds of panels.
TEST(SlmFile, EveryPanelHasASourceAndSaneFigures) {
  int sold = 0;
  for (const KnownPanel& panel : known_panels()) {
    EXPECT_FALSE(panel.is_users) << panel.name;
    const Slm slm = slm_preset(panel.name);
    EXPECT_GE(slm.grid.pitch, 3e-6) << panel.name;
    EXPECT_LE(slm.grid.pitch, 40e-6) << panel.name;
    EXPECT_GE(slm.grid.width(), 5e-3) << panel.name;
    EXPECT_LE(slm.grid.width(), 40e-3) << panel.name;
    EXPECT_GE(slm.fill_factor, 0.5) << panel.name;
    EXPECT_EQ(slm.levels & (slm.levels - 1), 0) << panel.name << ": levels are bits";
    const bool is_kind = panel.name == "lcos" || panel.name == "dmd" || panel.name == "ideal";
    EXPECT_EQ(slm.source.starts_with("no "), is_kind) << panel.name << " has no source of its own";
    if (is_kind) continue;
    ++sold;
    const char* makers[] = {"HOLOEYE",  "Meadowlark Optics", "Hamamatsu",        "Santec",
                            "Thorlabs", "Jasper Display",    "Texas Instruments"};
    EXPECT_TRUE(std::any_of(std::begin(makers), std::end(makers),
                            [&](const char* maker) { return slm.source.starts_with(maker); }))
        << panel.name << ": " << slm.source;
    // What its maker does not state is said to be typical.
    EXPECT_EQ(!effects_of(slm).empty() && !slm.source.starts_with("Texas"),
              slm.source.find("effects typical") != std::string::npos)
        << panel.name;
  }
  EXPECT_GE(sold, 20);
}

// The sides that makers state beside the pixels and their pitch, in mm, agree to the last digit that they state (of the 1920 x
// 1152, to two units of it; of the EXULUS-HD2, which has a border, to a tenth). The diagonal of the PLMs is in their names.
TEST(SlmFile, SidesAgreeWithThoseThatMakersState) {
  const auto sides = [](const char* name) { return slm_preset(name).grid; };
  const auto expect = [&](const char* name, double x, double y, double digit) {
    EXPECT_NEAR(sides(name).width() * 1e3, x, digit) << name;
    EXPECT_NEAR(sides(name).height() * 1e3, y, digit) << name;
  };
  expect("pluto", 15.36, 8.64, 0.005);
  expect("meadowlark-1920x1152", 17.6, 10.7, 0.11);
  expect("meadowlark-1024x1024", 17.4, 17.4, 0.05);
  expect("meadowlark-512x512", 7.68, 7.68, 0.005);
  expect("hamamatsu-x13138", 15.9, 12.8, 0.05);
  expect("hamamatsu-x10468", 15.8, 12.0, 0.05);
  expect("thorlabs-exulus-hd2", 15.42, 9.66, 0.08);
  expect("ti-dlp7000", 14.0, 10.5, 0.05);
  expect("ti-dlp9500", 20.7, 11.7, 0.05);
  for (const auto& [name, inches] : {std::pair{"ti-plm47", 0.47}, std::pair{"ti-plm67", 0.67}})
    EXPECT_NEAR(std::hypot(sides(name).width(), sides(name).height()) / 25.4e-3, inches, 0.005) << name;
}

// The effects of a kind of panel are in one file; each panel replaces what differs.
TEST(SlmFile, PanelsTakeTheTypicalEffectsOfTheirKind) {
  const Slm kind = slm_preset("lcos"), hamamatsu = slm_preset("hamamatsu-x13138"), santec = slm_preset("santec-slm200");
  EXPECT_EQ(effects_of(hamamatsu), effects_of(kind));
  EXPECT_EQ(hamamatsu.effects.aberration, kind.effects.aberration);
  EXPECT_TRUE(hamamatsu.own_effects.empty());  // typical figures are off
  // Crosstalk reaches over 1.6 µm: 0.2 pixels of 8 µm, 0.13 of 12.5 µm.
  for (const Slm& slm : {kind, hamamatsu, santec})
    EXPECT_NEAR(slm.effects.crosstalk * slm.grid.pitch, 1.6e-6, 0.01 * slm.grid.pitch) << slm.name;
  EXPECT_EQ(santec.effects.calibration.size(), 1024u);  // the curve of 256 levels, interpolated
  for (const char* name : {"dmd", "ti-dlp7000"}) {
    EXPECT_EQ(slm_preset(name).modulation, Modulation::amplitude);
    EXPECT_EQ(slm_preset(name).levels, 2);
    EXPECT_TRUE(effects_of(slm_preset(name)).empty());
  }
}

// ti-plm 1.1.0: the last displacement, 1, is 15/16 of a turn; the steps between are uneven, from 0.0126 to 0.1746 of it.
TEST(SlmFile, ThePhaseLightModulatorsHaveUnevenLevels) {
  const std::vector<CalibrationPoint> levels = slm_preset("ti-plm67").effects.calibration;
  ASSERT_EQ(levels.size(), 16u);
  EXPECT_EQ(levels, slm_preset("ti-plm47").effects.calibration);
  const double turn = 2 * pi * 15 / 16;
  EXPECT_EQ(levels[0].phase, 0);
  EXPECT_NEAR(levels[1].phase, 0.0126 * turn, 1e-9);
  EXPECT_NEAR(levels[15].phase - levels[14].phase, 0.1746 * turn, 1e-9);
  EXPECT_NEAR(levels[15].phase, turn, 1e-9);
}

TEST(SlmFile, APanelInAFolderOfTheUsersWins) {
  const std::string folder = fresh_folder("wins");
  file_in(folder, "luna.toml", "preset = \"pluto\"\nsource = \"measured\"\nfill_factor = 0.8\n");
  file_in(folder, "lcos.toml", "preset = \"pluto\"\ncrosstalk = 1\n");
  const Slm before = slm_preset("luna"), pluto = slm_preset("pluto");
  const UserPanels here(folder);
  const Slm luna = slm_preset("luna");
  EXPECT_EQ(luna.grid.pitch, 8e-6);
  EXPECT_EQ(luna.fill_factor, 0.8);
  EXPECT_EQ(luna.source, "measured");
  EXPECT_EQ(before.grid.pitch, 4.5e-6);
  EXPECT_EQ(slm_preset("pluto").effects.crosstalk,
            pluto.effects.crosstalk);  // built-in panels keep their own lcos.toml
  for (const KnownPanel& panel : known_panels()) {
    EXPECT_EQ(panel.is_users, panel.name == "luna" || panel.name == "lcos") << panel.name;
    EXPECT_EQ(panel.file.starts_with(folder + "/"), panel.is_users) << panel.file;
  }
}

TEST(SlmFile, AnUnknownOneIsRefusedWithTheNearest) {
  EXPECT_EQ(error_of([] { slm_preset("plutto"); }),
            "unknown SLM \"plutto\"; did you mean \"pluto\"? \"holotrace info --slm\" lists all");
  EXPECT_EQ(error_of([] { slm_preset("x13138"); }),
            "unknown SLM \"x13138\"; did you mean \"hamamatsu-x13138\"? \"holotrace info --slm\" lists all");
  EXPECT_EQ(error_of([] { slm_preset("PLUTO"); }),
            "unknown SLM \"PLUTO\"; did you mean \"pluto\"? \"holotrace info --slm\" lists all");
  const std::string of_maker = error_of([] { slm_preset("Hamamatsu"); });
  EXPECT_TRUE(of_maker.starts_with("unknown SLM \"Hamamatsu\"; did you mean \"hamamatsu-x")) << of_maker;
  EXPECT_EQ(error_of([] { slm_preset("xyzzyx"); }),
            "unknown SLM \"xyzzyx\"; \"holotrace info --slm\" lists those that are known");
  EXPECT_EQ(error_of([] { slm_preset("../panels/pluto"); }),
            "unknown SLM \"../panels/pluto\"; did you mean \"pluto\"? \"holotrace info --slm\" lists all");
}

TEST(SlmFile, AUserAddsPanelsAndChangesThem) {
  const std::string folder = fresh_folder("user");
  const UserPanels here(folder);
  file_in(folder, "mine.toml", R"(
preset = "pluto"
pitch = "10 um"
fill_x = 0.98
fill_y = 0.9
phase_range = "400 deg"
modulation = "complex"
levels = 64
dead_fraction = 0.001
dead_seed = 5
dead_pixels = [[1, 2, 3], [4, 5, 6]]
aberration = [{ n = 2, m = -2, rms = "0.25 rad" }]
)");
  const std::vector<std::string> names = slm_preset_names();
  EXPECT_NE(std::find(names.begin(), names.end(), "mine"), names.end());
  const Slm slm = slm_preset("mine");
  EXPECT_EQ(slm.name, "mine");
  EXPECT_EQ(slm.grid, (Grid{1920, 1080, 10e-6}));
  EXPECT_EQ(slm.lit_x(), 0.98);
  EXPECT_EQ(slm.lit_y(), 0.9);
  EXPECT_DOUBLE_EQ(slm.fill_factor, 0.98 * 0.9);
  EXPECT_DOUBLE_EQ(slm.phase_range, 400 * pi / 180);
  EXPECT_EQ(slm.modulation, Modulation::complex);
  ASSERT_EQ(slm.effects.calibration.size(), 64u);  // pluto's calibration, at every fourth level
  EXPECT_EQ(slm.effects.calibration[16].phase, slm_preset("pluto").effects.calibration[64].phase);
  EXPECT_EQ(slm.effects.dead_fraction, 0.001);
  EXPECT_EQ(slm.effects.dead_seed, 5);
  ASSERT_EQ(slm.effects.dead_pixels.size(), 2u);
  EXPECT_EQ(slm.effects.dead_pixels[1].level, 6);
  ASSERT_EQ(slm.effects.aberration.size(), 1u);
  EXPECT_EQ(slm.effects.aberration[0].m, -2);
  EXPECT_EQ(slm.effects.crosstalk, 0.2);

  file_in(folder, "a.toml", "preset = \"b\"\n");
  file_in(folder, "b.toml", "preset = \"a\"\n");
  EXPECT_EQ(sentence_in(folder, [] { slm_preset("a"); }),
            "a.toml:1:10: b.toml:1:10: expected a panel that does not extend itself, got \"a\"");
  file_in(folder, "c.toml", "columns = 10\nrows = 10\npitch = \"8 um\"\nfil_factor = 1\n");
  EXPECT_EQ(sentence_in(folder, [] { slm_preset("c"); }),
            "c.toml:4:1: unknown key \"fil_factor\"; did you mean \"fill_factor\"?");
  file_in(folder, "e.toml", "columns = 10\nrows = 10\n");
  EXPECT_EQ(sentence_in(folder, [] { slm_preset("e"); }),
            "e.toml:1:1: expected the key \"pitch\" in the panel, which is missing");
  file_in(folder, "d.toml", "columns = 10\nrows = 10\npitch = \"8 um\"\ndead_pixels = [[10, 0, 1]]\n");
  EXPECT_EQ(sentence_in(folder, [] { slm_preset("d"); }),
            "d.toml:1:1: expected dead pixels on the panel of 10 × 10 pixels, got column 10, row 0");
}

TEST(SlmFile, ACalibrationIsLinearBetweenItsLevels) {
  const std::string path = test::make_file(
      "calibration.csv", "# measured\ngrey, phase_pi, amplitude\n0, 0.1, 1\n2, 0.5, 0.9\n\n5, 2, 0.6\n");
  const std::vector<CalibrationPoint> points = load_calibration(path, 6);
  ASSERT_EQ(points.size(), 6u);
  EXPECT_DOUBLE_EQ(points[0].phase, 0.1 * pi);
  EXPECT_DOUBLE_EQ(points[1].phase, 0.3 * pi);
  EXPECT_DOUBLE_EQ(points[1].amplitude, 0.95);
  EXPECT_DOUBLE_EQ(points[4].phase, 1.5 * pi);
  EXPECT_DOUBLE_EQ(points[5].amplitude, 0.6);
  const std::string degrees = test::make_file("degrees.csv", "level,phase_deg\n0,0\n1,180\n");
  EXPECT_DOUBLE_EQ(load_calibration(degrees, 2)[1].phase, pi);
  EXPECT_EQ(load_calibration(degrees, 2)[1].amplitude, 1);
}

TEST(SlmFile, ACrystalIsReadWithItsPolarisers) {
  const std::string folder = fresh_folder("crystal");
  const auto panel = [&](const std::string& keys) {
    return load_slm(file_in(folder, "p.toml", "columns = 8\nrows = 4\npitch = \"8 um\"\nlevels = 4\n" + keys));
  };
  EXPECT_FALSE(panel("").effects.crystal);
  // A polariser alone belongs to a parallel-aligned crystal with its director along x, whose delays are the panel's phases.
  const Slm simple = panel("polariser = \"30 deg\"\n");
  ASSERT_TRUE(simple.effects.crystal);
  EXPECT_EQ(simple.own_effects, std::vector<std::string>{"crystal"});
  EXPECT_DOUBLE_EQ(*simple.effects.crystal->polariser, pi / 6);
  EXPECT_FALSE(simple.effects.crystal->analyser);
  EXPECT_TRUE(simple.effects.crystal->delays.empty());
  EXPECT_FALSE(panel("polariser = \"none\"\n").effects.crystal->polariser);

  const Slm all = panel(R"(analyser = "-45 deg"
plates_before = [{ axis = "22.5 deg", delay = "180 deg" }]
[crystal]
kind = "transmissive"
director = "90 deg"
twist = "-90 deg"
first_delay = "400 deg"
last_delay = "0 deg"
)");
  const Crystal& crystal = *all.effects.crystal;
  EXPECT_EQ(crystal.pass, CrystalPass::transmissive);
  EXPECT_DOUBLE_EQ(crystal.twist, -pi / 2);
  EXPECT_DOUBLE_EQ(*crystal.polariser, pi / 2);  // along the director, where nothing else is said
  EXPECT_DOUBLE_EQ(*crystal.analyser, -pi / 4);
  EXPECT_EQ(crystal.plates_before, (std::vector<WavePlate>{{pi / 8, pi}}));
  ASSERT_EQ(crystal.delays.size(), 4u);  // level 4 would have the last one
  EXPECT_NEAR(crystal.delays[0], 400 * pi / 180, 1e-12);
  EXPECT_NEAR(crystal.delays[3], 100 * pi / 180, 1e-12);

  // A panel with other levels keeps the curve; other keys stay.
  file_in(folder, "delays.csv", "level, delay_pi\n0, 1\n1, 2\n3, 0\n");
  const Slm table = panel("[crystal]\ndelays = \"delays.csv\"\n");
  EXPECT_NEAR(table.effects.crystal->delays[1], 2 * pi, 1e-12);
  EXPECT_NEAR(table.effects.crystal->delays[2], pi, 1e-12);
  const Slm fewer = load_slm(file_in(folder, "q.toml", "preset = \"p.toml\"\nlevels = 2\nanalyser = \"0 deg\"\n"));
  ASSERT_EQ(fewer.effects.crystal->delays.size(), 2u);
  EXPECT_NEAR(fewer.effects.crystal->delays[1], pi, 1e-12);
  EXPECT_EQ(*fewer.effects.crystal->analyser, 0);
}

TEST(SlmFile, APolariserThatNobodySetFollowsTheDirector) {
  const std::string folder = fresh_folder("director");
  const std::string size = "columns = 8\nrows = 4\npitch = \"8 um\"\nlevels = 4\n";
  const auto over = [&](const std::string& keys, const std::string& more) {
    file_in(folder, "p.toml", size + keys);
    return *load_slm(file_in(folder, "q.toml", "preset = \"p.toml\"\n" + more)).effects.crystal;
  };
  const std::string turned = "[crystal]\ndirector = \"10 deg\"\n";
  EXPECT_DOUBLE_EQ(*over("[crystal]\ndirector = \"30 deg\"\n", turned).polariser, pi / 18);
  EXPECT_DOUBLE_EQ(*over("polariser = \"20 deg\"\n[crystal]\ndirector = \"30 deg\"\n", turned).polariser, pi / 9);
  EXPECT_DOUBLE_EQ(*over("[crystal]\ndirector = \"30 deg\"\n", "polariser = \"5 deg\"\n" + turned).polariser, pi / 36);
}

TEST(SlmFile, ABadCrystalIsRefusedWithItsLine) {
  const std::string folder = fresh_folder("bad_crystal");
  file_in(folder, "delays.csv", "level, phase_rad\n0, 1\n3, 0\n");
  const auto error = [&](const std::string& keys) {
    const std::string path = file_in(folder, "p.toml", "columns = 8\nrows = 4\npitch = \"8 um\"\nlevels = 4\n" + keys);
    return sentence_in(folder, [&] { load_slm(path); });
  };
  EXPECT_EQ(error("polariser = \"30 mm\"\n").substr(0, 12), "p.toml:5:13:");
  EXPECT_EQ(
      error("modulation = \"complex\"\npolariser = \"0 deg\"\n"),
      "p.toml:1:1: expected a crystal on a panel of phase or amplitude, as its levels give both together, got the "
      "modulation \"complex\"; set modulation to \"phase\"");
  EXPECT_EQ(error("[crystal]\ntwists = \"1 deg\"\n"), "p.toml:6:1: unknown key \"twists\"; did you mean \"twist\"?");
  EXPECT_EQ(error("[crystal]\nfirst_delay = \"1 deg\"\n"),
            "p.toml:6:15: expected \"last_delay\", the delay that the level 4 would have, beside \"first_delay\"");
  EXPECT_EQ(error("[crystal]\nlast_delay = \"1 deg\"\ndelays = \"delays.csv\"\n"),
            "p.toml:7:10: expected either \"delays\", or \"first_delay\" and \"last_delay\", got both");
  EXPECT_EQ(error("[crystal]\ndelays = \"delays.csv\"\n"),
            "p.toml:6:10: delays.csv:1: unknown column \"phase_rad\"; known: level, grey, delay_rad, delay_pi, "
            "delay_deg");
  EXPECT_EQ(error("plates_behind = [{ axis = \"1 deg\" }]\n"),
            "p.toml:5:18: expected a list of wave plates [{ axis = \"45 deg\", delay = \"90 deg\" }, …] for "
            "\"plates_behind\", got a table");
}

TEST(SlmFile, ABadCalibrationIsRefusedWithItsLine) {
  const std::string folder = fresh_folder("calibrations");
  const auto error = [&](const std::string& text) {
    const std::string path = file_in(folder, "c.csv", text);
    return sentence_in(folder, [&] { load_calibration(path, 4); });
  };
  EXPECT_EQ(error("level,phase\n0,0\n1,1\n2,2\n"),
            "c.csv:4: expected a calibration up to level 3, the last of the panel's 4, got levels up to 2");
  EXPECT_EQ(error(""), "c.csv: expected a calibration up to level 3, the last of the panel's 4, got none");
  EXPECT_EQ(error("level,phase\n0,0\n1,2\n2,1\n3,3\n"),
            "c.csv:4: expected a calibration whose phase never falls, got 1 rad after 2 rad; write a phase that "
            "wraps as values above 2π");
  EXPECT_EQ(error("level,phase,amplitude\n0,0,1\n1,2,1.2\n"), "c.csv:3: expected an amplitude in [0, 1], got 1.2");
  EXPECT_EQ(error("level,phase\n1,0\n"), "c.csv:2: expected a calibration that begins at level 0, got level 1");
  EXPECT_EQ(error("level,phase\n0,0\n2,1\n1,2\n"), "c.csv:4: expected levels in rising order, got 1 after 2");
  EXPECT_EQ(error("level,phase\n0,zero\n"), "c.csv:2: expected a number, got \"zero\"");
  EXPECT_EQ(error("level,phase\n0,0,1\n"), "c.csv:2: expected 2 values, as there are headings, got 3");
  EXPECT_EQ(error("level,phase_ra\n0,0\n"), "c.csv:1: unknown column \"phase_ra\"; did you mean \"phase_rad\"?");
  EXPECT_EQ(error("0,0\n1,1\n2,2\n3,3\n").substr(0, 25), "c.csv:1: unknown column \"");
}

// A panel's own calibration with 4 levels, used by one with 6: level l is its level 4l/6, interpolated linearly
// and extrapolated.
TEST(SlmFile, ACalibrationOfAnotherNumberOfLevelsIsInterpolated) {
  const std::string folder = fresh_folder("levels");
  const UserPanels here(folder);
  file_in(folder, "four.csv", "level,phase,amplitude\n0,0,1\n1,1,0.9\n2,2.5,0.6\n3,4,0.5\n");
  file_in(folder, "four.toml", "columns = 10\nrows = 10\npitch = \"8 um\"\nlevels = 4\ncalibration = \"four.csv\"\n");
  file_in(folder, "six.toml", "preset = \"four\"\nlevels = 6\n");
  const std::vector<CalibrationPoint> points = slm_preset("six").effects.calibration;
  ASSERT_EQ(points.size(), 6u);
  const double phases[] = {0, 2.0 / 3, 1.5, 2.5, 3.5, 4.5};
  const double amplitudes[] = {1, 1 - 0.1 * 2 / 3, 0.8, 0.6, 0.6 - 0.1 * 2 / 3, 0.5};  // constant beyond the last
  for (size_t l = 0; l < 6; ++l) {
    EXPECT_NEAR(points[l].phase, phases[l], 1e-12) << l;
    EXPECT_NEAR(points[l].amplitude, amplitudes[l], 1e-12) << l;
  }
}

TEST(SlmFile, EffectsOfTheSceneItselfAreOn) {
  const std::string body =
      "wavelength = \"532 nm\"\n[[object]]\ntype = \"wireframe_cube\"\nsize = \"1 mm\"\nposition = \"0 0 -100 mm\"\n";
  const auto job_of = [&](const std::string& rest) { return load_job(test::make_file("effects.toml", body + rest)); };
  EXPECT_TRUE(job_of("").slm.own_effects.empty());  // effects of the preset are off until they are named
  test::make_file("ramp.csv", "level,phase_pi\n0,0\n255,2\n");
  const Job own = job_of("[slm]\ncrosstalk = 0.3\ncalibration = \"ramp.csv\"\n");
  EXPECT_EQ(own.slm.own_effects, (std::vector<std::string>{"calibration", "crosstalk"}));
  EXPECT_DOUBLE_EQ(own.slm.effects.calibration[255].phase, 2 * pi);
  EXPECT_EQ(effects_of(own.slm).size(), 5u);  // pluto's other effects are included, but off
  EXPECT_TRUE(job_of("[slm]\ncrosstalk = 0\n").slm.own_effects.empty());
  const Job told = job_of("[slm]\ncrosstalk = 0.3\n[show]\neffects = \"gaps\"\n");
  EXPECT_EQ(told.show.effects, (std::vector<std::string>{"gaps"}));
}

TEST(SlmFile, APanelFileHasItsOwnEffects) {
  const std::string folder = fresh_folder("own");
  file_in(folder, "ramp.csv", "level,phase_pi\n0,0\n15,1.9\n");
  file_in(folder, "mine.toml", "columns = 8\nrows = 4\npitch = \"8 um\"\nlevels = 16\ncalibration = \"ramp.csv\"\n");
  EXPECT_EQ(load_slm(folder + "/mine.toml").own_effects, (std::vector<std::string>{"calibration"}));
  EXPECT_TRUE(load_slm("pluto").own_effects.empty());  // typical figures
  // A scene, or another panel, that takes the file as its preset: beside it, with changes.
  const std::string scene =
      file_in(folder, "scene.toml",
              "wavelength = \"532 nm\"\n[slm]\npreset = \"mine.toml\"\ncrosstalk = 0.2\n[[object]]\ntype = "
              "\"wireframe_cube\"\nsize = \"1 mm\"\nposition = \"0 0 -100 mm\"\n");
  const Job job = load_job(scene);
  EXPECT_EQ(job.slm.grid.nx, 8);
  EXPECT_EQ(job.slm.own_effects, (std::vector<std::string>{"calibration", "crosstalk"}));
  ASSERT_EQ(job.slm.effects.calibration.size(), 16u);
  file_in(folder, "a.toml", "preset = \"./b.toml\"\n");
  file_in(folder, "b.toml", "preset = \"././a.toml\"\n");
  EXPECT_NE(error_of([&] { load_slm(folder + "/a.toml"); }).find("expected a panel that does not extend itself"),
            std::string::npos);
}

TEST(SlmFile, PixelsThatAreNotSquareAreRefusedByName) {
  const auto panel = [](const std::string& pitch) {
    return test::make_file("pitch.toml", "columns = 8\nrows = 4\nlevels = 16\n" + pitch);
  };
  EXPECT_EQ(load_slm(panel("pitch_x = \"7.6 um\"\npitch_y = \"7.6 um\"\n")).grid.pitch, 7.6e-6);
  const auto error = [&](const std::string& pitch) { return error_of([&] { load_slm(panel(pitch)); }); };
  EXPECT_NE(
      error("pitch_x = \"7.6 um\"\npitch_y = \"10.8 um\"\n").find("expected square pixels, got 7.6 µm in x and 10.8"),
      std::string::npos);
  EXPECT_NE(error("pitch_x = \"7.6 um\"\n").find("expected pitch_x and pitch_y together"), std::string::npos);
}

TEST(SlmFile, DataSheetsGivePercentBitsAndPartsOfPi) {
  const auto panel = [](const std::string& more) {
    return test::make_file("sheet.toml", "columns = 8\nrows = 4\npitch = \"8 um\"\n" + more);
  };
  const Slm slm = load_slm(panel("bits = 10\nfill_factor = \"92 %\"\nphase_range = \"2.2 pi\"\n"));
  EXPECT_EQ(slm.levels, 1024);
  EXPECT_EQ(slm.fill_factor, 0.92);
  EXPECT_DOUBLE_EQ(slm.phase_range, 2.2 * pi);
  const auto error = [&](const std::string& more) { return error_of([&] { load_slm(panel(more)); }); };
  EXPECT_NE(error("bits = 8\nlevels = 256\n").find("expected either \"bits\" or \"levels\", got both"),
            std::string::npos);
  EXPECT_NE(error("bits = 17\n").find("16"), std::string::npos) << error("bits = 17\n");
  EXPECT_NE(error("fill_factor = \"92\"\n").find("expected a number"), std::string::npos);
  EXPECT_NE(error("fill_factor = \"120 %\"\n").find("above 0, up to 1 for \"fill_factor\", got 1.2"), std::string::npos)
      << error("fill_factor = \"120 %\"\n");
  EXPECT_NE(error("fill_factor = \"x %\"\n").find("sheet.toml:4:15: expected a part with its unit"), std::string::npos)
      << error("fill_factor = \"x %\"\n");
}

// A panel with every effect, all with values other than those of the panel file.
Slm panel_of_all_effects() {
  Slm slm = slm_preset("pluto");
  slm.grid = {8, 4, 8e-6};
  slm.levels = 16;
  slm.phase_range = 6.5;
  slm.effects.calibration.clear();
  for (int level = 0; level < 16; ++level) slm.effects.calibration.push_back({level / 3.0, 1 - level / 70.0});
  slm.effects.gap_phase = 0.1;
  slm.effects.dead_fraction = 0.01;
  slm.effects.dead_seed = (int64_t(1) << 60) + 1;  // more than a double can hold
  slm.effects.dead_pixels = {{7, 3, 15}, {0, 1, 2}};
  Array2D<float> map(4, 8);
  for (size_t i = 0; i < map.size(); ++i) map.values[i] = 0.1F * float(i) - 1;
  slm.effects.phase_map = std::make_shared<const Array2D<float>>(map);
  for (float& value : map.values) value = value * value;
  slm.effects.light_map = std::make_shared<const Array2D<float>>(map);
  slm.effects.crystal = Crystal{CrystalPass::transmissive, 0.1, -0.7, {}, 0.3, 1.2, {{0.2, pi}}, {{0.4, 1}, {0.5, 2}}};
  for (int level = 0; level < 16; ++level) slm.effects.crystal->delays.push_back(5 - level / 7.0);
  return slm;
}

TEST(SlmFile, AHologramKeepsItsPanelsEffectsWhereverItGoes) {
  Slm slm = panel_of_all_effects();
  slm.effects.crosstalk = 0;  // the panel file has crosstalk
  slm.preset = "gone.toml";
  Hologram hologram = make_hologram(slm, Modulation::phase, [](int i) { return i; });
  hologram.slm = slm;
  hologram.effects = {"calibration", "phase-map"};
  const std::string here = fresh_folder("here"), there = fresh_folder("there");
  save_hologram(here + "/h.png", hologram);
  for (const char* file : {"h.png", "h_phase_map.exr", "h_light_map.exr"})
    fs::rename(here + "/" + file, there + "/" + file);
  const Hologram again = load_hologram(there + "/h.png");
  EXPECT_EQ(again.effects, hologram.effects);
  ASSERT_TRUE(again.slm);
  EXPECT_EQ(again.slm->phase_range, 6.5);
  EXPECT_EQ(again.slm->source, slm.source);
  const SlmEffects &was = slm.effects, &is = again.slm->effects;
  ASSERT_EQ(is.calibration.size(), 16u);
  for (size_t i = 0; i < 16; ++i) {
    EXPECT_EQ(is.calibration[i].phase, was.calibration[i].phase);
    EXPECT_EQ(is.calibration[i].amplitude, was.calibration[i].amplitude);
  }
  EXPECT_EQ(is.crosstalk, 0);
  EXPECT_EQ(is.gap_amplitude, was.gap_amplitude);
  EXPECT_EQ(is.gap_phase, was.gap_phase);
  EXPECT_EQ(is.flicker, was.flicker);
  ASSERT_EQ(is.aberration.size(), was.aberration.size());
  ASSERT_FALSE(was.aberration.empty());
  for (size_t i = 0; i < was.aberration.size(); ++i) {
    EXPECT_EQ(is.aberration[i].n, was.aberration[i].n);
    EXPECT_EQ(is.aberration[i].m, was.aberration[i].m);
    EXPECT_EQ(is.aberration[i].rms, was.aberration[i].rms);
  }
  EXPECT_EQ(is.dead_fraction, was.dead_fraction);
  EXPECT_EQ(is.dead_seed, was.dead_seed);
  ASSERT_EQ(is.dead_pixels.size(), 2u);
  EXPECT_EQ(is.dead_pixels[0].column, 7);
  EXPECT_EQ(is.dead_pixels[0].row, 3);
  EXPECT_EQ(is.dead_pixels[0].level, 15);
  ASSERT_TRUE(is.phase_map);
  EXPECT_EQ(is.phase_map->values, was.phase_map->values);
  ASSERT_TRUE(is.light_map);
  EXPECT_EQ(is.light_map->values, was.light_map->values);
  ASSERT_TRUE(is.crystal);
  EXPECT_EQ(is.crystal->pass, was.crystal->pass);
  EXPECT_EQ(is.crystal->director, was.crystal->director);
  EXPECT_EQ(is.crystal->twist, was.crystal->twist);
  EXPECT_EQ(is.crystal->delays, was.crystal->delays);
  EXPECT_EQ(is.crystal->polariser, was.crystal->polariser);
  EXPECT_EQ(is.crystal->analyser, was.crystal->analyser);
  EXPECT_EQ(is.crystal->plates_before, was.crystal->plates_before);
  EXPECT_EQ(is.crystal->plates_behind, was.crystal->plates_behind);
  EXPECT_EQ(effects_of(*again.slm), effects_of(slm));
}

TEST(SlmFile, AWarningNamesAnEffectThatIsLostWithItsFile) {
  const Slm slm = panel_of_all_effects();
  Hologram hologram = make_hologram(slm, Modulation::phase, [](int i) { return i; });
  hologram.slm = slm;
  const std::string folder = fresh_folder("lost"), path = folder + "/h.png";
  save_hologram(path, hologram);
  fs::remove(folder + "/h_phase_map.exr");
  EXPECT_NE(sentence_in(folder, [&] { load_hologram(path); }).find("h_phase_map.exr"), std::string::npos);
  save_hologram(path, hologram);
  nlohmann::json json = nlohmann::json::parse(test::png_text(path, "holotrace"));
  json["slm"]["effects"]["calibration"]["amplitude"].erase(0);
  test::set_png_text(path, "holotrace", json.dump());
  EXPECT_EQ(sentence_in(folder, [&] { load_hologram(path); }),
            "h.png: expected as many calibrated amplitudes as phases, got 15 and 16; write the hologram again");
}

TEST(SlmFile, AComplexHologramIsTwoImages) {
  Slm slm = make_panel(8, 4);
  slm.modulation = Modulation::complex;
  Hologram hologram = make_hologram(slm, Modulation::complex, [](int i) { return 3 * i; });
  hologram.modulus_level = Array2D<uint16_t>(4, 8);
  for (size_t i = 0; i < 32; ++i) hologram.modulus_level.values[i] = uint16_t(255 - 2 * i);
  const std::string path = test::make_file("complex.png", "");
  save_hologram(path, hologram);
  const Hologram again = load_hologram(path);
  EXPECT_EQ(again.modulation, Modulation::complex);
  EXPECT_EQ(again.level.values, hologram.level.values);
  EXPECT_EQ(again.modulus_level.values, hologram.modulus_level.values);
}

TEST(SlmFile, APhaseMapIsAnImageOfThePanel) {
  Image image(2, 3, 1);
  for (int i = 0; i < 6; ++i) image.values[size_t(i)] = float(i) / 4;
  const std::string map = test::make_file("map.exr", "");
  save_image(map, image, 1, 8);
  const std::string panel = test::make_file(
      "mapped.toml", "columns = 3\nrows = 2\npitch = \"8 um\"\nphase_map = \"map.exr\"\nphase_map_range = \"2 rad\"\n");
  const Slm slm = load_slm(panel);
  EXPECT_EQ(slm.name, "mapped");
  ASSERT_TRUE(slm.effects.phase_map);
  EXPECT_FLOAT_EQ((*slm.effects.phase_map)(1, 2), 2 * 5 / 4.0F);
  const std::string plain =
      test::make_file("plain.toml", "columns = 3\nrows = 2\npitch = \"8 um\"\nphase_map = \"map.exr\"\n");
  EXPECT_FLOAT_EQ((*load_slm(plain).effects.phase_map)(0, 2), float(2 * pi * 2 / 4)) << "white is a wave";
}

TEST(SlmFile, ALightMapIsAnImageOfThePanelInWhichWhiteIs1) {
  Image image(2, 3, 1);
  for (int i = 0; i < 6; ++i) image.values[size_t(i)] = float(i) / 4;
  const std::string map = test::make_file("light.exr", "");
  save_image(map, image, 1, 8);
  const std::string keys = "columns = 3\nrows = 2\npitch = \"8 um\"\nlight_map = \"light.exr\"\n";
  const Slm slm = load_slm(test::make_file("lit.toml", keys));
  ASSERT_TRUE(slm.effects.light_map);
  EXPECT_FLOAT_EQ((*slm.effects.light_map)(1, 2), 5 / 4.0F);
  EXPECT_EQ(effects_of(slm), std::vector<std::string>{"light-map"});
  EXPECT_EQ(effects_of(with_effects(slm, {"crosstalk"})), std::vector<std::string>{});
  EXPECT_EQ(effects_of(with_effects(slm, {"light-map"})), std::vector<std::string>{"light-map"});
}

TEST(SlmFile, FillFactorsOfTheAxesBelongTogether) {
  const std::string folder = fresh_folder("fill");
  const std::string file = file_in(folder, "p.toml", "columns = 4\nrows = 4\npitch = \"8 um\"\nfill_x = 0.9\n");
  EXPECT_NE(sentence_in(folder, [&] { load_slm(file); })
                .find("expected fill_x and fill_y, which belong together, got 0.9 in x, 0 in y; give both"),
            std::string::npos);
}

TEST(SlmFile, AnswersWhatAPanelIs) {
  const nlohmann::ordered_json json = describe_slm(slm_preset("pluto"));
  EXPECT_EQ(json["pixels"], "1920x1080");
  EXPECT_EQ(json["pitch"], "8 µm");
  EXPECT_EQ(json["size"], "15.36 mm x 8.64 mm");
  EXPECT_EQ(json["crosstalk"], "0.2 pixels (1.6 µm)");
  EXPECT_EQ(json["flicker"], "±3 % of the phase");
  EXPECT_EQ(describe_slm(slm_preset("ideal"))["effects"], "none");
}

}  // namespace
}  // namespace holotrace
