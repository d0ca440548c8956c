#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "holotrace/data/rgl_brdf.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/io/scene/scene_materials.h"
#include "io/scene/scene_text.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::make_file;

constexpr double green = 532e-9;

// The material of a scene file that has these lines.
Material material(const std::string& lines) {
  const Job job =
      load_job(make_file("scene.toml", "wavelength = \"532 nm\"\n[materials.m]\n" + lines + "\n" + test::cube));
  return job.scene.materials.at(0);
}

template <class Surface>
Surface surface(const std::string& lines) {
  return std::get<Surface>(material(lines).surface);
}

// The error without the folder: "3:9: expected …".
std::string error_of_material(const std::string& lines) {
  const std::string path =
      make_file("scene.toml", "wavelength = \"532 nm\"\n[materials.m]\n" + lines + "\n" + test::cube);
  const std::string sentence = error_of([&] { load_job(path); });
  return sentence.starts_with(path + ":") ? sentence.substr(path.size() + 1) : sentence;
}

std::string texture(const char* name, int channels = 3) {
  Image image(1, 1, channels);
  for (float& value : image.values) value = float(srgb_decode(188 / 255.));
  const std::string path = test::temporary(name);
  save_image(path, image, 1, 8);
  return path;
}

TEST(SceneMaterials, ADiffuseMaterialReflectsAndTransmits) {
  const auto leaf = surface<DiffuseMaterial>("reflectance = [0.1, 0.5, 0.1]\ntransmittance = 0.25");
  EXPECT_EQ(leaf.reflectance, (Vec3{0.1, 0.5, 0.1}));
  EXPECT_EQ(leaf.transmittance, (Vec3{0.25, 0.25, 0.25}));
  // Without a reflectance, the default is limited to 1 − transmittance.
  EXPECT_EQ(surface<DiffuseMaterial>("transmittance = 0.75").reflectance, (Vec3{0.25, 0.25, 0.25}));
  EXPECT_EQ(surface<DiffuseMaterial>("transmittance = 0.1").reflectance, (Vec3{0.8, 0.8, 0.8}));
  EXPECT_EQ(error_of_material("reflectance = 0.75\ntransmittance = [0, 0, 0.5]"),
            "4:17: expected a reflectance and a transmittance of at most 1 together, got 1.25");
}

TEST(SceneMaterials, AConductorIsOfAMetalOrAnIndex) {
  const auto silver = surface<ConductorMaterial>("type = \"conductor\"\nmetal = \"Ag\"\nroughness = 0.5");
  EXPECT_EQ(index_at(silver.index, green), index_at(metal_index("Ag"), green));
  EXPECT_EQ(silver.roughness, 0.5);
  const auto own = surface<ConductorMaterial>("type = \"conductor\"\nindex = { n = 0.5, k = 3 }");
  EXPECT_EQ(index_at(own.index, green), (std::complex<double>(0.5, 3)));
  // Halfway between two samples, which the file has in descending order.
  const auto listed =
      surface<ConductorMaterial>("type = \"conductor\"\nindex = [[\"632 nm\", 1.5, 4], [\"432 nm\", 0.5, 2]]");
  EXPECT_NEAR(std::abs(index_at(listed.index, green) - std::complex<double>(1, 3)), 0, 1e-12);
  make_file("index.txt", "# my metal\n432 nm  0.5  2\n632 nm, 1.5, 4  # red\n");
  const auto filed = surface<ConductorMaterial>("type = \"conductor\"\nindex = \"index.txt\"");
  EXPECT_NEAR(std::abs(index_at(filed.index, green) - std::complex<double>(1, 3)), 0, 1e-12);
}

TEST(SceneMaterials, ADielectricIsOfAGlassOrAnIndex) {
  const auto glass = surface<DielectricMaterial>("type = \"dielectric\"\nglass = \"BK7\"");
  EXPECT_EQ(index_at(glass.index, green), index_at(glass_index("BK7"), green));
  EXPECT_FALSE(glass.is_thin);
  const auto pane = surface<DielectricMaterial>("type = \"dielectric\"\nindex = 1.25\nthin = true\nroughness = 0.1");
  EXPECT_EQ(index_at(pane.index, green), std::complex<double>(1.25));
  EXPECT_TRUE(pane.is_thin);
  EXPECT_EQ(pane.roughness, 0.1);
  const auto listed =
      surface<DielectricMaterial>("type = \"dielectric\"\nindex = [[\"432 nm\", 1.75], [\"632 nm\", 1.25]]");
  EXPECT_NEAR(index_at(listed.index, green).real(), 1.5, 1e-12);
  EXPECT_TRUE(is_dispersive(listed.index));
}

