// Another narrow phase than ours, which a library beside this one may offer.
#pragma once
#include "collision/narrow.h"

namespace pcphys {

struct NarrowHook {
  bool (*f32)(const ShapeView<float>&, const ShapeView<float>&, float, Manifold<float>&) = nullptr;
  bool (*f64)(const ShapeView<double>&, const ShapeView<double>&, double, Manifold<double>&) = nullptr;

  bool operator()(const ShapeView<float>& a, const ShapeView<float>& b, float margin, Manifold<float>& out) const {
    return f32(a, b, margin, out);
  }
  bool operator()(const ShapeView<double>& a, const ShapeView<double>& b, double margin, Manifold<double>& out) const {
    return f64(a, b, margin, out);
  }
  explicit operator bool() const { return f32 && f64; }
};

/// FCL's, empty until `use_fcl` was called.
NarrowHook& fcl_hook();

}  // namespace pcphys
