#include "tests/preprocess/import_corpus.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include <array>
#include <cstring>
#include <memory>

#include "tests/preprocess/import_fixtures.h"

namespace promenade {

namespace {

const std::vector<float>& corners() {
  static const std::vector<float> values{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  return values;
}

std::string featured_glb() {
  GlbFixture glb = tetrahedron_glb();
  nlohmann::json& primitive = glb.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["NORMAL"] =
      glb.add_values<int8_t>({127, 0, 0, 0, 127, 0, 0, 0, 127, 127, 0, 0}, "VEC3", 5120, true);
  primitive["attributes"]["COLOR_0"] =
      glb.add_values<uint8_t>({1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 9, 1, 1, 1, 1}, "VEC4", 5121, true);
  primitive["attributes"]["TEXCOORD_0"] = glb.add_floats({0, 0, 1, 0, 0, 1, 1, 1}, "VEC2");
  primitive["material"] = 0;
  const std::array<uint16_t, 1> place{3};
  const std::array<float, 3> value{0, 0, 2};
  glb.json["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", glb.add_view(std::as_bytes(std::span(place)))}, {"componentType", 5123}}},
      {"values", {{"bufferView", glb.add_view(std::as_bytes(std::span(value)))}}}};
  glb.json["images"] = {{{"uri", "data:image/png;base64,AAAA"}}};
  glb.json["textures"] = {{{"source", 0}}};
  glb.json["materials"] = {
      {{"pbrMetallicRoughness",
        {{"baseColorTexture",
          {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"scale", {2, 2}}, {"rotation", 1}}}}}}}}}}};
  glb.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      glb.add_floats({0, 0, 0, 3, 0, 0}, "VEC3");
  return glb.bytes();
}

std::string meshopt_glb() {
  GlbFixture glb;
  std::vector<unsigned char> packed(meshopt_encodeVertexBufferBound(4, 12));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), corners().data(), 4, 12));
  const size_t positions = glb.add_view(std::as_bytes(std::span(packed)));
  const std::vector<uint32_t> indices{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  const size_t packed_positions = packed.size();
  packed.resize(meshopt_encodeIndexBufferBound(12, 4));
  packed.resize(meshopt_encodeIndexBuffer(packed.data(), packed.size(), indices.data(), 12));
  const size_t triangles = glb.add_view(std::as_bytes(std::span(packed)));
  const auto compressed = [&](size_t view, size_t bytes, size_t count, size_t stride, const char* mode) {
    nlohmann::json& declared = glb.json["bufferViews"][view];
    const nlohmann::json offset = declared["byteOffset"];
    declared["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},         {"byteOffset", offset},
                                                         {"byteLength", bytes}, {"byteStride", stride},
                                                         {"count", count},      {"mode", mode}};
  };
  compressed(positions, packed_positions, 4, 12, "ATTRIBUTES");
  compressed(triangles, packed.size(), 12, 4, "TRIANGLES");
  glb.add_mesh(glb.add_accessor(positions, 4, "VEC3", 5126), glb.add_accessor(triangles, 12, "SCALAR", 5125));
  glb.json["nodes"] = {{{"mesh", 0}}};
  return glb.bytes();
}

