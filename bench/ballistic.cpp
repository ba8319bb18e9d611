// A world in which nothing meets, holds or slows a body, beside what one would write by hand for it: the same
// arithmetic over the same arrays, in turns with pcphys so that what else happens on the machine hits both. The time is
// pcphys's median step.
//   ballistic/BODIES/cpu     beside a loop of one thread (ballistic_hand.cpp);
//                            `differs`: bodies whose rows are not the same bits
//   ballistic/BODIES/gl      beside a compute shader over buffers that stay on the device
//   ballistic/BODIES/create  making the world, a body
#include <benchmark/benchmark.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>

#include "ballistic_hand.h"
#include "glcompute/context.h"
#include "pcphys/step.h"
#include "scenes/scene.h"
#include "world/state.h"

namespace {

using namespace pcphys;

constexpr double dt = 1.0 / 60;
constexpr int steps_before = 20, turns = 15;  // before: a body that was just placed settles

template <class Action> double clock_ms(Action action) {
  const auto begin = std::chrono::steady_clock::now();
  action();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}
double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// The scene some steps on.
struct Flight {
  World world{{Precision::f32}};
  Stepper stepper;
  Error error;

  Flight(int bodies, Place place)
      : stepper([place] {
          StepSettings s;
          s.set_all(place);
          s.resident = true;
          s.timings = false;
          return s;
        }()) {
    scenes::SceneOptions options;
    options.count = bodies;
    if (const auto scene = scenes::make("ballistic", options, world); !scene) error = scene.error();
    for (int i = 0; i < steps_before; i++) step();
  }
  void step() {
    if (error.code == ErrorCode::none) error = stepper.step(world, dt).error;
  }
  ballistic::Arrays arrays() {
    const Tables& t = world.state().tables;
    const auto copy = [&t](Buffer b) {
      const float* from = t.data<float>(b);
      return std::vector<float>(from, from + t.bytes(b).size() / sizeof(float));
    };
    ballistic::Arrays a;
    a.motion = copy(Buffer::motion), a.pose = copy(Buffer::pose), a.velocity_parts = copy(Buffer::velocity_parts);
    a.mass = copy(Buffer::mass), a.force = copy(Buffer::force);
    a.bodies = world.body_count();
    a.gravity[1] = -9.81f;
    a.substeps = int(stepper.settings().substeps);
    a.h = float(dt / a.substeps);
    return a;
  }
};

/// Bodies of which some row of state differs.
std::size_t differences(const ballistic::Arrays& a, const ballistic::Arrays& b) {
  const auto same = [](const std::vector<float>& x, const std::vector<float>& y, std::size_t row, std::size_t reals) {
    return std::equal(&x[row * reals], &x[row * reals] + reals, &y[row * reals]);
  };
  std::size_t count = 0;
  for (std::size_t row = 1; row + 8 <= a.bodies + 1; row++)
    count += !(same(a.motion, b.motion, row, 8) && same(a.pose, b.pose, row, 16) &&
               same(a.velocity_parts, b.velocity_parts, row, 16));
  return count;
}

void report(benchmark::State& state, const std::vector<double>& own, const std::vector<double>& hand,
            std::size_t bodies, const std::string& device) {
  state.SetIterationTime(median(own) / 1000);
  state.counters["ms"] = median(own);
  state.counters["hand_ms"] = median(hand);
  state.counters["ratio"] = median(own) / median(hand);
  state.counters["ns_per_body"] = 1e6 * median(own) / double(bodies);
  char text[64];
  std::snprintf(text, sizeof text, "; %.2f of the hand-written one's time", median(own) / median(hand));
  state.SetLabel(device + text);
}

void beside_loop(benchmark::State& state, int bodies) {
#ifdef __x86_64__
  if (!__builtin_cpu_supports("avx2")) return state.SkipWithError("the loop by hand is compiled for AVX2");
#endif
  Flight flight(bodies, Place::cpu);
  ballistic::Arrays arrays = flight.arrays();
  std::vector<double> own, hand;
  for (auto _ : state) {
    for (int i = 0; i < turns; i++) {
      own.push_back(clock_ms([&] { flight.step(); }));
      hand.push_back(clock_ms([&] { ballistic::step(arrays); }));
    }
    if (flight.error.code != ErrorCode::none) return state.SkipWithError(flight.error.message.c_str());
    report(state, own, hand, arrays.bodies, flight.stepper.device(Place::cpu));
  }
  state.counters["differs"] = double(differences(arrays, flight.arrays()));
}

/// The shader, its buffers and its program, in a context of its own.
class Shader {
 public:
  Shader(GlContext& context, const ballistic::Arrays& arrays) : context_(context), bodies_(unsigned(arrays.bodies)) {
    GlScope scope(context_);
    const GLuint part = glCreateShader(GL_COMPUTE_SHADER);
    const char* text = ballistic::shader();
    glShaderSource(part, 1, &text, nullptr);
    glCompileShader(part);
    program_ = glCreateProgram();
    glAttachShader(program_, part);
    glLinkProgram(program_);
    GLint linked = 0;
    glGetProgramiv(program_, GL_LINK_STATUS, &linked);
    ready_ = linked != 0;
    glUseProgram(program_);
    glUniform4f(glGetUniformLocation(program_, "gravity_h"), arrays.gravity[0], arrays.gravity[1], arrays.gravity[2],
                arrays.h);
    glUniform2ui(glGetUniformLocation(program_, "bodies_substeps"), bodies_, unsigned(arrays.substeps));
    glGenBuffers(GLsizei(buffers_.size()), buffers_.data());
    GLuint binding = 0;
    for (const auto* rows : {&arrays.motion, &arrays.pose, &arrays.velocity_parts, &arrays.mass, &arrays.force}) {
      glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffers_[binding]);
      glBufferData(GL_SHADER_STORAGE_BUFFER, GLsizeiptr(rows->size() * sizeof(float)), rows->data(), GL_DYNAMIC_COPY);
      binding++;
    }
  }
  bool ready() const { return ready_; }
  void step() {
    GlScope scope(context_);
    glUseProgram(program_);
    for (GLuint i = 0; i < buffers_.size(); i++) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, i, buffers_[i]);
    glDispatchCompute((bodies_ + 63) / 64, 1, 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    glFinish();
  }

