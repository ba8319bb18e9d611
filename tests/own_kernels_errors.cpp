// Pins what is refused of a host's own kernels, with which words; that nothing is added then; and that a kernel whose
// property was removed stops the step, not the world.
#include <optional>

#include "glcompute/compile_log.h"
#include "pcphys/write_kernel.h"
#include "plan/kernel_lines.h"
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
PCPHYS_KERNEL(sum_up, (PC_IN(Real) fuel, PC_SUM(Real) total), { total = fuel; })
PCPHYS_KERNEL(reset, (PC_OUT(Real) fuel), { fuel = PC_REAL(0.0); })
PCPHYS_KERNEL(look, (PC_INOUT(Real) fuel, PC_OUT(Real) a), { a = fuel; })

const int no_glsl_line = __LINE__ + 1;
PCPHYS_KERNEL(no_glsl, (PC_INOUT(Real) fuel, PC_PARAM(Real) flow), {
  // what is left; and half of it
  Real left = fuel;
  /* three times,
     no more */
  for (uint i = 0u; i < 3u; i++) left = left - flow;
  auto half = left * PC_REAL(0.5);
  fuel = half;
})

// In C++ what is read only would be refused by the compiler, so these have no C++ side: the text as the preprocessor
// leaves it.
#define GLSL_ALONE(Name, signature, ...)                                                       \
  struct Name {                                                                                \
    static KernelText text() { return {#Name, #signature, #__VA_ARGS__, __FILE__, __LINE__}; } \
  };
const int writes_line = __LINE__ + 1;
GLSL_ALONE(writes_what_it_reads, (PC_INOUT(Real) fuel, PC_IN(Real) a), {
  // `a` is only read
  Real full = PC_REAL(1.0);

  fuel = full;
  a = full;
})
const int unknown_name_line = __LINE__ + 1;
GLSL_ALONE(unknown_name,
           (PC_INOUT(Real) fuel,  // kg
            PC_IN(Real) oil),
           { fuel = oil; })
const int wrong_type_line = __LINE__ + 1;
GLSL_ALONE(wrong_type,  // the property is a Real
           (PC_INOUT(Vec3) fuel, PC_IN(Real) a), { fuel = fuel; })
const int read_only_line = __LINE__ + 1;
GLSL_ALONE(read_only,
           (PC_IN(Real) fuel, PC_INOUT(Vec3) force,  // these may be
            PC_INOUT(Vec3) position),
           { position = position; })

/// The file as the compiler was given it may be relative to where it ran.
constexpr const char* this_file = PCPHYS_SOURCE_DIR "/tests/own_kernels_errors.cpp";
KernelText here(KernelText text) {
  text.file = this_file;
  return text;
}
std::string refusal(World& world, const KernelText& text) {
  StepSettings settings;
  settings.set_all(Place::gl);
  Stepper stepper(settings);
  KernelDef def{.text = text};
  if (std::string(text.signature).find("flow") != std::string::npos) def.parameters = {{"flow", 0.1}};
  const Status refused = stepper.add_kernel(world, def);
  REQUIRE(!refused);
  return refused.error().message;
}

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
  CHECK_REFUSED(w, s.add_kernel(w, glsl("k", "(PC_INOUT(Real) oil)")), ErrorCode::unknown_name,
                "uses the property \"oil\"");
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
  CHECK_REFUSED(w, s.add_kernel(w, {.text = drain::text(), .parameters = {{"flow", std::nan("")}}}),
                ErrorCode::not_finite, "parameter \"flow\" is nan");
  CHECK_REFUSED(w, s.add_kernel(w, {.text = drain::text(), .parameters = {{"flow", 1.0}, {"flux", 1.0}}}),
                ErrorCode::bad_argument, "is given the parameter \"flux\"");
  CHECK_REFUSED(
      w,
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
  must(s.add_kernel(w, {.text = look::text(), .follows = {"refill"}}));
  must(s.add_kernel(w, {.text = reset::text(), .follows = {"look"}}));  // and so refill, too
  must(s.add_kernel(w, {.text = drain::text(), .parameters = {{"flow", 0.5}}}));
  CHECK_REFUSED(w, s.set_parameter("drain", {"flux", 1.0}), ErrorCode::unknown_name, "has no parameter \"flux\"");
  CHECK_REFUSED(w, s.set_parameter("leak", {"flow", 1.0}), ErrorCode::unknown_name, "There is no kernel \"leak\"");
  run(w, s, 1);
  CHECK(must(w.get(must(w.property<Real>("fuel")), w.bodies()[0])) == -0.5);  // refilled, reset, drained
  CHECK(must(w.get(must(w.property<Real>("a")), w.bodies()[0])) == 3);        // what it was before reset
  must(s.remove_kernel(w, "reset"));
  run(w, s, 1);
  CHECK(must(w.get(must(w.property<Real>("fuel")), w.bodies()[0])) == 2.5);
  CHECK_REFUSED(w, s.remove_kernel(w, "reset"), ErrorCode::unknown_name, "There is no kernel \"reset\"");
}

TEST_CASE("order: a circle names those in it, and what does not exist is no order") {
  Populated p;
  World& w = p.world;
  Stepper& s = p.stepper;
  (void)must(w.add_property<Real>("heat", 0.0, "K"));
  must(s.add_kernel(w, {.text = drain::text(), .parameters = {{"flow", 0.5}}}));
  const auto cpp = [](const char* name, const char* signature) {
    KernelText t = drain::text();
    t.name = name, t.signature = signature;
    return t;
  };
  must(s.add_kernel(w, {.text = cpp("gauge", "(PC_IN(Real) heat, PC_INOUT(Vec3) force)")}));  // not to blame
  must(s.add_kernel(w, {.text = cpp("burn", "(PC_IN(Real) fuel, PC_INOUT(Real) heat)")}));
  CHECK_REFUSED(w, s.add_kernel(w, {.text = cpp("vent", "(PC_INOUT(Real) fuel, PC_IN(Real) heat)")}),
                ErrorCode::bad_argument, "\"burn\" and \"vent\" each have to run before the other");
  CHECK_REFUSED(w, s.add_kernel(w, {.text = cpp("late", "(PC_INOUT(Real) heat)"), .follows = {"brun"}}),
                ErrorCode::unknown_name, "is to follow \"brun\"");
  CHECK_REFUSED(w, s.add_kernel(w, {.text = cpp("late", "(PC_INOUT(Real) heat)"), .stage = Stage(9)}),
                ErrorCode::bad_argument, "at stage 9");
}

TEST_CASE("a kernel that is refused for another world leaves those that there are") {
  Populated p;
  must(p.stepper.add_kernel(p.world, {.text = drain::text(), .parameters = {{"flow", 0.5}}}));
  run(p.world, p.stepper, 1);
  World other;
  CHECK_REFUSED(other, p.stepper.add_kernel(other, {.text = drain::text(), .parameters = {{"flow", 0.5}}}),
                ErrorCode::unknown_name, "uses the property \"fuel\"");
  const auto fuel = [&] { return must(p.world.get(must(p.world.property<Real>("fuel")), p.world.bodies()[0])); };
  const double before = fuel();
  run(p.world, p.stepper, 1);
  CHECK(fuel() < before);
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
  must(p.stepper.remove_kernels());
  run(other.world, p.stepper, 1);
  std::optional<World> gone{WorldDef{Precision::f32, {}}};
  must(gone->add_property<Real>("fuel", 1));
  must(p.stepper.add_kernel(*gone, {.text = drain::text(), .parameters = {{"flow", 0.1}}}));
  gone.reset();
  CHECK_REFUSED(other.world, step_status(p.stepper, other.world), ErrorCode::bad_argument, "Stepper::remove_kernels");
  must(p.stepper.remove_kernels());
  run(other.world, p.stepper, 1);
}

TEST_CASE("a table of one row that has another number of them: the step says so, until it has one again") {
  for (const std::uint32_t rows : {0u, 2u}) {
    World world(WorldDef{Precision::f32, {}});
    const TableId one = must(world.add_table("one", 1));
    must(world.add_property<Real>("total", 0, "1", one));
    const BodyId body = must(world.create_body(ball({0, 5, 0})));
    must(world.add_property<Real>("fuel", 3));
    Stepper stepper;
    must(stepper.add_kernel(world, {.text = sum_up::text()}));
    run(world, stepper, 1);
    must(world.resize(one, rows));
    CHECK_REFUSED(
        world, step_status(stepper, world), ErrorCode::bad_argument,
        "The kernel \"sum_up\" uses \"total\" of a table of one row, which has " + std::to_string(rows) + " now");
    must(world.resize(one, 1));
    must(world.set(must(world.property<Real>("fuel")), body, Real(4)));
    run(world, stepper, 1);
    CHECK(double(must(world.get(must(world.property<Real>("total")), RowOf(1)))) == 4);
  }
}

TEST_CASE("a text that names the library's buffers is refused") {
  Populated p;
  CHECK_REFUSED(
      p.world,
      p.stepper.add_kernel(p.world, glsl("sly", "(PC_INOUT(Real) fuel)", "{ fuel = 1.0; io_pose[0].x = 2.0; }")),
      ErrorCode::bad_argument, "The kernel \"sly\" uses \"io_pose\" in its text");
}

TEST_CASE("GLSL that does not compile comes back with the host's own lines") {
  require_gl();
  Populated p;
  StepSettings settings;
  settings.set_all(Place::gl);
  Stepper stepper(settings);
  const char* wrong = "{\n  fuel = fuel - 1.0;\n  fuel = nonsense;\n}";
  CHECK_REFUSED(p.world, stepper.add_kernel(p.world, glsl("leak", "(PC_INOUT(Real) fuel)", wrong)),
                ErrorCode::device_error, "nonsense");
  check_glsl_error(p.world, glsl("leak", "(PC_INOUT(Real) fuel)", wrong), 3);
  const char* writes = "{\n  a = 1.0;\n  fuel = a;\n}";
  CHECK_REFUSED(p.world, stepper.add_kernel(p.world, glsl("leak", "(PC_INOUT(Real) fuel, PC_IN(Real) a)", writes)),
                ErrorCode::device_error, "mine.glsl");
  run(p.world, stepper, 1);
  must(stepper.add_kernel(p.world, glsl("leak", "(PC_INOUT(Real) fuel)", "{ fuel = fuel - 0.25; }")));
  run(p.world, stepper, 1);
  CHECK(must(p.world.get(must(p.world.property<Real>("fuel")), p.world.bodies()[0])) == 0);
}

TEST_CASE("of a text that the preprocessor made one line of, errors name the line of its file") {
  require_gl();
  Populated p;
  const std::string said = refusal(p.world, here(no_glsl::text()));
  CHECK_MESSAGE(said.find(std::string("there: ") + this_file + ":" + std::to_string(no_glsl_line + 6) +
                          ": auto half = left * ") != said.npos,
                said);
  const std::string constant = refusal(p.world, here(writes_what_it_reads::text()));
  CHECK_MESSAGE(constant.find(std::string("there: ") + this_file + ":" + std::to_string(writes_line + 5) + ": a =") !=
                    constant.npos,
                constant);
}

TEST_CASE("where that file is not at hand, or is another by now, the statement is quoted") {
  require_gl();
  Populated p;
  for (const char* file : {"not_there.cpp", PCPHYS_SOURCE_DIR "/tests/own_kernels.cpp"}) {
    KernelText text = no_glsl::text();
    text.file = file;
    const std::string said = refusal(p.world, text);
    CHECK_MESSAGE(said.find("\n  there: auto half = left * ") != said.npos, said);
    CHECK_MESSAGE(said.find(file + (":" + std::to_string(no_glsl::text().line))) != said.npos, said);
    CHECK_MESSAGE(said.find(std::string("was not found in ") + file) != said.npos, said);
  }
}

TEST_CASE("what is refused of a signature names the line of the argument") {
  Populated p;
  const auto at = [](int line) { return std::string(this_file) + ":" + std::to_string(line); };
  CHECK(refusal(p.world, here(unknown_name::text())).find(at(unknown_name_line + 2) + ".") != std::string::npos);
  CHECK(refusal(p.world, here(wrong_type::text())).find(at(wrong_type_line + 1) + ".") != std::string::npos);
  CHECK(refusal(p.world, here(read_only::text())).find(at(read_only_line + 2) + ".") != std::string::npos);
  CHECK(refusal(p.world, text("k", "(PC_IN(Real) oil)", "{}")).ends_with("At mine.glsl:1."));
}

TEST_CASE("lines are found by the macro's first line and by its last, and what NVIDIA says comes with them") {
  const std::string file =
      "\n// leak, of fuel\nMINE (leak,  // why\n  (PC_INOUT(Real) fuel,\n   PC_IN(Real) a), {\n  /* one\n  two */ fuel "
      "= b;\n"
      "  if (a > fuel) fuel =\n    a;\n})\nMINE(leak, (PC_IN(Real) a), {})\n";
  OwnKernel k;
  k.name = "leak";
  k.signature = "(PC_INOUT(Real) fuel, PC_IN(Real) a)";
  k.body = "{ fuel = b; if (a > fuel) fuel = a; }";
  k.file = "mine.cpp";
  for (const int line : {3, 9, 10}) {
    k.line = line;
    const std::optional<KernelLines> found = find_lines(file, k);
    REQUIRE(found);
    CHECK(found->signature.line == 4);
    CHECK(found->signature.line_at(k.signature.find("PC_IN(")) == 5);
    CHECK(found->body.line == 5);
    CHECK(found->body.text == "{ \n\nfuel = b; \nif (a > fuel) fuel = \na; \n}");
  }
  k.line = 2;
  CHECK(!find_lines(file, k));
  k.line = 10;
  k.body = "{ fuel = b; if (a < fuel) fuel = a; }";
  CHECK(!find_lines(file, k));
  k.body = "{\n\n fuel = b;\n}";
  k.line = 5;
  k.own_lines = true;
  const ProgramSource source = must(own_kernel_source(k, {}));
  const std::string place = std::to_string(std::ranges::find(source.files, "mine.cpp") - source.files.begin());
  for (const std::string& said :
       {place + "(7) : error C1503: undefined variable \"b\"", place + ":7(9): error: `b' undeclared",
        std::string("0:7(1): error: assignment to read-only variable"), std::string("0(7) : error C7563")})
    CHECK(with_quotes(said, source) == said + "\n  there: mine.cpp:7: fuel = b;");
}

TEST_CASE("statements and what compilers say of them") {
  CHECK(by_statement("{ a = b; for (uint i = 0u; i < 3u; i++) { c(i); } }  // d; e") ==
        "{\na = b;\nfor (uint i = 0u; i < 3u; i++) {\nc(i);\n}\n}\n");
  const ProgramSource source{
      "#version 430\n#line 1 0\nvoid f();\n#line 7 1\n{\n  x = y;\n}\n#line 1 0\nvoid main() {}\n", {}, 0};
  // Mesa
  CHECK(with_quotes("1:8(7): error: `y' undeclared", source) == "1:8(7): error: `y' undeclared\n  there: x = y;");
  // NVIDIA
  CHECK(with_quotes("1(8) : error C1503: undefined variable \"y\"\n0(2) : error", source) ==
        "1(8) : error C1503: undefined variable \"y\"\n  there: x = y;\n0(2) : error");
  CHECK(with_quotes("out of memory", source) == "out of memory");
  // nothing else is known then
  CHECK(with_quotes("0:3(1): warning: extension", source) == "0:3(1): warning: extension");
  CHECK(with_quotes("0:3(1): warning: extension\n1:8(7): error: `y' undeclared", source) ==
        "1:8(7): error: `y' undeclared\n  there: x = y;");
}
