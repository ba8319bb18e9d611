// Pins the GL side below the kernels: contexts and their errors, programs in every form, the layout check,
// the cache that may never be a reason to fail, and a host's bindings that are found again.
#include <doctest/doctest.h>
#include <epoxy/gl.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "gl_parity.h"
#include "glcompute/context.h"
#include "glcompute/device_probe.h"
#include "glcompute/program.h"
#include "pcphys/device.h"

namespace {
using namespace pcphys;
constexpr Precision precisions[] = {Precision::f32, Precision::f64};

std::unique_ptr<GlContext> require_context() {
  Result<std::unique_ptr<GlContext>> made = GlContext::open(-1);
  if (!made)
    FAIL("This test needs OpenGL 4.3 (scripts/install-dependencies brings llvmpipe): " << made.error().message);
  return std::move(*made);
}

/// A cache folder of the process's own, gone with the test: others may run beside it.
class TemporaryCache {
 public:
  TemporaryCache() : folder_(std::filesystem::temp_directory_path() / ("pcphys-gl-test-" + std::to_string(getpid()))) {
    if (const char* before = std::getenv("PCPHYS_CACHE")) before_ = before, had_ = true;
    std::filesystem::remove_all(folder_);
    setenv("PCPHYS_CACHE", folder_.c_str(), 1);
  }
  ~TemporaryCache() {
    if (had_)
      setenv("PCPHYS_CACHE", before_.c_str(), 1);
    else
      unsetenv("PCPHYS_CACHE");
    std::filesystem::remove_all(folder_);
  }
  const std::filesystem::path& folder() const { return folder_; }
  std::vector<std::filesystem::path> files() const {
    std::vector<std::filesystem::path> all;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) all.push_back(entry.path());
    return all;
  }

 private:
  std::filesystem::path folder_;
  std::string before_;
  bool had_ = false;
};

std::string text_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Runs the body kernel `remember` on four bodies; true when it did what it should.
bool remember_works(Backend& gl) {
  std::vector<std::uint32_t> bodies = {1, 3};
  constexpr std::size_t moves = reals_of(Buffer::motion), parts_each = reals_of(Buffer::velocity_parts);
  std::vector<float> motion(4 * moves), parts(4 * parts_each, -1.0f);
  for (std::size_t i = 0; i < motion.size(); i++) motion[i] = float(i);
  const InfoOf<float> info;
  const Range all{0, 2};
  parity::require(gl.attach(Buffer::bodies, bodies.data(), bodies.size() * 4));
  parity::require(gl.attach(Buffer::motion, motion.data(), motion.size() * 4));
  parity::require(gl.attach(Buffer::velocity_parts, parts.data(), parts.size() * 4));
  for (const Buffer buffer : {Buffer::bodies, Buffer::motion, Buffer::velocity_parts})
    parity::require(gl.upload(buffer));
  parity::require(gl.set_infos(&info, 1));
  const KernelRun run{Kernel::remember, false, 0, gl.width(), {&all, 1}};
  parity::require(gl.run({&run, 1}));
  parity::require(gl.finish());
  parity::require(gl.download(Buffer::velocity_parts));
  for (std::size_t row = 0; row < 4; row++)
    for (std::size_t i = 0; i < parts_each; i++)
      if (parts[row * parts_each + i] != (row % 2 == 1 && i < moves ? motion[row * moves + i] : -1.0f)) return false;
  return true;
}
}  // namespace

TEST_CASE("the report names the device, its limits and its arithmetic") {
  const GlReport report = probe_gl(-1);
  if (!report.usable) FAIL("No usable GL device: " << report.problem);
  CHECK_FALSE(report.renderer.empty());
  CHECK(report.limits.storage_blocks >= 8);
  CHECK(report.limits.storage_block_bytes >= 1u << 24);
  CHECK(report.f32.supported);
  CHECK(report.f64.supported);
  CHECK(report.f32.parity());
  CHECK(report.f64.parity());
  for (const GlArithmetic& found : {report.f32, report.f64})
    MESSAGE(report.renderer << ": division " << std::string(name(found.division)) << ", square root "
                            << std::string(name(found.square_root)) << ", fma fused " << found.fma_fused
                            << ", subnormals kept " << found.subnormals_kept);
}

