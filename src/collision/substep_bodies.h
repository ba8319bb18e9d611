// What a sub-step reads of bodies: where they are, how they move, and how far they have come since the step began.
#pragma once
#include <algorithm>
#include <cmath>

#include "collision/meeting.h"
#include "collision/standing.h"
#include "collision/view.h"

namespace pcphys {

template <class Scalar> class Bodies {
 public:
  explicit Bodies(const Tables& t)
      : poses_(t),
        motion_(t.data<Scalar>(Buffer::motion)),
        mass_(t.data<Scalar>(Buffer::mass)),
        delta_(t.data<Scalar>(Buffer::delta)) {}

  const Scalar* motion(std::uint32_t row) const { return motion_ + row * reals_of(Buffer::motion); }
  /// `lever`: how far a turn of one radian moves any point of its shapes, at most.
  Way way(std::uint32_t row, float lever, double h) const {
    const Scalar *d = delta_ + row * reals_of(Buffer::delta), *m = motion(row),
                 *inverse = mass_ + row * reals_of(Buffer::mass) + 4;
    const auto size = [](const Scalar* v) {
      return std::sqrt(float(v[0]) * float(v[0]) + float(v[1]) * float(v[1]) + float(v[2]) * float(v[2]));
    };
    const float most = float(std::max({inverse[0], inverse[1], inverse[2]}));
    constexpr float up = 1.00001f;  // beyond the rounding of all this
    return {up * (size(d) + size(d + 4) * lever), up * (size(m) + size(m + 4) * most * lever) * float(h), 0};
  }

  const BodyReader<Scalar>& poses() const { return poses_; }
  Moved moved(std::uint32_t a, std::uint32_t b) const {
    const Scalar *x = delta_ + a * reals_of(Buffer::delta), *y = delta_ + b * reals_of(Buffer::delta);
    Moved m;
    for (int k = 0; k < 3; k++) {
      m.apart[std::size_t(k)] = double(y[k]) - double(x[k]);
      m.turned_a[std::size_t(k)] = double(x[4 + k]);
      m.turned_b[std::size_t(k)] = double(y[4 + k]);
    }
    return m;
  }
  TwistOf<Scalar> twist(std::uint32_t row) const {
    const Scalar *motion = motion_ + row * reals_of(Buffer::motion),
                 *inverse = mass_ + row * reals_of(Buffer::mass) + 4;
    const Scalar* q = poses_.orientation(row);
    TwistOf<Scalar> t;
    const Scalar back[4] = {-q[0], -q[1], -q[2], q[3]};
    Scalar l[3];
    rotate_by(back, motion + 4, l);
    for (int k = 0; k < 3; k++) l[k] *= inverse[k];
    rotate_by(q, l, t.w);
    Scalar speed = 0, turn = 0;
    for (int k = 0; k < 3; k++) t.v[k] = motion[k], speed += motion[k] * motion[k], turn += l[k] * l[k];
    t.speed = std::sqrt(speed);
    t.turn = std::sqrt(turn);
    t.across = std::sqrt(l[0] * l[0] + l[2] * l[2]);
    return t;
  }

 private:
  BodyReader<Scalar> poses_;
  const Scalar *motion_, *mass_, *delta_;
};

}  // namespace pcphys
