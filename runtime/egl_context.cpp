#include "runtime/egl_context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <string_view>

#include "runtime/gl_functions.h"

namespace promenade {
namespace {

/// What we call of libEGL.
struct Egl {
  decltype(&eglGetProcAddress) get_proc_address = nullptr;
  decltype(&eglInitialize) initialize = nullptr;
  decltype(&eglTerminate) terminate = nullptr;
  decltype(&eglBindAPI) bind_api = nullptr;
  decltype(&eglChooseConfig) choose_config = nullptr;
  decltype(&eglCreateContext) create_context = nullptr;
  decltype(&eglDestroyContext) destroy_context = nullptr;
  decltype(&eglMakeCurrent) make_current = nullptr;
  PFNEGLQUERYDEVICESEXTPROC query_devices = nullptr;
  PFNEGLQUERYDEVICESTRINGEXTPROC query_device_string = nullptr;
  PFNEGLGETPLATFORMDISPLAYEXTPROC get_platform_display = nullptr;
};

/// Opened once and never closed: drivers do not survive being unloaded.
const Egl* open_egl() {
  static const Egl egl = [] {
    Egl e;
    void* library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) return e;
    const auto symbol = [library](auto& target, const char* name) {
      target = reinterpret_cast<std::remove_reference_t<decltype(target)>>(dlsym(library, name));
      return target != nullptr;
    };
    const bool whole = symbol(e.initialize, "eglInitialize") && symbol(e.terminate, "eglTerminate") &&
                       symbol(e.bind_api, "eglBindAPI") && symbol(e.choose_config, "eglChooseConfig") &&
                       symbol(e.create_context, "eglCreateContext") && symbol(e.destroy_context, "eglDestroyContext") &&
                       symbol(e.make_current, "eglMakeCurrent") && symbol(e.get_proc_address, "eglGetProcAddress");
    if (!whole) return Egl{};
    const auto extension = [&e](auto& target, const char* name) {
      target = reinterpret_cast<std::remove_reference_t<decltype(target)>>(e.get_proc_address(name));
    };
    extension(e.query_devices, "eglQueryDevicesEXT");
    extension(e.query_device_string, "eglQueryDeviceStringEXT");
    extension(e.get_platform_display, "eglGetPlatformDisplayEXT");
    return e;
  }();
  return egl.query_devices != nullptr && egl.get_platform_display != nullptr ? &egl : nullptr;
}

class EglContext final : public GlContext {
 public:
  EglContext(const Egl& egl, EGLDisplay display, EGLContext context)
      : egl_(egl), display_(display), context_(context) {}
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;
  ~EglContext() override {
    egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    egl_.destroy_context(display_, context_);
    egl_.terminate(display_);
  }
  Status make_current() override {
    if (egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE)
      return Error{"EGL: the context cannot be made current without a surface"};
    return Done{};
  }
  Status load() {
    Result<GlFunctions> loaded =
        load_gl_functions([](const char* name) { return GlProc(open_egl()->get_proc_address(name)); });
    if (!loaded) return loaded.error();
    functions_ = *loaded;
    return Done{};
  }
  const GlFunctions& functions() const override { return functions_; }
  std::string_view kind() const override { return "egl"; }

 private:
  const Egl& egl_;
  EGLDisplay display_;
  EGLContext context_;
  GlFunctions functions_;
};

bool is_software(const Egl& egl, EGLDeviceEXT device) {
  if (egl.query_device_string == nullptr) return false;
  const char* extensions = egl.query_device_string(device, EGL_EXTENSIONS);
  return extensions != nullptr &&
         std::string_view(extensions).find("EGL_MESA_device_software") != std::string_view::npos;
}

Result<std::unique_ptr<GlContext>> context_on(const Egl& egl, EGLDeviceEXT device) {
  const EGLDisplay display = egl.get_platform_display(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
  if (display == EGL_NO_DISPLAY || egl.initialize(display, nullptr, nullptr) != EGL_TRUE)
    return Error{"EGL: a device cannot be initialised"};
  static constexpr EGLint kConfig[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  static constexpr EGLint kContext[] = {
      EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  EGLContext raw = EGL_NO_CONTEXT;
  if (egl.bind_api(EGL_OPENGL_API) == EGL_TRUE && egl.choose_config(display, kConfig, &config, 1, &count) == EGL_TRUE &&
      count > 0)
    raw = egl.create_context(display, config, EGL_NO_CONTEXT, kContext);
  if (raw == EGL_NO_CONTEXT) {
    egl.terminate(display);
    return Error{"EGL: a device gives no OpenGL 3.3 core context"};
  }
  auto context = std::make_unique<EglContext>(egl, display, raw);
  PROMENADE_TRY(context->make_current());
  PROMENADE_TRY(context->load());
  return std::unique_ptr<GlContext>(std::move(context));
}

}  // namespace

Result<std::unique_ptr<GlContext>> create_egl_context(bool hardware_only) {
  const Egl* egl = open_egl();
  if (egl == nullptr) return Error{"EGL: libEGL.so.1 with device enumeration is not installed (libegl1)"};
  std::array<EGLDeviceEXT, 16> devices{};
  EGLint count = 0;
  if (egl->query_devices(static_cast<EGLint>(devices.size()), devices.data(), &count) != EGL_TRUE) count = 0;
  Error last{hardware_only ? "EGL: no hardware device" : "EGL: no device"};
  // Hardware first, software after.
  for (const bool software : {false, true}) {
    if (software && hardware_only) break;
    for (EGLint i = 0; i < count; ++i) {
      const EGLDeviceEXT device = devices[static_cast<size_t>(i)];
      if (is_software(*egl, device) != software) continue;
      Result<std::unique_ptr<GlContext>> context = context_on(*egl, device);
      if (context) return context;
      last = context.error();
    }
  }
  return last;
}

}  // namespace promenade