// Colours are decoded from sRGB; the values of normal maps, metallic and roughness are not.
TEST(SceneMaterials, TexturesOfColourAreDecodedAndThoseOfNumbersAreNot) {
  texture("t.png");
  const Material m = material(
      "type = \"metallic-roughness\"\nbase_color = [1, 0.5, 0]\nmetallic = 0.25\nroughness = 0.75\n"
      "base_texture = \"t.png\"\nmetallic_texture = \"t.png\"\nemission_texture = \"t.png\"\nnormal_map = \"t.png\"\n"
      "normal_scale = 0.5\ntwo_sided = false");
  const auto& s = std::get<MetallicRoughnessMaterial>(m.surface);
  EXPECT_EQ(s.base_color, (Vec3{1, 0.5, 0}));
  EXPECT_EQ(s.metallic, 0.25);
  EXPECT_EQ(s.roughness, 0.75);
  EXPECT_EQ(s.base_texture->values[0], float(srgb_decode(188 / 255.)));
  EXPECT_EQ(m.emission_texture->values[0], float(srgb_decode(188 / 255.)));
  EXPECT_EQ(s.metallic_texture->values[0], 188 / 255.f);
  EXPECT_EQ(m.normal_map->values[0], 188 / 255.f);
  EXPECT_EQ(m.emission, (Vec3{1, 1, 1}));  // only the texture
  EXPECT_EQ(m.normal_scale, 0.5);
  EXPECT_FALSE(m.two_sided);
}

TEST(SceneMaterials, PrincipledHasTheKeysOfItsLayers) {
  texture("t.png");
  const Material material_of_all = material(
      "type = \"principled\"\nbase_color = [1, 0.5, 0]\nmetalness = 0.25\nroughness_texture = \"t.png\"\nindex = 1.75\n"
      "specular = 0.5\nspecular_color = [2, 1, 0]\nanisotropy = 0.5\nanisotropy_rotation = \"90 deg\"\n"
      "transmission = 0.75\nattenuation_color = [1, 0.5, 0.25]\nattenuation_distance = \"10 mm\"\n"
      "diffuse_transmission = 0.125\ndiffuse_transmission_color = [0, 1, 0]\nclearcoat = 0.5\n"
      "clearcoat_roughness = 0.25\nclearcoat_index = 1.25\nsheen_color_texture = \"t.png\"\nsheen_roughness = 0.75\n"
      "iridescence = 0.5\niridescence_index = 2\niridescence_thickness = \"500 nm\"\n"
      "iridescence_least_thickness = \"200 nm\"\niridescence_thickness_texture = \"t.png\"");
  const auto& m = std::get<PrincipledMaterial>(material_of_all.surface);
  EXPECT_EQ(m.base_color.value, (Vec3{1, 0.5, 0}));
  EXPECT_EQ(m.metalness.value, 0.25);
  EXPECT_EQ(m.roughness.value, 1);  // the texture alone
  EXPECT_EQ(m.roughness.texture.image->channels, 1);
  EXPECT_EQ(m.roughness.texture.image->values[0], 188 / 255.f);  // not decoded
  EXPECT_EQ(index_at(m.index, 500e-9).real(), 1.75);
  EXPECT_EQ(m.specular.value, 0.5);
  EXPECT_EQ(m.specular_color.value, (Vec3{2, 1, 0}));
  EXPECT_EQ(m.anisotropy.value, 0.5);
  EXPECT_DOUBLE_EQ(m.anisotropy_rotation, pi / 2);
  EXPECT_EQ(m.transmission.value, 0.75);
  EXPECT_FALSE(m.is_thin);
  EXPECT_EQ(m.attenuation_color, (Vec3{1, 0.5, 0.25}));
  EXPECT_DOUBLE_EQ(m.attenuation_distance, 10e-3);
  EXPECT_EQ(m.diffuse_transmission.value, 0.125);
  EXPECT_EQ(m.diffuse_transmission_color.value, (Vec3{0, 1, 0}));
  EXPECT_EQ(m.clearcoat.value, 0.5);
  EXPECT_EQ(m.clearcoat_roughness.value, 0.25);
  EXPECT_EQ(m.clearcoat_index, 1.25);
  EXPECT_EQ(m.sheen_color.texture.image->values[0], float(srgb_decode(188 / 255.)));
  EXPECT_EQ(m.sheen_roughness.value, 0.75);
  EXPECT_EQ(m.iridescence.value, 0.5);
  EXPECT_EQ(m.iridescence_index, 2);
  EXPECT_DOUBLE_EQ(m.film_thickness, 500e-9);
  EXPECT_DOUBLE_EQ(m.least_thickness, 200e-9);
  EXPECT_TRUE(m.thickness_texture.image);
  EXPECT_EQ(error_of_material("type = \"principled\"\nclearcoat = 1.5"),
            "4:13: expected a number from 0 to 1 for \"clearcoat\", got 1.5");
  EXPECT_EQ(error_of_material("type = \"principled\"\niridescence_index = 0.5"),
            "4:21: expected a number of 1 or more for \"iridescence_index\", got 0.5");
  EXPECT_EQ(error_of_material("type = \"principled\"\nattenuation_distance = \"0 mm\""),
            "4:24: expected a length above 0 m for \"attenuation_distance\", got 0 m");
}

