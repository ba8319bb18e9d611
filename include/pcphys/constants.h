// Every tolerance and limit of the library, with its meaning.
#pragma once
#include <cstdint>

namespace pcphys::constants {

/// Lengths of shapes outside this interval are refused: float32 cannot resolve contacts between them [m].
inline constexpr double smallest_extent = 1e-5, largest_extent = 1e6;
/// A convex hull may have so many vertices; contacts see up to so many corners of a face.
inline constexpr unsigned largest_hull_vertices = 64, largest_hull_face = 16;
/// Points whose smallest extent is below this share of their largest are flat: they make no hull.
inline constexpr double hull_flatness = 1e-4;
/// Vertices nearer to a plane or line than this share of the hull's largest extent lie in it: triangles merge into
/// faces.
inline constexpr double hull_planarity = 1e-5;
/// Coordinates, velocities and other inputs beyond this are refused: their squares leave float32's range.
inline constexpr double largest_input = 1e15;
/// A body whose coordinates [m], speed [m/s] or spin [rad/s] would go beyond this within a step is frozen.
inline constexpr double largest_state = 1e18;
/// In sub-steps shorter than this [s] and single precision the visits of contacts keep what rounding drops from bodies
/// that are by far the heavier, and what slides goes by the load that was found (docs/impulses.md).
inline constexpr double short_substep = 1.001e-3;
/// Masses [kg] and moments of inertia [kg m^2] outside this interval are refused: float32 must hold them, their
/// inverses and the products of both.
inline constexpr double smallest_mass = 1e-30, largest_mass = 1e30;
/// Time steps outside this interval are refused: their inverses or what falls within them leave float32's range [s].
inline constexpr double shortest_step = 1e-15, longest_step = 1e3;
/// How far an orientation may be from unit length; closer ones are normalised.
inline constexpr double unit_tolerance = 1e-3;
/// An angle limit further out than this does not exist [rad].
inline constexpr double free_angle = 1e9;
/// An angle with a narrower interval is locked (angle_rows.inl) [rad].
inline constexpr double locked_interval = 1e-6;
/// Pins between two bodies stand in one place, or on one line, where they are nearer to it than this share of the
/// smaller body's radius of gyration.
inline constexpr double apart_pins = 1e-4;
/// Moments may violate the triangle inequality by this share, for rounding.
inline constexpr double moment_tolerance = 1e-6;

/// Soft contacts: angular frequency times sub-step, and damping ratio. Stiffness is tied to the sub-step, so overlap
/// falls with its square. Three tenths of an overlap are pushed out in a sub-step, 12 % of the impulse let go of; the
/// relax pass takes out the velocity. Stiffer than that at rest, and piles bounce on their own (docs/impulses.md).
inline constexpr double contact_frequency_times_h = 1.48;
inline constexpr double contact_damping_ratio = 1.73;
/// The same for contacts with joint trees, whose rows leak on what deviates from a slow mean (mean_impulse_share).
inline constexpr double tree_contact_frequency_times_h = 1.0471975511965976;  // 2 pi / 6
inline constexpr double tree_contact_damping_ratio = 5;
/// Between free bodies, in manifolds of three points and more: by which share of its last change a normal impulse goes
/// on in the next sub-step.
inline constexpr double impulse_trend = 0.5;
/// Soft contacts give way to what is beyond an impulse that makes so many times the velocity that gravity makes in a
/// sub-step: what lies alone on what stands does not sink.
inline constexpr double contact_preload = 1.75;
/// What would need more than static friction by less than this share of the load is held by static friction: what is
/// that slow may stick again, and the load is not known better.
inline constexpr double friction_band = 0.1;
/// Friction foresees the load of what closes its gap in the first 1 / gap_weight of a sub-step; the rest meets
/// elsewhere.
inline constexpr double gap_weight = 16;
/// One visit solves a manifold's rows well enough unless the load is so many times what the last sub-step left, or
/// friction changes by such a share of its limit: then it takes rounds (contact_settle.inl).
inline constexpr double settled_load = 1.5, settled_friction = 0.5;
/// Not for loads below this share of what gravity makes in a sub-step: those are rounding.
inline constexpr double least_load = 0.01;
/// In a round a row goes so many times the share of its own correction that is safe if all four rows pull together.
/// They seldom do.
inline constexpr double settling_pace = 1.5;
/// A manifold stands until its bodies have moved against each other by this share of the smaller one's thickness.
inline constexpr double manifold_share = 0.01;
/// Where bodies that both answer move along each other by more than this share in a sub-step, or turn into each other,
/// their contact is an impact: nothing of it lasts.
inline constexpr double quick_share = 0.1;
/// Contacts are kept up to a gap of this share of the smaller shape's radius (of the sphere that holds it), so that
/// what happens is the same at any size.
inline constexpr double margin_share = 0.02;
/// A free body that carries one so many times as heavy may need more sub-steps (docs/impulses.md): where it would be
/// pressed in by more than the first overlap [m], they are to bring that down to the second.
inline constexpr double uneven_masses = 16, heavy_overlap = 0.015, load_overlap = 5e-4;
/// What stands high on small bodies may need more, too (plan/columns.h): where the weight above the lowest would press
/// them in by more than the first share of their size (twice the radius of gyration), sub-steps are to bring that down
/// to the second.
inline constexpr double column_overlap = 0.02, column_aim = 0.005;
/// And what is slender: where twice what a column as high as the island would shrink by, as a share of the island's
/// width, times its height over its width, is more than this. Towers lean by themselves from there on.
inline constexpr double column_lean = 0.02;
/// Islands of few bodies get more where a column of them as high as the island would shrink by more than the first
/// share of their size; sub-steps are to bring that down to the second.
inline constexpr double column_sag = 0.002, sag_aim = 4e-4;
inline constexpr std::uint32_t small_island = 48;
/// A body of a joint tree that would turn by more than this in a sub-step [rad] gets more of them, but in islands of
/// more bodies than that no more than twice as many (docs/substeps.md).
inline constexpr double largest_joint_turn = 0.5;
/// And so does one that whips: whose spin changed in the last sub-step by more than this, times the sub-step [rad], in
/// a tree that nothing touches.
inline constexpr double largest_spin_change = 0.006;
/// And so does one in a tree with limits that the host pulls by more than this share of its size in a sub-step, or
/// turns by so much [rad]; sub-steps are to bring that down to the second.
inline constexpr double largest_pull = 0.1, pull_aim = 0.03;
inline constexpr std::uint32_t large_island = 256;
/// A joint tree on what does not answer is torn where a joint is open by more than that share of its body's size, and
/// apart where no turning closes it, by that share. A torn one that turns by more than this in a sub-step [rad] whirls:
/// its steps are made again with all sub-steps.
inline constexpr double torn = 0.1, tear_apart = 0.5, whirling = 0.1;
/// Rounds after which a device that finds islands is stopped; a chain of a million bodies takes 23.
inline constexpr std::uint32_t most_island_rounds = 1000;
/// A joint that closes a loop may need more, too: (frequency at which its bodies swing under its tension, times half
/// the sub-step)^2 is to stay below this.
inline constexpr double loop_stiffness = 0.02;
/// Where a step brings this many times the tension that it was made for, and that asks for more, it is made again with
/// all there are.
inline constexpr double loop_snap = 2;
/// In islands that are not large, as far as this, beyond StepSettings::refinement.
inline constexpr std::uint32_t most_loop_substeps = 512;
/// The same for joint rows, which carry more and may be stiffer. At 2 pi 3 / 8 a chain under a heavy load gains energy.
inline constexpr double joint_frequency_times_h = 1.5707963267948966;  // 2 pi / 4
inline constexpr double joint_damping_ratio = 2;
/// Of what a sub-step is too long to resolve in the turning of a tree's bodies, this share is taken out
/// (docs/joints.md).
inline constexpr double tree_damping = 0.4;
/// Of contacts with joint trees, the share of a sub-step's impulse that goes into its slow mean, on which the soft
/// constraint does not leak (docs/joint-trees.md).
inline constexpr double mean_impulse_share = 0.025;
/// And the mean at most what would give the lighter body this speed [m/s]: what cannot be pushed apart is not pushed
/// ever harder.
inline constexpr double mean_impulse_speed = 30;
/// Least inertia of a joint's freedom inside a tree, as a share of the sum over its axes.
inline constexpr double tree_spin_floor = 6e-5;
/// Of fourth order a tree has no stiffness in its inertia: (frequency at which the forces of its pins would turn a
/// body, times half the sub-step)^2, from above. Beyond it stays at second order.
inline constexpr double stiff_pins = 1;
/// And one of which the shortest sub-step turns a body by more than this [rad].
inline constexpr double largest_smooth_turn = 1;
/// Stiffness of a locked angle inside a joint tree, as a multiple of the joint's own inertia about it.
inline constexpr double lock_stiffness = 1e4;
/// Compliance of a pin that closes a loop of joint trees, as a share of what its two bodies would answer without
/// joints: what a tree holds by itself answers nothing but rounding. So many roundings (of relative size epsilon) of it
/// at least; shorter sub-steps have more, as much as leaves it the same spring, and `loop_give_most` at most.
inline constexpr double loop_give = 1e-7, loop_roundings = 800, loop_give_most = 1e-4;
/// Of what an impulse on one body of a joint tree moves another one, so much counts in the effective masses of a
/// contact between the two: bodies that can hardly move against each other then have a mass that is finite.
inline constexpr double cross_share = 0.9;
/// Effective masses of contacts with joint trees are at most so many times what the bare bodies have.
inline constexpr double row_mass_most = 100;
/// A contact with a joint tree that holds nothing is left alone in a sub-step while its points would have to be brought
/// together by this and the speeds of its bodies besides [m/s].
inline constexpr double idle_speed = 0.5;
/// Contacts keep how they reach into a joint tree, from sub-step to sub-step of a step, until its bodies may have
/// turned by this [rad].
inline constexpr double kept_turn = 0.005;
/// Joints of a tree are solved where the sub-step will take its bodies, until one has turned by `seen_turn`. Newton's
/// method there is not to be trusted where it more than doubles the energy of the motion within the tree, as after a
/// blow or in a whip that sub-steps are too long for: its steps are taken back, and bodies are seen ahead until
/// `strayed_turn` [rad].
inline constexpr double seen_turn = 1, strayed_turn = 0.1;
/// Largest speed at which an open joint is closed [m/s] and a violated angle is undone [rad/s].
inline constexpr double joint_push_speed = 8;

/// A body that a contact holds reads as at rest below this many roundings (of relative size epsilon) of the velocity
/// that the contact's impulse would give it.
inline constexpr double rest_roundings = 32;

/// So many roundings (of relative size epsilon) of a contact's arms are in its gaps.
inline constexpr double gap_roundings = 1;

/// How often a sub-step looks for impacts, at most, while there are any: what one hands on, the next body hands on
/// again, as in Newton's cradle.
inline constexpr unsigned impact_sweeps = 8;
/// Nets of springs (kernels/net_solve.inl): looks at a sub-step's lengths, most search directions after each, and how
/// often what was solved is made less where the sub-step would make more energy than this share of what the net has.
inline constexpr unsigned net_rounds = 8, net_searches = 24, net_bounds = 4;
inline constexpr double net_made = 1e-5;
/// A Newton step's equations are solved to this many roundings.
inline constexpr double net_roundings = 10;
/// Contacts of a body that was just placed are visited so often in each pass, in so many steps: nothing is remembered
/// yet of what holds it (docs/impulses.md).
inline constexpr unsigned settling_visits = 8, settling_steps = 16;
/// Where sub-steps of h are short, so that an overlap is pushed out much faster than loads are taken up, so often, and
/// of the count of steps so much is taken by each. Short is where gravity g does not move a body by this: 0 < g h^2 <
/// settling_fall [m], that of 1 ms on Earth.
inline constexpr unsigned settling_visits_short = 16;
inline constexpr double settling_step_short = 0.25, settling_fall = 9.83e-6;

/// A body is slow below this speed of its centre of mass [m/s] and this spin [rad/s], and falls asleep with its island
/// when all of it has been for so long [s] (docs/sleeping.md). Piles at rest keep a hundredth of that and less.
inline constexpr double sleep_speed = 0.02, sleep_spin = 0.05, sleep_time = 0.5;

/// Proxies of the broad phase are fattened by this, so that most steps change no pair [m].
inline constexpr double broad_margin = 0.05;

}  // namespace pcphys::constants
