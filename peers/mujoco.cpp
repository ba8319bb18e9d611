// MuJoCo: trees in coordinates of their joints, soft contacts solved by Newton's method, double precision.
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "engines.h"
#include "mujoco_model.h"

namespace pcphys::peers {
namespace {

constexpr double own_step = 0.002;      // MuJoCo's default [s]
constexpr double most_gigabytes = 1.9;  // of its dense arrays: above, version 2.2.2 fails to make them
constexpr const char* file = "world.xml";

struct DeleteModel {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
};
struct DeleteData {
  void operator()(mjData* data) const { mj_deleteData(data); }
};
struct DeleteFiles {
  void operator()(mjVFS* files) const {
    mj_deleteVFS(files);
    delete files;
  }
};

/// MuJoCo reports through functions of the process: warnings are counted in its data,
/// errors are thrown and caught here.
void take_reports() {
  mju_user_warning = [](const char*) {};
  mju_user_error = [](const char* message) { throw std::runtime_error(message); };
}

Error gave_up(const std::string& why) { return {ErrorCode::unavailable, "MuJoCo gave up: " + why + "."}; }

class Mujoco : public Peer {
 public:
  Mujoco(const Description& description, const Options& options)
      : description_(description), wanted_(options.substeps) {
    untranslated_ = description.untranslated;
  }

  Status build(const Options& options, MujocoIntegrator integrator) {
    if (description_.has_hulls())
      return Error{ErrorCode::unavailable, "Hulls are not translated for MuJoCo; leave it out."};
    std::string attributes = integrator == MujocoIntegrator::rk4 ? "integrator='RK4'" : "integrator='Euler'";
    if (options.iterations > 0) attributes += " iterations='" + std::to_string(options.iterations) + "'";
    made_ = make_mujoco_model(description_, attributes);
    if (made_.gigabytes > most_gigabytes)
      return Error{ErrorCode::unavailable, "MuJoCo's arrays of constraints are dense and would take " +
                                               std::to_string(int(std::ceil(made_.gigabytes))) +
                                               " GiB for this scene; above 2 it cannot make them."};
    untranslated_.insert(untranslated_.end(), made_.untranslated.begin(), made_.untranslated.end());
    if (auto status = load(); !status) return status;
    (void)set_gravity(description_.gravity);
    for (std::size_t i = 0; i < description_.bodies.size(); ++i)
      ids_.push_back(mj_name2id(model_.get(), mjOBJ_BODY, body_name(int(i)).c_str()));
    hold_points();
    place_joints();
    std::vector<Speeds> speeds;
    for (const Body& body : description_.bodies) speeds.push_back({body.velocity, body.angular_velocity});
    take_velocities(speeds);
    for (std::size_t i = 0; i < ids_.size(); ++i) push(i);
    return {};
  }

  Status step(double dt) override {
    const int count = substeps(dt);
    model_->opt.timestep = dt / count;
    stale_ = true;
    stepping_ = this;
    Status status;
    try {
      for (int k = 0; k < count && status; ++k) {
        mj_step(model_.get(), data_.get());
        status = look_at_warnings();
      }
    } catch (const std::runtime_error& error) {
      status = gave_up(error.what());
    }
    stepping_ = nullptr;
    return status;
  }
  int substeps(double dt) const override {
    return wanted_ > 0 ? wanted_ : std::max(1, int(std::ceil(dt / own_step - 1e-9)));
  }
  int iterations() const override { return model_->opt.iterations; }

  Pose pose(std::size_t body) const override {
    refresh();
    const mjtNum* p = data_->xipos + 3 * ids_[body];
    return {{p[0], p[1], p[2]}, orientation(body)};
  }
  Vec3 velocity(std::size_t body) const override { return speeds(body).linear; }
  Vec3 angular_velocity(std::size_t body) const override { return speeds(body).angular; }
  MassProperties mass_properties(std::size_t body) const override {
    const mjtNum* moments = model_->body_inertia + 3 * ids_[body];
    return {model_->body_mass[ids_[body]], {moments[0], moments[1], moments[2]}};
  }

