#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/data/light_spectrum.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/scene/scene_file.h"
#include "io/scene/scene_text.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::cube;
using test::make_file;

Scene scene(const std::string& lines) {
  return load_job(make_file("scene.toml", "wavelength = \"532 nm\"\n" + lines + "\n" + cube)).scene;
}

template <class Kind>
Kind light(const std::string& lines) {
  return std::get<Kind>(scene("[[light]]\n" + lines).lights.at(0));
}

// The error without the folder: "3:9: expected …".
std::string error_before_cube(const std::string& text) {
  const std::string path = make_file("scene.toml", text + "\n" + cube);
  const std::string sentence = error_of([&] { load_job(path); });
  return sentence.starts_with(path + ":") ? sentence.substr(path.size() + 1) : sentence;
}

std::string error_of_light(const std::string& lines) { return error_before_cube("wavelength = \"532 nm\"\n" + lines); }

TEST(SceneLights, ASpotPointsAlongADirectionOrToATarget) {
  const auto spot = light<SpotLight>(
      "type = \"spot\"\nposition = \"0 0 100 mm\"\ndirection = [0, -3, -4]\nintensity = [1, 2, 3]\n"
      "inner_angle = \"10 deg\"\nouter_angle = \"20 deg\"");
  EXPECT_EQ(spot.position, (Vec3{0, 0, 0.1}));
  EXPECT_NEAR(length(spot.direction - Vec3{0, -0.6, -0.8}), 0, 1e-15);
  EXPECT_EQ(spot.intensity, (Vec3{1, 2, 3}));
  EXPECT_DOUBLE_EQ(spot.inner_angle, pi / 18);
  EXPECT_DOUBLE_EQ(spot.outer_angle, pi / 9);
  const auto aimed = light<SpotLight>(
      "type = \"spot\"\nposition = \"0 0 100 mm\"\ntarget = \"0 -30 60 mm\"\nintensity = 1\nouter_angle = \"20 deg\"");
  EXPECT_NEAR(length(aimed.direction - Vec3{0, -0.6, -0.8}), 0, 1e-15);
  EXPECT_EQ(aimed.inner_angle, 0);
}

TEST(SceneLights, ParallelLightAndLasersAreRead) {
  const auto sun = light<DirectionalLight>("type = \"directional\"\ndirection = [0, -2, 0]\nirradiance = 3");
  EXPECT_EQ(sun.direction, (Vec3{0, -1, 0}));
  EXPECT_EQ(sun.irradiance, (Vec3{3, 3, 3}));
  EXPECT_FALSE(sun.is_laser);
  EXPECT_TRUE(std::isinf(sun.radius));
  const auto beam = light<DirectionalLight>(
      "type = \"laser-beam\"\nposition = \"0 0 1 m\"\ntarget = \"0 0 -1 m\"\nirradiance = 3\nradius = \"2 mm\"");
  EXPECT_EQ(beam.direction, (Vec3{0, 0, -1}));
  EXPECT_EQ(beam.position, (Vec3{0, 0, 1}));
  EXPECT_EQ(beam.radius, 2e-3);
  EXPECT_TRUE(beam.is_laser);
  EXPECT_TRUE(light<PointLight>("type = \"laser-point\"\nposition = \"0 0 -1 m\"\nintensity = 3").is_laser);
}

TEST(SceneLights, WrongDirectionsArePlaced) {
  const auto directional = [](const std::string& direction) {
    return error_of_light("[[light]]\ntype = \"directional\"\nirradiance = 1\n" + direction);
  };
  EXPECT_EQ(directional("direction = [0, 0, 0]"),
            "5:13: expected a direction for \"direction\", got [0, 0, 0], which points nowhere");
  EXPECT_EQ(directional("direction = \"0 0 -1 m\""),
            "5:13: expected a direction [x, y, z] of three plain numbers for \"direction\", got \"0 0 -1 m\"");
  EXPECT_EQ(directional("direction = [1, 2]"),
            "5:13: expected a direction [x, y, z] of three plain numbers for \"direction\", got a list");
  EXPECT_EQ(directional("direction = [1, nan, 2]"), "5:17: expected finite numbers for \"direction\", got nan");
  EXPECT_EQ(directional("direction = [1, 0, 0]\ntarget = \"0 0 -1 m\""),
            "6:10: expected either \"direction\" or \"target\", got both");
  EXPECT_EQ(directional("target = \"0 0 0 m\""),
            "5:10: expected a target away from the light's position, got the same place");
  EXPECT_EQ(directional(""), "2:1: expected the key \"direction\" in [[light]], which is missing");
}

