// OBJ with MTL, PLY, and what assimp reads, on files of a few lines.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "tests/preprocess/import_fixtures.h"

namespace promenade {
namespace {

Scene imported(const std::filesystem::path& path, const ImportOptions& options = {}) {
  Result<Scene> scene = import_file(path, options);
  if (!scene.ok()) {
    ADD_FAILURE() << scene.error().message;
    return {};
  }
  EXPECT_EQ(find_scene_defect(*scene), "");
  return *std::move(scene);
}

Scene imported(const std::string& name, std::string_view bytes, const ImportOptions& options = {}) {
  const TemporaryFolder folder;
  return imported(folder.write(name, bytes), options);
}

Box world_box(const Scene& scene, const glm::dvec3& origin = {}) {
  Box box;
  for (const SceneInstance& instance : scene.instances) box.add(bounds(flattened(scene, instance, origin)));
  return box;
}

uint64_t count(const Scene& scene, const std::string& key) {
  const auto found = scene.report.counts.find(key);
  return found == scene.report.counts.end() ? 0 : found->second;
}

ImportOptions z_up() {
  ImportOptions options;
  options.up = UpAxis::z;
  return options;
}

constexpr const char* kCubeObj = R"(# a cube of quads
o cube
v 0 0 0
v 1 0 0
v 0 1 0
v 1 1 0
v 0 0 1
v 1 0 1
v 0 1 1
v 1 1 1
f 1 3 4 2
f 5 6 8 7
f 1 2 6 5
f 3 7 8 4
f 1 5 7 3
f 2 4 8 6
)";

TEST(ImportObj, closed_cube_of_quads_is_one_sided_and_y_up) {
  const Scene scene = imported("cube.obj", kCubeObj);
  EXPECT_EQ(count(scene, "triangles"), 12U);
  ASSERT_EQ(scene.instances.size(), 1U);
  EXPECT_EQ(scene.instances[0].name, "cube");
  EXPECT_FALSE(scene.materials[0].two_sided);
  EXPECT_EQ(world_box(scene).min, glm::vec3(0, -1, 0));
}

TEST(ImportObj, open_box_is_two_sided) {
  std::string text = kCubeObj;
  text.resize(text.rfind("f "));
  EXPECT_TRUE(imported("box.obj", text).materials[0].two_sided);
}

TEST(ImportObj, materials_textures_and_objects_are_kept) {
  const TemporaryFolder folder;
  folder.write("my materials.mtl", "newmtl red\nKd 1 0 0\nd 0.5\nnewmtl wall\nKd 0 0 0\nmap_Kd tex\\wall.png\n");
  folder.write("tex/wall.png", "picture");
  const Scene scene = imported(folder.write("a.obj", R"(mtllib my materials.mtl
v 0 0 0
v 1 0 0
v 0 1 0
vt 0.25 0.75
vn 0 0 1
o first
usemtl red
f 1 2 3
o second
usemtl wall
f 1/1/1 2/1/1 3/1/1
f -3 -2 -1
)"));
  ASSERT_EQ(scene.instances.size(), 2U);
  const Mesh& first = scene.meshes[scene.instances[0].mesh];
  const Mesh& second = scene.meshes[scene.instances[1].mesh];
  EXPECT_EQ(scene.materials[first.material_of(0)].color, glm::u8vec4(255, 0, 0, 128));
  const Material& wall = scene.materials[second.material_of(0)];
  ASSERT_NE(wall.texture, kNoTexture);
  EXPECT_EQ(wall.color, glm::u8vec4(255));
  EXPECT_EQ(scene.textures[wall.texture].encoded.size(), 7U);
  EXPECT_EQ(second.texcoords[0], glm::vec2(0.25F, 0.25F));
  EXPECT_EQ(second.normals[0], glm::vec3(0, -1, 0));
  EXPECT_EQ(count(scene, "faces_duplicate"), 1U);  // the relative indices name the same face
}

TEST(ImportObj, absent_library_and_absent_picture_are_named) {
  const TemporaryFolder folder;
  const Scene no_library = imported(folder.write("a.obj", "mtllib no.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
  ASSERT_EQ(no_library.report.warnings.size(), 1U);
  EXPECT_EQ(no_library.report.warnings[0], "missing material library no.mtl");
  folder.write("b.mtl", "newmtl m\nmap_Kd ../../etc/passwd\n");
  const Scene no_picture =
      imported(folder.write("b.obj", "mtllib b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n"));
  EXPECT_EQ(count(no_picture, "textures_missing"), 1U);
  EXPECT_EQ(no_picture.report.warnings[0], "missing texture ../../etc/passwd");
}

TEST(ImportObj, utm_coordinates_keep_a_millimetre) {
  const Scene scene = imported("utm.obj",
                               "v 500000.001 5800000.002 30\nv 500000.002 5800000.002 30\n"
                               "v 500000.001 5800000.003 30\nf 1 2 3\n",
                               z_up());
  const Box box = world_box(scene, {500000, 5800000, 0});
  EXPECT_NEAR(box.size().x, 0.001, 1e-4);
  EXPECT_NEAR(box.size().y, 0.001, 1e-4);
  EXPECT_NEAR(box.min.x, 0.001, 1e-4);
}

TEST(ImportObj, vertex_colours_and_polygons_with_notches_are_read) {
  const Scene scene = imported("notch.obj",
                               "v 0 0 0 1 0 0\nv 4 0 0 0 1 0\nv 4 4 0 0 0 1\nv 2 1 0 1 1 1\nv 0 4 0 0 0 0\n"
                               "f 1 2 3 \\\n 4 5\n");
  ASSERT_EQ(scene.meshes.size(), 1U);
  EXPECT_EQ(scene.meshes[0].triangle_count(), 3U);
  EXPECT_NEAR(surface_area_m2(scene.meshes[0]), 16 - 6, 1e-5);
  EXPECT_EQ(scene.meshes[0].colors.size(), 5U);
}

TEST(ImportObj, warped_quad_and_bad_faces_are_counted) {
  const Scene scene = imported("bad.obj",
                               "v 0 0 0\nv 1 0 0.5\nv 1 1 0\nv 0 1 0.5\nv 1 1\n"
                               "f 1 2 3 4\nf 1 2\nf 1 2 99\nf 0 1 2\nf 1 2 5\n");
  EXPECT_EQ(count(scene, "faces_non_planar"), 1U);
  EXPECT_EQ(count(scene, "faces_dropped"), 4U);
  EXPECT_EQ(count(scene, "vertices_non_finite"), 1U);
  EXPECT_EQ(count(scene, "triangles"), 2U);
}

TEST(ImportObj, scale_is_the_callers) {
  ImportOptions options = z_up();
  options.unit_m = 0.004;
  EXPECT_NEAR(world_box(imported("cube.obj", kCubeObj, options)).max.x, 0.004, 1e-9);
}

constexpr const char* kAsciiPly = R"(ply
format ascii 1.0
comment made by hand
element vertex 4
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
element face 1
property list uchar int vertex_indices
element edge 1
property int vertex1
property int vertex2
end_header
0 0 0 255 0 0
1 0 0 0 255 0
1 1 0 0 0 255
0 1 0 9 9 9
4 0 1 2 3
0 1
)";

TEST(ImportPly, ascii_quad_with_colours_is_z_up) {
  const Scene scene = imported("quad.ply", kAsciiPly);
  ASSERT_EQ(scene.meshes.size(), 1U);
  EXPECT_EQ(scene.meshes[0].triangle_count(), 2U);
  EXPECT_EQ(scene.meshes[0].colors[1], glm::u8vec4(0, 255, 0, 255));
  EXPECT_EQ(world_box(scene).max, glm::vec3(1, 1, 0));
  EXPECT_EQ(scene.instances[0].name, "quad");
}

/// A triangle with double positions, in the given byte order.
std::string binary_ply(bool big_endian) {
  std::string out = std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
                    "_endian 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
                    "element face 1\nproperty list uchar uint vertex_indices\nend_header\n";
  const auto put = [&](auto value) {
    std::string bytes(sizeof(value), '\0');
    std::memcpy(bytes.data(), &value, sizeof(value));
    if (big_endian) std::reverse(bytes.begin(), bytes.end());
    out += bytes;
  };
  for (const double v : {500000.001, 10.0, 0.0, 500000.002, 10.0, 0.0, 500000.001, 10.001, 0.0}) put(v);
  out += '\3';
  for (const uint32_t i : {0U, 1U, 2U}) put(i);
  return out;
}

TEST(ImportPly, binary_of_both_byte_orders_keeps_a_millimetre_at_500_km) {
  for (const bool big_endian : {false, true}) {
    const Scene scene = imported("t.ply", binary_ply(big_endian));
    EXPECT_EQ(count(scene, "triangles"), 1U);
    const Box box = world_box(scene, {500000, 0, 0});
    EXPECT_NEAR(box.size().x, 0.001, 1e-4);
    EXPECT_NEAR(box.min.x, 0.001, 1e-4);
  }
}

TEST(ImportPly, texture_of_faces_and_strips_are_read) {
  const TemporaryFolder folder;
  folder.write("brick.jpg", "picture");
  const Scene scene = imported(folder.write("t.ply", R"(ply
format ascii 1.0
comment TextureFile brick.jpg
element vertex 4
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
property list uchar float texcoord
element tristrips 1
property list int int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
1 1 1
3 0 1 2 6 0 0 1 0 0 1
4 1 0 3 2
)"));
  ASSERT_EQ(scene.meshes.size(), 1U);
  EXPECT_EQ(scene.meshes[0].triangle_count(), 3U);
  EXPECT_EQ(scene.meshes[0].texcoords.size(), scene.meshes[0].vertex_count());
  EXPECT_EQ(scene.textures[0].encoded.size(), 7U);
  EXPECT_EQ(scene.materials[0].texture, 0U);
}

TEST(ImportPly, counts_larger_than_the_file_are_refused) {
  std::string text = kAsciiPly;
  text.replace(text.find("vertex 4"), 8, "vertex 400000000000");
  const Result<Scene> scene = import_bytes("t.ply", text);
  ASSERT_FALSE(scene.ok());
  EXPECT_NE(scene.error().message.find("vertex"), std::string::npos);
}

TEST(ImportAssimp, off_stl_and_collada_are_read) {
  const Scene off = imported("t.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  EXPECT_EQ(count(off, "triangles"), 4U);
  const Scene stl = imported("t.stl",
                             "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                             "endloop\nendfacet\nendsolid t\n");
  EXPECT_EQ(count(stl, "triangles"), 1U);
  const Scene dae = imported("t.dae", R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="9">0 0 0 100 0 0 0 0 100</float_array>
<technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n" name="wall"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)");
  EXPECT_EQ(count(dae, "triangles"), 1U);
  const Box box = world_box(dae);
  EXPECT_NEAR(box.max.x, 1, 1e-5);  // centimetres, and z stays up
  EXPECT_NEAR(box.max.z, 1, 1e-5);
}

constexpr const char* kWallIfc = R"(ISO-10303-21;
HEADER;
FILE_DESCRIPTION(('ViewDefinition [CoordinationView]'),'2;1');
FILE_NAME('t.ifc','2020-01-01T00:00:00',(''),(''),'','','');
FILE_SCHEMA(('IFC2X3'));
ENDSEC;
DATA;
#80=IFCPERSON($,'a','b',$,$,$,$,$);
#81=IFCORGANIZATION($,'o',$,$,$);
#82=IFCPERSONANDORGANIZATION(#80,#81,$);
#83=IFCAPPLICATION(#81,'1','x','x');
#90=IFCOWNERHISTORY(#82,#83,$,.ADDED.,$,$,$,0);
#1=IFCCARTESIANPOINT((0.,0.,0.));
#2=IFCDIRECTION((0.,0.,1.));
#3=IFCDIRECTION((1.,0.,0.));
#4=IFCAXIS2PLACEMENT3D(#1,#2,#3);
#5=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-05,#4,$);
#6=IFCSIUNIT(*,.LENGTHUNIT.,.MILLI.,.METRE.);
#7=IFCUNITASSIGNMENT((#6));
#8=IFCPROJECT('0001',#90,'p',$,$,$,$,(#5),#7);
#10=IFCLOCALPLACEMENT($,#4);
#11=IFCSITE('0002',#90,'s',$,$,#10,$,$,.ELEMENT.,$,$,$,$,$);
#12=IFCBUILDING('0003',#90,'b',$,$,#10,$,$,.ELEMENT.,$,$,$);
#13=IFCBUILDINGSTOREY('0004',#90,'st',$,$,#10,$,$,.ELEMENT.,0.);
#14=IFCRELAGGREGATES('0005',#90,$,$,#8,(#11));
#15=IFCRELAGGREGATES('0006',#90,$,$,#11,(#12));
#16=IFCRELAGGREGATES('0007',#90,$,$,#12,(#13));
#20=IFCCARTESIANPOINT((0.,0.));
#21=IFCAXIS2PLACEMENT2D(#20,$);
#22=IFCRECTANGLEPROFILEDEF(.AREA.,$,#21,2000.,1000.);
#23=IFCEXTRUDEDAREASOLID(#22,#4,#2,5000.);
#24=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#23));
#25=IFCPRODUCTDEFINITIONSHAPE($,$,(#24));
#26=IFCWALL('0008',#90,'wall',$,$,#10,#25,$);
#27=IFCRELCONTAINEDINSPATIALSTRUCTURE('0009',#90,$,$,(#26),#13);
ENDSEC;
END-ISO-10303-21;
)";

TEST(ImportAssimp, ifc_wall_is_in_metres_z_up_and_classed) {
  const Scene scene = imported("wall.ifc", kWallIfc);
  ASSERT_EQ(scene.instances.size(), 1U);
  EXPECT_EQ(scene.instances[0].class_name, "IfcWall");
  EXPECT_EQ(count(scene, "triangles"), 12U);
  const Box box = world_box(scene);
  EXPECT_NEAR(box.min.z, 0, 1e-5);
  EXPECT_NEAR(box.max.z, 5, 1e-5);
  EXPECT_NEAR(box.size().x, 2, 1e-5);
}

TEST(ImportAssimp, broken_file_is_an_error_that_names_it) {
  const Result<Scene> scene = import_bytes("broken.fbx", "Kaydara FBX Binary  \0\x1a\0 and then nothing");
  ASSERT_FALSE(scene.ok());
  EXPECT_NE(scene.error().message.find("broken.fbx"), std::string::npos);
  EXPECT_EQ(scene.error().message.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace promenade
