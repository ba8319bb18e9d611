// lint: allow-file (computes the correctly rounded results that a device's are compared with)
#include "glcompute/device_probe.h"

#include <epoxy/gl.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "glcompute/program.h"

namespace pcphys {
namespace {

template <class Real> struct Operands { Real x, y, z, unused; };
/// As probe.glsl writes them; arrays by form: built-in, fma, nearest.
template <class Real> struct Results {
  Real division[3], sum;
  Real square_root[3], residual;
  Real reciprocal[3], product;
  Real total, unused[3];
};

/// xorshift64*: the same operands everywhere.
class Random {
 public:
  double unit() { return double(next() >> 11) * 0x1p-53; }
  double mantissa() { return 1.0 + unit(); }
  int exponent(int range) { return int(next() % std::uint64_t(2 * range + 1)) - range; }

 private:
  std::uint64_t next() {
    state_ ^= state_ >> 12;
    state_ ^= state_ << 25;
    state_ ^= state_ >> 27;
    return state_ * 0x2545f4914f6cdd1du;
  }
  std::uint64_t state_ = 0x9e3779b97f4a7c15u;
};

template <class Real> class Trial {
 public:
  Trial() {
    powers();
    hard_divisors();
    near_ties();
    ordinary();
    tame_ = operands_.size();
    wide();
    subnormals();
    results_.resize(operands_.size());
  }

  const std::vector<Operands<Real>>& operands() const { return operands_; }
  std::vector<Results<Real>>& results() { return results_; }
  GlArithmetic judge() const;

 private:
  static constexpr Real ulp = std::numeric_limits<Real>::epsilon();
  static constexpr int tame_exponent = std::numeric_limits<Real>::max_exponent / 4;

  void add(Real x, Real y) { add(x, y, -(x * y)); }  // a contracted x y + z would not be zero
  void add(Real x, Real y, Real z) { operands_.push_back({x, y, z, Real(0)}); }
  void powers();
  void hard_divisors();
  void near_ties();
  void ordinary();
  void wide();
  void subnormals();
  static void rule_out(bool (&exact)[3], const Real (&found)[3], Real expected);
  static RoundingForm first(const bool (&exact)[3]);

  Random random_;
  std::vector<Operands<Real>> operands_;
  std::vector<Results<Real>> results_;
  std::size_t tame_ = 0;
};

/// Beside powers of two, hence of four: square roots are near ties there, and unit quaternions hit them always.
template <class Real> void Trial<Real>::powers() {
  for (const int exponent : {-24, -2, -1, 0, 1, 2, 24}) {
    const Real power = std::ldexp(Real(1), exponent);
    Real above = power, below = power;
    for (int i = 0; i < 48; i++) {
      add(above, below);
      add(below, above);
      above = std::nextafter(above, power * 2);
      below = std::nextafter(below, Real(0));
    }
  }
}

/// Divisors just below a power of two defeat a corrected reciprocal; small integers are what kernels divide by.
template <class Real> void Trial<Real>::hard_divisors() {
  const Real divisors[] = {
      1 - ulp / 2, 2 - ulp, 1 + ulp, 1 + 2 * ulp, Real(1.5) - ulp, Real(1.5) + ulp, 3, 5, 7, 10, 11, 13,
      49,          60,      100,     240};
  for (const Real divisor : divisors)
    for (int i = 0; i < 48; i++) {
      add(1 + Real(i) * ulp, divisor);
      add(2 - Real(i) * ulp, divisor);
    }
}

/// Quotients and roots that lie close to the middle between two numbers.
template <class Real> void Trial<Real>::near_ties() {
  for (int i = 0; i < 1024; i++) {
    const long double middle = (long double)Real(random_.mantissa()) + (long double)ulp / 2;
    const Real y = Real(random_.mantissa());
    add(Real(middle * y), y);
    add(Real(middle * middle), y);
    add(Real(middle * middle) * 2, Real(middle * y));
  }
}

template <class Real> void Trial<Real>::ordinary() {
  for (int i = 0; i < 2048; i++) {
    const Real x = std::ldexp(Real(random_.mantissa()), random_.exponent(tame_exponent)) * (i & 1 ? 1 : -1);
    const Real y = std::ldexp(Real(random_.mantissa()), random_.exponent(20)) * (i & 2 ? 1 : -1);
    add(x, y);
    add(x, y, x * y * Real(random_.unit()));
  }
}

/// Far out, where a careless correction under- or overflows.
template <class Real> void Trial<Real>::wide() {
  const int range = std::numeric_limits<Real>::max_exponent - 4;
  for (int i = 0; i < 1024; i++) {
    const int a = random_.exponent(range), b = random_.exponent(range);
    if (std::abs(a - b) < range)
      add(std::ldexp(Real(random_.mantissa()), a), std::ldexp(Real(random_.mantissa()), b), Real(0));
  }
}

/// Product, then sum, of numbers that meet below the normal range.
template <class Real> void Trial<Real>::subnormals() {
  const Real smallest = std::numeric_limits<Real>::min();
  add(smallest * Real(1.5), Real(0.5), Real(0));
  Real below;  // made from its bits: arithmetic may run with subnormals flushed
  std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t> bits = 3u << 10;
  std::memcpy(&below, &bits, sizeof below);
  add(below, below, Real(0));
}

template <class Real> void Trial<Real>::rule_out(bool (&exact)[3], const Real (&found)[3], Real expected) {
  for (int form = 0; form < 3; form++) exact[form] = exact[form] && found[form] == expected;
}

template <class Real> RoundingForm Trial<Real>::first(const bool (&exact)[3]) {
  for (int form = 0; form < 3; form++)
    if (exact[form]) return RoundingForm(form);
  return RoundingForm::none;
}

template <class Real> GlArithmetic Trial<Real>::judge() const {
  bool division[3] = {true, true, true}, root[3] = {true, true, true};
  GlArithmetic found;
  found.supported = found.two_roundings = found.fma_fused = true;
  const std::size_t normal = operands_.size() - 2;
  for (std::size_t i = 0; i < normal; i++) {
    const Operands<Real>& o = operands_[i];
    const Results<Real>& r = results_[i];
    rule_out(division, r.division, o.x / o.y);
    rule_out(division, r.reciprocal, Real(1) / o.y);
    rule_out(root, r.square_root, std::sqrt(std::fabs(o.x)));
    if (i >= tame_) continue;
    const volatile Real product = o.x * o.y;
    found.two_roundings = found.two_roundings && r.product == product && r.sum == product + o.z && r.total == o.x + o.y;
    found.fma_fused = found.fma_fused && r.residual == std::fma(o.x, o.y, -product);
  }
  found.division = first(division);
  found.square_root = first(root);
  found.subnormals_kept = results_[normal].product != 0 && results_[normal + 1].total != 0;
  return found;
}

template <class Real> Result<GlArithmetic> probe(const ProgramSource& source, const ProgramCache& cache) {
  const Result<std::uint32_t> program = link_program(source, "probe", cache);
  if (!program) return program.error();
  Trial<Real> trial;
  GLuint buffers[2];
  glGenBuffers(2, buffers);
  const auto place = [&](GLuint binding, std::size_t bytes, const void* data) {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffers[binding]);
    glBufferData(GL_SHADER_STORAGE_BUFFER, GLsizeiptr(bytes), data, GL_STREAM_COPY);
  };
  const std::size_t bytes = trial.results().size() * sizeof(Results<Real>);
  place(0, trial.operands().size() * sizeof(Operands<Real>), trial.operands().data());
  place(1, bytes, nullptr);
  glUseProgram(*program);
  glUniform1ui(glGetUniformLocation(*program, "count"), GLuint(trial.operands().size()));
  glDispatchCompute(GLuint(trial.operands().size() + 63) / 64, 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, GLsizeiptr(bytes), trial.results().data());
  glDeleteBuffers(2, buffers);
  glUseProgram(0);
  glDeleteProgram(*program);
  if (glGetError() != GL_NO_ERROR) return Error{ErrorCode::device_error, "The device probe met a GL error."};
  return trial.judge();
}

}  // namespace

Result<GlArithmetic> probe_arithmetic(Precision precision, const ProgramCache& cache) {
  const Result<ProgramSource> source = probe_source(precision);
  if (!source) return source.error();
  const std::string key = "arithmetic\n" + source->text;
  GlArithmetic found;
  if (const auto bytes = cache.load(key); bytes && bytes->size() == sizeof found) {
    std::memcpy(&found, bytes->data(), sizeof found);
    return found;
  }
  const Result<GlArithmetic> probed =
      precision == Precision::f64 ? probe<double>(*source, cache) : probe<float>(*source, cache);
  if (!probed) return probed;
  const char* bytes = reinterpret_cast<const char*>(&*probed);
  cache.store(key, std::vector<char>(bytes, bytes + sizeof found));
  return probed;
}

}  // namespace pcphys
