#include "glcompute/egl_devices.h"

#include <epoxy/egl.h>

namespace pcphys {
namespace {

bool client_extension(const char* name) { return epoxy_has_egl_extension(EGL_NO_DISPLAY, name); }

void* platform_display(EGLenum platform, void* native) {
  if (!client_extension("EGL_EXT_platform_base")) return EGL_NO_DISPLAY;
  return eglGetPlatformDisplayEXT(platform, native, nullptr);
}

}  // namespace

std::vector<void*> egl_devices() {
  if (!client_extension("EGL_EXT_device_base") && !client_extension("EGL_EXT_device_enumeration")) return {};
  EGLint count = 0;
  if (!eglQueryDevicesEXT(0, nullptr, &count) || count <= 0) return {};
  std::vector<void*> devices(static_cast<std::size_t>(count));
  if (!eglQueryDevicesEXT(count, devices.data(), &count)) return {};
  devices.resize(static_cast<std::size_t>(count));
  return devices;
}

void* egl_device_display(void* device) {
  return client_extension("EGL_EXT_platform_device") ? platform_display(EGL_PLATFORM_DEVICE_EXT, device)
                                                     : EGL_NO_DISPLAY;
}

void* egl_surfaceless_display() {
  return client_extension("EGL_MESA_platform_surfaceless")
             ? platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY)
             : EGL_NO_DISPLAY;
}

}  // namespace pcphys