TEST(SceneLights, AnglesOfASpotAreInOrder) {
  const auto spot = [](const std::string& angles) {
    return error_of_light(
        "[[light]]\ntype = \"spot\"\nposition = \"0 0 0 m\"\ndirection = [0, 0, -1]\nintensity = 1\n" + angles);
  };
  EXPECT_EQ(spot("outer_angle = \"10 deg\"\ninner_angle = \"20 deg\""),
            "8:15: expected an inner angle from 0 deg to the outer angle of 10°, got 20°");
  EXPECT_EQ(spot("outer_angle = \"200 deg\""),
            "7:15: expected an angle above 0 deg, up to 180 deg for \"outer_angle\", got 200 deg");
  EXPECT_EQ(spot(""), "2:1: expected the key \"outer_angle\" in [[light]], which is missing");
}

TEST(SceneLights, UnknownTypesAndKeysSuggestTheNearest) {
  EXPECT_EQ(error_of_light("[[light]]\ntype = \"spott\""), "3:8: unknown light type \"spott\"; did you mean \"spot\"?");
  EXPECT_EQ(error_of_light("[[light]]\ntype = \"laser-beem\""),
            "3:8: unknown light type \"laser-beem\"; did you mean \"laser-beam\"?");
  EXPECT_EQ(error_of_light("[[light]]\ntype = \"directional\"\ndirection = [0, 0, -1]\nirradience = 1"),
            "5:1: unknown key \"irradience\"; did you mean \"irradiance\"?");
}

void save_map(const char* name, int ny, int nx, int channels, float value = 0.5f) {
  Image map(ny, nx, channels);
  std::fill(map.values.begin(), map.values.end(), value);
  save_image(test::temporary(name), map, 1, 8);
}

TEST(SceneLights, AnEnvironmentIsAMapWithAScaleAndATurn) {
  save_map("sky.exr", 2, 4, 3);
  const auto sky = scene("[environment]\nmap = \"sky.exr\"\nscale = [1, 2, 3]\nturn = \"-90 deg\"").environment;
  ASSERT_TRUE(sky);
  EXPECT_EQ(sky->map->nx, 4);
  EXPECT_EQ(sky->map->values[0], 0.5f);
  EXPECT_EQ(sky->scale, (Vec3{1, 2, 3}));
  EXPECT_DOUBLE_EQ(sky->turn, -pi / 2);
  EXPECT_FALSE(scene("").environment);
  // A grey map has equal colours; a PNG is decoded from sRGB.
  save_map("grey.png", 2, 4, 1, float(srgb_decode(188 / 255.)));
  const auto grey = scene("[environment]\nmap = \"grey.png\"").environment;
  ASSERT_TRUE(grey);
  EXPECT_EQ(grey->map->values, std::vector<float>(24, float(srgb_decode(188 / 255.))));
}

TEST(SceneLights, AMapThatIsNoneIsNamed) {
  save_map("square.png", 4, 4, 3);
  EXPECT_EQ(error_of_light("[environment]\nmap = \"square.png\""),
            "3:7: " + (std::filesystem::path(make_file("scene.toml", "")).parent_path() / "square.png").string() +
                ": expected an environment map, equirectangular and so twice as wide as high, got 4 × 4 pixels");
  save_map("dark.exr", 1, 2, 3, -1);
  EXPECT_NE(error_of_light("[environment]\nmap = \"dark.exr\"")
                .find("dark.exr: expected an environment map with light of 0 or more, got -1 at row 0, column 0"),
            std::string::npos);
  const std::string text = make_file("text.png", "only text");
  EXPECT_EQ(error_of_light("[environment]\nmap = \"text.png\""),
            "3:7: " + text +
                ": expected an image, but it is not an image in a format known here; convert it to PNG, JPEG or EXR");
  EXPECT_EQ(error_of_light("[environment]\nmap = \"none.exr\"").substr(0, 24), "3:7: expected an image a");
  EXPECT_EQ(error_of_light("[environment]\nscale = 2"),
            "2:1: expected the key \"map\" in [environment], which is missing");
  EXPECT_EQ(error_of_light("[environment]\nmap = \"square.png\"\nturn = 90"),
            "4:8: expected an angle with its unit, such as \"15 deg\", for \"turn\", got the bare number 90");
}

