// A scene as a C++ program against the public API alone: one statement a call, numbers that read back as the same
// double.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <utility>

#include "wild/program_text.h"
#include "wild/shrink.h"

namespace pcphys::wild {
namespace {

using program::Members;
using program::members;
using program::text;

constexpr std::size_t line_length = 118;

// ---- layout --------------------------------------------------------------------------------------------------

/// Where a line may end: after a comma that has no number on either side, so that vectors stay whole.
std::size_t next_break(std::string_view content) {
  for (std::size_t comma = content.find(", "); comma != content.npos; comma = content.find(", ", comma + 1)) {
    const char before = content[comma - 1], after = content[comma + 2];
    if (before == '}' || before == ')' || (after >= 'A' && after <= 'Z') || after == '.' || after == '{')
      return comma + 2;
  }
  return content.size();
}

/// One statement of main, broken where it is too long.
std::string statement(std::string_view content) {
  std::string lines, line = "  ";
  while (!content.empty()) {
    const std::string_view piece = content.substr(0, next_break(content));
    if (line.size() + piece.size() > line_length && line.find_first_not_of(' ') != line.npos) {
      lines += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
      line = "      ";
    }
    line += piece;
    content.remove_prefix(piece.size());
  }
  return lines + line + ";\n";
}

std::string wrench_text(const Wrench& w) { return "Wrench{" + text(w.force) + ", " + text(w.torque) + "}"; }
std::string element(const char* list, int number) { return std::string(list) + "[" + std::to_string(number) + "]"; }
std::string body_text(int number) { return number == ground ? "world.ground()" : element("body", number); }

// ---- calls ---------------------------------------------------------------------------------------------------

/// Writes the statements of main.
class Writer {
 public:
  explicit Writer(const PlayOptions& options) : options_(options) {}

  void operator()(const MakeBody& c) {
    count(bodies_, c.body);
    say(element("body", c.body) + " = made(world.create_body(" + text_of(c.def) + "))");
  }
  void operator()(const MakeJoint& c) {
    count(joints_, c.joint);
    Members list("JointDef");
    list.put("a", body_text(c.a)).put("b", body_text(c.b));
    list.add("frame_a", c.def.frame_a, Pose{}).add("frame_b", c.def.frame_b, Pose{});
    list.put("freedom", members(c.def.freedom)).put("motor", members(c.def.motor)).put("spring", members(c.def.spring));
    list.add("collide", c.def.collide, false);
    say(element("joint", c.joint) + " = made(world.create_joint(" + list.str() + "))");
  }
  void operator()(const MakeSpring& c) {
    count(springs_, c.spring);
    Members list("SpringDef");
    list.put("a", body_text(c.a)).put("b", body_text(c.b));
    list.add("anchor_a", c.def.anchor_a, Vec3{}).add("anchor_b", c.def.anchor_b, Vec3{});
    list.add("rest_length", c.def.rest_length, 0.0).add("stiffness", c.def.stiffness, 0.0);
    list.add("damping", c.def.damping, 0.0);
    say(element("spring", c.spring) + " = made(world.create_spring(" + list.str() + "))");
  }
  void operator()(const MakeRagdoll& c) {
    const int bones = int(c.def.bones.size());
    count(bodies_, c.first_body + bones - 1);
    count(joints_, c.first_joint + std::max(bones - 2, 0));
    ragdolls_ = true;
    const std::string def = ragdoll_definition(c.def);
    say("make_ragdoll(" + def + ", Pose" + text(c.pose) + ", Vec3" + text(c.velocity) + ", " +
        std::to_string(c.first_body) + ", " + std::to_string(c.first_joint) + ")");
  }
  void operator()(const Destroy& c) {
    switch (c.object) {
      case Object::body: return tell("destroy(" + body_text(c.number) + ")");
      case Object::joint: return tell("destroy(" + element("joint", c.number) + ")");
      case Object::spring: return tell("destroy(" + element("spring", c.number) + ")");
      case Object::force: return tell("remove(" + element("force", c.number) + ")");
    }
  }
  void operator()(const SetPose& c) { tell("set_pose(" + body_text(c.body) + ", Pose" + text(c.pose) + ")"); }
  void operator()(const SetVelocity& c) {
    tell("set_velocity(" + body_text(c.body) + ", Vec3" + text(c.velocity) + ")");
    tell("set_angular_velocity(" + body_text(c.body) + ", Vec3" + text(c.angular_velocity) + ")");
  }
  void operator()(const SetMass& c) {
    tell("set_mass_properties(" + body_text(c.body) + ", MassProperties{" + text(c.mass.mass) + ", " +
         text(c.mass.moments) + "})");
  }
  void operator()(const SetMaterial& c) {
    tell("set_material(" + body_text(c.body) + ", " + members(c.material).str() + ")");
  }
  void operator()(const SetDrag& c) {
    tell("set_drag(" + body_text(c.body) + ", " + text(c.linear) + ", " + text(c.angular) + ")");
  }
  void operator()(const SetFilter& c) {
    tell("set_filter(" + body_text(c.body) + ", " + members(c.filter).str() + ")");
  }
  void operator()(const SetCollide& c) {
    tell("set_collide(" + body_text(c.a) + ", " + body_text(c.b) + ", " + text(c.collide) + ")");
  }
  void operator()(const SetMotor& c) {
    tell("set_motor(" + element("joint", c.joint) + ", " + members(c.motor).str() + ")");
  }
  void operator()(const SetJointSpring& c) {
    tell("set_spring(" + element("joint", c.joint) + ", " + members(c.spring).str() + ")");
  }
  void operator()(const SetSpring& c) {
    tell("set_spring(" + element("spring", c.spring) + ", " + text(c.rest_length) + ", " + text(c.stiffness) + ", " +
         text(c.damping) + ")");
  }
  void operator()(const SetGravity& c) { tell("set_gravity(Vec3" + text(c.gravity) + ")"); }
  void operator()(const AddForce& c) {
    count(forces_, c.force);
    say(element("force", c.force) + " = made(world.add_force(" + body_text(c.body) + ", " + wrench_text(c.wrench) +
        "))");
  }
  void operator()(const SetCanSleep& c) { tell("set_can_sleep(" + body_text(c.body) + ", " + text(c.can_sleep) + ")"); }
  void operator()(const Wake& c) { tell("wake(" + body_text(c.body) + ")"); }
  void operator()(const Configure& c) {
    tells_ = true;
    say("tell(stepper.configure(" + settings_text(c.settings) + "))");
  }
  void operator()(const Save&) {
    saves_ = true;
    say("saved = world.snapshot()");
  }
  void operator()(const Restore&) {
    saves_ = true;
    tell("restore(saved)");
  }
  void operator()(const Steps& c) { say("play(" + std::to_string(c.count) + ", " + text(c.dt) + ")"); }

