// What `pcphys doctor` tells about GL.
#include <epoxy/egl.h>

#include "glcompute/context.h"
#include "glcompute/device_probe.h"
#include "glcompute/egl_devices.h"

namespace pcphys {

GlReport probe_gl(int device) {
  GlReport report;
  const Result<std::unique_ptr<GlContext>> context = GlContext::open(device);
  if (!context) {
    report.device = device;
    report.problem = context.error().message;
    report.package = epoxy_has_egl() ? "libgl1-mesa-dri" : "libegl1";
    return report;
  }
  report = (*context)->report();
  GlScope scope(**context);
  const ProgramCache cache((*context)->identity());
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const Result<GlArithmetic> found =
        scope.status() ? probe_arithmetic(precision, cache) : Result<GlArithmetic>(scope.status().error());
    if (found)
      (precision == Precision::f64 ? report.f64 : report.f32) = *found;
    else if (precision == Precision::f32)
      report.problem = found.error().message;
  }
  report.usable = report.f32.supported;
  return report;
}

std::vector<GlDevice> gl_devices() {
  std::vector<GlDevice> devices;
  if (!epoxy_has_egl()) return devices;
  const std::size_t count = egl_devices().size();
  for (std::size_t i = 0; i < count; i++) {
    const Result<std::unique_ptr<GlContext>> context = GlContext::open(int(i));
    if (context)
      devices.push_back({int(i), true, (*context)->report().software, (*context)->report().renderer});
    else
      devices.push_back({int(i), false, false, context.error().message});
  }
  return devices;
}

}  // namespace pcphys
