// Pins docs/properties.md: it is what the schema says. After a change of src/kernels/properties.inl run this
// test with PCPHYS_WRITE_DOCS=1 and it writes the page:
//   PCPHYS_WRITE_DOCS=1 ctest --test-dir build/release -R world_properties_page
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>

#include "support_world.h"
#include "world/schema.h"

using namespace worldtest;

namespace {

constexpr std::string_view table_docs[] = {
#define PC_TABLE(table, doc) doc,
#define PC_BUFFER(table, buffer, quads, doc)
#define PC_PROPERTY(table, buffer, offset, type, name, role, initial, unit, doc)
#include "kernels/properties.inl"
#undef PC_TABLE
#undef PC_BUFFER
#undef PC_PROPERTY
};

/// "pose" and "pose, at 4" say where a kernel finds it.
std::string place(const PropertySchema& p) {
  return std::string(schema(p.buffer).name) + " " + std::to_string(p.offset);
}

std::string capital(std::string_view text) {
  std::string s(text);
  if (!s.empty() && s[0] >= 'a' && s[0] <= 'z') s[0] = char(s[0] - 'a' + 'A');
  return s;
}

const char* text_of(Domain domain) {
  switch (domain) {  // compilers name one that is missing
    case Domain::body: return "bodies";
    case Domain::contact: return "contacts";
    case Domain::free_contact: return "free contacts";
    case Domain::tree_contact: return "tree contacts";
    case Domain::joint: return "joints";
    case Domain::free_joint: return "free joints";
    case Domain::tree_joint: return "tree joints";
    case Domain::tree: return "trees";
    case Domain::tree_nodes: return "trees, and nodes of large ones";
    case Domain::net: return "nets of springs";
    case Domain::row: return "all bodies";
    case Domain::edge: return "edges";
  }
  return "";
}

std::string page() {
  std::ostringstream out;
  out << "# Properties\n"
         "Everything that a world stores. `World::view(name)` shows a property as it lies in memory; row 0 of every\n"
         "table is the padding row, and `World::row_of` finds a body's.\n"
         "\n"
         "Types: real; vec3 (x y z); quat (x y z w); sym3 (xx xy xz yy yz zz). Roles: input, which the host writes;\n"
         "state, which snapshots and the hash hold; derived, which follows from others; scratch, which means\n"
         "nothing between steps. Place: the buffer that kernels bind, and the real in its row.\n"
         "\n"
         "A property of a host's own (`World::add_property`) is of the role host unless it asks for another: it is\n"
         "the host's alone until a kernel of a stepper names it (`Stepper::add_kernel`).\n"
         "\n"
         "| role | in snapshots | in the hash | another value wakes |\n"
         "|---|---|---|---|\n"
         "| host | yes | once a kernel has named it | once a kernel has named it |\n"
         "| state | yes | always | once a kernel has named it |\n"
         "| input, derived, scratch | no | no | once a kernel has named it |\n"
         "\n"
         "<!-- Written by tests/world_properties_page.cpp from src/kernels/properties.inl; see there. -->\n";
  for (std::size_t t = 0; t < table_count; t++) {
    out << "\n## " << name(Table(t)) << "\n" << capital(table_docs[t]) << ".\n\n";
    out << "| property | type | role | unit | at first | place | meaning |\n|---|---|---|---|---|---|---|\n";
    for (const PropertySchema& p : properties())
      if (p.table == Table(t))
        out << "| `" << p.name << "` | " << name(p.type) << " | " << name(p.role) << " | " << p.unit << " | "
            << p.initial << " | " << place(p) << " | " << p.doc << " |\n";
    out << "\n| buffer | reals a row | holds |\n|---|---|---|\n";
    for (std::size_t b = 0; b < table_buffer_count; b++)
      if (schema(Buffer(b)).table == Table(t))
        out << "| `" << schema(Buffer(b)).name << "` | " << schema(Buffer(b)).reals << " | " << schema(Buffer(b)).doc
            << " |\n";
  }
  out << "\n## Kernels\nEvery kernel with its stage, what it runs over, and the buffers that it reads and writes.\n\n"
         "| kernel | stage | over | reads | writes |\n|---|---|---|---|---|\n";
  for (std::size_t k = 0; k < kernel_count; k++) {
    const KernelSchema& s = schema(Kernel(k));
    std::string lists[2];
    for (const Access& a : s.accesses)
      lists[a.write] += (lists[a.write].empty() ? "" : ", ") + std::string(schema(a.buffer).name);
    out << "| `" << s.name << "` | " << name(s.stage) << " | " << text_of(s.domain) << " | " << lists[0] << " | "
        << lists[1] << " |\n";
  }
  return out.str();
}

}  // namespace

TEST_CASE("docs/properties.md is what the schema says") {
  const std::string path = PCPHYS_SOURCE_DIR "/docs/properties.md", wanted = page();
  if (std::getenv("PCPHYS_WRITE_DOCS")) std::ofstream(path, std::ios::binary) << wanted;
  std::ifstream file(path, std::ios::binary);
  REQUIRE_MESSAGE(file, "there is no docs/properties.md; run this test with PCPHYS_WRITE_DOCS=1 to write it");
  const std::string found{std::istreambuf_iterator<char>(file), {}};
  CHECK_MESSAGE(found == wanted, "docs/properties.md is old; run this test with PCPHYS_WRITE_DOCS=1 to write it anew");
}
