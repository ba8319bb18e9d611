// The EGL devices and displays of this machine. `epoxy_has_egl()` must hold.
#pragma once
#include <vector>

namespace pcphys {

std::vector<void*> egl_devices();        // EGLDeviceEXT
void* egl_device_display(void* device);  // EGLDisplay, not initialised; null when there is none
void* egl_surfaceless_display();

}  // namespace pcphys
