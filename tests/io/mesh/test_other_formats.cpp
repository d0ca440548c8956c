// Formats that Assimp reads in a child process.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>

#include "holotrace/io/files/file_kind.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/picture/image_file.h"
#include "support/gltf.h"
#include "support/mesh_area.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::area;
using test::bytes_of;
using test::make_file;
using test::temporary;

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

TEST(OtherFormats, TransparencyIsRead) {
  std::string text = collada(std::string("<node>") + instance + "</node>");
  const auto opacity = [](const std::string& t) { return load_meshes(make_file("m.dae", t)).materials.at(0).opacity; };
  EXPECT_EQ(opacity(text), 1);
  const std::string end = "</diffuse>";
  text.insert(
      text.find(end) + end.size(),
      "<transparent opaque=\"A_ONE\"><color>1 1 1 1</color></transparent><transparency><float>0.5</float></transparency>");
  EXPECT_EQ(opacity(text), 0.5);
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

// A triangle in the text form of FBX 7.4; its node is moved by 100 along x.
// @param paint        further properties of its material
// @param objects      further objects, whose numbers are 400 and above
// @param connections  theirs
std::string fbx(const std::string& paint, const std::string& objects = "", const std::string& connections = "") {
  return R"(; FBX 7.4.0 project file
FBXHeaderExtension: {
 FBXHeaderVersion: 1003
 FBXVersion: 7400
}
Objects: {
 Geometry: 100, "Geometry::leaf", "Mesh" {
  Vertices: *9 { a: 0,0,0,2,0,0,0,1,0 }
  PolygonVertexIndex: *3 { a: 0,1,-3 }
  GeometryVersion: 124
  LayerElementUV: 0 {
   Version: 101
   Name: "UVMap"
   MappingInformationType: "ByPolygonVertex"
   ReferenceInformationType: "IndexToDirect"
   UV: *6 { a: 0.25,0,1,0,0.25,0.75 }
   UVIndex: *3 { a: 0,1,2 }
  }
  LayerElementMaterial: 0 {
   Version: 101
   Name: ""
   MappingInformationType: "AllSame"
   ReferenceInformationType: "IndexToDirect"
   Materials: *1 { a: 0 }
  }
  Layer: 0 {
   Version: 100
   LayerElement: {
    Type: "LayerElementUV"
    TypedIndex: 0
   }
   LayerElement: {
    Type: "LayerElementMaterial"
    TypedIndex: 0
   }
  }
 }
 Model: 200, "Model::leaf", "Mesh" {
  Version: 232
  Properties70: {
   P: "Lcl Translation", "Lcl Translation", "", "A",100,0,0
  }
 }
 Material: 300, "Material::paint", "" {
  Version: 102
  ShadingModel: "lambert"
  MultiLayer: 0
  Properties70: {
   P: "DiffuseColor", "Color", "", "A",1,0.5,0.25
)" + paint +
         "  }\n }\n" + objects + "}\nConnections: {\n C: \"OO\",200,0\n C: \"OO\",100,200\n C: \"OO\",300,200\n" +
         connections + "}\n";
}

std::string fbx_texture(int number, const std::string& file) {
  const std::string name = "\"Texture::" + file + "\"";
  return fmt::format(
      " Texture: {0}, {1}, \"\" {{\n  Type: \"TextureVideoClip\"\n  Version: 202\n  TextureName: {1}\n  FileName: "
      "\"{2}\"\n  RelativeFilename: \"{2}\"\n }}\n",
      number, name, file);
}

// A chunk of a 3DS file: its number, its size with these six bytes, its content.
std::string chunk(uint16_t number, const std::string& content) {
  return bytes_of(std::vector<uint16_t>{number}) + bytes_of(std::vector<uint32_t>{uint32_t(6 + content.size())}) +
         content;
}

std::string with_end(const char* text) { return std::string(text) + '\0'; }
std::string percent(uint16_t value) { return chunk(0x0030, bytes_of(std::vector<uint16_t>{value})); }

// The same triangle as a 3DS file, with further chunks of its material.
std::string three_ds(const std::string& paint) {
  const std::string colour = chunk(0x0011, {char(255), char(128), 0});
  const std::string material = chunk(0xA000, with_end("paint")) + chunk(0xA020, colour) + paint;
  const std::string count = bytes_of(std::vector<uint16_t>{3});
  const std::string vertices = chunk(0x4110, count + bytes_of(std::vector<float>{0, 0, 0, 2, 0, 0, 0, 1, 0}));
  const std::string places = chunk(0x4140, count + bytes_of(std::vector<float>{0.25f, 0, 1, 0, 0.25f, 0.75f}));
  const std::string users = chunk(0x4130, with_end("paint") + bytes_of(std::vector<uint16_t>{1, 0}));
  const std::string faces = chunk(0x4120, bytes_of(std::vector<uint16_t>{1, 0, 1, 2, 7}) + users);
  const std::string leaf = chunk(0x4000, with_end("leaf") + chunk(0x4100, vertices + places + faces));
  return chunk(0x4D4D,
               chunk(0x0002, bytes_of(std::vector<uint32_t>{3})) + chunk(0x3D3D, chunk(0xAFFF, material) + leaf));
}

const DiffuseMaterial& paint_of(const LoadedModel& model) {
  return std::get<DiffuseMaterial>(model.materials.at(size_t(model.meshes.at(0).material)).surface);
}

// A picture of one red pixel beside the models.
void save_red(const char* name) {
  Image red(1, 1, 3);
  red(0, 0, 0) = 1;
  save_image(temporary(name), red, 1, 8);
}

void expect_only_warning(const LoadedModel& model, const std::string& words) {
  ASSERT_EQ(model.warnings.size(), 1u) << words;
  EXPECT_NE(model.warnings[0].find(words), std::string::npos) << model.warnings[0];
}

TEST(OtherFormats, FbxHasItsColourPlaceAndMaps) {
  const LoadedModel plain = load_meshes(make_file("m.fbx", fbx("")));
  EXPECT_TRUE(plain.warnings.empty());
  EXPECT_EQ(area(plain), 1);
  EXPECT_EQ(plain.meshes[0].positions[0], (Vec3{100, 0, 0}));
  EXPECT_EQ(paint_of(plain).reflectance, (Vec3{1, 0.5, 0.25}));
  save_red("red.png");
  const LoadedModel painted =
      load_meshes(make_file("m.fbx", fbx("", fbx_texture(400, "red.png") + fbx_texture(401, "bumps.png"),
                                         " C: \"OP\",400,300, \"DiffuseColor\"\n C: \"OP\",401,300, \"Bump\"\n")));
  ASSERT_TRUE(paint_of(painted).texture);
  EXPECT_EQ((*paint_of(painted).texture)(0, 0, 0), 1);
  EXPECT_EQ((*paint_of(painted).texture)(0, 0, 1), 0);
  EXPECT_EQ(painted.meshes[0].texture_coordinates[2].y, 0.75);
  expect_only_warning(painted, "material \"paint\" has a texture of its bumps; it is ignored");
}

TEST(OtherFormats, TransparencyOfFbxIsRead) {
  for (const char* paint : {"   P: \"Opacity\", \"double\", \"Number\", \"\",0.5\n",
                            "   P: \"TransparentColor\", \"Color\", \"\", \"A\",1,1,1\n"
                            "   P: \"TransparencyFactor\", \"Number\", \"\", \"A\",0.5\n"})
    EXPECT_EQ(load_meshes(make_file("m.fbx", fbx(paint))).materials.at(0).opacity, 0.5);
}

// The joint stood at (5, 0, 0) when the mesh, at (100, 0, 0), was bound to it (the file keeps their difference), and
// stands at (5, 0, 2) now: it takes the mesh to (100, 0, 2).
TEST(OtherFormats, SkinsOfFbxAreMovedByTheirJoints) {
  const std::string skin = R"( Model: 500, "Model::joint", "LimbNode" {
  Version: 232
  Properties70: {
   P: "Lcl Translation", "Lcl Translation", "", "A",5,0,2
  }
 }
 NodeAttribute: 501, "NodeAttribute::joint", "LimbNode" {
  TypeFlags: "Skeleton"
 }
 Deformer: 600, "Deformer::skin", "Skin" {
  Version: 101
  Link_DeformAcuracy: 50
 }
 Deformer: 601, "SubDeformer::joint", "Cluster" {
  Version: 100
  UserData: "", ""
  Indexes: *3 { a: 0,1,2 }
  Weights: *3 { a: 1,1,1 }
  Transform: *16 { a: 1,0,0,0,0,1,0,0,0,0,1,0,95,0,0,1 }
  TransformLink: *16 { a: 1,0,0,0,0,1,0,0,0,0,1,0,5,0,0,1 }
 }
)";
  const LoadedModel model = load_meshes(make_file(
      "m.fbx",
      fbx("", skin,
          " C: \"OO\",500,0\n C: \"OO\",501,500\n C: \"OO\",600,100\n C: \"OO\",601,600\n C: \"OO\",500,601\n")));
  ASSERT_EQ(model.meshes.size(), 1u);
  EXPECT_EQ(area(model), 1);
  EXPECT_EQ(model.meshes[0].positions[0], (Vec3{100, 0, 2}));
}

TEST(OtherFormats, ThreeDsHasItsColourAndMaps) {
  const LoadedModel plain = load_meshes(make_file("m.3ds", three_ds("")));
  EXPECT_TRUE(plain.warnings.empty());
  EXPECT_EQ(area(plain), 1);
  EXPECT_EQ(paint_of(plain).reflectance.x, 1);
  EXPECT_FLOAT_EQ(float(paint_of(plain).reflectance.y), 128 / 255.0f);
  save_red("red.png");
  const LoadedModel painted =
      load_meshes(make_file("m.3ds", three_ds(chunk(0xA200, percent(100) + chunk(0xA300, with_end("red.png"))) +
                                              chunk(0xA230, percent(100) + chunk(0xA300, with_end("bumps.png"))))));
  ASSERT_TRUE(paint_of(painted).texture);
  EXPECT_EQ((*paint_of(painted).texture)(0, 0, 0), 1);
  EXPECT_EQ(painted.meshes[0].texture_coordinates[2].y, 0.75);
  expect_only_warning(painted, "material \"paint\" has a texture of its bumps; it is ignored");
}

TEST(OtherFormats, TransparencyOfThreeDsIsRead) {
  EXPECT_TRUE(load_meshes(make_file("m.3ds", three_ds(chunk(0xA050, percent(0))))).warnings.empty());
  EXPECT_NEAR(load_meshes(make_file("m.3ds", three_ds(chunk(0xA050, percent(40))))).materials.at(0).opacity, 0.6, 1e-6);
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