// The bytes of a table of the MERL database whose numbers are all `value`.
std::string merl_bytes(double value) {
  const std::array<int32_t, 3> sizes{90, 90, 180};
  const std::vector<double> values(3 * merl_cells, value);
  std::string bytes(reinterpret_cast<const char*>(sizes.data()), sizeof(sizes));
  return bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
}

TEST(SceneMaterials, MeasuredOnesAreTablesOfTheMerlDatabase) {
  const auto material = [](const std::string& keys) {
    return "[materials.m]\ntype = \"measured\"\n" + keys + "\n" + test::cube;
  };
  std::string bytes = merl_bytes(300);
  const double negative = -1;
  std::memcpy(bytes.data() + 12, &negative, 8);
  make_file("paint.binary", bytes);
  const Job job = test::load("wavelength = \"532 nm\"\n" + material("file = \"paint.binary\""));
  const auto& field = std::get<MeasuredMaterial>(job.scene.materials.front().surface).brdf->fields.front();
  // The factors of the database: 1/1500, 1.15/1500, 1.66/1500.
  EXPECT_EQ(field.values[0], 0.0F) << "below 0: not measured";
  EXPECT_FLOAT_EQ(field.values[1], 0.2F);
  EXPECT_FLOAT_EQ(field.values[merl_cells], 0.23F);
  EXPECT_FLOAT_EQ(field.values[2 * merl_cells], 0.332F);

  const auto error = [&](const std::string& keys) { return test::error_with(material(keys)); };
  EXPECT_EQ(error(""), "2:1: expected the key \"file\" in [materials.m], which is missing");
  EXPECT_NE(error("file = \"none.binary\"").find("expected a measured BRDF"), std::string::npos);
  make_file("text.binary", "only text, no table");
  EXPECT_NE(error("file = \"text.binary\"")
                .find("expected a table of the MERL or the RGL database of materials, got another file"),
            std::string::npos);
  make_file("cut.binary", bytes.substr(0, 1000));
  EXPECT_NE(error("file = \"cut.binary\"")
                .find("expected 34992012 bytes of a table of the MERL database, got 1000; load it again"),
            std::string::npos);
  const double infinite = std::numeric_limits<double>::infinity();
  std::memcpy(bytes.data() + 20, &infinite, 8);
  make_file("infinite.binary", bytes);
  EXPECT_NE(error("file = \"infinite.binary\"").find("expected finite values, got inf as number 1"), std::string::npos);
}

// A field of an RGL file: its name, shape and values.
struct RglTable {
  std::string name;
  std::vector<uint64_t> shape;
  std::vector<float> values;
};

template <class Number>
void append(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
}

