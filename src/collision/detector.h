// Finds the contacts of a step: boxes, pairs, manifolds, and each manifold's memory from the last step.
// What it finds depends on poses and velocities alone, never on what the broad phase remembers.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "collision/aabb.h"
#include "collision/flights.h"
#include "collision/narrow.h"
#include "collision/pair_cache.h"
#include "collision/pair_filter.h"
#include "collision/pair_lanes.h"
#include "collision/standing.h"
#include "collision/twist.h"
#include "collision/view.h"
#include "cpu/workers.h"
#include "pcphys/constants.h"
#include "pcphys/step.h"
#include "world/state.h"

namespace pcphys {

template <class Scalar> class Bodies;

/// The contacts of one level of islands: rows, in the order of a backend's blocks, 0 where one is not full; and their
/// places there, in the order of the rows.
struct Listed {
  std::span<const std::uint32_t> rows, places;
};

class Detector {
 public:
  struct Options {
    NarrowPhase narrow = NarrowPhase::native;
    double contact_margin = 0;  // [m]; 0: by the sizes of the shapes
    double least_bounce = 0;    // slower approaches do not bounce [m/s]
    std::size_t max_pairs = 0;
    std::uint32_t lanes = 0;           // of the narrow phase; 0: the widest that the processor has
    const Workers* workers = nullptr;  // to share looks among, if any

    /// Looks are some microseconds each. FCL's are not known to go beside each other.
    template <class Part> void share(std::size_t looks, const Part& part) const {
      constexpr std::uint32_t grain = 16;
      if (!workers || narrow == NarrowPhase::fcl) return part(0u, std::uint32_t(looks));
      workers->run(std::uint32_t(looks), grain, part);
    }
  };
  struct Found {
    std::uint32_t pairs = 0, contacts = 0, points = 0;
    bool friction = false;                    // some contact resists sliding
    bool restitution = false;                 // some contact bounces
    bool impacts = false;                     // or is between shapes that meet in flight
    bool rolling = false;                     // some contact resists rolling or turning
    bool placed = false;                      // some is of a body that was just placed
    bool changed = false;                     // other pairs touch than in the last step
    bool faces = false;                       // some have more than one point, so that something may stand on something
    std::uint32_t kept = 0, kept_points = 0;  // of contacts and points, those of bodies that sleep: as they were
  };

  /// Broad phase. Errors (too many pairs, a pose that is not finite) leave the world as it was.
  Status find_pairs(const WorldState& state, double dt, const Options& options);
  /// Narrow phase: replaces the world's contacts.
  Status find_contacts(WorldState& state, const Options& options, Found& found);
  /// In a sub-step of `h` [s], after its forces: finds manifolds anew whose bodies have moved against each other by
  /// more than a share of what they were made for, and of shapes that are apart whether, when and how they meet in it.
  /// `contacts`: those of one level (octave) come together, from its `first` sub-step of the step on.
  void meet(WorldState& state, const Listed& contacts, unsigned level, bool first, double h, const Options& options);
  /// And once more, of bodies that impacts have struck since, which now go elsewhere, and of impacts that waited for
  /// others. `last`: none waits any longer.
  void meet_again(WorldState& state, const Listed& contacts, unsigned level, bool last, double h,
                  const Options& options);
  /// Whether impacts wait for others that come before them.
  bool waits() const { return !waiting_.empty(); }
  /// After contacts and joints have acted, before the bodies move: limbs that they have sent against something.
  void meet_sent(WorldState& state, const Listed& contacts, unsigned level, double h, const Options& options);
  /// Of the contacts that `meet` was given last, the places of those whose rows are others than in the sub-step before;
  /// and of impacts that may act, since their bodies were struck after they were looked for last.
  std::span<const std::uint32_t> renewed() const { return renewed_; }
  std::span<const std::uint32_t> struck() const { return unseen_; }
  /// By contact row.
  std::span<const Standing> standings() const { return standings_; }
  /// Of a contact, after the step: where the first body's centre was when its rows were found, as its points see it
  /// [m].
  Vec3 origin(std::uint32_t contact) const {
    const Standing& c = standings_[contact];
    return c.later > 0 ? later_[c.later].origin : starts_[c.rows[0]];
  }
  /// After the step: contacts that came apart in it have no points.
  void let_go(WorldState& state);
  /// Takes that back, once, when the step could not be made.
  void put_back(WorldState& state);
  /// The step was made: there is nothing to take back.
  void drop() { replaced_ = false; }
  /// After the step: whether some body went further than it was looked for, so far that it could be past what stands.
  /// `before`: the poses that the step began with. `find_pairs` looks as far for them as they went, until
  /// `forget_strays`.
  bool find_strays(const WorldState& state, const AlignedBytes& before);
  void forget_strays();
  /// Rows of bodies that sleep and that something touches which does not.
  std::span<const std::uint32_t> touched() const { return touched_; }
  /// Whether two shapes of the world could ever touch.
  bool possible() const { return possible_; }
  std::size_t memory_bytes() const;
  /// Whether some body has restitution, any friction, rolling or torsional friction.
  static bool may_bounce(const WorldState& state) { return some_material(state, {2}); }
  static bool may_resist(const WorldState& state) { return some_material(state, {0, 1, 4, 5}); }
  static bool may_resist_rolling(const WorldState& state) { return some_material(state, {4, 5}); }

