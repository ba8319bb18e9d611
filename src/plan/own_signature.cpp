#include "plan/own_signature.h"

#include <algorithm>
#include <iterator>

#include "plan/own_words.h"

namespace pcphys {
namespace {

struct TypeWord {
  std::string_view word;
  PropertyType type;
};
constexpr TypeWord type_words[] = {{"Real", PropertyType::real},       {"Vec3", PropertyType::vec3},
                                   {"Quaternion", PropertyType::quat}, {"Sym3", PropertyType::sym3},
                                   {"Quad", PropertyType::vec4},       {"Mat3", PropertyType::mat3},
                                   {"float", PropertyType::float32},   {"double", PropertyType::float64},
                                   {"int", PropertyType::int32},       {"uint", PropertyType::uint32}};
constexpr std::string_view kind_words[] = {"PC_IN", "PC_INOUT", "PC_OUT", "PC_PARAM", "PC_SELF",  "PC_OTHER", "PC_A",
                                           "PC_B",  "PC_SUM",   "PC_ADD", "PC_ADD_A", "PC_ADD_B", "PC_MIN",   "PC_MAX"};

std::string without(std::string_view name, std::string_view suffix) {
  return std::string(name.ends_with(suffix) ? name.substr(0, name.size() - suffix.size()) : name);
}

std::string property_of(const OwnArgument& a) {
  using Kind = OwnArgument::Kind;
  switch (a.kind) {
    case Kind::self: return without(a.name, "_self");
    case Kind::other: return without(a.name, "_other");
    case Kind::a: return without(without(a.name, "_a"), "_of");
    case Kind::b: return without(without(a.name, "_b"), "_of");
    case Kind::add_a: return without(a.name, "_a");
    case Kind::add_b: return without(a.name, "_b");
    default: return a.name;
  }
}

/// Words and signs of a signature.
class Tokens {
 public:
  /// `reached`: where in the text the last one stands.
  Tokens(std::string_view text, std::size_t& reached) : rest_(text), size_(text.size()), reached_(reached) {}
  std::string_view next() {
    while (!rest_.empty() && (rest_[0] == ' ' || rest_[0] == '\n' || rest_[0] == '\t')) rest_.remove_prefix(1);
    reached_ = size_ - rest_.size();
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
  std::size_t size_, &reached_;
};

}  // namespace

Status parse_signature(OwnKernel& k) {
  const Error wrong = bad(
      k, "has the signature `" + k.signature +
             "`; write it as (PC_IN(Vec3) position, PC_INOUT(Real) fuel, PC_PARAM(Real) flow), with PC_OUT for what "
             "is written anew, and types Real, Vec3, Quaternion, Quad, Sym3, Mat3, float, double, int or uint.");
  Tokens tokens(k.signature, k.reached);
  if (!tokens.take("(")) return wrong;
  std::string_view sign = ",";
  while (sign == ",") {
    OwnArgument argument;
    const auto* kind = std::ranges::find(kind_words, tokens.next());
    argument.at = k.reached;
    if (kind == std::end(kind_words) || !tokens.take("(")) return wrong;
    const auto* type = std::ranges::find(type_words, tokens.next(), &TypeWord::word);
    if (type == std::end(type_words) || !tokens.take(")")) return wrong;
    argument.kind = OwnArgument::Kind(kind - kind_words);
    argument.type = type->type;
    argument.name = tokens.next();
    argument.property = property_of(argument);
    if (contains(k.arguments, argument.name, &OwnArgument::name))
      return bad(k, "names " + quoted(argument.name) + " twice in its signature; PC_INOUT reads and writes.");
    k.arguments.push_back(std::move(argument));
    sign = tokens.next();
  }
  if (sign != ")" || !tokens.next().empty()) return wrong;
  k.reached = 0;
  if (k.arguments.size() > OwnKernel::most_arguments)
    return bad(k, "has " + std::to_string(k.arguments.size()) + " arguments; at most 32 are possible.");
  return {};
}

std::string_view word_of(OwnArgument::Kind kind) { return kind_words[std::size_t(kind)]; }

std::string whole_property_of(const OwnArgument& a) {
  return a.of_three() == 0 ? a.property : without(a.name, a.of_three() == 1 ? "_a" : "_b");
}

Status check_body(const OwnKernel& k) {
  std::size_t reached = 0;
  Tokens tokens(k.body, reached);
  for (std::string_view token = tokens.next(); !token.empty(); token = tokens.next())
    if (token.starts_with("io_"))
      return bad(k, "uses " + quoted(token) +
                        " in its text; names with io_ are the library's buffers. Declare what it reads and "
                        "writes in the signature.");
  return {};
}

}  // namespace pcphys