TEST_CASE("a device that does not exist is a named error") {
  const auto made = make_gl_backend(Precision::f32, 99, false);
  REQUIRE_FALSE(bool(made));
  CHECK(made.error().code == ErrorCode::unavailable);
  CHECK(made.error().message.find("99") != std::string::npos);
  CHECK_FALSE(probe_gl(99).usable);
  CHECK_FALSE(probe_gl(99).problem.empty());
  for (const GlDevice& device : gl_devices()) CHECK_FALSE(device.renderer.empty());
}

TEST_CASE("every kernel compiles in both precisions and every form of division and root") {
  const auto context = require_context();
  GlScope scope(*context);
  setenv("PCPHYS_CACHE", "", 0);
  const ProgramCache cache("compile test");
  for (const Precision precision : precisions)
    for (const RoundingForm form : {RoundingForm::builtin, RoundingForm::fma, RoundingForm::nearest})
      for (std::size_t k = 0; k < kernel_count; k++) {
        const Result<KernelProgram> program = load_kernel(Kernel(k), {precision, form, form}, cache);
        if (!program)
          FAIL_CHECK(program.error().message);
        else
          glDeleteProgram(program->id);
      }
}

// A second compiler front end, where it is installed. Its propagation of `precise` never ends on kernels that
// read and write one buffer (glslang 12), so `precise` is defined away for it.
TEST_CASE("every kernel passes glslangValidator") {
  if (std::system("command -v glslangValidator > /dev/null 2>&1") != 0) return;
  const TemporaryCache place;
  std::filesystem::create_directories(place.folder());
  for (const Precision precision : precisions)
    for (std::size_t k = 0; k < kernel_count; k++) {
      Result<ProgramSource> source = kernel_source(Kernel(k), {precision});
      REQUIRE(bool(source));
      const std::string file = place.folder() / "kernel.comp";
      std::string text = source->text;
      text.insert(text.find('\n') + 1, "#define precise\n");
      std::ofstream(file) << text;
      const std::string command = "(ulimit -v 4000000; glslangValidator " + file + " > " + file + ".log 2>&1)";
      if (std::system(command.c_str()) != 0)
        FAIL_CHECK(std::string(schema(Kernel(k)).name) << ": " << text_of(file + ".log"));
    }
}

TEST_CASE("constants are rounded as C++ rounds them") {
  const Result<ProgramSource> single = kernel_source(Kernel::advance, {Precision::f32});
  const Result<ProgramSource> twice = kernel_source(Kernel::advance, {Precision::f64});
  REQUIRE(bool(single));
  REQUIRE(bool(twice));
  CHECK(single->text.find("0.63661975f") != std::string::npos);
  // 2 / pi by its bits
  CHECK(twice->text.find("packDouble2x32(uvec2(0x6dc9c883u, 0x3fe45f30u))") != std::string::npos);
  CHECK(twice->text.find("(0.25lf)") != std::string::npos);
  CHECK(single->text.find("PC_REAL(") == std::string::npos);
}

TEST_CASE("a program whose layout differs from the schema is refused, with buffer, expected and found") {
  const auto context = require_context();
  GlScope scope(*context);
  const ProgramCache cache("layout test");
  const Result<KernelProgram> program = load_kernel(Kernel::inertia, {Precision::f32}, cache);
  REQUIRE(bool(program));
  CHECK(bool(check_layout(program->id, Kernel::inertia, Precision::f32)));
  const Status other_precision = check_layout(program->id, Kernel::inertia, Precision::f64);
  REQUIRE_FALSE(bool(other_precision));
  CHECK(other_precision.error().code == ErrorCode::device_error);
  CHECK(other_precision.error().message.find("`pose`") != std::string::npos);
  const Status other_bindings = check_layout(program->id, Kernel::advance, Precision::f32);
  REQUIRE_FALSE(bool(other_bindings));
  CHECK(other_bindings.error().message.find("binding") != std::string::npos);
  glDeleteProgram(program->id);
}

