// Pins what is refused of a host's own kernels, with which words; that nothing is added then; and that a kernel whose property was
// removed stops the step, not the world.
#include "glcompute/compile_log.h"
#include "pcphys/write_kernel.h"
#include "support_world.h"

using namespace worldtest;

namespace {

KernelText text(const char* name, const char* signature, const char* body = "") {
  return {name, signature, body, "mine.glsl", 1};
}
KernelDef glsl(const char* name, const char* signature, const char* body = "{ fuel = fuel; }") {
  return {.text = text(name, signature, body)};
}

struct Populated {
  World world;
  Stepper stepper;
  Populated() {
    for (int i = 0; i < 3; i++) (void)must(world.create_body(ball({3.0 * i, 5, 0})));
    must(world.add_property<Real>("fuel", 1));
    for (const char* name : {"a", "b", "c", "d", "e", "f", "g"}) must(world.add_property<Real>(name));
  }
};

PCPHYS_KERNEL(drain, (PC_INOUT(Real) fuel, PC_PARAM(Real) flow), { fuel = fuel - flow; })
PCPHYS_KERNEL(refill, (PC_OUT(Real) fuel, PC_PARAM(Real) full), { fuel = full; })
PCPHYS_KERNEL(reset, (PC_OUT(Real) fuel), { fuel = PC_REAL(0.0); })

PCPHYS_KERNEL(no_glsl, (PC_INOUT(Real) fuel, PC_PARAM(Real) flow), {
  Real left = fuel;
  for (uint i = 0u; i < 3u; i++) left = left - flow;
  auto half = left * PC_REAL(0.5);
  fuel = half;
})

}  // namespace

TEST_CASE("what does not fit is refused with its reason") {
  Populated p;
  World& w = p.world;
  Stepper& s = p.stepper;
  for (const char* bad : {"", "PC_IN(Real) fuel", "(PC_IN Real fuel)", "(PC_IN(Real fuel)", "(PC_IN(Reel) fuel)",
                          "(PC_INOUT(Real) fuel) x", "(PC_INOUT(Real) fuel,)"})
    CHECK_REFUSED(w, s.add_kernel(w, glsl("k", bad)), ErrorCode::bad_argument, "has the signature `");
  CHECK_REFUSED(w, s.add_kernel(w, glsl("", "(PC_INOUT(Real) fuel)")), ErrorCode::bad_argument, "has no name");
  CHECK_REFUSED(w, s.add_kernel(w, glsl("k", "(PC_INOUT(Real) fuel)", "")), ErrorCode::bad_argument,
                "neither a C++ nor a GLSL side");
  CHECK_REFUSED(w, s.add_kernel(w, glsl("k", "(PC_INOUT(Real) oil)")), ErrorCode::unknown_name, "uses the property \"oil\"");
  CHECK_REFUSED(w, s.add_kernel(w, glsl("k", "(PC_INOUT(Vec3) fuel)")), ErrorCode::wrong_type,
                "declares \"fuel\" as vec3; the property is of type real");
  CHECK_REFUSED(w, s.add_kernel(w, glsl("k", "(PC_IN(Real) fuel)")), ErrorCode::bad_argument, "writes nothing");
  CHECK_REFUSED(w, s.add_kernel(w, glsl("k", "(PC_IN(Real) fuel, PC_INOUT(Real) fuel)")), ErrorCode::bad_argument,
                "names \"fuel\" twice");
  CHECK_REFUSED(w, s.add_kernel(w, glsl("k", "(PC_INOUT(Vec3) position)")), ErrorCode::bad_argument,
                "writes \"position\", from which the library");
  CHECK_REFUSED(w, s.add_kernel(w, glsl("k", "(PC_INOUT(Real) fuel, PC_PARAM(Real) flow)")), ErrorCode::bad_argument,
                "no value is given for it");
  CHECK_REFUSED(w, s.add_kernel(w, {.text = drain::text(), .parameters = {{"flow", Vec3{}}}}), ErrorCode::wrong_type,
                "parameter \"flow\" as real; the value given is of type vec3");
  CHECK_REFUSED(w, s.add_kernel(w, {.text = drain::text(), .parameters = {{"flow", std::nan("")}}}), ErrorCode::not_finite,
                "parameter \"flow\" is nan");
  CHECK_REFUSED(w, s.add_kernel(w, {.text = drain::text(), .parameters = {{"flow", 1.0}, {"flux", 1.0}}}),
                ErrorCode::bad_argument, "is given the parameter \"flux\"");
  CHECK_REFUSED(w,
                s.add_kernel(w, glsl("k",
                                     "(PC_INOUT(Real) fuel, PC_IN(Real) a, PC_IN(Real) b, PC_IN(Real) c, PC_IN(Real) d, "
                                     "PC_IN(Real) e, PC_IN(Real) f, PC_IN(Real) g)")),
                ErrorCode::bad_argument, "needs 9 storage blocks (fuel, a, b, c, d, e, f, g, and the list of bodies)");
  CHECK_REFUSED(w, s.add_kernel(w, {.text = text("k", "(PC_INOUT(Vec3) force)", "{}"), .stage = Stage::joints}),
                ErrorCode::bad_argument, "run it before that stage");
  run(w, s, 2);  // as if nothing had been asked for
}

