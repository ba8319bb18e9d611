#include "plan/own_kernels.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <string>
#include <string_view>

#include "world/validate.h"

namespace pcphys {
namespace {

constexpr std::size_t most_buffers = 8;  // storage blocks that GL 4.3 guarantees
constexpr std::string_view writable[] = {"force", "torque", "displacement_rate", "angular_momentum"};

std::string quoted(std::string_view text) { return "\"" + std::string(text) + "\""; }
Error bad(const OwnKernel& k, const std::string& what) {
  return {ErrorCode::bad_argument, "The kernel " + quoted(k.name) + " " + what};
}

template <class List, class Value, class Of = std::identity> bool contains(const List& list, const Value& value, Of of = {}) {
  return std::ranges::find(list, value, of) != std::ranges::end(list);
}

struct TypeWord {
  std::string_view word;
  PropertyType type;
};
constexpr TypeWord type_words[] = {{"Real", PropertyType::real},       {"Vec3", PropertyType::vec3},
                                   {"Quaternion", PropertyType::quat}, {"Sym3", PropertyType::sym3},
                                   {"Quad", PropertyType::vec4},       {"Mat3", PropertyType::mat3},
                                   {"float", PropertyType::float32},   {"double", PropertyType::float64},
                                   {"int", PropertyType::int32},       {"uint", PropertyType::uint32}};
constexpr std::string_view kind_words[] = {"PC_IN", "PC_INOUT", "PC_OUT", "PC_PARAM"};

/// Words and signs of a signature.
class Tokens {
 public:
  explicit Tokens(std::string_view text) : rest_(text) {}
  std::string_view next() {
    while (!rest_.empty() && (rest_[0] == ' ' || rest_[0] == '\n' || rest_[0] == '\t')) rest_.remove_prefix(1);
    if (rest_.empty()) return {};
    const auto part_of_word = [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    };
    std::size_t n = 0;
    while (n < rest_.size() && part_of_word(rest_[n])) n++;
    const std::string_view token = rest_.substr(0, n == 0 ? 1 : n);
    rest_.remove_prefix(token.size());
    return token;
  }
  bool take(std::string_view wanted) { return next() == wanted; }