  const std::string& statements() const { return out_; }
  std::string globals() const {
    std::string list;
    const auto array = [&](const char* type, const char* name, int size) {
      if (size > 0) list += std::string(type) + " " + name + "[" + std::to_string(size) + "];\n";
    };
    array("BodyId", "body", bodies_);
    array("JointId", "joint", joints_);
    array("SpringId", "spring", springs_);
    array("ForceId", "force", forces_);
    if (saves_) list += "std::vector<std::byte> saved;\n";
    return list;
  }
  bool ragdolls() const { return ragdolls_; }
  bool tells() const { return tells_; }

  /// As the player places stages.
  std::string settings_text(StepSettings settings) const {
    settings.set_all(options_.place);
    settings.lanes = options_.lanes;
    settings.threads = options_.threads;
    return members(settings).str();
  }

 private:
  static void count(int& size, int number) { size = std::max(size, number + 1); }
  void say(const std::string& content) { out_ += statement(content); }
  void tell(const std::string& content) {
    tells_ = true;
    say("tell(world." + content + ")");
  }

  /// The hull made of the corners of another has its frame where that one has it, to rounding.
  std::string hull_text(const Hull& hull) {
    const auto known = std::find(hulls_.begin(), hulls_.end(), hull);
    const std::string name = "hull_" + std::to_string(known - hulls_.begin());
    if (known != hulls_.end()) return name;
    hulls_.push_back(hull);
    std::string points;
    for (const Vec3 v : hull.vertices()) points += (points.empty() ? "" : ", ") + text(v);
    say("const Hull " + name + " = *make_hull(std::vector<Vec3>{" + points + "})");
    return name;
  }

  /// Where the hull that the program makes has another frame (two equal moments), the shape is turned back by it.
  static Pose local_of(const ShapeDef& shape) {
    if (shape.kind != ShapeKind::hull) return shape.local;
    const auto made = make_hull(shape.convex.vertices());
    if (!made) return shape.local;
    const Pose frame = made->frame();
    const bool same =
        length(frame.position) < 1e-12 * shape.convex.radius() && 1 - std::fabs(frame.orientation.w) < 1e-15;
    if (same) return shape.local;
    return {transform(shape.local, frame.position), shape.local.orientation * frame.orientation};
  }

