// Pins what every public function refuses: the error's code, a whole sentence, and a world that is as it was, from one
// table (tests/support_bad_*.cpp). docs/errors.md is that table, and each function of the public headers that answers
// with a Result is in it. After a change of the table run this test with PCPHYS_WRITE_DOCS=1 and it writes the page:
//   PCPHYS_WRITE_DOCS=1 ctest --test-dir build/release -R bad_arguments
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <utility>

#include "support_bad_calls.h"

using namespace worldtest;

namespace {

struct Section {
  const char* title;
  BadCalls calls;
};
const std::vector<Section>& sections() {
  static const std::vector<Section> all = [] {
    std::vector<Section> made{
        {"Objects", {}}, {"What objects hold", {}},        {"Properties, tables, snapshots", {}}, {"Shapes", {}},
        {"Steps", {}},   {"Kernels of the host's own", {}}};
    add_bad_objects(made[0].calls);
    add_bad_values(made[1].calls);
    add_bad_properties(made[2].calls);
    add_bad_shapes(made[3].calls);
    add_bad_steps(made[4].calls);
    add_bad_kernels(made[5].calls);
    return made;
  }();
  return all;
}
template <class Do> void each_call(Do&& what) {
  for (const Section& section : sections())
    for (const BadCall& call : section.calls) what(call);
}

bool is_sentence(const std::string& text) {
  return text.size() > 10 && std::isupper(static_cast<unsigned char>(text.front())) && text.back() == '.';
}

/// Of each function the first of its calls.
std::vector<const BadCall*> first_calls() {
  std::vector<const BadCall*> first;
  std::set<std::string_view> seen;
  each_call([&](const BadCall& call) {
    if (seen.insert(call.function).second) first.push_back(&call);
  });
  return first;
}

std::string page() {
  std::ostringstream out;
  out << "# Errors\n"
         "What public functions refuse, and by which error. The message says what was wrong and what to do, and the\n"
         "world is as it was. Ranges of numbers, and what each code stands for: [limits.md](limits.md). Where there "
         "is\n"
         "no memory any function answers `buffer_full`.\n"
         "\n"
         "<!-- Written by tests/bad_arguments.cpp from tests/support_bad_*.cpp; see there. -->\n";
  for (const Section& section : sections()) {
    out << "\n## " << section.title << "\n| function | what is wrong | error |\n|---|---|---|\n";
    for (const BadCall& call : section.calls)
      out << "| `" << call.function << "` | " << call.wrong << " | `" << name(call.code) << "` |\n";
  }
  out << "\n## While a step runs\nA callback may look at its world, and change other ones. Of the world that is "
         "stepped, and of "
         "its stepper, these\n"
         "answer `busy`, whatever else is wrong:";
  std::string list;
  for (const BadCall* call : first_calls())
    if (call->changes) list += (list.empty() ? " `" : ", `") + std::string(call->function) + "`";
  out << list << ".\n";
  return out.str();
}

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Functions of a public header that answer with a Result or a Status, those of a class by its name.
std::set<std::string> functions_of(const std::string& header) {
  static const std::regex function(R"(^\s*(?:template <[^>]*> )?(?:Result<.*>|Status) (\w+)\(.*)"),
      type(R"(^(?:class|struct) (\w+).*\{$)");
  std::set<std::string> found;
  std::istringstream lines(text_of(PCPHYS_SOURCE_DIR "/include/pcphys/" + header));
  std::string scope;
  bool open = true;
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, match, type)) scope = match[1].str() + "::", open = true;
    if (line == "};") scope.clear(), open = true;
    if (line == " private:") open = false;
    if (open && std::regex_match(line, match, function)) found.insert(scope + match[1].str());
  }
  return found;
}

}  // namespace

TEST_CASE("every bad call: its code, a sentence, and the world as it was") {
  each_call([](const BadCall& bad) {
    INFO(std::string(bad.function), ": ", std::string(bad.wrong));
    Host host;
    const Error error = bad.call(host);
    CHECK_MESSAGE(error.code == bad.code, name(error.code), ": ", error.message);
    CHECK_MESSAGE(is_sentence(error.message), error.message);
    CHECK_MESSAGE((lasting(host.world) == host.before), "the refused call changed the world");
  });
}

TEST_CASE("while a step runs what changes is busy, and what reads answers as ever") {
  for (const BadCall* bad : first_calls()) {
    if (bad->code == ErrorCode::busy) continue;
    INFO(std::string(bad->function));
    Host host, plain;
    Error error;
    const Error of_step = host.within_step([&] { error = bad->call(host); });
    CHECK_MESSAGE(of_step.code == ErrorCode::none, of_step.message);
    CHECK_MESSAGE(error.code == (bad->changes ? ErrorCode::busy : bad->code), name(error.code), ": ", error.message);
    CHECK(plain.within_step([] {}).code == ErrorCode::none);
    CHECK(host.world.hash() == plain.world.hash());
  }
}

TEST_CASE("every public function that can refuse is in the table") {
  std::set<std::string> in_table{"use_fcl"};  // unavailable in a build without FCL, and never in this one
  each_call([&](const BadCall& call) { in_table.insert(call.function); });
  std::size_t found = 0;
  for (const char* header :
       {"world.h", "step.h", "hull.h", "kernel.h", "plan.h", "events.h", "device.h", "fcl.h", "property.h", "types.h"})
    for (const std::string& function : functions_of(header)) {
      found++;
      CHECK_MESSAGE(in_table.contains(function),
                    function << " of " << header << " is in no row of tests/support_bad_*.cpp");
    }
  CHECK(found > 50);
}

TEST_CASE("docs/errors.md is the table") {
  const std::string path = PCPHYS_SOURCE_DIR "/docs/errors.md", wanted = page();
  if (std::getenv("PCPHYS_WRITE_DOCS")) std::ofstream(path, std::ios::binary) << wanted;
  CHECK_MESSAGE(text_of(path) == wanted,
                "docs/errors.md is old; run this test with PCPHYS_WRITE_DOCS=1 to write it anew");
}
