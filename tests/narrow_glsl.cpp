// Pins that the narrow phase stays in the common subset: the same text compiles as GLSL in both precisions.
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>

namespace {
std::string read(const std::filesystem::path& path) {
  std::ifstream file(path);
  REQUIRE_MESSAGE(file.good(), path.string());
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}
std::string with_includes(const std::filesystem::path& path) {
  std::stringstream lines(read(path));
  std::string out, line;
  const std::string directive = "#include \"";
  while (std::getline(lines, line)) {
    if (line.starts_with(directive))
      out += with_includes(path.parent_path() /
                           line.substr(directive.size(), line.find('"', directive.size()) - directive.size()));
    else
      out += line + "\n";
  }
  return out;
}
std::string program(bool twofold) {
  const std::filesystem::path kernels = std::filesystem::path(PCPHYS_SOURCE_DIR) / "src/kernels";
  std::string text = "#version 430\n";
  text += twofold ? "#define PC_DOUBLE\n#define Real double\n#define Vec3 dvec3\n"
                  : "#define Real float\n#define Vec3 vec3\n";
  text += R"(
#define Mask bool
#define Index uint
#define PC_FN
#define PC_INOUT(T) inout T
#define PC_ANY(mask) (mask)
Real pc_select(bool m, Real a, Real b) { return m ? a : b; }
bool pc_and(bool a, bool b) { return a && b; }
bool pc_or(bool a, bool b) { return a || b; }
Real pc_abs(Real a) { return abs(a); }
Real pc_div(Real a, Real b) { precise Real q = a / b; return q; }
Real pc_sqrt(Real a) { precise Real r = sqrt(a); return r; }
)";
  text += R"(
struct HullRef { uint reals; uint indices; };
layout(std430, binding = 3) readonly buffer HullReals { Real hull_reals[]; };
layout(std430, binding = 4) readonly buffer HullIndices { uint hull_indices[]; };
Real pc_hull_real(HullRef h, uint i) { return hull_reals[h.reals + i]; }
uint pc_hull_index(HullRef h, uint i) { return hull_indices[h.indices + i]; }
)";
  text += with_includes(kernels / "math.inl") + with_includes(kernels / "narrow/narrow.inl");
  text += R"(
layout(local_size_x = 64) in;
struct Row { Real v[14]; };
layout(std430, binding = 0) readonly buffer Shapes { Row shapes[]; };
layout(std430, binding = 1) buffer Manifolds { Real manifolds[]; };
layout(std430, binding = 2) buffer Hints { uint hints[]; };
NarrowShape shape(uint i) {
  NarrowShape s; s.kind = uint(shapes[i].v[0]); s.size = Vec3(shapes[i].v[1], shapes[i].v[2], shapes[i].v[3]);
  s.p = Vec3(shapes[i].v[4], shapes[i].v[5], shapes[i].v[6]);
  s.q = pc_quaternion(Vec3(shapes[i].v[7], shapes[i].v[8], shapes[i].v[9]), shapes[i].v[10]);
  s.hull.reals = uint(shapes[i].v[11]); s.hull.indices = uint(shapes[i].v[12]);
  return s;
}
void main() {
  uint i = gl_GlobalInvocationID.x; uint hint = hints[i]; NarrowManifold m;
  pc_narrow(shape(2u * i), shape(2u * i + 1u), shapes[2u * i].v[13], hint, m);
  hints[i] = hint; manifolds[i * 20u] = m.normal.x; manifolds[i * 20u + 1u] = Real(m.count);
  for (uint k = 0u; k < m.count; k++) manifolds[i * 20u + 2u + k] = m.points[k].separation;
}
)";
  return std::regex_replace(text, std::regex(R"(PC_REAL\(([^)]*)\))"), twofold ? "($1lf)" : "($1f)");
}
}  // namespace

TEST_CASE("narrow: the text compiles as GLSL") {
  if (std::system("glslangValidator --version > /dev/null 2>&1") != 0) {
    MESSAGE("glslangValidator was not found (Debian, Ubuntu: apt-get install glslang-tools)");
    return;
  }
  for (const bool twofold : {false, true}) {
    const auto stem = std::filesystem::temp_directory_path() / ("pcphys_narrow_" + std::to_string(twofold));
    const std::string source = stem.string() + ".comp", log = stem.string() + ".log";
    std::ofstream(source) << program(twofold);
    const int code = std::system(("glslangValidator " + source + " > " + log + " 2>&1").c_str());
    CHECK_MESSAGE(code == 0, read(log));
  }
}