TEST_CASE("the cache is filled, used, and survives corruption") {
  const TemporaryCache cache;
  {
    const auto gl = parity::require_gl(Precision::f32);
    CHECK(remember_works(*gl));
  }
  const auto files = cache.files();
  CHECK(files.size() >= 2);  // the probe's answer and the kernel
  {
    const auto gl = parity::require_gl(Precision::f32);
    CHECK(remember_works(*gl));
  }
  CHECK(cache.files().size() == files.size());
  int rewritten = 0;
  for (const auto& file : files) {
    const std::string whole = text_of(file), other = text_of(file == files.front() ? files.back() : files.front());
    std::string flipped = whole;
    flipped[flipped.size() - 3] = char(flipped[flipped.size() - 3] ^ 4);
    for (const std::string& spoiled : {whole.substr(0, whole.size() / 2), other, flipped}) {
      std::ofstream(file, std::ios::binary) << spoiled;
      const auto gl = parity::require_gl(Precision::f32);
      CHECK(remember_works(*gl));
    }
    rewritten += text_of(file) != flipped;  // made anew; some drivers add a time to a program
  }
  CHECK(rewritten >= 2);  // all but the probe's program, which nobody needs while its answer is whole
}

TEST_CASE("the cache survives folders in place of its files") {
  const TemporaryCache cache;
  CHECK(remember_works(*parity::require_gl(Precision::f32)));
  const auto files = cache.files();
  for (const bool empty : {true, false}) {
    for (const auto& file : files) {
      std::filesystem::remove_all(file);
      std::filesystem::create_directory(file);
      if (!empty) std::ofstream(file / "held") << "not ours";
    }
    CHECK(remember_works(*parity::require_gl(Precision::f32)));
    for (const auto& file : files) CHECK(std::filesystem::is_directory(file) != empty);
  }
  CHECK(cache.files().size() == files.size());  // no drafts
}

TEST_CASE("a cache that cannot be written is no error") {
  const TemporaryCache cache;
  std::ofstream(cache.folder()) << "a file where the folder should be";
  const auto gl = parity::require_gl(Precision::f32);
  CHECK(remember_works(*gl));
}