TEST_CASE("order: two that write the same anew, names, and circles") {
  Populated p;
  World& w = p.world;
  Stepper& s = p.stepper;
  must(s.add_kernel(w, {.text = refill::text(), .parameters = {{"full", 3.0}}}));
  CHECK_REFUSED(w, s.add_kernel(w, {.text = refill::text(), .parameters = {{"full", 3.0}}}), ErrorCode::name_taken,
                "There is a kernel \"refill\" already");
  CHECK_REFUSED(w, s.add_kernel(w, {.text = reset::text()}), ErrorCode::bad_argument,
                "\"reset\" and \"refill\" both write \"fuel\" anew");
  must(s.add_kernel(w, {.text = reset::text(), .follows = {"refill"}}));
  must(s.add_kernel(w, {.text = drain::text(), .parameters = {{"flow", 0.5}}}));
  CHECK_REFUSED(w, s.set_parameter("drain", {"flux", 1.0}), ErrorCode::unknown_name, "has no parameter \"flux\"");
  CHECK_REFUSED(w, s.set_parameter("leak", {"flow", 1.0}), ErrorCode::unknown_name, "There is no kernel \"leak\"");
  run(w, s, 1);
  CHECK(must(w.get(must(w.property<Real>("fuel")), w.bodies()[0])) == -0.5);  // refilled, reset, drained
  must(s.remove_kernel(w, "reset"));
  run(w, s, 1);
  CHECK(must(w.get(must(w.property<Real>("fuel")), w.bodies()[0])) == 2.5);
  CHECK_REFUSED(w, s.remove_kernel(w, "reset"), ErrorCode::unknown_name, "There is no kernel \"reset\"");
}

TEST_CASE("a property that was removed under a kernel: the step says so, the world is as it was") {
  Populated p;
  must(p.stepper.add_kernel(p.world, {.text = drain::text(), .parameters = {{"flow", 0.1}}}));
  run(p.world, p.stepper, 1);
  must(p.world.remove_property("fuel"));
  CHECK_REFUSED(p.world, step_status(p.stepper, p.world), ErrorCode::stale_id,
                "The kernel \"drain\" uses the property \"fuel\", which was removed");
  must(p.stepper.remove_kernel(p.world, "drain"));
  run(p.world, p.stepper, 1);
}

TEST_CASE("a stepper has kernels of one world") {
  Populated p, other;
  must(p.stepper.add_kernel(p.world, {.text = drain::text(), .parameters = {{"flow", 0.1}}}));
  CHECK_REFUSED(other.world, step_status(p.stepper, other.world), ErrorCode::bad_argument, "kernels of another world");
}

TEST_CASE("GLSL that does not compile comes back with the host's own lines") {
  require_gl();
  Populated p;
  StepSettings settings;
  settings.set_all(Place::gl);
  Stepper stepper(settings);
  const char* wrong = "{\n  fuel = fuel - 1.0;\n  fuel = nonsense;\n}";
  CHECK_REFUSED(p.world, stepper.add_kernel(p.world, glsl("leak", "(PC_INOUT(Real) fuel)", wrong)), ErrorCode::device_error,
                "nonsense");
  check_glsl_error(p.world, glsl("leak", "(PC_INOUT(Real) fuel)", wrong), 3);
  const char* writes = "{\n  a = 1.0;\n  fuel = a;\n}";
  CHECK_REFUSED(p.world, stepper.add_kernel(p.world, glsl("leak", "(PC_INOUT(Real) fuel, PC_IN(Real) a)", writes)),
                ErrorCode::device_error, "mine.glsl");
  run(p.world, stepper, 1);
  must(stepper.add_kernel(p.world, glsl("leak", "(PC_INOUT(Real) fuel)", "{ fuel = fuel - 0.25; }")));
  run(p.world, stepper, 1);
  CHECK(must(p.world.get(must(p.world.property<Real>("fuel")), p.world.bodies()[0])) == 0);
}

TEST_CASE("of a text that the preprocessor made one line of, the statement at fault is quoted") {
  require_gl();
  Populated p;
  StepSettings settings;
  settings.set_all(Place::gl);
  Stepper stepper(settings);
  const Status refused = stepper.add_kernel(p.world, {.text = no_glsl::text(), .parameters = {{"flow", 0.1}}});
  REQUIRE(!refused);
  const std::string& said = refused.error().message;
  CHECK_MESSAGE(said.find("\n  there: auto half = left * ") != said.npos, said);
  CHECK_MESSAGE(said.find("own_kernels_errors.cpp:" + std::to_string(no_glsl::text().line)) != said.npos, said);
}

TEST_CASE("statements and what compilers say of them") {
  CHECK(by_statement("{ a = b; for (uint i = 0u; i < 3u; i++) { c(i); } }  // d; e") ==
        "{\na = b;\nfor (uint i = 0u; i < 3u; i++) {\nc(i);\n}\n}\n");
  const ProgramSource source{"#version 430\n#line 1 0\nvoid f();\n#line 7 1\n{\n  x = y;\n}\n#line 1 0\nvoid main() {}\n", {}};
  CHECK(with_quotes("1:8(7): error: `y' undeclared", source) == "1:8(7): error: `y' undeclared\n  there: x = y;");  // Mesa
  CHECK(with_quotes("1(8) : error C1503: undefined variable \"y\"\n0(2) : error", source) ==                        // NVIDIA
        "1(8) : error C1503: undefined variable \"y\"\n  there: x = y;\n0(2) : error");
  CHECK(with_quotes("out of memory", source) == "out of memory");
}
