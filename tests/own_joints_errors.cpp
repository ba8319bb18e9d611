// Pins what is refused of kernels of a joint with its bodies, with which words, and that nothing is added then; that a
// number that is none names the body that was given it, and a property that was removed the kernel; and that a kernel
// with one side runs there.
#include "pcphys/write_kernel.h"
#include "support_world.h"

using namespace worldtest;

namespace {

KernelDef glsl(const char* signature, const char* body = "{ }") {
  return {.text = {"k", signature, body, "mine.glsl", 1}, .over = joint_table};
}

struct Populated {
  World world;
  Stepper stepper;
  BodyId first, second;
  Populated() {
    first = must(world.create_body(ball({0, 5, 0})));
    second = must(world.create_body(ball({3, 5, 0})));
    (void)must(world.create_joint(pin(first, {1.5, 0, 0}, second, {-1.5, 0, 0})));
    for (const char* name : {"heat", "p", "q", "r", "s", "t"}) must(world.add_property<Real>(name, 1));
    must(world.add_property<Quat>("turn"));
    must(world.add_property<Real>("stretch", 2, "m", joint_table));
    const TableId one = must(world.add_table("one", 1));
    must(world.add_property<Real>("total", 0, "1", one));
  }
};

PCPHYS_KERNEL(warm, (PC_A(Real) heat_of_a, PC_ADD_B(Real) heat_b, PC_PARAM(Real) by),
              { heat_b = pc_div(heat_of_a, by); })
PCPHYS_CPU_KERNEL(here, (PC_A(Real) heat_of_a, PC_IN(Real) stretch, PC_ADD_B(Real) heat_b),
                  { heat_b = heat_of_a > stretch ? Real(1) : Real(5); })
PCPHYS_PAIR_KERNEL(wrong_macro, (PC_A(Real) heat_of_a, PC_ADD_B(Real) heat_b), { heat_b = heat_of_a; })

}  // namespace

TEST_CASE("what does not fit is refused with its reason") {
  Populated p;
  World& w = p.world;
  Stepper& s = p.stepper;
  const auto refused = [&](const KernelDef& def, ErrorCode code, const char* words) {
    CHECK_REFUSED(w, s.add_kernel(w, def), code, words);
  };
  KernelDef over_bodies = glsl("(PC_A(Real) heat_a, PC_ADD_B(Real) heat_b)");
  over_bodies.over = body_table;
  refused(over_bodies, ErrorCode::bad_argument, "let it run over joints: .over = joint_table");
  refused(glsl("(PC_A(Real) heat, PC_ADD_B(Real) heat_b)"), ErrorCode::bad_argument,
          "says PC_A of \"heat\"; the name of such an argument ends in _a: heat_a");
  refused(glsl("(PC_A(Real) heat_a, PC_ADD_B(Real) heat)"), ErrorCode::bad_argument,
          "says PC_ADD_B of \"heat\"; the name");
  refused(glsl("(PC_A(Real) oil_a, PC_ADD_B(Real) heat_b)"), ErrorCode::unknown_name, "uses the property \"oil\"");
  refused(glsl("(PC_A(Vec3) heat_a, PC_ADD_B(Real) heat_b)"), ErrorCode::wrong_type, "declares \"heat_a\" as vec3");
  refused(glsl("(PC_A(Real) stretch_a, PC_ADD_B(Real) heat_b)"), ErrorCode::bad_argument,
          "\"stretch\" is no property of bodies; the joint's own are PC_IN");
  refused(glsl("(PC_A(Real) total_a, PC_ADD_B(Real) heat_b)"), ErrorCode::bad_argument,
          "\"total\" is no property of bodies");
  refused(glsl("(PC_IN(Real) heat, PC_ADD_B(Real) heat_b)"), ErrorCode::bad_argument,
          "a property of bodies; say of which body: PC_A(T) heat_a or PC_B(T) heat_b");
  refused(glsl("(PC_IN(Real) heat, PC_INOUT(Real) stretch)"), ErrorCode::bad_argument,
          "say of which body: PC_A(T) heat_a");
  refused(glsl("(PC_A(Real) heat_a, PC_INOUT(Vec3) force)"), ErrorCode::bad_argument,
          "PC_ADD_A(T) or PC_ADD_B(T) for what");
  refused(glsl("(PC_A(Real) heat_a, PC_SUM(Real) total)"), ErrorCode::bad_argument,
          "says PC_SUM of \"total\"; what bodies are given is PC_ADD_A or PC_ADD_B, and a total of all joints");
  refused(glsl("(PC_A(Real) heat_a, PC_ADD(Real) heat)"), ErrorCode::bad_argument, "says PC_ADD of \"heat\"");
  refused(glsl("(PC_A(Real) heat_a, PC_SELF(Real) stretch)"), ErrorCode::bad_argument, "says PC_SELF of \"stretch\"");
  refused(glsl("(PC_A(Real) heat_a, PC_ADD_B(Vec3) position_b)"), ErrorCode::bad_argument,
          "from which the library derives others");
  refused(glsl("(PC_A(Real) heat_a, PC_ADD_B(Quaternion) turn_b)"), ErrorCode::wrong_type, "\"turn_b\", of type quat");
  refused(glsl("(PC_A(Real) heat_a, PC_B(Real) heat_b)"), ErrorCode::bad_argument,
          "declare what it gives to bodies as PC_ADD_A");
  KernelDef late = glsl("(PC_A(Real) heat_a, PC_ADD_B(Vec3) force_b)");
  late.stage = Stage::joints;
  refused(late, ErrorCode::bad_argument, "run it before that stage");
  KernelDef cut = glsl("(PC_A(Real) heat_a, PC_ADD_B(Vec3) force_b)");
  cut.cutoff = 1;
  refused(cut, ErrorCode::bad_argument, "for pairs of bodies alone");
  refused({.text = wrong_macro::text(), .over = joint_table}, ErrorCode::bad_argument, "write it with PCPHYS_KERNEL");
  refused(glsl("(PC_A(Real) heat_a, PC_B(Real) p_b, PC_A(Real) q_a, PC_A(Real) r_a, PC_B(Real) s_b, PC_B(Real) t_b, "
               "PC_IN(Real) stretch, PC_ADD_B(Vec3) force_b)"),
          ErrorCode::bad_argument,
          "needs 9 storage blocks (heat_a, p_b, q_a, r_a, s_b, t_b, stretch, joints of bodies that move");
  run(w, s, 2);
}

