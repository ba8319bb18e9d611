// Pins what is refused of pair kernels and reductions, with which words, and that nothing is added then; and that a
// kernel with one side runs there.
#include <limits>

#include "pcphys/write_kernel.h"
#include "support_world.h"

using namespace worldtest;

namespace {

KernelDef glsl(const char* signature, const char* body = "{ }") {
  return {.text = {"k", signature, body, "mine.glsl", 1}};
}

struct Populated {
  World world;
  Stepper stepper;
  TableId cells, one;
  Populated() {
    for (int i = 0; i < 3; i++) (void)must(world.create_body(ball({3.0 * i, 5, 0})));
    for (const char* name : {"a", "b", "c", "d", "e", "f", "g"}) must(world.add_property<Real>(name));
    must(world.add_property<Quat>("q"));
    must(world.add_property<Mat3>("m"));
    cells = must(world.add_table("cells", 5));
    must(world.add_property<Real>("heat", 0, "1", cells));
    one = must(world.add_table("one", 1));
    must(world.add_property<Real>("total", 0, "1", one));
    must(world.add_property<Quat>("turn", {}, "1", one));
    must(world.add_property<Mat3>("all", {}, "1", one));
  }
};

PCPHYS_PAIR_KERNEL(near, (PC_SELF(Real) a, PC_OTHER(Real) a_other, PC_SUM(Real) b), { b = a_other - a; })
PCPHYS_CPU_PAIR_KERNEL(here, (PC_SELF(Real) a, PC_OTHER(Real) a_other, PC_SUM(Real) b),
                       { b = a_other > a ? Real(1) : Real(2); })
PCPHYS_KERNEL(wrong_macro, (PC_SELF(Real) a, PC_SUM(Real) b), { b = a; })

}  // namespace