  std::string text_of(const ShapeDef& shape) {
    const Pose local = local_of(shape);
    const bool plain = local == Pose{} && members(shape.filter).empty();
    const std::string kind = text(shape.kind).substr(std::string_view("ShapeKind::").size());
    if (plain && shape.kind == ShapeKind::hull) return "ShapeDef::hull(" + hull_text(shape.convex) + ")";
    if (plain && shape.kind == ShapeKind::sphere) return "ShapeDef::sphere(" + text(shape.size.x) + ")";
    if (plain && shape.kind == ShapeKind::plane) return "ShapeDef::plane()";
    if (plain && shape.kind == ShapeKind::box) return "ShapeDef::box(" + text(shape.size) + ")";
    if (plain) return "ShapeDef::" + kind + "(" + text(shape.size.x) + ", " + text(shape.size.y) + ")";
    Members list("ShapeDef");
    list.put("kind", text(shape.kind)).put("size", text(shape.size));
    list.add("local", local, Pose{}).put("filter", members(shape.filter));
    if (shape.kind == ShapeKind::hull) list.put("convex", hull_text(shape.convex));
    return list.str();
  }

  std::string text_of(const BodyDef& def) {
    const BodyDef usual;
    std::string shapes;
    for (const ShapeDef& shape : def.shapes) shapes += (shapes.empty() ? "" : ", ") + text_of(shape);
    Members list("BodyDef");
    list.add("kind", def.kind, usual.kind).add("pose", def.pose, usual.pose);
    list.add("velocity", def.velocity, usual.velocity);
    list.add("angular_velocity", def.angular_velocity, usual.angular_velocity);
    if (!shapes.empty()) list.put("shapes", "{" + shapes + "}");
    list.add("density", def.density, usual.density);
    const auto [mass, moments] = mass_of(def);
    if (mass) list.put("mass", text(*mass));
    if (moments) list.put("moments", "Vec3" + text(*moments));
    list.put("material", members(def.material)).add("linear_drag", def.linear_drag, usual.linear_drag);
    list.add("angular_drag", def.angular_drag, usual.angular_drag).add("can_sleep", def.can_sleep, usual.can_sleep);
    list.add("rotates", def.rotates, usual.rotates);
    return list.str();
  }

  /// A hull that is turned back stands displaced in its body, which then needs the mass and moments that it had by
  /// itself.
  static std::pair<std::optional<double>, std::optional<Vec3>> mass_of(const BodyDef& def) {
    if (def.kind != BodyKind::dynamic || def.moments || def.shapes.size() != 1) return {def.mass, def.moments};
    const ShapeDef& shape = def.shapes[0];
    if (shape.kind != ShapeKind::hull || local_of(shape) == shape.local) return {def.mass, def.moments};
    const auto own = mass_properties(shape, def.density);
    if (!own) return {def.mass, def.moments};
    const double scale = def.mass ? *def.mass / own->mass : 1;
    return {scale * own->mass, scale * own->moments};
  }

  /// The name of the variable that holds it; ragdolls of one kind share theirs.
  std::string ragdoll_definition(const RagdollDef& def) {
    std::vector<std::string> lines;
    const RagdollDef usual;
    if (def.density != usual.density) lines.push_back(".density = " + text(def.density));
    const Members material = members(def.material);
    if (!material.empty()) lines.push_back(".material = " + material.str());
    for (const BoneDef& bone : def.bones) {
      Members list("BoneDef");
      list.add("parent", bone.parent, -1).put("shape", text_of(bone.shape)).add("pose", bone.pose, Pose{});
      list.add("joint", bone.joint, Vec3{}).add("joint_axes", bone.joint_axes, Quat{});
      list.put("freedom", members(bone.freedom)).add("damping", bone.damping, 0.0);
      lines.push_back(".bones.push_back(" + list.str() + ")");
    }
    const auto known = std::find(definitions_.begin(), definitions_.end(), lines);
    const std::string name = "ragdoll_" + std::to_string(known - definitions_.begin());
    if (known != definitions_.end()) return name;
    definitions_.push_back(lines);
    say("RagdollDef " + name);
    for (const std::string& line : lines) say(name + line);
    return name;
  }