 private:
  /// What does not change while the structure stays, compact and by shape index.
  struct Proxy {
    ShapeKind kind = ShapeKind::sphere;
    bool alive = false, centred = true;  // centred: its frame is the body's
    bool responds = false;               // forces and impulses act on its body
    std::uint32_t body = 0;              // row
    // how far a turn of one radian moves its surface outward: a turn across its axis (the body's y), any turn
    float lever_across = 0, lever_any = 0;
    double radius = 0;     // of the sphere about its centre that holds it
    float inner = 0;       // half its thickness; 0: its body does not move by forces
    bool jointed = false;  // its body hangs on joints
    bool moves = false;    // its body does not stand
    const HullData* hull = nullptr;
  };

  /// What of a shape chooses how its pairs are looked at.
  template <class Scalar> struct Kind {
    Scalar margin;
    float reach;
    ShapeKind kind;
    bool responds;
  };

  template <class Scalar> struct Scratch {
    std::vector<ShapeView<Scalar>> shapes;  // world axes, p relative to the body's centre of mass
    AlignedBytes rows;                      // of shapes: narrow_bounds.inl
    std::vector<Kind<Scalar>> kinds;        // of shapes
    PairLanes<Scalar> lanes;
    std::vector<Manifold<Scalar>> manifolds;  // of pairs that do not go in lanes
    AlignedBytes contacts;                    // the table of the next step
    std::vector<TwistOf<Scalar>> twists;      // of bodies, where `twisted_` says so

    std::size_t memory_bytes() const { return bytes_of(shapes, rows, kinds, lanes, manifolds, contacts, twists); }
  };

  /// A pair of which a contact comes.
  template <class Scalar> struct Touch {
    std::uint32_t rows[2];  // in the order of the contact's bodies
    double impact = 0;      // impact_time of the contact [s]
    Manifold<Scalar>* manifold;
  };