  Status set_wrench(std::size_t body, const Wrench& wrench) override {
    const Vec3 f = wrench.force, t = wrench.torque;
    const mjtNum both[6] = {f.x, f.y, f.z, t.x, t.y, t.z};
    if (description_.bodies[body].dynamic) std::copy(both, both + 6, data_->xfrc_applied + 6 * ids_[body]);
    return {};
  }
  Status set_gravity(Vec3 gravity) override {
    const mjtNum g[3] = {gravity.x, gravity.y, gravity.z};
    std::copy(g, g + 3, model_->opt.gravity);
    return {};
  }
  Status set_velocity(std::size_t body, Vec3 velocity, Vec3 angular_velocity) override {
    std::vector<Speeds> all;
    for (std::size_t i = 0; i < ids_.size(); ++i) all.push_back(speeds(i));
    all[body] = {velocity, angular_velocity};
    take_velocities(all);
    return {};
  }

  std::size_t contacts() const override { return std::size_t(data_->ncon); }
  std::optional<double> deepest() const override {
    double depth = 0;
    for (int k = 0; k < data_->ncon; ++k) depth = std::max(depth, -double(data_->contact[k].dist));
    return depth;
  }
  std::uint64_t failures() const override { return failures_; }

 private:
  Status load() {
    take_reports();
    std::unique_ptr<mjVFS, DeleteFiles> files(new mjVFS);
    mj_defaultVFS(files.get());
    if (mj_makeEmptyFileVFS(files.get(), file, int(made_.xml.size())) != 0) return gave_up("no memory for its model");
    std::memcpy(files->filedata[0], made_.xml.data(), made_.xml.size());
    char message[500] = "";
    try {
      model_.reset(mj_loadXML(file, files.get(), message, sizeof message));
      if (!model_) return gave_up(message);
      data_.reset(mj_makeData(model_.get()));
      if (!data_) return gave_up("no memory for its state");
    } catch (const std::runtime_error& error) {
      return gave_up(error.what());
    }
    return {};
  }

  /// The model's compiler takes the second point from the first pose; ours is known.
  void hold_points() {
    for (int k = 0; k < int(made_.held.size()); ++k) {
      const HeldPoint& held = made_.held[std::size_t(k)];
      const Vec3 first = held.a < 0 ? held.at_b : held.at_a, second = held.a < 0 ? held.at_a : held.at_b;
      const mjtNum both[6] = {first.x, first.y, first.z, second.x, second.y, second.z};
      std::copy(both, both + 6, model_->eq_data + mjNEQDATA * k);
    }
  }

  /// Coordinates of the joints, from where the bodies stand.
  void place_joints() {
    for (std::size_t i = 0; i < made_.links.size(); ++i) {
      const Link& link = made_.links[i];
      if (link.joint < 0) continue;
      const Joint& joint = description_.joints[std::size_t(link.joint)];
      const Quat a = description_.pose_of(joint.a).orientation * joint.frame_a.orientation;
      const Quat b = description_.pose_of(joint.b).orientation * joint.frame_b.orientation;
      const HingeAngles angles = hinge_angles(conjugate(a) * b);
      for (int axis = 0; axis < 3; ++axis) {
        const int id = mj_name2id(model_.get(), mjOBJ_JOINT, joint_name(link.joint, axis).c_str());
        if (id < 0) continue;
        mjtNum* q = data_->qpos + model_->jnt_qposadr[id];
        if (model_->jnt_type[id] == mjJNT_BALL) {
          const Quat own = link.flipped ? joint.frame_a.orientation : joint.frame_b.orientation;
          const Quat turned = own * (link.flipped ? conjugate(b) * a : conjugate(a) * b) * conjugate(own);
          const mjtNum values[4] = {turned.w, turned.x, turned.y, turned.z};
          std::copy(values, values + 4, q);
        } else {
          *q = axis == 0 ? angles.roll : axis == 1 ? angles.pitch : angles.yaw;
        }
      }
    }
  }

  struct Speeds {
    Vec3 linear, angular;
  };