std::string draco_glb() {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(4);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  constexpr std::array<std::array<size_t, 3>, 4> kFaces{{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  for (uint32_t f = 0; f < 4; ++f)
    builder.SetAttributeValuesForFace(position, draco::FaceIndex(f), &corners()[3 * kFaces[f][0]],
                                      &corners()[3 * kFaces[f][1]], &corners()[3 * kFaces[f][2]]);
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeMeshToBuffer(*mesh, &buffer).ok()) return {};
  GlbFixture glb;
  const size_t view = glb.add_view(std::as_bytes(std::span(buffer.data(), buffer.size())));
  glb.json["accessors"] = {{{"count", 4}, {"type", "VEC3"}, {"componentType", 5126}},
                           {{"count", 12}, {"type", "SCALAR"}, {"componentType", 5123}}};
  glb.add_mesh(0, 1);
  glb.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
  glb.json["nodes"] = {{{"mesh", 0}}};
  return glb.bytes();
}

std::string binary_ply() {
  std::string out =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
  out.append(reinterpret_cast<const char*>(corners().data()), corners().size() * sizeof(float));
  for (const std::array<int32_t, 4>& face : {std::array<int32_t, 4>{0, 1, 2, 3}, std::array<int32_t, 4>{3, 2, 1, 0}}) {
    out += '\4';
    out.append(reinterpret_cast<const char*>(face.data()), sizeof(face));
  }
  return out;
}

constexpr const char* kCity =
    R"({"type":"CityJSON","version":"2.0","transform":{"scale":[0.001,0.001,0.001],"translate":[5e5,5e6,0]},)"
    R"("geometry-templates":{"templates":[{"type":"MultiSurface","lod":"1","boundaries":[[[0,1,2]]]}],)"
    R"("vertices-templates":[[0,0,0],[1,0,0],[0,1,0]]},)"
    R"("appearance":{"materials":[{"name":"m","diffuseColor":[1,0,0]}],"textures":[{"type":"PNG","image":"a.png"}],)"
    R"("vertices-texture":[[0,0],[1,0],[0,1]]},)"
    R"("CityObjects":{"a":{"type":"Building","children":["b"],"geometry":[{"type":"Solid","lod":"2.2",)"
    R"("boundaries":[[[[0,2,1]],[[0,1,3]],[[0,3,2]],[[1,2,3],[4,5,6]]]],"semantics":{"surfaces":[{"type":"RoofSurface"}],)"
    R"("values":[[0,null,0,0]]},"material":{"t":{"values":[[0,null,0,0]]}},)"
    R"("texture":{"t":{"values":[[[[0,0,1,2]],[[null]],[[null]],[[null],[null]]]]}}}]},)"
    R"("b":{"type":"BuildingPart","parents":["a"],"geometry":[{"type":"GeometryInstance","template":0,"boundaries":[1],)"
    R"("transformationMatrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}]}},)"
    R"("vertices":[[0,0,0],[9000,0,0],[0,9000,0],[0,0,9000],[1000,1000,1000],[2000,1000,1000],[1000,2000,1000]]})";

constexpr const char* kSequence =
    R"({"type":"CityJSON","version":"2.0","transform":{"scale":[1,1,1],"translate":[0,0,0]},"CityObjects":{},"vertices":[]})"
    "\n"
    R"({"type":"CityJSONFeature","id":"f","CityObjects":{"f":{"type":"Road","geometry":[{"type":"MultiSurface",)"
    R"("lod":"1","boundaries":[[[0,1,2,3]]]}]}},"vertices":[[0,0,0],[4,0,0],[4,4,0],[1,1,0]]})";

constexpr const char* kObj =
    "o a\nv 0 0 0 1 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nvt 0 0\nvn 0 0 1\nusemtl m\n"
    "f 1/1/1 2/1/1 3/1/1 4//1 5\nf -1 -2 -3\ng b c\nf 1 2 \\\n3\nl 1 2\n";

constexpr const char* kPly =
    "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_indices\n"
    "property list uchar float texcoord\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    "0 0 0 1\n1 0 0 2\n1 1 0 3\n0 1 0 4\n3 0 1 2 6 0 0 1 0 1 1\n4 0 1 2 -1\n";

constexpr const char* kOff = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

constexpr const char* kStl =
    "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid "
    "t\n";

}  // namespace

std::vector<CorpusFile> import_corpus() {
  return {{"features.glb", featured_glb()},
          {"meshopt.glb", meshopt_glb()},
          {"draco.glb", draco_glb()},
          {"city.json", kCity},
          {"sequence.jsonl", kSequence},
          {"text.obj", kObj},
          {"ascii.ply", kPly},
          {"binary.ply", binary_ply()},
          {"text.off", kOff, false},
          {"text.stl", kStl, false}};
}

std::string mutated(std::string bytes, std::mt19937& random) {
  const auto below = [&](size_t n) { return n == 0 ? 0 : size_t(random()) % n; };
  const size_t changes = 1 + below(4);
  for (size_t i = 0; i < changes && !bytes.empty(); ++i) {
    const size_t at = below(bytes.size());
    switch (below(5)) {
      case 0:
        bytes[at] = static_cast<char>(below(256));
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 2:
        bytes.insert(at, bytes.substr(below(bytes.size()), below(16)));
        break;
      case 3:
        bytes.erase(at, 1 + below(8));
        break;
      default: {
        // A number becomes another one: extreme, negative or merely wrong.
        constexpr std::array<const char*, 8> kNumbers{
            "-1", "4294967295", "18446744073709551615", "1e308", "nan", "0", "65536", "7"};
        const size_t digit = bytes.find_first_of("0123456789", at);
        if (digit == std::string::npos) break;
        const size_t end = std::min(bytes.find_first_not_of("0123456789.", digit), bytes.size());
        bytes.replace(digit, end - digit, kNumbers[below(kNumbers.size())]);
      }
    }
  }
  return bytes;
}

}  // namespace promenade