TEST(SceneLights, ASkyTakesThePlaceOfAMap) {
  const auto environment =
      scene("[environment]\nsky = { turbidity = 4, elevation = \"30 deg\", azimuth = \"-20 deg\", sun = false }")
          .environment;
  ASSERT_TRUE(environment && environment->sky);
  EXPECT_EQ(environment->sky->turbidity, 4);
  EXPECT_DOUBLE_EQ(environment->sky->elevation, pi / 6);
  EXPECT_DOUBLE_EQ(environment->sky->azimuth, -pi / 9);
  EXPECT_FALSE(environment->sky->has_sun);
  EXPECT_EQ(error_of_light("[environment]\nsky = { elevation = \"-5 deg\" }"),
            "3:21: expected an angle from 0 deg to 90 deg for \"elevation\", got -5 deg");
  EXPECT_EQ(error_of_light("[environment]\nsky = { elevation = \"9 deg\", turbidity = 30 }"),
            "3:42: expected a number from 1.7 to 10 for \"turbidity\", got 30");
  EXPECT_EQ(error_of_light("[environment]\nsky = { turbidity = 3 }"),
            "3:7: expected the key \"elevation\" in [sky], which is missing");
  EXPECT_EQ(error_of_light("[environment]\nmap = \"a.png\"\nsky = { elevation = \"9 deg\" }"),
            "4:7: expected either a \"map\" or a \"sky\" in [environment], got both");
  EXPECT_EQ(error_of_light("[environment]\nsky = { elevation = \"9 deg\" }\nscale = -1").substr(0, 5), "4:9: ");
}

std::shared_ptr<const Spectrum> spectrum_of_point(const std::string& text) {
  const auto lights =
      scene("[[light]]\ntype = \"point\"\nposition = \"0 0 -1 m\"\nintensity = 1\nspectrum = " + text).lights;
  return std::get<PointLight>(lights.front()).spectrum;
}

std::string error_of_spectrum(const std::string& text) {
  return error_of_light("[[light]]\ntype = \"point\"\nposition = \"0 0 -1 m\"\nintensity = 1\nspectrum = " + text);
}

TEST(SceneLights, LampsHaveSpectra) {
  EXPECT_EQ(spectrum_of_point("\"3000 K\"")->values, blackbody_spectrum(3000).values);
  EXPECT_EQ(spectrum_of_point("\"D65\"")->values, illuminant_spectrum("D65").values);
  EXPECT_EQ(spectrum_of_point("{ peak = \"520 nm\", width = \"30 nm\" }")->values, led_spectrum(520e-9, 30e-9).values);
  make_file("lamp.csv", "# of a shop\n380 nm, 0\n500 nm, 2\n780 nm, 0\n");
  const auto table = spectrum_of_point("\"lamp.csv\"");
  EXPECT_NEAR(table->at(440e-9) / table->at(500e-9), 0.5, 1e-12) << "linear between its lines";
}

TEST(SceneLights, BadSpectraSayWhatWasExpected) {
  EXPECT_EQ(error_of_spectrum("\"D66\""), "6:12: unknown illuminant \"D66\"; did you mean \"D65\"?");
  EXPECT_EQ(error_of_spectrum("\"20 K\""), "6:12: expected a temperature of a lamp from 1000 to 40000 K, got 20 K");
  EXPECT_EQ(error_of_spectrum("\"none.csv\"").substr(0, 6), "6:12: ");
  const std::string bad = make_file("bad.csv", "380 nm 1\n500 2\n");
  EXPECT_EQ(
      error_of_spectrum("\"bad.csv\""),
      "6:12: " + bad + ":2: expected a wavelength with its unit and a value, such as \"450 nm 0.8\", got \"500 2\"");
  const std::string negative = make_file("negative.csv", "380 nm 1\n500 nm -2\n");
  EXPECT_EQ(error_of_spectrum("\"negative.csv\""),
            "6:12: " + negative + ":2: expected a spectrum of 0 or more, got -2");
  const std::string back = make_file("back.csv", "500 nm 1\n480 nm 2\n");
  EXPECT_EQ(error_of_spectrum("\"back.csv\""),
            "6:12: " + back + ":2: expected wavelengths in ascending order, got 480 nm after 500 nm");
  EXPECT_EQ(
      error_of_light("[[light]]\ntype = \"laser-point\"\nposition = \"0 0 -1 m\"\nintensity = 1\nspectrum = \"A\""),
      "6:12: expected a lamp without a \"spectrum\", got a laser, whose light has one wavelength");
}