TEST_CASE("a number that is none names kernel and body, and the world is as it was") {
  require_gl();
  for (const Place place : {Place::cpu, Place::gl}) {
    Populated p;
    StepSettings settings;
    settings.set_all(place);
    must(p.stepper.configure(settings));
    must(p.stepper.add_kernel(p.world, {.text = warm::text(), .over = joint_table, .parameters = {{"by", 0.0}}}));
    const std::string words =
        "The kernel \"warm\" gave body " + std::to_string(p.second.index) + " a \"heat\" that is no finite number";
    const std::uint64_t before = p.world.hash();
    const Status made = step_status(p.stepper, p.world);
    REQUIRE(!made);
    CHECK(made.error().code == ErrorCode::not_finite);
    CHECK_MESSAGE(made.error().message.find(words) != std::string::npos, made.error().message);
    CHECK(p.world.hash() == before);
    must(p.stepper.set_parameter("warm", {"by", 2.0}));
    run(p.world, p.stepper, 1);
  }
}

TEST_CASE("a property of bodies that was removed under it") {
  Populated p;
  must(p.stepper.add_kernel(p.world, {.text = warm::text(), .over = joint_table, .parameters = {{"by", 2.0}}}));
  run(p.world, p.stepper, 1);
  must(p.world.remove_property("heat"));
  CHECK_REFUSED(p.world, step_status(p.stepper, p.world), ErrorCode::stale_id,
                "uses the property \"heat\", which was removed");
}

TEST_CASE("of one side alone it runs there, and the plan says where") {
  require_gl();
  for (const bool on_gl : {false, true}) {
    Populated p;
    StepSettings settings;
    settings.set_all(on_gl ? Place::cpu : Place::gl);
    must(p.stepper.configure(settings));
    KernelDef def =
        on_gl ? glsl("(PC_A(Real) heat_of_a, PC_ADD_B(Real) heat_b)", "{ heat_b = heat_of_a + PC_REAL(3.0); }")
              : KernelDef{.text = here::text(), .over = joint_table};
    def.once_a_step = true;
    must(p.stepper.add_kernel(p.world, def));
    run(p.world, p.stepper, 1);
    CHECK(double(must(p.world.get(must(p.world.property<Real>("heat")), p.second))) == (on_gl ? 5 : 6));
    const std::string plan = to_text(p.stepper.plan());
    CHECK_MESSAGE(plan.find(on_gl ? "gl    integrate  k " : "cpu   integrate  here ") != std::string::npos, plan);
    if (on_gl) CHECK_MESSAGE(plan.find("download heat") != std::string::npos, plan);
  }
}

TEST_CASE("what the GLSL compiler says comes with the host's own file and line") {
  Populated p;
  KernelDef def =
      glsl("(PC_A(Real) heat_a, PC_ADD_B(Real) heat_b)", "{\n  Real x = heat_a;\n  heat_b = x + nothing;\n}");
  def.text.line = 40;
  check_glsl_error(p.world, def, 42);
}