 private:
  GlContext& context_;
  unsigned bodies_;
  bool ready_ = false;
  GLuint program_ = 0;
  std::array<GLuint, 5> buffers_{};
};

void beside_shader(benchmark::State& state, int bodies) {
  Flight flight(bodies, Place::gl);
  if (flight.error.code != ErrorCode::none) return state.SkipWithError(flight.error.message.c_str());
  const ballistic::Arrays arrays = flight.arrays();
  Result<std::unique_ptr<GlContext>> context = GlContext::open(-1);
  if (!context) return state.SkipWithError(context.error().message.c_str());
  Shader shader(**context, arrays);
  if (!shader.ready()) return state.SkipWithError("the shader by hand does not compile here");
  shader.step();
  std::vector<double> own, hand;
  for (auto _ : state) {
    for (int i = 0; i < turns; i++) {
      own.push_back(clock_ms([&] { flight.step(); }));
      hand.push_back(clock_ms([&] { shader.step(); }));
    }
    if (flight.error.code != ErrorCode::none) return state.SkipWithError(flight.error.message.c_str());
    report(state, own, hand, arrays.bodies, flight.stepper.device(Place::gl));
  }
}

void create(benchmark::State& state, int bodies) {
  for (auto _ : state) {
    World world({Precision::f32});
    scenes::SceneOptions options;
    options.count = bodies;
    const double ms = clock_ms([&] { (void)scenes::make("ballistic", options, world); });
    state.SetIterationTime(ms / 1000);
    state.counters["ns_per_body"] = 1e6 * ms / double(bodies);
    state.counters["bytes_per_body"] = double(world.memory_bytes()) / double(bodies);
  }
}

const bool registered = [] {
  for (const int bodies : {1'000, 100'000, 1'000'000}) {
    const std::string name = "ballistic/" + std::to_string(bodies);
    const auto add = [&](const char* variant, void (*run)(benchmark::State&, int)) {
      benchmark::RegisterBenchmark((name + "/" + variant).c_str(), run, bodies)
          ->UseManualTime()
          ->Iterations(1)
          ->Unit(benchmark::kMillisecond);
    };
    add("cpu", beside_loop);
    add("gl", beside_shader);
    add("create", create);
  }
  return true;
}();

}  // namespace