// The bytes of a spectral file of the RGL database.
std::string rgl_bytes(const std::vector<RglTable>& tables) {
  std::string bytes("tensor_file\0\1\0", 14), values(1, '\1');
  append(bytes, uint32_t(tables.size() + 1));
  size_t header = bytes.size() + 2 + 8 + 2 + 1 + 8 + 8;  // with the field "jacobian"
  for (const RglTable& table : tables) header += 2 + table.name.size() + 2 + 1 + 8 + 8 * table.shape.size();
  const auto describe_field = [&](const std::string& name, const std::vector<uint64_t>& shape, uint8_t kind,
                                  size_t place) {
    append(bytes, uint16_t(name.size()));
    bytes += name;
    append(bytes, uint16_t(shape.size()));
    append(bytes, kind);
    append(bytes, uint64_t(place));
    for (const uint64_t side : shape) append(bytes, side);
  };
  describe_field("jacobian", {1}, 1, header);
  for (const RglTable& table : tables) {
    describe_field(table.name, table.shape, 10, header + values.size());
    values.append(reinterpret_cast<const char*>(table.values.data()), table.values.size() * sizeof(float));
  }
  return bytes + values;
}

TEST(SceneMaterials, MeasuredOnesAreSpectralFilesOfTheRglDatabase) {
  std::vector<RglTable> tables{{"phi_i", {1}, {0}},
                               {"theta_i", {2}, {0, 1.5F}},
                               {"wavelengths", {2}, {400, 700}},
                               {"ndf", {2, 2}, {2, 1, 2, 1}},
                               {"sigma", {2, 2}, {1, 1, 1, 1}},
                               {"vndf", {1, 2, 2, 2}, {3, 3, 3, 3, 5, 5, 5, 5}},
                               {"spectra", {1, 2, 2, 2, 2}, std::vector<float>(16, 0.25F)}};
  make_file("cloth.bsdf", rgl_bytes(tables));
  const auto brdf = surface<MeasuredMaterial>("type = \"measured\"\nfile = \"cloth.bsdf\"").brdf;
  EXPECT_EQ(brdf->fields[rgl_theta].values, (std::vector<float>{0, 1.5F}));
  EXPECT_EQ(brdf->fields[rgl_vndf].values, std::vector<float>(8, 1)) << "of integral 1 for each direction";
  EXPECT_EQ(brdf->fields[rgl_spectra].shape, (std::vector<int>{1, 2, 2, 2, 2}));

  const auto error = [&](const std::string& bytes) {
    make_file("bad.bsdf", bytes);
    return error_of_material("type = \"measured\"\nfile = \"bad.bsdf\"");
  };
  const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  const std::string whole = rgl_bytes(tables);
  EXPECT_TRUE(has(error(whole.substr(0, whole.size() - 1)), "expected more than"))
      << error(whole.substr(0, whole.size() - 1));
  EXPECT_TRUE(has(error(whole.substr(0, 40)), "expected more than 40 bytes; the file is cut off"));
  std::vector<RglTable> damaged = tables;
  damaged[1].values[1] = std::nanf("");
  EXPECT_TRUE(has(error(rgl_bytes(damaged)), "expected 2 ascending values or more in the field \"theta_i\""));
  // Sizes are those of the file before anything is held: 6 GB of values, and a side that no int has.
  damaged = tables;
  damaged[6].shape = {1, 2, 2, 20000, 20000};
  EXPECT_TRUE(has(error(rgl_bytes(damaged)), "the file is cut off")) << error(rgl_bytes(damaged));
  damaged[6].shape = {1, 1, 1, 1, uint64_t(1) << 31};
  EXPECT_TRUE(has(error(rgl_bytes(damaged)), "got a side of 2147483648")) << error(rgl_bytes(damaged));
  tables[3].values[1] = -1;
  EXPECT_TRUE(has(error(rgl_bytes(tables)),
                  "bad.bsdf: expected values of 0 or more in the field \"ndf\" of a measured BRDF, got -1"));
  tables.erase(tables.begin() + 3);
  EXPECT_TRUE(has(error(rgl_bytes(tables)),
                  "expected a field \"ndf\", which a spectral file of the RGL database has, got none"));
}