TEST_CASE("what does not fit is refused with its reason") {
  Populated p;
  World& w = p.world;
  Stepper& s = p.stepper;
  const auto refused = [&](const KernelDef& def, ErrorCode code, const char* words) {
    CHECK_REFUSED(w, s.add_kernel(w, def), code, words);
  };
  refused(glsl("(PC_SELF(Real) a, PC_OTHER(Real) b, PC_SUM(Real) c)"), ErrorCode::bad_argument,
          "ends in _other: b_other");
  refused(glsl("(PC_SELF(Real) a, PC_OTHER(Real) oil_other, PC_SUM(Real) c)"), ErrorCode::unknown_name,
          "uses the property \"oil\"");
  refused(glsl("(PC_SELF(Vec3) a, PC_SUM(Real) c)"), ErrorCode::wrong_type, "declares \"a\" as vec3");
  refused(glsl("(PC_SELF(Real) a, PC_INOUT(Real) c)"), ErrorCode::bad_argument, "neither PC_INOUT nor PC_OUT");
  refused(glsl("(PC_SELF(Real) a, PC_MIN(Real) c)"), ErrorCode::bad_argument, "pairs are summed");
  refused(glsl("(PC_IN(Real) a, PC_ADD(Real) c)"), ErrorCode::bad_argument, "PC_ADD, which is for sums over pairs");
  refused(glsl("(PC_IN(Real) a, PC_SELF(Real) b, PC_SUM(Real) c)"), ErrorCode::bad_argument,
          "say of which body: PC_SELF(T) a");
  refused(glsl("(PC_SELF(Real) a)"), ErrorCode::bad_argument, "declare what it sums as PC_ADD or PC_SUM");
  refused(glsl("(PC_SELF(Real) a, PC_SUM(Vec3) position)"), ErrorCode::bad_argument,
          "from which the library derives others");
  refused(glsl("(PC_SELF(Real) a, PC_SUM(Quaternion) q)"), ErrorCode::wrong_type, "\"q\", of type quat");
  refused(glsl("(PC_SELF(Real) heat, PC_SUM(Real) a)"), ErrorCode::bad_argument, "must be of one table");
  refused({.text = wrong_macro::text()}, ErrorCode::bad_argument, "write it with PCPHYS_PAIR_KERNEL");
  refused(glsl("(PC_IN(Real) a, PC_SUM(Real) b)"), ErrorCode::bad_argument, "add it to a table of one row");
  refused(glsl("(PC_IN(Quaternion) q, PC_SUM(Quaternion) turn)"), ErrorCode::wrong_type, "\"turn\", of type quat");
  refused(glsl("(PC_IN(Mat3) m, PC_MIN(Mat3) all)"), ErrorCode::wrong_type, "\"all\", of type mat3");
  refused(glsl("(PC_IN(Real) a, PC_INOUT(Real) total)"), ErrorCode::bad_argument, "must be of one table");
  refused(glsl("(PC_SELF(Real) a, PC_OTHER(Real) b_other, PC_SELF(Real) c, PC_SELF(Real) d, PC_SELF(Real) e, "
               "PC_SELF(Real) f, "
               "PC_SUM(Real) g)"),
          ErrorCode::bad_argument, "needs 9 storage blocks (");
  for (const double cutoff : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    refused({.text = near::text(), .cutoff = cutoff}, ErrorCode::bad_argument, "must be above zero and finite");
  KernelDef cells = glsl("(PC_SELF(Real) heat_self, PC_ADD(Real) heat)");
  cells.over = p.cells;
  cells.cutoff = 1;
  refused(cells, ErrorCode::bad_argument, "for pairs of bodies alone");
  KernelDef total = glsl("(PC_IN(Real) a, PC_SUM(Real) total)");
  total.cutoff = 1;
  refused(total, ErrorCode::bad_argument, "for pairs of bodies alone");
  run(w, s, 2);
}

TEST_CASE("a property that was removed under a pair kernel") {
  Populated p;
  must(p.stepper.add_kernel(p.world, {.text = near::text()}));
  run(p.world, p.stepper, 1);
  must(p.world.remove_property("a"));
  CHECK_REFUSED(p.world, step_status(p.stepper, p.world), ErrorCode::stale_id,
                "uses the property \"a\", which was removed");
}

TEST_CASE("what the GLSL compiler says comes with the host's own file and line") {
  Populated p;
  KernelDef def =
      glsl("(PC_SELF(Real) a, PC_OTHER(Real) a_other, PC_SUM(Real) b)", "{\n  Real x = a;\n  b = x + nothing;\n}");
  def.text.line = 40;
  check_glsl_error(p.world, def, 42);
}

TEST_CASE("of one side alone it runs there, and the plan shows what crosses") {
  require_gl();
  for (const bool on_gl : {false, true}) {
    Populated p;
    StepSettings settings;
    settings.set_all(on_gl ? Place::cpu : Place::gl);
    must(p.stepper.configure(settings));
    must(p.stepper.add_kernel(p.world, on_gl ? glsl("(PC_SELF(Real) a, PC_SUM(Real) b)", "{ b = a + PC_REAL(3.0); }")
                                             : KernelDef{.text = here::text()}));
    const StepReport& report = p.stepper.step(p.world, frame);
    REQUIRE_MESSAGE(bool(report), report.error.message);
    CHECK(double(must(p.world.get(must(p.world.property<Real>("b")), p.world.bodies()[0]))) == (on_gl ? 6 : 4));
    const std::string plan = to_text(p.stepper.plan());
    CHECK_MESSAGE(plan.find(on_gl ? "gl    integrate  k " : "cpu   integrate  here ") != std::string::npos, plan);
    // what the kernel alone uses crosses only where it stands on the other side
    CHECK_MESSAGE((plan.find("upload a\n") != std::string::npos) == on_gl, plan);
    CHECK_MESSAGE((plan.find("download b  B\n") != std::string::npos) == on_gl, plan);
    CHECK(report.transfer_bytes > 0);
  }
}