TEST_CASE("a host's context is used and its bindings are found again") {
  const auto host = require_context();
  REQUIRE(bool(host->enter()));
  GLuint buffers[3];
  glGenBuffers(3, buffers);
  for (const GLuint buffer : buffers) {
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffer);
    glBufferData(GL_SHADER_STORAGE_BUFFER, 4096, nullptr, GL_STATIC_DRAW);
  }
  const auto shape = [&] {
    glBindBufferRange(GL_SHADER_STORAGE_BUFFER, 1, buffers[0], 256, 512);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, buffers[1]);
    glBindBufferRange(GL_UNIFORM_BUFFER, 0, buffers[2], 1024, 256);
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffers[2]);
    glBindBuffer(GL_UNIFORM_BUFFER, buffers[1]);
    glBindBuffer(GL_COPY_READ_BUFFER, buffers[0]);
    glBindBuffer(GL_COPY_WRITE_BUFFER, buffers[1]);
  };
  shape();
  {
    auto made = make_gl_backend(Precision::f32, -1, true);
    REQUIRE_MESSAGE(bool(made), made.error().message);
    CHECK(remember_works(**made));
  }
  const auto bound = [](GLenum name) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    return GLuint(value);
  };
  const auto bound_at = [](GLenum name, GLuint i) {
    GLint64 value = 0;
    glGetInteger64i_v(name, i, &value);
    return value;
  };
  CHECK(bound(GL_CURRENT_PROGRAM) == 0);
  CHECK(bound(GL_SHADER_STORAGE_BUFFER_BINDING) == buffers[2]);
  CHECK(bound(GL_UNIFORM_BUFFER_BINDING) == buffers[1]);
  CHECK(bound(GL_COPY_READ_BUFFER_BINDING) == buffers[0]);
  CHECK(bound(GL_COPY_WRITE_BUFFER_BINDING) == buffers[1]);
  CHECK(bound_at(GL_SHADER_STORAGE_BUFFER_BINDING, 0) == 0);
  CHECK(bound_at(GL_SHADER_STORAGE_BUFFER_BINDING, 1) == GLint64(buffers[0]));
  CHECK(bound_at(GL_SHADER_STORAGE_BUFFER_START, 1) == 256);
  CHECK(bound_at(GL_SHADER_STORAGE_BUFFER_SIZE, 1) == 512);
  CHECK(bound_at(GL_SHADER_STORAGE_BUFFER_BINDING, 2) == GLint64(buffers[1]));
  CHECK(bound_at(GL_UNIFORM_BUFFER_BINDING, 0) == GLint64(buffers[2]));
  CHECK(bound_at(GL_UNIFORM_BUFFER_START, 0) == 1024);
  CHECK(glGetError() == GL_NO_ERROR);
  glDeleteBuffers(3, buffers);
  host->leave();
}

TEST_CASE("without the host's context every call is a device_error") {
  const auto absent = make_gl_backend(Precision::f32, -1, true);
  REQUIRE_FALSE(bool(absent));
  CHECK(absent.error().code == ErrorCode::device_error);
  const auto host = require_context();
  REQUIRE(bool(host->enter()));
  auto made = make_gl_backend(Precision::f32, -1, true);
  REQUIRE(bool(made));
  host->leave();
  float data[8] = {};
  const Status lost = (*made)->attach(Buffer::motion, data, sizeof data);
  REQUIRE_FALSE(bool(lost));
  CHECK(lost.error().code == ErrorCode::device_error);
  REQUIRE(bool(host->enter()));
  made->reset();
  host->leave();
}

TEST_CASE("our own context gives way to the one that was current") {
  const auto gl = parity::require_gl(Precision::f32);
  const auto other = require_context();
  GlScope scope(*other);
  GLuint mine = 0;
  glGenBuffers(1, &mine);
  glBindBuffer(GL_UNIFORM_BUFFER, mine);
  CHECK(remember_works(*gl));
  GLint bound = 0;
  glGetIntegerv(GL_UNIFORM_BUFFER_BINDING, &bound);
  CHECK(GLuint(bound) == mine);
}

TEST_CASE("a buffer beyond the device's limit says what it needs") {
  const auto gl = parity::require_gl(Precision::f32);
  const Status status = gl->reserve(Buffer::contact_rows, std::size_t(1) << 40);
  REQUIRE_FALSE(bool(status));
  CHECK(status.error().code == ErrorCode::buffer_full);
  CHECK(status.error().message.find("contact_rows") != std::string::npos);
}

TEST_CASE("a kernel whose buffers are missing names the first, and the next call works") {
  const auto gl = parity::require_gl(Precision::f32);
  const InfoOf<float> info;
  const Range all{0, 2};
  parity::require(gl->set_infos(&info, 1));
  const KernelRun run{Kernel::remember, false, 0, gl->width(), {&all, 1}};
  const Status status = gl->run({&run, 1});
  REQUIRE_FALSE(bool(status));
  CHECK(status.error().message.find("bodies") != std::string::npos);
  CHECK_FALSE(bool(gl->upload(Buffer::motion)));
  CHECK(remember_works(*gl));
}