TEST(SceneMaterials, PolarisersAndRetardersHaveAnAxis) {
  const auto film =
      surface<FilterMaterial>("type = \"polariser\"\naxis = \"30 deg\"\ntransmittance = 0.8\nleakage = 0.01");
  EXPECT_NEAR(film.axis.x, std::cos(pi / 6), 1e-15);
  EXPECT_NEAR(film.axis.y, 0.5, 1e-15);
  EXPECT_EQ(film.axis.z, 0);
  EXPECT_EQ(film.transmittance, 0.8);
  EXPECT_EQ(film.leakage, 0.01);
  const auto plate = surface<FilterMaterial>(
      "type = \"retarder\"\naxis = [0, 0, 2]\ndelay = \"90 deg\"\npath_difference = \"560 nm\"\ntransmittance = 0.9");
  EXPECT_EQ(plate.axis, (Vec3{0, 0, 1}));
  EXPECT_NEAR(plate.delay, pi / 2, 1e-15);
  EXPECT_EQ(plate.path_difference, 560e-9);
  EXPECT_EQ(plate.leakage, 0.9) << "it passes both polarizations alike";
  EXPECT_EQ(error_of_material("type = \"polariser\"\ndelay = \"90 deg\"").substr(0, 24), "4:1: unknown key \"delay\"");
  EXPECT_EQ(error_of_material("type = \"polariser\"\naxis = 3").substr(0, 13), "4:8: expected");
}

TEST(SceneMaterials, AnAnalyserIsAnAngleOrCircular) {
  const auto analyser = [](const std::string& lines) {
    return load_job(make_file("scene.toml", "wavelength = \"532 nm\"\n" + lines + "\n" + test::cube)).scene.analyser;
  };
  EXPECT_EQ(analyser(""), std::nullopt);
  EXPECT_EQ(analyser("analyser = \"none\""), std::nullopt);
  EXPECT_EQ(analyser("polarization = true"), all_light);
  EXPECT_EQ(analyser("polarization = true\nanalyser = \"none\""), all_light);
  EXPECT_EQ(analyser("analyser = \"left\""), left_polariser);
  EXPECT_EQ(analyser("polarization = true\nanalyser = \"right\""), right_polariser);
  EXPECT_EQ(analyser("analyser = \"90 deg\""), linear_polariser(pi / 2));
  const std::string wrong = error_of([&] { analyser("analyser = \"up\""); });
  EXPECT_NE(
      wrong.find("2:12: expected an angle such as \"30 deg\", or left, right or none, for the analyser, got \"up\""),
      std::string::npos)
      << wrong;
}

TEST(SceneMaterials, UnknownNamesSuggestTheNearest) {
  EXPECT_EQ(error_of_material("type = \"dielectrik\""),
            "3:8: unknown material type \"dielectrik\"; did you mean \"dielectric\"?");
  EXPECT_EQ(error_of_material("type = \"metal-roughness\""),
            "3:8: unknown material type \"metal-roughness\"; did you mean \"metallic-roughness\"?");
  EXPECT_EQ(error_of_material("type = \"conductor\"\nmetal = \"Agg\""),
            "4:9: unknown metal \"Agg\"; did you mean \"Ag\"?");
  EXPECT_EQ(error_of_material("type = \"dielectric\"\nglass = \"BK8\""),
            "4:9: unknown glass \"BK8\"; did you mean \"BK7\"?");
  EXPECT_EQ(error_of_material("type = \"dielectric\"\nrougness = 1"),
            "4:1: unknown key \"rougness\"; did you mean \"roughness\"?");
  // Each type has its own keys.
  EXPECT_EQ(error_of_material("type = \"dielectric\"\nmetallic = 1").substr(0, 29), "4:1: unknown key \"metallic\"; ");
}

