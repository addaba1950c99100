#include "runtime/gl_shaders.h"

#include <fmt/format.h>

#include <array>
#include <string>

namespace promenade {
namespace {

constexpr const char* kSurfaceVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal;
layout(location = 2) in vec4 color;
layout(location = 3) in vec2 texcoord;
uniform mat4 clip_from_mesh;
uniform mat4 eye_from_mesh;           // axes of model space, origin at the eye
uniform mat3 model_from_mesh_normal;  // inverse transpose
uniform int has_colors;
out vec3 from_eye;
out vec3 model_normal;
out vec4 tint;
out vec2 uv;
vec3 linear(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045))); }
void main() {
  gl_Position = clip_from_mesh * vec4(position, 1.0);
  from_eye = (eye_from_mesh * vec4(position, 1.0)).xyz;
  model_normal = model_from_mesh_normal * normal.xyz;
  tint = has_colors != 0 ? vec4(linear(color.rgb), color.a) : vec4(1.0);
  uv = texcoord;
}
)";

constexpr const char* kSurfaceFragment = R"(
in vec3 from_eye;
in vec3 model_normal;
in vec4 tint;
in vec2 uv;
uniform vec4 base_color;  // linear
uniform float alpha_cutoff;
uniform sampler2D picture;
uniform int has_normals;
uniform int opaque;
uniform uint node;
uniform vec2 fade;
uniform vec3 to_sun, sun, sky_ambient, ground_ambient;
#ifdef IDS
out uint result;
#else
out vec4 result;
#endif

vec3 facing_normal() {
  if (has_normals != 0 && dot(model_normal, model_normal) > 0.0) {  // 0: the triangle's own
    vec3 n = normalize(model_normal);
    return gl_FrontFacing ? n : -n;
  }
  vec3 n = normalize(cross(dFdx(from_eye), dFdy(from_eye)));
  return dot(n, from_eye) < 0.0 ? n : -n;
}

#ifdef FADING
// In (0, 1), each of 64 values once in 8 x 8 pixels, near ones far apart: the bits of x ^ y and y, turned around.
float door_threshold() {
  ivec2 at = ivec2(gl_FragCoord.xy) & 7;
  int x = at.x ^ at.y, y = at.y;
  int rank = (x & 1) << 5 | (y & 1) << 4 | (x & 2) << 2 | (y & 2) << 1 | (x & 4) >> 1 | (y & 4) >> 2;
  return (float(rank) + 0.5) / 64.0;
}
#endif

void main() {
#ifdef FADING
  float threshold = door_threshold();
  if (threshold < fade.x || threshold >= fade.y) discard;
#endif
  vec4 albedo = base_color * tint;
#ifdef TEXTURED
  albedo *= texture(picture, uv);
#endif
#ifdef MASKED
  if (albedo.a < alpha_cutoff) discard;
#endif
#ifdef IDS
  result = node;
#else
  vec3 n = facing_normal();
  vec3 light = sun * max(dot(n, to_sun), 0.0) + mix(ground_ambient, sky_ambient, 0.5 + 0.5 * n.z);
  result = vec4(albedo.rgb * light, opaque != 0 ? 1.0 : albedo.a);
#endif
}
)";

constexpr const char* kSkyVertex = R"(
uniform vec3 forward, right, up;
uniform float depth;
out vec3 direction;
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  direction = forward + corner.x * right + corner.y * up;
  gl_Position = vec4(corner, depth, 1.0);
}
)";

constexpr const char* kSkyFragment = R"(
in vec3 direction;
uniform vec3 zenith, horizon, below;
out vec4 result;
void main() {
  float z = normalize(direction).z;
  result = vec4(z > 0.0 ? mix(horizon, zenith, sqrt(z)) : mix(horizon, below, min(1.0, -8.0 * z)), 1.0);
}
)";

Result<GLuint> compile(const GlFunctions& gl, GLenum stage, const std::string& source) {
  const GLuint shader = gl.create_shader(stage);
  const char* text = source.c_str();
  gl.shader_source(shader, 1, &text, nullptr);
  gl.compile_shader(shader);
  GLint done = GL_FALSE;
  gl.get_shaderiv(shader, GL_COMPILE_STATUS, &done);
  if (done == GL_TRUE) return shader;
  std::array<char, 1024> log{};
  gl.get_shader_info_log(shader, static_cast<GLsizei>(log.size() - 1), nullptr, log.data());
  gl.delete_shader(shader);
  return Error{fmt::format("OpenGL: the driver refuses a shader: {}", log.data())};
}

Result<GLuint> link(const GlFunctions& gl, const std::string& vertex, const std::string& fragment) {
  const Result<GLuint> vs = compile(gl, GL_VERTEX_SHADER, vertex);
  if (!vs) return vs.error();
  const Result<GLuint> fs = compile(gl, GL_FRAGMENT_SHADER, fragment);
  if (!fs) {
    gl.delete_shader(*vs);
    return fs.error();
  }
  const GLuint program = gl.create_program();
  gl.attach_shader(program, *vs);
  gl.attach_shader(program, *fs);
  gl.bind_frag_data_location(program, 0, "result");
  gl.link_program(program);
  gl.delete_shader(*vs);
  gl.delete_shader(*fs);
  GLint done = GL_FALSE;
  gl.get_programiv(program, GL_LINK_STATUS, &done);
  if (done == GL_TRUE) return program;
  std::array<char, 1024> log{};
  gl.get_program_info_log(program, static_cast<GLsizei>(log.size() - 1), nullptr, log.data());
  gl.delete_program(program);
  return Error{fmt::format("OpenGL: the driver refuses a program: {}", log.data())};
}

GlProgram located(const GlFunctions& gl, GLuint id) {
  const auto at = [&](const char* name) { return gl.get_uniform_location(id, name); };
  GlProgram p;
  p.id = id;
  p.clip_from_mesh = at("clip_from_mesh");
  p.eye_from_mesh = at("eye_from_mesh");
  p.model_from_mesh_normal = at("model_from_mesh_normal");
  p.has_normals = at("has_normals");
  p.has_colors = at("has_colors");
  p.base_color = at("base_color");
  p.alpha_cutoff = at("alpha_cutoff");
  p.opaque = at("opaque");
  p.picture = at("picture");
  p.node = at("node");
  p.fade = at("fade");
  p.to_sun = at("to_sun");
  p.sun = at("sun");
  p.sky_ambient = at("sky_ambient");
  p.ground_ambient = at("ground_ambient");
  p.forward = at("forward");
  p.right = at("right");
  p.up = at("up");
  p.zenith = at("zenith");
  p.horizon = at("horizon");
  p.below = at("below");
  p.depth = at("depth");
  return p;
}

Result<GlProgram> build(const GlFunctions& gl, const std::string& vertex, const std::string& fragment) {
  const Result<GLuint> id = link(gl, vertex, fragment);
  if (!id) return id.error();
  return located(gl, *id);
}

}  // namespace

Result<GlProgram> build_surface_program(const GlFunctions& gl, const SurfaceVariant& variant) {
  const std::string head = fmt::format("#version 330 core\n{}{}{}{}", variant.fading ? "#define FADING\n" : "",
                                       variant.textured ? "#define TEXTURED\n" : "",
                                       variant.masked ? "#define MASKED\n" : "", variant.ids ? "#define IDS\n" : "");
  return build(gl, head + kSurfaceVertex, head + kSurfaceFragment);
}

Result<GlProgram> build_sky_program(const GlFunctions& gl) {
  const std::string head = "#version 330 core\n";
  return build(gl, head + kSkyVertex, head + kSkyFragment);
}

}  // namespace promenade
