#include "plan/own_kernels.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <string>
#include <string_view>

#include "pcphys/constants.h"
#include "plan/kernel_lines.h"
#include "plan/own_signature.h"
#include "plan/own_words.h"
#include "world/validate.h"

namespace pcphys {
namespace {

constexpr std::size_t most_buffers = 8;  // storage blocks that GL 4.3 guarantees
constexpr std::string_view writable[] = {"force", "torque", "displacement_rate", "angular_momentum"};

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
    if (p.name == name)
      return found = {p.table, p.buffer, std::uint32_t(p.offset * s.tables.real_bytes()), p.type, false}, true;
  for (const OwnProperty& p : s.own.list)
    if (p.used && p.name == name) return found = {p.table, p.buffer, 0, p.type, true}, true;
  return false;
}

void add_access(std::vector<Access>& accesses, Buffer buffer, bool write) {
  const auto known = std::ranges::find(accesses, buffer, &Access::buffer);
  if (known == accesses.end())
    accesses.push_back({buffer, write});
  else
    known->write |= write;
}
/// `sums`: by the program that puts sums together, where there are two.
void use(OwnKernel& k, Buffer buffer, bool write, bool sums) {
  if (k.form != OwnKernel::Form::element) add_access(sums ? k.second : k.first, buffer, write);
  add_access(k.accesses, buffer, write);
}
void read_list(OwnKernel& k, Buffer list) { use(k, list, false, false); }

/// What is said of a property that is of another table than its argument asks for.
Error wrong_table(const OwnKernel& k, const OwnArgument& a, Table table) {
  if (a.of_three() != 0)
    return bad(k, "says PC_A or PC_B of " + quoted(a.name) + ", and " + quoted(a.property) +
                      " is no property of bodies; the joint's own are PC_IN, PC_INOUT and PC_OUT.");
  if (k.table == Table::joint && table == Table::body)
    return bad(k, "runs over joints and uses " + quoted(a.property) +
                      ", a property of bodies; say of which body: PC_A(T) " + a.property + "_a or PC_B(T) " +
                      a.property + "_b, and PC_ADD_A(T) or PC_ADD_B(T) for what it is given.");
  return bad(k, "runs over another table than that of its property " + quoted(a.property) +
                    "; all of them must be of one table, or what is read of a table of one row.");
}

Status bind_property(const WorldState& s, OwnKernel& k, OwnArgument& a) {
  Found f;
  // `part_of_a` is of the property part_of where there is one, else of part
  if (const std::string whole = whole_property_of(a);
      whole != a.property && find_property(s, whole, f) && f.table == Table::body)
    a.property = whole;
  if (!find_property(s, a.property, f))
    return Error{ErrorCode::unknown_name,
                 "The kernel " + quoted(k.name) + " uses the property " + quoted(a.property) +
                     ", which the world does not have; add it first (World::add_property), or make it a "
                     "PC_PARAM."};
  if (f.type != a.type)
    return Error{ErrorCode::wrong_type, "The kernel " + quoted(k.name) + " declares " + quoted(a.name) + " as " +
                                            std::string(name(a.type)) + "; the property is of type " +
                                            std::string(name(f.type)) + "."};
  // a total goes into a table of one row, and every kernel may read there
  const bool total = k.form == OwnKernel::Form::reduction && a.summed();
  const Table wanted = a.of_three() == 0 ? k.table : Table::body;
  a.single = f.table != wanted && f.table >= Table::count && s.tables.rows(f.table) == 2 && (total || !a.writes()) &&
             a.of_three() == 0;
  if (total && !a.single)
    return bad(k, "makes one value of all rows, " + quoted(a.name) +
                      ", which is a property of many; add it to a table of one row (World::add_table(name, 1)).");
  if (f.table != wanted && !a.single) return wrong_table(k, a, f.table);
  if (k.form == OwnKernel::Form::pair && a.kind == OwnArgument::Kind::in && !a.single)
    return bad(k, "is of pairs and says PC_IN of " + quoted(a.name) + "; say of which body: PC_SELF(T) " + a.name +
                      ", or PC_OTHER(T) " + a.name + "_other.");
  if (a.writes() && !f.own && std::ranges::find(writable, a.property) == std::end(writable))
    return bad(k, "writes " + quoted(a.name) +
                      ", from which the library derives others; of its properties kernels may write force, torque, "
                      "displacement_rate and angular_momentum.");
  a.table = f.table;
  a.buffer = f.buffer;
  a.offset = f.offset;
  a.row_bytes = std::uint32_t(s.tables.row_bytes(f.buffer));
  use(k, a.buffer, a.writes(), a.summed());
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

// ---- pairs, joints with their bodies, and reductions ---------------------------------------------------
/// PC_OTHER, PC_A and so on: the name says so too.
Status check_ending(const OwnKernel& k, const OwnArgument& a) {
  using Kind = OwnArgument::Kind;
  const char* ending = a.kind == Kind::other ? "_other" : a.of_three() == 1 ? "_a" : a.of_three() == 2 ? "_b" : nullptr;
  if (!ending || a.name != a.property) return {};
  const std::string word(word_of(a.kind));
  return bad(k, "says " + word + " of " + quoted(a.name) + "; the name of such an argument ends in " + ending + ": " +
                    a.name + ending + ".");
}

/// Of a joint with its bodies: what does not go with that.
Status check_joined(OwnKernel& k) {
  using Kind = OwnArgument::Kind;
  if (k.table != Table::joint)
    return bad(k, "names the bodies of a joint (PC_A, PC_B); let it run over joints: .over = joint_table.");
  for (const OwnArgument& a : k.arguments) {
    k.reached = a.at;
    if (a.kind == Kind::self || a.kind == Kind::other || (a.summed() && a.of_three() == 0))
      return bad(k, "is of a joint and its bodies, and says " + std::string(word_of(a.kind)) + " of " + quoted(a.name) +
                        "; what bodies are given is PC_ADD_A or PC_ADD_B, and a total of all joints is made by another "
                        "kernel of a "
                        "property that this one writes (PC_OUT).");
  }
  k.reached = 0;
  return {};
}

Status find_form(OwnKernel& k) {
  using Kind = OwnArgument::Kind;
  using Form = OwnKernel::Form;
  const auto has = [&](auto... kinds) {
    return std::ranges::any_of(k.arguments, [&](const OwnArgument& a) { return ((a.kind == kinds) || ...); });
  };
  if (has(Kind::a, Kind::b, Kind::add_a, Kind::add_b))
    k.form = Form::joined;
  else if (has(Kind::self, Kind::other))
    k.form = Form::pair;
  else if (has(Kind::sum, Kind::least, Kind::most))
    k.form = Form::reduction;
  if (k.form == Form::joined)
    if (Status ok = check_joined(k); !ok) return ok;
  if ((k.form == Form::pair || k.form == Form::reduction) && has(Kind::inout, Kind::out))
    return bad(
        k,
        "is of pairs, or makes one value of all rows; what it writes is then a sum (PC_ADD, PC_SUM) or, of all rows, "
        "PC_SUM, PC_MIN or PC_MAX, and neither PC_INOUT nor PC_OUT.");
  if (k.form == Form::pair && has(Kind::least, Kind::most))
    return bad(k, "is of pairs and says PC_MIN or PC_MAX; pairs are summed: PC_ADD or PC_SUM.");
  if (k.form != Form::pair && has(Kind::add))
    return bad(k, "says PC_ADD, which is for sums over pairs: declare what is read as PC_SELF and PC_OTHER.");
  for (const OwnArgument& a : k.arguments) {
    k.reached = a.at;
    if (Status ok = check_ending(k, a); !ok) return ok;
    const bool ordered = components(a.type) == 1 || a.type == PropertyType::vec3 || a.type == PropertyType::vec4;
    if (a.summed() && (a.type == PropertyType::quat || (a.kind >= Kind::least && !ordered)))
      return Error{ErrorCode::wrong_type,
                   "The kernel " + quoted(k.name) + " makes a sum, least or most of " + quoted(a.name) + ", of type " +
                       std::string(name(a.type)) +
                       ", which has none; sums are of numbers, vectors and matrices, PC_MIN and PC_MAX of "
                       "numbers and vectors."};
  }
  k.reached = 0;
  if ((k.form == Form::pair ? k.loop != nullptr : k.pairs != nullptr))
    return bad(k, k.form == Form::pair ? "is of pairs; write it with PCPHYS_PAIR_KERNEL."
                                       : "names no PC_SELF and no PC_OTHER; write it with PCPHYS_KERNEL.");
  if (!k.cutoff) return {};
  if (k.form != Form::pair || k.table != Table::body)
    return bad(k, "has a cut-off (KernelDef::cutoff), which is for pairs of bodies alone.");
  if (!(*k.cutoff > 0 && *k.cutoff <= constants::largest_state))
    return bad(k, "has a cut-off of " + std::to_string(*k.cutoff) +
                      " m; it must be above zero and finite. Without one all pairs are visited.");
  return {};
}

/// Which rows are visited, and in which order; each pair's or row's place.
void use_lists(OwnKernel& k) {
  if (k.form == OwnKernel::Form::reduction) {
    if (k.table == Table::body) read_list(k, Buffer::moving_by_id);
    if (k.table == Table::joint) read_list(k, Buffer::joints_by_id);
    return;
  }
  if (k.form == OwnKernel::Form::joined) {
    read_list(k, Buffer::joined);
    for (const Buffer list : {Buffer::bodies, Buffer::body_joints}) use(k, list, false, true);
    return;
  }
  if (k.table == Table::body) read_list(k, Buffer::bodies);
  if (k.form == OwnKernel::Form::element) return;
  if (k.table == Table::body) k.second.push_back({Buffer::bodies, false});
  if (k.cutoff) {
    for (const Buffer b : {Buffer::near_first, Buffer::near_rows, Buffer::pose}) read_list(k, b);
  } else if (k.table == Table::body) {
    read_list(k, Buffer::bodies_by_id);
  }
}

Status check_blocks(const OwnKernel& k) {
  const bool element = k.form == OwnKernel::Form::element;
  const bool sums = k.second.size() > k.first.size();
  const std::vector<Access>& bound = element ? k.accesses : sums ? k.second : k.first;
  const std::size_t blocks = bound.size() + (element ? 0 : 1);
  if (blocks <= most_buffers) return {};
  std::string list;
  for (const OwnArgument& a : k.arguments)
    if (a.of_property() && a.summed() == sums) list += (list.empty() ? "" : ", ") + a.name;
  for (const Access& a : bound)
    if (!of_table(a.buffer)) list += element ? ", and the list of bodies" : ", " + std::string(schema(a.buffer).doc);
  if (!element) list += ", and its sums";
  return bad(k,
             "needs " + std::to_string(blocks) + " storage blocks (" + list +
                 "); a GPU has eight for a program. Properties of the library that stand in one buffer share a block "
                 "(docs/properties.md); a vec4 or a mat3 may hold several of your own.");
}

Status fill(const WorldState& s, const KernelDef& def, OwnKernel& k) {
  if (k.name.empty()) return bad(k, "has no name.");
  if (k.body.empty() && !k.in_cpp()) return bad(k, "has neither a C++ nor a GLSL side; write it with PCPHYS_KERNEL.");
  if (Status ok = check_body(k); !ok) return ok;
  if (k.stage == Stage::islands)
    return bad(k,
               "is of the stage islands, which has kernels of the library alone; use integrate, joints or impulses.");
  const Result<Table> table = s.table_of(def.over);
  if (!table) return table.error();
  k.table = *table;
  Status ok = parse_signature(k);
  if (ok) ok = find_form(k);
  if (ok) use_lists(k);
  for (OwnArgument& a : k.arguments) {
    if (!ok) break;
    k.reached = a.at;
    ok = a.kind == OwnArgument::Kind::parameter ? bind_parameter(k, a, def.parameters) : bind_property(s, k, a);
  }
  if (!ok) return ok;
  k.reached = 0;
  for (const KernelParameter& p : def.parameters)
    if (!contains(k.arguments, p.name, &OwnArgument::name))
      return bad(k, "is given the parameter " + quoted(p.name) + ", which its signature does not have.");
  if (ok = check_blocks(k); !ok) return ok;
  const bool forces = k.writes(Buffer::force);
  if (forces && (k.stage != Stage::integrate || k.after))
    return bad(k, "writes force or torque, which the stage integrate takes up; run it before that stage.");
  if (std::ranges::none_of(k.accesses, &Access::write))
    return bad(k, k.form == OwnKernel::Form::pair ? "writes nothing; declare what it sums as PC_ADD or PC_SUM."
                  : k.form == OwnKernel::Form::joined
                      ? "writes nothing; declare what it gives to bodies as PC_ADD_A or PC_ADD_B, or what it changes "
                        "of the joint "
                        "as PC_INOUT or PC_OUT."
                      : "writes nothing; declare what it changes as PC_INOUT or PC_OUT.");
  return {};
}

}  // namespace

std::uint32_t pair_chunk(std::uint32_t count) {
  constexpr std::uint32_t tile = KernelPairs::tile, filled = 1u << 18;  // pairs of a body and a chunk that fill a GPU
  const std::uint32_t most = std::clamp(filled / std::max(count, 1u), 1u, KernelPairs::most_chunks);
  std::uint32_t chunk = tile;
  while (std::uint64_t{chunk} * most < count) chunk *= 2;
  return chunk;
}

Result<std::shared_ptr<OwnKernel>> resolve(const WorldState& s, const KernelDef& def) {
  static std::atomic<std::uint64_t> serials{0};
  auto k = std::make_shared<OwnKernel>();
  k->serial = ++serials;
  const auto text = [](const char* given) { return given ? given : ""; };
  k->name = text(def.text.name);
  k->signature = text(def.text.signature);
  k->body = text(def.text.body);
  k->own_lines = k->body.find('\n') != k->body.npos;
  k->file = text(def.text.file);
  k->line = def.text.line;
  k->real_bytes = s.tables.real_bytes();
  const bool single = s.tables.precision() == Precision::f32;
  k->loop = single ? def.text.f32 : def.text.f64;
  k->pairs = single ? def.text.pairs32 : def.text.pairs64;
  k->cutoff = def.cutoff;
  k->stage = def.stage;
  k->after = def.after;
  k->once_a_step = def.once_a_step;
  k->follows = def.follows;
  if (def.stage > Stage::impulses)
    return bad(*k, "is to run at stage " + std::to_string(unsigned(def.stage)) +
                       "; there are integrate, joints and impulses.");
  const Status ok = fill(s, def, *k);
  if (ok) return k;
  const std::string place = place_in_signature(*k, k->reached);
  return Error{ok.error().code, ok.error().message + (place.empty() ? "" : " At " + place + ".")};
}

Status check_properties(const WorldState& s, const OwnKernel& k) {
  for (const OwnArgument& a : k.arguments) {
    Found f;
    if (!a.of_property()) continue;
    if (!find_property(s, a.property, f) || f.buffer != a.buffer || f.type != a.type || f.table != a.table)
      return Error{ErrorCode::stale_id,
                   "The kernel " + quoted(k.name) + " uses the property " + quoted(a.property) +
                       ", which was removed; remove the kernel too (Stepper::remove_kernel), and add it again where "
                       "there is a new one of that name. The world is as it was."};
    if (a.single && s.tables.rows(a.table) != 2)
      return Error{
          ErrorCode::bad_argument,
          "The kernel " + quoted(k.name) + " uses " + quoted(a.property) + " of a table of one row, which has " +
              std::to_string(s.tables.rows(a.table) - 1) +
              " now; give it one again (World::resize), or remove the kernel (Stepper::remove_kernel). The world is as "
              "it was."};
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
    return Error{ErrorCode::wrong_type, "The kernel " + quoted(k.name) + " declares its parameter " + quoted(a->name) +
                                            " as " + std::string(name(a->type)) + "; the value given is of type " +
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

}  // namespace pcphys
