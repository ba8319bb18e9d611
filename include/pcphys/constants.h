// Every tolerance and limit of the library, with its meaning.
#pragma once
#include <cstdint>

namespace pcphys::constants {

/// Lengths of shapes outside this interval are refused: float32 cannot resolve contacts between them [m].
inline constexpr double smallest_extent = 1e-5, largest_extent = 1e6;
/// A convex hull may have so many vertices; contacts see up to so many corners of a face.
inline constexpr unsigned largest_hull_vertices = 64, largest_hull_face = 16;
/// Points are flat, and make no hull, where it is less wide across one of its faces than this share of the distance of
/// the two vertices that are farthest apart.
inline constexpr double hull_flatness = 1e-4;
/// Vertices nearer to a plane or line than this share of how far the hull's points reach lie in it:
/// triangles merge into faces.
inline constexpr double hull_planarity = 1e-5;
/// Coordinates, velocities and other inputs beyond this are refused: their squares leave float32's range.
inline constexpr double largest_input = 1e15;
/// A body whose coordinates [m], speed [m/s] or spin [rad/s] would go beyond this within a step is frozen.
inline constexpr double largest_state = 1e18;
/// Masses [kg], moments of inertia [kg m^2] and densities [kg/m^3] outside this interval are refused: float32 must hold
/// masses and moments, their inverses and the products of both.
inline constexpr double smallest_mass = 1e-30, largest_mass = 1e30;
/// A spin that with the largest moment of its body makes an angular momentum beyond this [kg m^2/s] is refused, in
/// either precision, and contacts remember no larger impulses [N s]: float32 must hold sums of such, whichever way a
/// body is turned.
inline constexpr double largest_momentum = 1e36;
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

/// Soft rows, of contacts and of joints: angular frequency times sub-step, and damping ratio. Stiffness is tied to the
/// sub-step, so overlap falls with its square. Three tenths of an error are undone in a sub-step, 12 % of the impulse
/// let go of; the relax pass takes out the velocity. Stiffer than that at rest, and piles bounce on their own
/// (docs/impulses.md).
inline constexpr double soft_frequency_times_h = 1.5, soft_damping_ratio = 1.8;
/// Where sub-steps get shorter, soft rows get as much stiffer in so long [s] (docs/impulses.md).
inline constexpr double stiffening_time = 4;
/// Soft contacts give way to what is beyond an impulse that makes so many times the velocity that gravity makes in a
/// sub-step: what lies alone on what stands does not sink.
inline constexpr double contact_preload = 1.75;
/// One visit solves a manifold's rows well enough unless the load is so many times what the last sub-step left, or
/// friction changes by half of its limit: then it takes rounds (contact_settle.inl).
inline constexpr double settled_load = 1.5;
/// Not for loads below this share of what gravity makes in a sub-step: those are rounding.
inline constexpr double least_load = 0.01;
/// What moves by more than this share of its size in a sub-step, or turns by more than this [rad], is no longer where
/// it was seen: bodies that answer and pass each other so, or turn into each other, have no contact but an impact, of
/// which nothing lasts; rows of what has turned so are made anew; no spring on a tree turns a body so far; and where
/// Newton's method for a tree more than doubles the energy of the motion within it, as after a blow or in a whip,
/// bodies are seen ahead so far alone.
inline constexpr double stale_share = 0.1;
/// What contacts remember makes a body faster by no more than this squared over how much its velocity changed in the
/// sub-step before [m/s]: a blow is no load.
inline constexpr double struck_speed = 0.5;
/// Contacts are kept up to a gap of this share of the smaller shape's radius (of the sphere that holds it), so that
/// what happens is the same at any size. A manifold stands until its bodies have moved against each other by this share
/// of the smaller one's thickness.
inline constexpr double contact_share = 0.01;
/// An island gets as many sub-steps as bring (h omega)^2 of each of its rows below this (docs/substeps.md): of a
/// contact how far, over the body's size (twice the radius of gyration), it is pressed in by as many bodies of its own
/// kind as the island is high, and by as many again as it is higher than wide (plan/columns.h); of a joint with limits
/// the host's pull over the body's size, or its spin where its tree is alone; of one that closes a loop the frequency
/// of what swings under its tension, of half the sub-step; of a tree that nothing touches how much a spin changes.
inline constexpr double largest_give = 0.01;
/// And by one body at least so many times as heavy (plan/loads.h) a contact is to be pressed in by less than this
/// share: it sinks where the other rows of its manifold do not.
inline constexpr double uneven_masses = 200, load_give = 0.001;
/// A body of a joint tree that would turn by more than this in a sub-step [rad] gets more of them (docs/substeps.md).
inline constexpr double largest_joint_turn = 0.5;
/// Rounds after which a device that finds islands is stopped; a chain of a million bodies takes 23.
inline constexpr std::uint32_t most_island_rounds = 1000;
/// Loops may ask for as many as this, beyond StepSettings::refinement: a pin that closes a loop near its dead centre
/// throws what the sub-step does not resolve.
inline constexpr std::uint32_t most_loop_substeps = 512;
/// Of what a sub-step is too long to resolve in the turning of a tree's bodies, this share is taken out
/// (docs/joints.md).
inline constexpr double tree_damping = 0.4;
/// Stiffness of a locked angle inside a joint tree, as a multiple of the joint's own inertia about it.
inline constexpr double lock_stiffness = 1e4;
/// Least inertia of a joint's freedom inside a tree, as a share of the sum over its axes.
inline constexpr double tree_spin_floor = 3e-5;
/// Compliance of a pin that closes a loop of joint trees, as a share of what its two bodies would answer without
/// joints: what a tree holds by itself answers nothing but rounding.
inline constexpr double loop_give = 1e-4;
/// Largest speed at which an open joint is closed [m/s] and a violated angle is undone [rad/s].
inline constexpr double joint_push_speed = 8;

/// What is this many roundings (of relative size epsilon) below what it is a difference of is rounding: a velocity
/// below what the contact's impulse that holds the body would give it, what Newton's method for a net
/// of springs leaves.
inline constexpr double roundings = 32;

/// What is sought round by round gets so many at most: impacts in a sub-step, since what one hands on, the next body
/// hands on again, as in Newton's cradle; Newton's method for a net of springs, and its search directions after each
/// step; visits of contacts in each pass, and such steps, after a body was just placed, since nothing is remembered yet
/// of what holds it (docs/impulses.md).
inline constexpr unsigned rounds = 8;
/// A net's solution is dropped where the sub-step would make more energy than this share of what the net has.
inline constexpr double net_made = 1e-3;
/// A body is slow below this speed of its centre of mass [m/s] and this spin [rad/s], and falls asleep with its island
/// when all of it has been for so long [s] (docs/sleeping.md). Piles at rest keep a hundredth of that and less.
inline constexpr double sleep_speed = 0.02, sleep_spin = 0.05, sleep_time = 0.5;

/// Proxies of the broad phase are fattened by this, so that most steps change no pair [m].
inline constexpr double broad_margin = 0.05;

}  // namespace pcphys::constants
