// Pins: division and square root on the device are those of the CPU, bit for bit, for more operands than the probe asks
// for: every mantissa of a float's root, millions of quotients, sizes from the easiest to the last that is a normal
// number.
#include <doctest/doctest.h>
#include <epoxy/gl.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "glcompute/context.h"
#include "glcompute/device_probe.h"
#include "glcompute/program.h"
#include "glcompute/program_source.h"
#include "glcompute/source_text.h"

namespace {
using namespace pcphys;

constexpr char body[] = R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) restrict readonly buffer Operands { Real operands[]; };
layout(std430, binding = 1) restrict writeonly buffer Results { Real results[]; };
void main() {
  uint i = gl_GlobalInvocationID.x;
  results[2u * i] = pc_div(operands[2u * i], operands[2u * i + 1u]);
  results[2u * i + 1u] = pc_sqrt(abs(operands[2u * i]));
}
)";

/// Divides and takes roots on the device, in the forms that its probe chose.
template <class Real> class Device {
 public:
  static constexpr std::size_t most = std::size_t{1} << 20;
  Device() {
    Result<std::unique_ptr<GlContext>> made = GlContext::open(-1);
    if (!made)
      FAIL("This test needs OpenGL 4.3 (scripts/install-dependencies brings llvmpipe): " << made.error().message);
    context_ = std::move(*made);
    REQUIRE(bool(context_->enter()));
    const ProgramCache cache(context_->identity());
    SourceOptions options;
    options.precision = sizeof(Real) == 8 ? Precision::f64 : Precision::f32;
    const Result<GlArithmetic> found = probe_arithmetic(options.precision, cache);
    REQUIRE(bool(found));
    options.division = found->division, options.square_root = found->square_root;
    SourceText text(options.precision);
    text.add(source_head(options));
    REQUIRE(bool(text.include("prelude.glsl")));
    text.add(body);
    const Result<std::uint32_t> program = link_program(text.take(), "exact", cache);
    if (!program) FAIL(program.error().message);
    program_ = *program;
    glGenBuffers(2, buffers_);
    for (const GLuint buffer : buffers_) {
      glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffer);
      glBufferData(GL_SHADER_STORAGE_BUFFER, GLsizeiptr(2 * most * sizeof(Real)), nullptr, GL_DYNAMIC_COPY);
    }
  }
  ~Device() {
    glDeleteBuffers(2, buffers_);
    glDeleteProgram(program_);
    context_->leave();
  }
  /// How many of the quotients x[2 i] / x[2 i + 1] and roots of |x[2 i]| are not those of the CPU; `x` has 2 `most`
  /// numbers.
  long wrong(const std::vector<Real>& x) {
    results_.resize(2 * most);
    const GLsizeiptr bytes = GLsizeiptr(2 * most * sizeof(Real));
    for (GLuint i = 0; i < 2; i++) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, i, buffers_[i]);
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffers_[0]);
    glBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, bytes, x.data());
    glUseProgram(program_);
    glDispatchCompute(GLuint(most / 64), 1, 1);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffers_[1]);
    glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, bytes, results_.data());
    glFinish();
    long count = 0;
    for (std::size_t i = 0; i < most; i++)
      count += results_[2 * i] != x[2 * i] / x[2 * i + 1] || results_[2 * i + 1] != std::sqrt(std::fabs(x[2 * i]));
    return count;
  }

 private:
  std::unique_ptr<GlContext> context_;
  std::uint32_t program_ = 0;
  GLuint buffers_[2] = {};
  std::vector<Real> results_;
};

/// Operands with exponents up to `range` and quotients that are normal numbers.
template <class Real> void draw(std::mt19937_64& random, int range, std::vector<Real>& x) {
  std::uniform_real_distribution<double> mantissa(1, 2);
  std::uniform_int_distribution<int> exponent(-range, range);
  x.resize(2 * Device<Real>::most);
  for (std::size_t i = 0; i < x.size(); i += 2) {
    int a = exponent(random), b = exponent(random);
    while (std::abs(a - b) > std::numeric_limits<Real>::max_exponent - 4) b = exponent(random);
    x[i] = std::ldexp(Real(mantissa(random)), a) * (random() & 1 ? 1 : -1);
    x[i + 1] = std::ldexp(Real(mantissa(random)), b) * (random() & 1 ? 1 : -1);
  }
}

template <class Real> long wrong_in(int pieces) {
  Device<Real> device;
  std::mt19937_64 random(1);
  std::vector<Real> x;
  long wrong = 0;
  for (const int range : {2, 40, std::numeric_limits<Real>::max_exponent - 4})
    for (int i = 0; i < pieces; i++) {
      draw(random, range, x);
      wrong += device.wrong(x);
    }
  return wrong;
}
}  // namespace

TEST_CASE("on the device: quotients and roots of all sizes are exact") {
  CHECK(wrong_in<float>(2) == 0);
  CHECK(wrong_in<double>(1) == 0);
}

TEST_CASE("on the device: the root of every float mantissa is exact") {
  Device<float> device;
  std::vector<float> x(2 * device.most);
  long wrong = 0;
  std::uint32_t bits = 0x3f800000u;
  for (const std::uint32_t end = 0x40800000u; bits < end; bits += std::uint32_t(device.most)) {
    for (std::uint32_t i = 0; i < device.most; i++) {
      const std::uint32_t next = bits + i;
      std::memcpy(&x[2 * i], &next, 4);
      x[2 * i + 1] = x[2 * ((i * 7919u) % (i + 1))];
    }
    wrong += device.wrong(x);
  }
  CHECK(wrong == 0);
}