TEST(SceneMaterials, NumbersOutOfRangeArePlaced) {
  EXPECT_EQ(error_of_material("type = \"conductor\"\nroughness = 1.5"),
            "4:13: expected a number from 0 to 1 for \"roughness\", got 1.5");
  EXPECT_EQ(error_of_material("type = \"metallic-roughness\"\nmetallic = -1"),
            "4:12: expected a number from 0 to 1 for \"metallic\", got -1");
  EXPECT_EQ(error_of_material("type = \"dielectric\"\nindex = 0"), "4:9: expected an index n above 0, got 0");
  EXPECT_EQ(error_of_material("type = \"conductor\"\nindex = { k = 2 }"),
            "4:9: expected the key \"n\" in [index], which is missing");
  EXPECT_EQ(error_of_material("type = \"conductor\"\nmetal = \"Ag\"\nindex = { n = 1, k = 2 }"),
            "5:9: expected either \"metal\" or \"index\", got both");
  EXPECT_EQ(error_of_material("type = \"dielectric\"\nindex = [[\"500 nm\", 1.5], [\"500 nm\", 1.6]]"),
            "4:9: expected each wavelength once, got 500 nm twice");
  EXPECT_EQ(
      error_of_material("type = \"dielectric\"\nindex = [[500, 1.5]]"),
      "4:11: expected a number such as 1.5, a list [[\"450 nm\", 1.526], …] or a table file for \"index\", got the "
      "bare number 500");
  EXPECT_EQ(error_of_material("type = \"dielectric\"\nindex = [[\"500 nm\", 1.5, 0.1]]"),
            "4:9: expected a glass without absorption (k = 0), got k = 0.1; a metal is a \"conductor\"");
  EXPECT_EQ(error_of_material("emission = -1"), "3:12: expected finite numbers of 0 or more for \"emission\", got -1");
}

TEST(SceneMaterials, FilesThatAreMissingOrOfAnotherKindAreNamed) {
  const std::string none = test::temporary("none.png"), grey = texture("grey.png", 1);
  for (const char* key : {"texture", "emission_texture", "normal_map"})
    EXPECT_EQ(error_of_material(std::string(key) + " = \"none.png\""),
              fmt::format("3:{}: expected an image at {}, but there is no such file; check the path",
                          std::string(key).size() + 4, none));
  EXPECT_EQ(error_of_material("normal_map = \"grey.png\""),
            "3:14: expected an image of red, green and blue for \"normal_map\", got the grey one " + grey);
  const std::string table = make_file("index.txt", "500 nm 1.5\n\n600 1.6\n");
  EXPECT_EQ(error_of_material("type = \"dielectric\"\nindex = \"index.txt\""),
            "4:9: " + table +
                ":3: expected a wavelength with its unit, n and k, such as \"450 nm 0.04 2.6\", got \"600 1.6\"");
}

TEST(SceneMaterials, ATextureNeedsTextureCoordinatesAndNoLightBelowZero) {
  texture("t.png");
  make_file("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(
      error_of_material("texture = \"t.png\"\n[[object]]\ntype = \"mesh\"\nfile = \"m.obj\"\nfit = \"1 mm\"\n"
                        "distance = \"1 m\"\nname = \"leaf\"\nmaterial = \"m\""),
      "10:12: expected a mesh with texture coordinates for a material with a texture, got \"leaf\" without; export "
      "it with them, or use a material without a texture");
  Image dark(1, 1, 3);
  dark.values = {1, -2, 1};
  const std::string path = test::temporary("dark.exr");
  save_image(path, dark, 1, 8);
  EXPECT_EQ(error_of_material("texture = \"dark.exr\""),
            "3:11: " + path + ": expected a texture of values of 0 or more, got -2");
}

TEST(SceneMaterials, AnObjectsOwnMaterialTakesThePlaceOfItsFiles) {
  make_file("m.ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
            "property list uchar int vertex_indices\nend_header\n0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n"
            "3 0 1 2\n");
  const std::string object = "[[object]]\ntype = \"mesh\"\nfile = \"m.ply\"\nfit = \"8 mm\"\ndistance = \"300 mm\"\n";
  const Job job = load_job(make_file("scene.toml", "wavelength = \"532 nm\"\n[materials.m]\ntype = \"conductor\"\n" +
                                                       object + "material = \"m\"\n" + object));
  ASSERT_EQ(job.scene.meshes.size(), 2u);
  const auto is_metal = [&](size_t mesh) {
    return std::holds_alternative<ConductorMaterial>(
        job.scene.materials[size_t(job.scene.meshes[mesh].material)].surface);
  };
  EXPECT_TRUE(is_metal(0));
  EXPECT_TRUE(job.scene.meshes[0].colours.empty());
  EXPECT_FALSE(is_metal(1));
  EXPECT_EQ(job.scene.meshes[1].colours.size(), 3u);
  EXPECT_EQ(job.scene.meshes[1].positions[0], (Vec3{-4e-3, -4e-3, -0.3}));  // its centre 300 mm behind the panel
}

}  // namespace
}  // namespace holotrace
