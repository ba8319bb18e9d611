// (d) The property world: the library's own tables and compiled kernels. Objects are ids; a row of the tables is a
// body, joint or contact; lists of rows tell the loops what to visit.
#include <array>

#include "cpu/kernels.h"
#include "design.h"
#include "extras.h"
#include "world/id_pool.h"
#include "world/memory.h"
#include "world/tables.h"

namespace pcphys::architectures {
namespace {

using Rows = std::vector<std::uint32_t>;

/// Constraints of a table between bodies, and the rows that they are solved in.
struct Constraints {
  struct Ends {
    std::uint32_t a, b;  // ids of bodies
  };
  std::vector<Ends> made = {{0, 0}};  // by row; row 0 pads
  Rows ends, order;                   // of the slots, in blocks of lanes
  std::uint32_t blocks = 0;
};

class PropertyWorld final : public Design {
 public:
  explicit PropertyWorld(const CpuKernels& kernels) : kernels_(kernels) { row_ids_.push_back(ids_.allocate(0)); }

  Handle ground() const override { return 0; }
  Handle create_body(const BodyInit& init) override {
    const std::uint32_t row = grow(Table::body);
    row_ids_.push_back(ids_.allocate(row));
    write(init, {find(Buffer::motion, row), find(Buffer::pose, row), find(Buffer::mass, row), find(Buffer::force, row),
                 find(Buffer::material, row)});
    *find(area_, row) = float(init.area);  // [property]
    return row_ids_.back();
  }
  void destroy_body(Handle body) override {
    const std::uint32_t row = ids_.row(std::uint32_t(body)), last = tables_.rows(Table::body) - 1;
    tables_.copy_row(Table::body, last, row);
    row_ids_[row] = row_ids_[last];
    ids_.set_row(row_ids_[row], row);
    row_ids_.pop_back();
    tables_.resize(Table::body, last);
    ids_.release(std::uint32_t(body));
  }
  void create_joint(Handle a, Handle b, const JointInit& init) override {
    const std::uint32_t row = add(Table::joint, joints_, a, b);
    write(init, find(Buffer::joint_solved, row));
    if (a == ground()) chains_.emplace_back();
    chains_.back().push_back(row);
  }
  void create_contact(Handle a, Handle b, const ContactInit& init) override {
    write(init, find(Buffer::contact, add(Table::contact, contacts_, a, b)));
  }
  // [constraint]
  void create_rope(Handle a, Handle b, const RopeInit& init) override {
    *find(rope_length_, add(ropes_table_, ropes_, a, b)) = float(init.length);
  }
  // [end]

  void settle() override {
    const std::uint32_t lanes = kernels_.lanes;
    bodies_.clear();
    for (std::uint32_t row = 1; row < tables_.rows(Table::body); row++) bodies_.push_back(row);
    bodies_.resize((bodies_.size() + lanes - 1) / lanes * lanes);  // lanes without work visit row 0
    // chains side by side in a block, joint by joint
    Rows joints, contacts;
    for (std::size_t first = 0; first < chains_.size(); first += lanes)
      for (std::size_t k = 0; k < longest(first, lanes); k++)
        for (std::size_t chain = first; chain < first + lanes; chain++)
          joints.push_back(chain < chains_.size() && k < chains_[chain].size() ? chains_[chain][k] : 0);
    for (std::uint32_t row = 1; row < contacts_.made.size(); row++) contacts.push_back(row);
    lay_out(joints_, joints);
    lay_out(contacts_, contacts);
    bind();
  }

  void run(Kernel kernel, const Info& info) override {
    const Domain domain = schema(kernel).domain;
    std::uint32_t end = std::uint32_t(bodies_.size());
    if (domain != Domain::body) end = schema(kernel).stage == Stage::joints ? joints_.blocks : contacts_.blocks;
    kernels_.run[std::size_t(kernel)]({buffers_.data(), &info, 0, end});
  }
  // [force]
  void run_wind(const float wind[3]) override {
    for (const std::uint32_t row : bodies_)
      wind_drag(find(Buffer::motion, row), *find(area_, row), find(Buffer::force, row), wind);
  }
  // [constraint]
  void run_ropes(float inverse_h) override {
    for (std::uint32_t rope = 1; rope < ropes_.made.size(); rope++) {
      const std::uint32_t a = ids_.row(ropes_.made[rope].a), b = ids_.row(ropes_.made[rope].b);
      hold_rope(find(Buffer::pose, a), find(Buffer::pose, b), *find(rope_length_, rope), find(Buffer::motion, a),
                find(Buffer::motion, b), inverse_h);
    }
  }
  // [gather]
  std::vector<std::span<const std::byte>> blocks() const override {
    return {column(Buffer::pose), column(Buffer::motion)};
  }
  // [end]
  // (not needed to upload: the same rows as the other designs, to compare with)
  void gather(float* packed) const override {
    const float *pose = tables_.data<float>(Buffer::pose), *motion = tables_.data<float>(Buffer::motion),
                *mass = tables_.data<float>(Buffer::mass);
    for (std::size_t row = 1; row < tables_.rows(Table::body); row++, packed += packed_reals)
      pack(pose + row * length_of(Buffer::pose), mass + row * length_of(Buffer::mass),
           motion + row * length_of(Buffer::motion), packed);
  }
  void scatter(const float* packed) override {
    for (std::uint32_t row = 1; row < tables_.rows(Table::body); row++, packed += packed_reals)
      unpack(packed, find(Buffer::pose, row), find(Buffer::motion, row));
  }
  void state(Handle body, float* state) const override {
    const std::size_t row = ids_.row(std::uint32_t(body));
    read_state(tables_.data<float>(Buffer::pose) + row * length_of(Buffer::pose),
               tables_.data<float>(Buffer::motion) + row * length_of(Buffer::motion), state);
  }