  /// What the narrow phase looks at: pairs with a body that goes, or that stands and was stirred.
  enum class Part : std::uint8_t { none, looked_at, sleeps };
  void follow_rest(const WorldState& state);
  bool looked_at(Pair shapes) const {
    return parts_[proxies_[shapes.a].body] == Part::looked_at || parts_[proxies_[shapes.b].body] == Part::looked_at;
  }
  /// Whether a contact of the last step stands as it is.
  bool stays(const std::array<std::uint32_t, 2>& ends) const {
    const Part a = parts_[ends[0]], b = parts_[ends[1]];
    return a != Part::looked_at && b != Part::looked_at && (a == Part::sleeps || b == Part::sleeps);
  }
  static bool some_material(const WorldState& state, std::initializer_list<std::uint32_t> offsets);
  void follow(const WorldState& state);
  void rebuild(const WorldState& state);
  /// Where nothing but joints is other than it was.
  void follow_joints(const WorldState& state);
  template <class Scalar> bool passes_unseen(std::uint32_t shape, const Scalar* from, const Scalar* to) const;
  template <class Scalar> bool collect_strays(const WorldState& state, const Scalar* before);
  /// What of boxes does not change while the structure and the margin stay.
  void list_columns(const WorldState& state, const Options& options);
  template <class Scalar> void find_twists(const WorldState& state, const Options& options);
  void find_drawn(double dt);
  template <class Scalar>
  void bound(const WorldState& state, double dt, const Options& options, Scratch<Scalar>& scratch);
  template <class Scalar> struct Merge;
  template <class Scalar>
  Status narrow_all(WorldState& state, const Options& options, Scratch<Scalar>& scratch, Found& found);
  /// Takes over contacts of the last step, from the first row to before the last.
  template <class Scalar>
  void keep(const WorldState& state, Scratch<Scalar>& scratch, std::uint32_t first, std::uint32_t last, Found& found);
  /// The pairs whose tight boxes overlap into `near_`, and of these those that are looked at.
  void list_near();
  void leave_out_sleepers();
  /// Manifolds wait for their contacts by so many pairs at a time: in `batch_`, part of `near_`.
  static constexpr std::size_t most_in_batch = 4096;
  /// Finds the manifolds of pairs that go in lanes, and marks all pairs that may have one.
  template <class Scalar> void sort_out(const Options& options, Scratch<Scalar>& scratch);
  /// Calls does(place) for the places in the batch of pairs that may have a manifold.
  template <class Does> void each_candidate(const Does& does) {
    if (round_)
      marks_.each(does);
    else
      for (std::uint32_t place = 0; place < batch_.size(); place++) does(place);
  }
  /// Finds the manifolds of those that do not go in lanes, in their order.
  template <class Scalar>
  void find_manifolds(const WorldState& state, const Options& options, Scratch<Scalar>& scratch);
  /// The manifold of a place in the batch, `found` of which had none in lanes. False where no contact comes of it.
  template <class Scalar>
  bool touches(Scratch<Scalar>& scratch, std::uint32_t place, std::size_t& found, Touch<Scalar>& touch);
  template <class Scalar>
  Standing stand(const WorldState& state, const Scratch<Scalar>& scratch, std::uint32_t pair, bool held,
                 Touch<Scalar>& touch) const;
  /// Of a contact whose shapes are far apart: the gap that they have to come across, and how far each comes by itself
  /// [m].
  struct Distant {
    std::uint32_t row;
    double gap, comes[2];
  };
  double centre_comes(const Standing& standing, int side, const Vec3& normal) const;
  Distant distant(std::uint32_t row, const Standing& standing, const Vec3& normal) const;
  void drop_distant(ContactColumns& contacts, AlignedBytes& table, std::size_t row_bytes);
  /// The shapes of a pair in the order of the contact's bodies.
  Pair in_order(std::uint32_t pair) const;
  template <class Scalar> Scalar look_margin(Pair shapes) const;
  template <class Scalar>
  Sight<Scalar> sight(const WorldState& state, const Scratch<Scalar>& scratch, std::uint32_t pair) const;
  template <class Scalar>
  void find(const Options& options, const Sight<Scalar>& view, const ShapeView<Scalar>& a, const ShapeView<Scalar>& b,
            std::uint32_t pair, Manifold<Scalar>& manifold);
  /// Contacts of the shape are kept up to this gap; of a pair, up to the smaller of the two [m].
  double margin(std::uint32_t a, std::uint32_t b) const { return std::min(margins_[a], margins_[b]); }
  /// The smaller of what may move of the two [m].
  float thickness(std::uint32_t a, std::uint32_t b) const;
  template <class Scalar> Scratch<Scalar>& scratch();
  /// A contact that is looked at in a sub-step: its place, and whether its rows acted.
  struct Look {
    std::uint32_t at;
    bool acted;
  };
  template <class Scalar> struct Substep;
  template <class Scalar> struct Meeting;
  template <class Does>
  void look_in(WorldState& state, const Listed& contacts, unsigned level, double h, const Options& options,
               const Does& does);
  template <class Scalar> void find_all(const Substep<Scalar>& look, bool sent);
  template <class Scalar> void meet_in(const Substep<Scalar>& look);
  template <class Scalar> void meet_sent_in(const Substep<Scalar>& look);
  template <class Scalar> Meeting<Scalar> meeting(const Substep<Scalar>& look, std::uint32_t row);
  template <class Scalar> const Way& way_of(const Substep<Scalar>& look, std::uint32_t body) {
    if (ways_[body].of != meetings_) find_way(look, body);
    return ways_[body];
  }
  template <class Scalar> void find_way(const Substep<Scalar>& look, std::uint32_t body);
  /// Of a body in this look. It is made where none is yet, so before looks that go beside others.
  template <class Scalar> const TwistOf<Scalar>& twist_of(const Bodies<Scalar>& bodies, std::uint32_t body) {
    TwistOf<Scalar>& twist = scratch<Scalar>().twists[body];
    if (twisted_[body] == meetings_) return twist;
    twisted_[body] = meetings_;
    return twist = bodies.twist(body);
  }
  template <class Scalar> void point_of(const Meeting<Scalar>& x, std::uint32_t point, Scalar* at) const;
  template <class Scalar> bool covers(const Meeting<Scalar>& y, const Meeting<Scalar>& x, std::uint32_t point) const;
  template <class Scalar> void drop_inner_edges(const Substep<Scalar>& look);
  template <class Scalar> void put_off(const Substep<Scalar>& look);
  template <class Scalar> void meet_struck(const Substep<Scalar>& look);
  template <class Scalar> void mark_struck(const Substep<Scalar>& look);
  template <class Scalar> void mark(const Substep<Scalar>& look, std::uint32_t body);
  void list_contacts_of(const Listed& contacts, unsigned level);
  void find_beside_struck(const Listed& contacts, std::span<const std::uint32_t> others);
  static bool may_strike(const Standing& c) { return c.acts && !c.jointed && (c.struck || c.bounces); }
  template <class Scalar> void find_unseen(const Substep<Scalar>& look);
  template <class Scalar> void note_swept(const Substep<Scalar>& look);
  float went(std::uint32_t body) const { return ways_[body].went; }
  /// Before a look, which may go beside others.
  void make_record(Standing& contact) {
    if (contact.later > 0) return;
    contact.later = std::uint32_t(later_.size());
    later_.push_back({{}, starts_[contact.rows[0]]});
  }