TEST(SceneWavelengths, OneOrSeveralInTheOrderOfTheFile) {
  const auto wavelengths = [](const std::string& text) {
    return load_job(make_file("scene.toml", "wavelength = " + text + "\n" + cube)).wavelengths;
  };
  EXPECT_EQ(wavelengths("\"532 nm\""), (std::vector<double>{532e-9}));
  EXPECT_EQ(wavelengths("[\"638 nm\", \"520 nm\", \"450 nm\"]"), (std::vector<double>{638e-9, 520e-9, 450e-9}));
  EXPECT_EQ(wavelengths("\"HeNe\""), (std::vector<double>{632.8e-9}));
  EXPECT_EQ(wavelengths("[\"he-ne\", \"DPSS 532\", \"450 nm\"]"), (std::vector<double>{632.8e-9, 532e-9, 450e-9}));
  EXPECT_EQ(wavelengths("\"HeNe, DPSS 532, 450 nm\""), (std::vector<double>{632.8e-9, 532e-9, 450e-9}));
}

TEST(SceneWavelengths, LightsAreNamedOnlyWhereAWavelengthIsAskedFor) {
  EXPECT_EQ(error_before_cube("wavelength = [\"DPSS 532\", \"HeNi\"]"),
            "1:27: expected a length with its unit, such as \"532 nm\", or a known light (did you mean \"HeNe\"?), got "
            "\"HeNi\" for \"wavelength\"");
  EXPECT_EQ(error_before_cube("wavelength = [\"DPSS 532\", \"532 nm\"]"),
            "1:14: expected each wavelength once, got 532 nm twice");
  const Job job = load_job(make_file("scene.toml",
                                     "wavelength = \"HeNe\"\n[slm]\ndesign_wavelength = \"HeNe\"\n[show]\n"
                                     "wavelength = \"DPSS 532\"\n" +
                                         cube));
  EXPECT_EQ(job.slm.design_wavelength, 632.8e-9);
  EXPECT_EQ(job.show.wavelength, 532e-9);
  EXPECT_EQ(error_before_cube("[show]\nbandwidth = \"HeNe\""),
            "2:13: expected a length with its unit, such as \"2 nm\", got \"HeNe\" for \"bandwidth\"");
  EXPECT_EQ(error_before_cube("[slm]\npitch = \"HeNe\""),
            "2:9: expected a length with its unit, such as \"8 um\", got \"HeNe\" for \"pitch\"");
}

TEST(SceneWavelengths, WrongListsArePlaced) {
  EXPECT_EQ(error_before_cube("wavelength = []"), "1:14: expected one length or more for \"wavelength\", got none");
  EXPECT_EQ(error_before_cube("wavelength = [\"520 nm\", \"0.52 um\"]"),
            "1:14: expected each wavelength once, got 520 nm twice");
  EXPECT_EQ(error_before_cube("wavelength = [\"520 nm\", \"0 nm\"]"),
            "1:14: expected a length above 0 m for \"wavelength\", got 0 m");
  EXPECT_EQ(error_before_cube("wavelength = [\"520 nm\", 450]"),
            "1:25: expected a length with its unit, such as \"532 nm\", for \"wavelength\", got the bare number 450");
  EXPECT_EQ(error_before_cube("wavelength = [\"520 nm\", \"-450 nm\"]"),
            "1:14: expected a length above 0 m for \"wavelength\", got -450 nm");
}

TEST(SceneParameters, OutOfRangeOnesArePlaced) {
  EXPECT_EQ(error_of_light("[trace]\nframes = -1"),
            "3:10: expected a whole number of 0 or more for \"frames\", got -1");
  EXPECT_EQ(error_of_light("[trace]\ntile_columns = 0"),
            "3:16: expected a whole number of 1 or more for \"tile_columns\", got 0");
  EXPECT_EQ(error_of_light("[trace]\ntile_rows = 0"),
            "3:13: expected a whole number of 1 or more for \"tile_rows\", got 0");
  EXPECT_EQ(error_of_light("[trace]\npixel_samples = 0"),
            "3:17: expected a whole number of 1 or more for \"pixel_samples\", got 0");
  EXPECT_EQ(error_of_light("[trace]\nclamp = -1"), "3:9: expected a number of 0 or more for \"clamp\", got -1");
  EXPECT_EQ(error_of_light("[trace]\nfield_of_view = \"90 deg\""),
            "3:17: expected an angle from 0 deg to less than 90 deg for \"field_of_view\", got 90 deg");
  EXPECT_EQ(error_of_light("[trace]\npath_expressions = [\"EDL\", 3]"),
            "3:28: expected a text in quotes, or a list of them, for \"path_expressions\", got the bare number 3");
  EXPECT_EQ(error_of_light("[render]\neye = \"0 0 -1 mm\""),
            "3:7: expected a length of 0 m or more for z of \"eye\", got -1 mm");
  EXPECT_EQ(error_of_light("[render]\npupil = \"0 mm\""), "3:9: expected a length above 0 m for \"pupil\", got 0 m");
}

}  // namespace
}  // namespace holotrace
