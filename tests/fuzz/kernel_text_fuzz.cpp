// The text of kernels of a host's own: whatever it says, it is refused with a sentence and nothing is added, or it is
// read, put into a program, and found again in its file; beside a C++ side that does nothing it can be stepped. Fields
// of the input are strings with a zero byte behind each: how the kernel is made, its name, signature, body and a text
// of a file; then the next kernel.
#include <string>
#include <vector>

#include "expect.h"
#include "glcompute/compile_log.h"
#include "pcphys/pcphys.h"
#include "plan/kernel_lines.h"
#include "plan/own_kernels.h"
#include "seeds.h"
#include "world/state.h"

namespace {

using namespace pcphys;

void no_loop(const KernelRows&) {}
void no_pairs(const KernelPairs&) {}

class Fields {
 public:
  Fields(const std::uint8_t* data, std::size_t size) : rest_(reinterpret_cast<const char*>(data), size) {}
  bool over() const { return rest_.empty(); }
  std::string next() {
    const std::size_t end = rest_.find('\0');
    std::string field(rest_.substr(0, end));
    rest_ = end == rest_.npos ? std::string_view() : rest_.substr(end + 1);
    return field;
  }

 private:
  std::string_view rest_;
};

struct Given {
  std::string how, name, signature, body, source;

  explicit Given(Fields& fields)
      : how(fields.next()), name(fields.next()), signature(fields.next()), body(fields.next()), source(fields.next()) {
    how.resize(3);
  }
  bool of(int byte, int bit) const { return how[std::size_t(byte)] >> bit & 1; }

  KernelDef def(TableId cells) const {
    KernelDef def;
    def.text = {name.c_str(), signature.c_str(), of(0, 0) ? nullptr : body.c_str(), of(0, 1) ? "none.glsl" : "",
                how[2] % 8};
    def.text.pairs32 = def.text.pairs64 = of(0, 2) ? no_pairs : nullptr;
    def.text.f32 = def.text.f64 = of(0, 2) ? nullptr : no_loop;
    def.over = of(0, 3) ? joint_table : of(0, 4) ? cells : body_table;
    def.stage = Stage(how[1] & 3);
    def.after = of(1, 2);
    def.once_a_step = of(1, 3);
    if (of(1, 4)) def.cutoff = how[2];
    if (of(1, 5)) def.follows = {"first", name};
    if (of(0, 5)) def.parameters.emplace_back("flow", 0.5);
    if (of(0, 6)) def.parameters.emplace_back("wind", Vec3{1, 2, 3});
    return def;
  }
};

TableId make_world(World& world) {
  BodyDef ball;
  ball.shapes = {ShapeDef::sphere(0.1)};
  BodyId last = world.ground();
  for (int i = 0; i < 3; i++) {
    ball.pose.position = {double(i), 5, 0};
    SpringDef spring;
    spring.a = last;
    spring.b = last = fuzz::expect(world.create_body(ball));
    spring.stiffness = 1;
    (void)fuzz::expect(world.create_spring(spring));
  }
  (void)fuzz::expect(world.add_property<Real>("fuel", 1));
  (void)fuzz::expect(world.add_property<Vec3>("flow_of"));
  (void)fuzz::expect(world.add_property<std::uint32_t>("count"));
  (void)fuzz::expect(world.add_property<Mat3>("turn"));
  const TableId cells = fuzz::expect(world.add_table("cells", 3)), one = fuzz::expect(world.add_table("one", 1));
  (void)fuzz::expect(world.add_property<Real>("heat", 0, "K", cells));
  (void)fuzz::expect(world.add_property<Real>("total", 0, "J", one));
  return cells;
}

/// What a device would be asked to compile, and what is told of its answer.
void check_text(const WorldState& state, const KernelDef& def, const std::string& source) {
  const Result<std::shared_ptr<OwnKernel>> made = resolve(state, def);
  if (!made) {
    fuzz::expect(!made.error().message.empty(), "an error without a sentence");
    return;
  }
  const OwnKernel& kernel = **made;
  (void)find_lines(source, kernel);
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const SourceOptions options{.precision = precision};
    const Result<ProgramSource> program = own_kernel_source(kernel, options);
    if (!program) continue;
    (void)with_quotes(source, *program);
    if (kernel.form != OwnKernel::Form::element) (void)own_totals_source(kernel, options);
  }
}

}  // namespace

std::size_t fuzz::number_bytes(std::uint8_t) { return 0; }

std::vector<std::vector<std::uint8_t>> fuzz::seeds() {
  const auto text = [](std::initializer_list<std::string> fields) {
    std::vector<std::uint8_t> seed;
    for (const std::string& field : fields) {
      seed.insert(seed.end(), field.begin(), field.end());
      seed.push_back(0);
    }
    return seed;
  };
  const std::string drain = "(PC_INOUT(Real) fuel, PC_PARAM(Real) flow, PC_PARAM(Vec3) wind, PC_PARAM(Real) h)";
  const std::string burn = "{ Real left = fuel; /* half */ fuel = left - flow * PC_REAL(0.5); // and so on\n }";
  const std::string pull = "(PC_SELF(Vec3) position, PC_OTHER(Vec3) position_other, PC_ADD(Vec3) force)";
  const std::string cord =
      "(PC_A(Vec3) position_a, PC_B(Vec3) flow_of_b, PC_IN(Real) rest_length, PC_ADD_A(Vec3) force_a)";
  const std::string log = "4:43(14): error: `half' undeclared\n0(7) : error C1008: undefined variable\n";
  return {text({"\x62\x40\x01", "drain", drain, burn, "PCPHYS_KERNEL(drain, " + drain + ", " + burn + ")\n"}),
          text({"\x44\x50\x02", "pull", pull, "{ force = pc_sub(position, position_other); }", log}),
          text({"\x48\x40\x03", "cord", cord, "{ force_a = position_a; }", log}),
          text({"\x40\x44\x01", "sum", "(PC_IN(Real) fuel, PC_SUM(Real) total)", "{ total = fuel; }", log}),
          text({"\x50\x40\x01", "cells", "(PC_OUT(Real) heat)", "{ heat = PC_REAL(1e300); }", ""}),
          text({"\x40\x40\x01", "first", "(PC_OUT(uint) count)", "{ count = 1u; }", "", "\x40\x60\x01", "next",
                "(PC_IN(uint) count, PC_INOUT(Mat3) turn)", "{ turn.x.x = PC_REAL(2.0); }", ""})};
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  World world;
  const TableId cells = make_world(world);
  Stepper stepper({.substeps = 1});
  Fields fields(data, size);
  for (int i = 0; i < 4 && !fields.over(); i++) {
    const Given given(fields);
    const KernelDef def = given.def(cells);
    check_text(world.state(), def, given.source);
    const std::uint64_t before = world.hash();
    if (!stepper.add_kernel(world, def)) fuzz::expect(world.hash() == before, "a refused kernel changed the world");
  }
  (void)stepper.step(world, 1.0 / 60);  // sums that nobody made may be no numbers
  fuzz::expect(!to_text(stepper.plan()).empty(), "a plan without a text");
  return 0;
}