  std::uint64_t serial_ = 0, structure_ = 0;  // of the world that was seen last
  std::uint64_t joint_changes_ = 0;
  std::uint64_t rest_ = 0;
  std::vector<Part> parts_;             // of bodies, by row; empty where none sleeps
  std::vector<std::uint32_t> touched_;  // of those that sleep
  bool possible_ = false;
  std::vector<Proxy> proxies_;
  std::vector<std::uint32_t> standing_;  // shapes of fixed and kinematic bodies
  float thinnest_ = 0;                   // half the least thickness of what moves by forces [m]
  std::vector<Aabb> tight_;
  // contacts of a shape are kept up to this gap; of a pair, up to the smaller of the two [m]
  std::vector<double> margins_;
  std::vector<float> reach_;           // how far a shape may come this step [m]
  std::vector<Twist> twists_;          // of bodies, by row
  AlignedBytes columns_, rows_;        // of shapes, in float: narrow_bounds.inl
  AlignedBytes rounded_[3];            // motion, mass and pose of a world in double
  std::vector<std::uint32_t> odd_;     // shapes with boxes of their own: planes and hulls
  std::vector<std::uint32_t> moving_;  // rows of bodies that do not stand; whole lanes
  std::vector<std::uint32_t> bodies_;  // rows, of shapes; whole lanes
  std::uint32_t movers_ = 0;           // bodies that do not stand
  double dt_ = 0, fall_ = 0;           // the step [s], and how far gravity moves what rests in it, with a margin [m]
  double listed_margin_ = -1;          // contact_margin that the columns are for; below 0: there are none
  std::vector<Standing> standings_;    // of contacts, by row
  std::vector<Later> later_;           // of contacts that were looked at within the step; the first of none
  std::vector<Vec3> starts_;           // of bodies: where their centres were when the step began [m]
  // of bodies: how far a turn of one radian moves any point of their shapes, at most [m]
  std::vector<float> levers_;
  std::vector<Way> ways_;               // of bodies
  std::vector<std::uint32_t> twisted_;  // of bodies: the look that their twists are of
  std::uint32_t meetings_ = 0;          // how many sub-steps it has looked at
  // places in what was listed
  std::vector<std::uint32_t> renewed_, struck_, waiting_, unseen_, on_standing_, inner_, beside_, beside_struck_;
  std::vector<std::uint32_t> touching_;  // by body: how much of what stands it touches
  std::vector<Look> looks_;
  std::vector<std::uint32_t> alone_;  // pairs that do not go in lanes
  std::vector<float> times_struck_;   // of bodies, when impacts were looked for last
  bool none_struck_ = false;          // since the step has begun
  // bodies: struck since then; of the contacts that the sweep may strike
  std::vector<std::uint32_t> marked_, swept_;
  std::vector<std::uint32_t> first_of_, contacts_of_;  // by body, its contacts of a level: numbers in the order of rows
  Marks of_marked_;                                    // of these, those of marked bodies
  std::vector<double> soonest_;                        // of bodies: when in the sub-step the first impact is [s]
  unsigned listed_level_ = 0;                          // from 1; 0: none
  std::vector<std::vector<std::uint32_t>> anew_;       // by level: rows that were renewed in the sub-step before
  std::vector<Distant> distant_;                       // in ascending order of their rows
  std::vector<char> sent_elsewhere_;  // bodies that contacts may send elsewhere than they go by themselves
  std::vector<std::uint32_t> gone_;   // rows that came apart in the step
  // where `pairs_` finds it even when this is moved
  std::unique_ptr<PairFilter> filter_ = std::make_unique<PairFilter>();
  std::vector<float> went_;           // of bodies: how far a try of this step sent them beyond their reach; else 0 [m]
  bool strays_ = false;               // some body has
  std::vector<std::uint32_t> trees_;  // by body row: the joint tree that it is free in, or 0
  std::vector<float> fastest_;        // of trees, by that number: the speed of their fastest body [m/s]
  // of bodies: how far others of their tree may send them in this step; 0: no further than they go by themselves [m]
  std::vector<float> drawn_;
  bool draws_ = false;  // some are
  PairCache pairs_;
  std::vector<std::uint32_t> near_;  // numbers of pairs
  std::span<const std::uint32_t> batch_;
  Marks marks_;         // places in the batch of those that may have a manifold; where some shape is round
  bool round_ = false;  // some shape is: its pairs go in lanes
  std::vector<std::uint32_t> hints_, next_hints_;
  bool hinted_ = false;  // some hint is not 0
  ContactColumns next_;  // of the next step, or of the last one
  bool replaced_ = false;
  Scratch<float> scratch_f_;
  Scratch<double> scratch_d_;
};

inline Pair Detector::in_order(std::uint32_t pair) const {
  const auto [a, b] = pairs_.pairs()[pair];
  return proxies_[a].responds ? Pair{a, b} : Pair{b, a};  // as WorldState::ends_of
}

/// No gap beyond it matters in this step.
template <class Scalar> inline Scalar Detector::look_margin(Pair s) const {
  return Scalar(margin(s.a, s.b)) + Scalar(reach_[s.a] + reach_[s.b]);
}

template <class Scalar>
inline Sight<Scalar> Detector::sight(const WorldState& s, const Scratch<Scalar>& scratch, std::uint32_t pair) const {
  const Pair shapes = in_order(pair);
  const std::uint32_t row_a = proxies_[shapes.a].body, row_b = proxies_[shapes.b].body;
  Sight<Scalar> view = {
      {shapes.a, shapes.b}, {row_a, row_b}, {0, 0, 0}, scratch.shapes[shapes.b], look_margin<Scalar>(shapes)};
  BodyReader<Scalar>(s.tables).shift(row_a, row_b, view.apart);
  for (int k = 0; k < 3; k++) view.there.p[k] += view.apart[k];
  return view;
}

}  // namespace pcphys
