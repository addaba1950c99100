#include "runtime/osmesa_context.h"

#include <array>

#include "runtime/gl_functions.h"

// After glcorearb.h: the old gl.h that osmesa.h brings hides its types when it comes first.
#include <GL/osmesa.h>

namespace promenade {
namespace {

class OsmesaContext final : public GlContext {
 public:
  explicit OsmesaContext(OSMesaContext context) : context_(context) {}
  OsmesaContext(const OsmesaContext&) = delete;
  OsmesaContext& operator=(const OsmesaContext&) = delete;
  ~OsmesaContext() override {
    OSMesaMakeCurrent(nullptr, nullptr, 0, 0, 0);
    OSMesaDestroyContext(context_);
  }

  Status make_current() override {
    if (OSMesaMakeCurrent(context_, pixels_.data(), GL_UNSIGNED_BYTE, kSide, kSide) != GL_TRUE)
      return Error{"OSMesa: the context cannot be made current"};
    return Done{};
  }
  Status load() {
    Result<GlFunctions> loaded = load_gl_functions([](const char* name) { return GlProc(OSMesaGetProcAddress(name)); });
    if (!loaded) return loaded.error();
    functions_ = *loaded;
    return Done{};
  }
  const GlFunctions& functions() const override { return functions_; }
  std::string_view kind() const override { return "osmesa"; }

 private:
  // Pictures are drawn into framebuffer objects; this one only has to be there.
  static constexpr int kSide = 16;
  OSMesaContext context_;
  GlFunctions functions_;
  std::array<GLubyte, size_t{4} * kSide * kSide> pixels_{};
};

}  // namespace

Result<std::unique_ptr<GlContext>> create_osmesa_context() {
  static constexpr int kAttributes[] = {OSMESA_FORMAT,
                                        OSMESA_RGBA,
                                        OSMESA_DEPTH_BITS,
                                        0,
                                        OSMESA_PROFILE,
                                        OSMESA_CORE_PROFILE,
                                        OSMESA_CONTEXT_MAJOR_VERSION,
                                        3,
                                        OSMESA_CONTEXT_MINOR_VERSION,
                                        3,
                                        0};
  const OSMesaContext raw = OSMesaCreateContextAttribs(kAttributes, nullptr);
  if (raw == nullptr) return Error{"OSMesa: no OpenGL 3.3 core context; is libosmesa6 of Mesa 17 or later installed?"};
  auto context = std::make_unique<OsmesaContext>(raw);
  PROMENADE_TRY(context->make_current());
  PROMENADE_TRY(context->load());
  return std::unique_ptr<GlContext>(std::move(context));
}

}  // namespace promenade