  const PlayOptions& options_;
  std::string out_;
  int bodies_ = 0, joints_ = 0, springs_ = 0, forces_ = 0;
  bool ragdolls_ = false, saves_ = false, tells_ = false;
  std::vector<Hull> hulls_;
  std::vector<std::vector<std::string>> definitions_;
};

// ---- what stands around --------------------------------------------------------------------------------------

constexpr const char* maker = R"(/// The new object's id; none where the library refused it.
template <class Id> Id made(const Result<Id>& result) {
  if (!result) std::printf("refused: %s\n", result.error().message.c_str());
  return result ? *result : Id{};
}

)";

constexpr const char* teller = R"(void tell(const Status& status) {
  if (!status) std::printf("refused: %s\n", status.error().message.c_str());
}

)";

constexpr const char* ragdoll_helper =
    R"(void make_ragdoll(const RagdollDef& def, const Pose& pose, Vec3 velocity, int first_body, int first_joint) {
  const Result<Ragdoll> ragdoll = world.create_ragdoll(def, pose, velocity);
  if (!ragdoll) return std::printf("refused: %s\n", ragdoll.error().message.c_str()), void();
  for (std::size_t i = 0; i < ragdoll->bones.size(); i++) body[first_body + int(i)] = ragdoll->bones[i];
  for (std::size_t i = 0; i < ragdoll->joints.size(); i++) joint[first_joint + int(i)] = ragdoll->joints[i];
}

)";

constexpr const char* player = R"(int steps_made = 0;

/// Prints energy and the fastest body after each step.
void play(int steps, double dt) {
  for (int i = 0; i < steps; i++) {
    const StepReport& report = stepper.step(world, dt);
    if (!report) {
      std::printf("step %d: %s\n", steps_made + 1, report.error.message.c_str());
      std::exit(1);
    }
    steps_made++;
    double fastest = 0;
    for (const BodyId id : world.bodies()) fastest = std::fmax(fastest, length(*world.velocity(id)));
    const double energy = world.kinetic_energy() + world.potential_energy() + world.spring_energy();
    std::printf("step %d: energy %.9g J, fastest body %.6g m/s\n", steps_made, energy, fastest);
  }
}

)";

std::string figure(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.4g", value);
  return buffer;
}

std::string head(const Scene& scene, const PlayOptions& options, const Verdict& verdict) {
  std::string lines = "// " + scene.family + ", seed " + std::to_string(scene.seed) + ": ";
  const Measure worst = verdict.worst();
  if (!verdict.failure.empty()) {
    lines += "a step could not be made.\n// " + verdict.failure + "\n";
  } else if (worst == Measure::count) {
    lines += "nothing is broken.\n";
  } else {
    const Finding& found = verdict[worst];
    const MeasureInfo& about = info(worst);
    const std::string unit = about.unit.empty() || about.unit == "1" ? "" : " " + std::string(about.unit);
    lines += std::string(about.name) + " is " + figure(found.worst) + unit;
    if (found.bound) lines += ", and may be at most " + figure(*found.bound) + unit;
    lines += ", after step " + std::to_string(found.step) + ".\n// (" + std::string(about.name) + ": " +
             std::string(about.meaning) + ")\n";
  }
  lines +=
      "// The whole scene that this was made of: pcphys wild " + scene.family + " --seed " + std::to_string(scene.seed);
  if (options.precision == Precision::f64) lines += " --precision double";
  return lines + "\n";
}

}  // namespace

std::string as_program(const Scene& scene, const PlayOptions& options, const Verdict& verdict) {
  Writer writer(options);
  for (const Call& call : scene.calls) std::visit(writer, call);
  const std::string world = "World world(WorldDef{.precision = " + text(options.precision) +
                            ", .gravity = " + text(scene.world.gravity) + "});\n";
  const std::string stepper = "Stepper stepper(" + writer.settings_text(scene.settings) + ");\n";

  std::string program = head(scene, options, verdict);
  program += "#include <cmath>\n#include <cstddef>\n#include <cstdio>\n#include <cstdlib>\n#include <limits>\n";
  program += "#include <vector>\n\n#include \"pcphys/pcphys.h\"\n\nusing namespace pcphys;\n\nnamespace {\n\n";
  if (writer.statements().find("infinity") != std::string::npos)
    program += "constexpr double infinity = std::numeric_limits<double>::infinity();\n";
  program += world + stepper + writer.globals() + "\n" + maker;
  if (writer.tells()) program += teller;
  if (writer.ragdolls()) program += ragdoll_helper;
  program += std::string(player) + "}  // namespace\n\nint main() {\n" + writer.statements();
  program += "  std::printf(\"hash 0x%016llx\\n\", static_cast<unsigned long long>(world.hash()));\n}\n";
  return program;
}

}  // namespace pcphys::wild