  /// The velocities that joints allow and that are nearest to those given, by kinetic energy: M v = sum of J^T p.
  void take_velocities(const std::vector<Speeds>& given) {
    mj_forward(model_.get(), data_.get());
    std::vector<mjtNum> momentum(std::size_t(model_->nv), 0);
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      const Body& body = description_.bodies[i];
      if (!body.dynamic) continue;
      const Quat turn = orientation(i);
      const Vec3 w = rotate(conjugate(turn), given[i].angular), m = body.mass.moments;
      apply(i, body.mass.mass * given[i].linear, rotate(turn, {m.x * w.x, m.y * w.y, m.z * w.z}), momentum.data());
    }
    if (model_->nv > 0) mj_solveM(model_.get(), data_.get(), data_->qvel, momentum.data(), 1);
    mj_forward(model_.get(), data_.get());
  }
  Quat orientation(std::size_t body) const {
    const mjtNum* q = data_->xquat + 4 * ids_[body];
    return {q[1], q[2], q[3], q[0]};
  }

  void apply(std::size_t body, Vec3 force, Vec3 torque, mjtNum* target) const {
    const mjtNum f[3] = {force.x, force.y, force.z}, t[3] = {torque.x, torque.y, torque.z};
    mj_applyFT(model_.get(), data_.get(), f, t, data_->xipos + 3 * ids_[body], ids_[body], target);
  }

  void push(std::size_t index) {
    const Body& body = description_.bodies[index];
    if (body.dynamic && (body.linear_drag > 0 || body.angular_drag > 0)) {
      dragging_.push_back(index);
      mjcb_passive = [](const mjModel*, mjData*) {
        if (stepping_) stepping_->drag();
      };
    }
    (void)set_wrench(index, body.wrench);
  }

  /// Force -F m v and torque -F L, at each stage of the integrator.
  void drag() const {
    for (std::size_t i : dragging_) {
      const Body& body = description_.bodies[i];
      const Speeds now = read_speeds(i);
      const Quat turn = orientation(i);
      const Vec3 w = rotate(conjugate(turn), now.angular), m = body.mass.moments;
      const Vec3 momentum = rotate(turn, {m.x * w.x, m.y * w.y, m.z * w.z});
      apply(i, -body.linear_drag * body.mass.mass * now.linear, -body.angular_drag * momentum, data_->qfrc_passive);
    }
  }

  /// MuJoCo sets a state that it finds useless back to the model's first one: a run ends there.
  Status look_at_warnings() {
    const auto count = [&](mjtWarning kind) { return data_->warning[kind].number; };
    if (count(mjWARN_BADQPOS) + count(mjWARN_BADQVEL) + count(mjWARN_BADQACC) > 0)
      return gave_up("a coordinate, velocity or acceleration was not finite or above 1e10, and it set the scene back");
    failures_ = std::uint64_t(count(mjWARN_CONTACTFULL)) + std::uint64_t(count(mjWARN_CNSTRFULL));
    return {};
  }

  /// A step leaves poses and velocities of its start.
  void refresh() const {
    if (!stale_) return;
    stale_ = false;
    mj_kinematics(model_.get(), data_.get());
    mj_comPos(model_.get(), data_.get());
    mj_comVel(model_.get(), data_.get());
  }
  Speeds speeds(std::size_t body) const {
    refresh();
    return read_speeds(body);
  }
  Speeds read_speeds(std::size_t body) const {
    mjtNum v[6];
    mj_objectVelocity(model_.get(), data_.get(), mjOBJ_BODY, ids_[body], v, 0);
    return {{v[3], v[4], v[5]}, {v[0], v[1], v[2]}};
  }

  static thread_local const Mujoco* stepping_;  // whose step runs
  Description description_;
  MujocoModel made_;
  int wanted_;
  std::unique_ptr<mjModel, DeleteModel> model_;
  std::unique_ptr<mjData, DeleteData> data_;
  std::vector<int> ids_;
  std::vector<std::size_t> dragging_;
  std::uint64_t failures_ = 0;
  mutable bool stale_ = false;
};

thread_local const Mujoco* Mujoco::stepping_ = nullptr;

}  // namespace

std::string mujoco_version() { return mj_versionString(); }

Result<std::unique_ptr<Peer>> make_mujoco(const Description& description, const Options& options,
                                          MujocoIntegrator integrator) {
  auto peer = std::make_unique<Mujoco>(description, options);
  if (auto status = peer->build(options, integrator); !status) return status.error();
  return std::unique_ptr<Peer>(std::move(peer));
}

}  // namespace pcphys::peers