 private:
  std::string_view rest_;
};

Status parse(OwnKernel& k, std::string_view signature) {
  const Error wrong =
      bad(k, "has the signature `" + std::string(signature) +
                 "`; write it as (PC_IN(Vec3) position, PC_INOUT(Real) fuel, PC_PARAM(Real) flow), with PC_OUT for what "
                 "is written anew, and types Real, Vec3, Quaternion, Quad, Sym3, Mat3, float, double, int or uint.");
  Tokens tokens(signature);
  if (!tokens.take("(")) return wrong;
  std::string_view sign = ",";
  while (sign == ",") {
    OwnArgument argument;
    const auto* kind = std::ranges::find(kind_words, tokens.next());
    if (kind == std::end(kind_words) || !tokens.take("(")) return wrong;
    const auto* type = std::ranges::find(type_words, tokens.next(), &TypeWord::word);
    if (type == std::end(type_words) || !tokens.take(")")) return wrong;
    argument.kind = OwnArgument::Kind(kind - kind_words);
    argument.type = type->type;
    argument.name = tokens.next();
    if (contains(k.arguments, argument.name, &OwnArgument::name))
      return bad(k, "names " + quoted(argument.name) + " twice in its signature; PC_INOUT reads and writes.");
    k.arguments.push_back(std::move(argument));
    sign = tokens.next();
  }
  if (sign != ")" || !tokens.next().empty()) return wrong;
  if (k.arguments.size() > OwnKernel::most_arguments)
    return bad(k, "has " + std::to_string(k.arguments.size()) + " arguments; at most 32 are possible.");
  return {};
}

/// A property as kernels find it, the library's or the host's own.
struct Found {
  Table table{};
  Buffer buffer{};
  std::uint32_t offset = 0;
  PropertyType type = PropertyType::real;
  bool own = false;
};
bool find_property(const WorldState& s, std::string_view name, Found& found) {
  for (const PropertySchema& p : properties())
    if (p.name == name) return found = {p.table, p.buffer, std::uint32_t(p.offset * s.tables.real_bytes()), p.type, false}, true;
  for (const OwnProperty& p : s.own.list)
    if (p.used && p.name == name) return found = {p.table, p.buffer, 0, p.type, true}, true;
  return false;
}

Status bind_property(const WorldState& s, OwnKernel& k, OwnArgument& a) {
  Found f;
  if (!find_property(s, a.name, f))
    return Error{ErrorCode::unknown_name, "The kernel " + quoted(k.name) + " uses the property " + quoted(a.name) +
                                              ", which the world does not have; add it first (World::add_property), or make it a "
                                              "PC_PARAM."};
  if (f.type != a.type)
    return Error{ErrorCode::wrong_type, "The kernel " + quoted(k.name) + " declares " + quoted(a.name) + " as " +
                                            std::string(name(a.type)) + "; the property is of type " + std::string(name(f.type)) +
                                            "."};
  if (f.table != k.table)
    return bad(k, "runs over another table than that of its property " + quoted(a.name) + "; all of them must be of one table.");
  if (a.writes() && !f.own && std::ranges::find(writable, a.name) == std::end(writable))
    return bad(k, "writes " + quoted(a.name) +
                      ", from which the library derives others; of its properties kernels may write force, torque, "
                      "displacement_rate and angular_momentum.");
  a.buffer = f.buffer;
  a.offset = f.offset;
  a.row_bytes = std::uint32_t(s.tables.row_bytes(f.buffer));
  const auto bound = std::ranges::find(k.accesses, a.buffer, &Access::buffer);
  if (bound == k.accesses.end())
    k.accesses.push_back({a.buffer, a.writes()});
  else
    bound->write |= a.writes();
  return {};
}

Status bind_parameter(OwnKernel& k, OwnArgument& a, const std::vector<KernelParameter>& values) {
  const auto value = std::ranges::find(values, a.name, &KernelParameter::name);
  if (value == values.end()) {
    a.given = (a.name == "h" && a.type == PropertyType::real) || (a.name == "gravity" && a.type == PropertyType::vec3);
    if (a.given) return {};
    return bad(k, "has the parameter " + quoted(a.name) + ", and no value is given for it (KernelDef::parameters).");
  }
  a.place = std::uint32_t(k.parameters.size());
  k.parameters.resize(k.parameters.size() + OwnKernel::parameter_bytes);
  return set(k, *value);
}

/// Whether a must run before b, of one moment.
bool precedes(const OwnKernel& a, const OwnKernel& b) {
  if (std::ranges::find(b.follows, a.name) != b.follows.end()) return true;
  if (std::ranges::find(a.follows, b.name) != a.follows.end()) return false;
  const auto rank = [](OwnArgument::Kind kind) {
    return kind == OwnArgument::Kind::out ? 0 : kind == OwnArgument::Kind::inout ? 1 : 2;
  };
  for (const OwnArgument& x : a.arguments)
    for (const OwnArgument& y : b.arguments)
      if (x.kind != OwnArgument::Kind::parameter && y.kind != OwnArgument::Kind::parameter && x.name == y.name && x.writes() &&
          rank(x.kind) < rank(y.kind))
        return true;
  return false;
}
bool same_moment(const OwnKernel& a, const OwnKernel& b) {
  return a.stage == b.stage && a.after == b.after && a.once_a_step == b.once_a_step;
}

}  // namespace

Result<std::shared_ptr<OwnKernel>> resolve(const WorldState& s, const KernelDef& def) {
  static std::atomic<std::uint64_t> serials{0};
  auto k = std::make_shared<OwnKernel>();
  k->serial = ++serials;
  k->name = def.text.name;
  k->body = def.text.body ? def.text.body : "";
  k->file = def.text.file;
  k->line = def.text.line;
  k->real_bytes = s.tables.real_bytes();
  k->loop = s.tables.precision() == Precision::f32 ? def.text.f32 : def.text.f64;
  k->stage = def.stage;
  k->after = def.after;
  k->once_a_step = def.once_a_step;
  k->follows = def.follows;
  if (k->name.empty()) return bad(*k, "has no name.");
  if (k->body.empty() && !k->loop) return bad(*k, "has neither a C++ nor a GLSL side; write it with PCPHYS_KERNEL.");
  const Result<Table> table = s.table_of(def.over);
  if (!table) return table.error();
  k->table = *table;
  if (k->table == Table::body) k->accesses.push_back({Buffer::bodies, false});
  Status ok = parse(*k, def.text.signature);
  for (OwnArgument& a : k->arguments) {
    if (!ok) break;
    ok = a.kind == OwnArgument::Kind::parameter ? bind_parameter(*k, a, def.parameters) : bind_property(s, *k, a);
  }
  if (!ok) return ok.error();
  for (const KernelParameter& p : def.parameters)
    if (!contains(k->arguments, p.name, &OwnArgument::name))
      return bad(*k, "is given the parameter " + quoted(p.name) + ", which its signature does not have.");
  if (k->accesses.size() > most_buffers) {
    std::string list;
    for (const OwnArgument& a : k->arguments)
      if (a.kind != OwnArgument::Kind::parameter) list += (list.empty() ? "" : ", ") + a.name;
    return bad(*k, "needs " + std::to_string(k->accesses.size()) + " storage blocks (" + list +
                       (k->table == Table::body ? ", and the list of bodies" : "") +
                       "); a GPU has eight for a program. Properties of the library that stand in one buffer share a block "
                       "(docs/properties.md); a vec4 or a mat3 may hold several of your own.");
  }
  const bool forces = k->writes(Buffer::force);
  if (forces && (k->table != Table::body || k->stage != Stage::integrate || k->after))
    return bad(*k, "writes force or torque, which the stage integrate takes up; run it before that stage.");
  if (std::ranges::none_of(k->accesses, &Access::write))
    return bad(*k, "writes nothing; declare what it changes as PC_INOUT or PC_OUT.");
  return k;
}

Status check_properties(const WorldState& s, const OwnKernel& k) {
  for (const OwnArgument& a : k.arguments) {
    Found f;
    if (a.kind == OwnArgument::Kind::parameter) continue;
    if (!find_property(s, a.name, f) || f.buffer != a.buffer || f.type != a.type || f.table != k.table)
      return Error{ErrorCode::stale_id,
                   "The kernel " + quoted(k.name) + " uses the property " + quoted(a.name) +
                       ", which was removed; remove the kernel too (Stepper::remove_kernel), and add it again where "
                       "there is a new one of that name. The world is as it was."};
  }
  return {};
}

Status set(OwnKernel& k, const KernelParameter& value) {
  const auto a = std::ranges::find_if(k.arguments, [&](const OwnArgument& argument) {
    return argument.kind == OwnArgument::Kind::parameter && argument.name == value.name && !argument.given;
  });
  if (a == k.arguments.end())
    return Error{ErrorCode::unknown_name,
                 "The kernel " + quoted(k.name) + " has no parameter " + quoted(value.name) + " that a host gives."};
  if (value.type != a->type)
    return Error{ErrorCode::wrong_type, "The kernel " + quoted(k.name) + " declares its parameter " + quoted(a->name) + " as " +
                                            std::string(name(a->type)) + "; the value given is of type " +
                                            std::string(name(value.type)) + "."};
  const std::uint32_t count = components(a->type);
  if (a->type != PropertyType::int32 && a->type != PropertyType::uint32)
    for (std::uint32_t c = 0; c < count; c++)
      if (Status ok = check_finite(value.value.x[c], ("parameter " + quoted(a->name)).c_str()); !ok) return ok;
  for (std::uint32_t c = 0; c < count; c++)
    write_number(k.parameters.data() + a->place + c * number_bytes(a->type, k.real_bytes), a->type, k.real_bytes,
                 value.value.x[c]);
  return {};
}

OwnKernel* OwnKernels::find(std::string_view name) const {
  for (const auto& k : kernels_)
    if (k->name == name) return k.get();
  return nullptr;
}

Status OwnKernels::order(std::vector<std::shared_ptr<OwnKernel>>& out) const {
  std::vector<std::shared_ptr<OwnKernel>> left = kernels_;
  out.clear();
  while (!left.empty()) {
    const auto free = std::ranges::find_if(left, [&](const auto& b) {
      return std::ranges::none_of(left, [&](const auto& a) { return a != b && same_moment(*a, *b) && precedes(*a, *b); });
    });
    if (free == left.end())
      return bad(*left[0], "and " + quoted(left[1]->name) +
                               " each have to run before the other; run one of them at another stage, or say which follows which "
                               "(KernelDef::follows).");
    out.push_back(*free);
    left.erase(free);
  }
  return {};
}

Status OwnKernels::add(std::shared_ptr<OwnKernel> kernel) {
  if (find(kernel->name))
    return Error{ErrorCode::name_taken,
                 "There is a kernel " + quoted(kernel->name) + " already; remove it, or choose another name."};
  for (const auto& other : kernels_) {
    if (other->writes(Buffer::force) && kernel->writes(Buffer::force) && other->once_a_step != kernel->once_a_step)
      return bad(*kernel, "and " + quoted(other->name) +
                              " both make forces, one of them once a step; let both run once a step, or both in "
                              "each sub-step.");
    if (!same_moment(*other, *kernel)) continue;
    for (const OwnArgument& a : other->arguments)
      for (const OwnArgument& b : kernel->arguments)
        if (a.kind == OwnArgument::Kind::out && b.kind == OwnArgument::Kind::out && a.name == b.name &&
            !contains(kernel->follows, other->name) && !contains(other->follows, kernel->name))
          return bad(
              *kernel,
              "and " + quoted(other->name) + " both write " + quoted(a.name) +
                  " anew at the same moment; say which follows which (KernelDef::follows), or let one change it (PC_INOUT).");
  }
  kernels_.push_back(std::move(kernel));
  std::vector<std::shared_ptr<OwnKernel>> ordered;
  if (Status ok = order(ordered); !ok) {
    kernels_.pop_back();
    return ok;
  }
  ordered_ = std::move(ordered);
  version_++;
  return {};
}

Status OwnKernels::remove(std::string_view name) {
  const auto it = std::ranges::find_if(kernels_, [&](const auto& k) { return k->name == name; });
  if (it == kernels_.end())
    return Error{ErrorCode::unknown_name, "There is no kernel " + quoted(name) + "; Stepper::add_kernel adds one."};
  kernels_.erase(it);
  (void)order(ordered_);
  version_++;
  return {};
}

void OwnKernels::clear() {
  kernels_.clear();
  ordered_.clear();
  version_++;
}

}  // namespace pcphys
