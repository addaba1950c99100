#include "runtime/gl_functions.h"

#include <fmt/format.h>

#include <cstring>
#include <string_view>

namespace promenade {
namespace {

bool has_extension(const GlFunctions& gl, std::string_view wanted) {
  GLint count = 0;
  gl.get_integerv(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; ++i) {
    const GLubyte* name = gl.get_stringi(GL_EXTENSIONS, static_cast<GLuint>(i));
    if (name != nullptr && wanted == reinterpret_cast<const char*>(name)) return true;
  }
  return false;
}

}  // namespace

Result<GlFunctions> load_gl_functions(GlProc (*get_proc)(const char* name)) {
  GlFunctions gl;
#define PROMENADE_GL_LOAD(member, type, name)         \
  gl.member = reinterpret_cast<type>(get_proc(name)); \
  if (gl.member == nullptr)                           \
    return Error{fmt::format("OpenGL: {} is missing; a driver of version 3.3 or later is needed", name)};
  PROMENADE_GL_FUNCTIONS(PROMENADE_GL_LOAD)
#undef PROMENADE_GL_LOAD
  GLint major = 0, minor = 0;
  gl.get_integerv(GL_MAJOR_VERSION, &major);
  gl.get_integerv(GL_MINOR_VERSION, &minor);
  if (major < 3 || (major == 3 && minor < 3))
    return Error{fmt::format("OpenGL: version {}.{} found, 3.3 or later is needed", major, minor)};
  // A lookup may hand out stubs for functions that the driver does not have: ask the driver, too.
  if (major > 4 || (major == 4 && minor >= 5) || has_extension(gl, "GL_ARB_clip_control"))
    gl.clip_control = reinterpret_cast<PFNGLCLIPCONTROLPROC>(get_proc("glClipControl"));
  gl.anisotropic = (major == 4 && minor >= 6) || has_extension(gl, "GL_EXT_texture_filter_anisotropic") ||
                   has_extension(gl, "GL_ARB_texture_filter_anisotropic");
  return gl;
}

}  // namespace promenade
