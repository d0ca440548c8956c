// Formats that Assimp reads in a child process.

#include <gtest/gtest.h>

#include <cstring>

#include "holotrace/io/files/file_kind.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "support/mesh_area.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::area;
using test::make_file;

constexpr const char* off_triangle = "OFF\n3 1 0\n0 0 0\n2 0 0\n0 1 0\n3 0 1 2\n";
constexpr const char* stl_triangle =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    "endsolid a\n";

std::string collada(const std::string& node) {
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><up_axis>Y_UP</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert><diffuse><color>1 0.5 0.25 1</color></diffuse>
</lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="9">0 0 0 2 0 0 0 1 0</float_array>
<technique_common><accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/>
</vertices><triangles count="1" material="s"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">)" +
         node + R"(</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

TEST(OtherFormats, StlAndOffAreRead) {
  EXPECT_EQ(area(load_meshes(make_file("m.off", off_triangle))), 1);
  EXPECT_EQ(area(load_meshes(make_file("m.stl", stl_triangle))), 1);
}

TEST(OtherFormats, ColladaHasItsColourAndThePlaceOfItsNode) {
  const LoadedModel model = load_meshes(make_file(
      "m.dae",
      collada(R"(<node><translate>0 0 5</translate><instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="s" target="#m"/></technique_common></bind_material></instance_geometry></node>)")));
  EXPECT_EQ(area(model), 1);
  EXPECT_EQ(model.meshes[0].positions[0].z, 5);
  const auto& surface = model.materials[size_t(model.meshes[0].material)].surface;
  EXPECT_EQ(std::get<DiffuseMaterial>(surface).reflectance, (Vec3{1, 0.5, 0.25}));
}

constexpr const char* instance =
    R"(<instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="s" target="#m"/>
</technique_common></bind_material></instance_geometry>)";

TEST(OtherFormats, TransparencyIsNamed) {
  std::string text = collada(std::string("<node>") + instance + "</node>");
  const auto warnings = [](const std::string& t) { return load_meshes(make_file("m.dae", t)).warnings; };
  EXPECT_TRUE(warnings(text).empty());
  const std::string end = "</diffuse>";
  text.insert(
      text.find(end) + end.size(),
      "<transparent opaque=\"A_ONE\"><color>1 1 1 1</color></transparent><transparency><float>0.5</float></transparency>");
  ASSERT_EQ(warnings(text).size(), 1u);
  EXPECT_NE(warnings(text)[0].find("is transparent; it is shown opaque"), std::string::npos) << warnings(text)[0];
}

// A triangle bound to a joint, whose inverse bind matrix moves it by −5: p' = (joint)·(inverse bind)·p. The node that shows
// it is moved, which does not count.
TEST(OtherFormats, SkinsAtRestArePlacedByTheirJoints) {
  std::string text = collada(R"(<node id="joint" sid="j" type="JOINT"><translate>5 0 2</translate></node>
<node><translate>100 0 0</translate><instance_controller url="#c"><skeleton>#joint</skeleton></instance_controller></node>)");
  const std::string scenes = "<library_visual_scenes>";
  text.insert(text.find(scenes), R"(<library_controllers><controller id="c"><skin source="#g">
<bind_shape_matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</bind_shape_matrix>
<source id="cj"><Name_array id="cja" count="1">j</Name_array><technique_common><accessor source="#cja" count="1" stride="1">
<param name="JOINT" type="name"/></accessor></technique_common></source>
<source id="cb"><float_array id="cba" count="16">1 0 0 -5 0 1 0 0 0 0 1 0 0 0 0 1</float_array><technique_common>
<accessor source="#cba" count="1" stride="16"><param name="TRANSFORM" type="float4x4"/></accessor></technique_common></source>
<source id="cw"><float_array id="cwa" count="1">1</float_array><technique_common><accessor source="#cwa" count="1" stride="1">
<param name="WEIGHT" type="float"/></accessor></technique_common></source>
<joints><input semantic="JOINT" source="#cj"/><input semantic="INV_BIND_MATRIX" source="#cb"/></joints>
<vertex_weights count="3"><input semantic="JOINT" source="#cj" offset="0"/><input semantic="WEIGHT" source="#cw" offset="1"/>
<vcount>1 1 1</vcount><v>0 0 0 0 0 0</v></vertex_weights></skin></controller></library_controllers>)");
  const LoadedModel model = load_meshes(make_file("m.dae", text));
  ASSERT_EQ(model.meshes.size(), 1u);
  EXPECT_EQ(area(model), 1);
  EXPECT_EQ(model.meshes[0].positions[0], (Vec3{0, 0, 2}));
  // Assimp takes a matrix that is left out as 0, which would shrink the mesh to a point: then its node places it.
  const size_t begin = text.find("<bind_shape_matrix>"), end = text.find("<source id=\"cj\">");
  EXPECT_EQ(load_meshes(make_file("m.dae", text.erase(begin, end - begin))).meshes[0].positions[0], (Vec3{100, 0, 0}));
}

TEST(OtherFormats, DamageIsAnErrorThatNamesTheFile) {
  for (const char* name : {"m.off", "m.stl", "m.dae", "m.3ds", "m.fbx"})
    for (const std::string& bytes : {std::string(), std::string("OFF\n3 1 0\n0 0 0\n"), std::string(300, '\xff')}) {
      const std::string path = make_file(name, bytes);
      EXPECT_TRUE(error_of([&] { load_meshes(path); }).starts_with(path + ": expected")) << name << bytes.size();
    }
  // A chain of nodes in which Assimp calls itself for each.
  std::string chain;
  for (int i = 0; i < 100000; ++i) chain += "<node>";
  const std::string path = make_file("m.dae", collada(chain));
  EXPECT_TRUE(error_of([&] { load_meshes(path); }).starts_with(path + ": expected"));
}

TEST(FileKind, FilesAreNamedByTheirFirstBytes) {
  EXPECT_TRUE(kind_of_file(make_file("f", "\x89PNG\r\n")).starts_with("a PNG, a picture"));
  EXPECT_TRUE(kind_of_file(make_file("f", "\x93NUMPY")).starts_with("a field in NPY"));
  EXPECT_TRUE(kind_of_file(make_file("f", "glTF")).starts_with("a glTF file, a model"));
  EXPECT_EQ(kind_of_file(make_file("f.dgn", "what?")), "a file .dgn");
  EXPECT_EQ(kind_of_file(make_file("f", "")), "an empty file");
}

}  // namespace
}  // namespace holotrace