 private:
  std::uint32_t grow(Table table) {
    tables_.resize(table, tables_.rows(table) + 1);
    return tables_.rows(table) - 1;
  }
  std::uint32_t add(Table table, Constraints& to, Handle a, Handle b) {
    to.made.push_back({std::uint32_t(a), std::uint32_t(b)});
    return grow(table);
  }
  float* find(Buffer buffer, std::uint32_t row) {
    return tables_.data<float>(buffer) + row * (tables_.row_bytes(buffer) / sizeof(float));
  }
  std::span<const std::byte> column(Buffer buffer) const {
    return {tables_.bytes(buffer).data(), tables_.bytes(buffer).size()};
  }
  std::size_t longest(std::size_t first, std::size_t count) const {
    std::size_t most = 0;
    for (std::size_t chain = first; chain < first + count && chain < chains_.size(); chain++)
      most = std::max(most, chains_[chain].size());
    return most;
  }
  /// Slots of the constraints in this order, in blocks of as many lanes as the kernels have.
  void lay_out(Constraints& of, Rows rows) {
    const std::uint32_t lanes = kernels_.lanes;
    of.blocks = std::uint32_t((rows.size() + lanes - 1) / lanes);
    rows.resize(std::size_t{of.blocks} * lanes);
    of.ends.resize(2 * rows.size());
    for (std::size_t slot = 0; slot < rows.size(); slot++) {
      const std::size_t first = slot / lanes * 2 * lanes + slot % lanes;
      of.ends[first] = ids_.row(of.made[rows[slot]].a);
      of.ends[first + lanes] = ids_.row(of.made[rows[slot]].b);
    }
    of.order = std::move(rows);
  }
  void bind() {
    for (std::size_t b = 0; b < table_buffer_count; b++) buffers_[b] = tables_.bytes(Buffer(b)).data();
    const auto list = [&](Buffer b, Rows& rows) { buffers_[std::size_t(b)] = rows.data(); };
    list(Buffer::bodies, bodies_);
    list(Buffer::joint_ends, joints_.ends), list(Buffer::joint_order, joints_.order);
    list(Buffer::contact_ends, contacts_.ends), list(Buffer::contact_order, contacts_.order);
    const auto scratch = [&](Buffer b, std::size_t slots) {
      AlignedBytes& rows = scratch_[std::size_t(b)];
      rows.resize(slots * length_of(b) * sizeof(float));
      buffers_[std::size_t(b)] = rows.data();
    };
    scratch(Buffer::joint_rows, joints_.order.size());
    scratch(Buffer::contact_rows, contacts_.order.size());
    scratch(Buffer::contact_impulses, contacts_.order.size());
  }

  const CpuKernels& kernels_;
  Tables tables_{Precision::f32};
  IdPool ids_;
  Rows row_ids_, bodies_;
  Constraints joints_, contacts_;
  std::vector<Rows> chains_;  // rows of joints
  std::array<void*, buffer_count> buffers_{};
  std::array<AlignedBytes, buffer_count> scratch_;
  Buffer area_ = tables_.add(Table::body, std::as_bytes(std::span<const float>(std::array{0.0f})));  // [property]
  // [constraint]
  Table ropes_table_ = tables_.add_table();
  Buffer rope_length_ = tables_.add(ropes_table_, std::as_bytes(std::span<const float>(std::array{0.0f})));
  Constraints ropes_;
  // [end]
};

}  // namespace

std::unique_ptr<Design> make_properties(std::uint32_t lanes) {
#ifdef PCPHYS_HAVE_X86_LANES
  if (lanes == 8) return __builtin_cpu_supports("avx2") ? std::make_unique<PropertyWorld>(cpu_kernels_f8) : nullptr;
#endif
  return lanes == 1 ? std::make_unique<PropertyWorld>(cpu_kernels_f1) : nullptr;
}

}  // namespace pcphys::architectures
