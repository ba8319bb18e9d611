// What a kernel is told besides its buffers: one block of reals per sub-step class and phase.
//   PC_INFO_FIELD(name, doc)
PC_INFO_FIELD(h, "sub-step [s]")
PC_INFO_FIELD(inverse_h, "1 / h")
PC_INFO_FIELD(gravity_x, "[m/s^2]")
PC_INFO_FIELD(gravity_y, "")
PC_INFO_FIELD(gravity_z, "")
PC_INFO_FIELD(h_change, "1 - h / h_before: shifts u by the change of half a sub-step")
PC_INFO_FIELD(h_before, "that the stored velocities are of; h if there was no step before [s]")
PC_INFO_FIELD(by_forces,
              "1 where a step is divided into more sub-steps than the settings say: such a shift is of forces alone")
PC_INFO_FIELD(begins, "1 in the first sub-step of a step: rows of contacts are all made anew")
PC_INFO_FIELD(impulse_ratio, "h / h_before: remembered impulses scale with the sub-step")
PC_INFO_FIELD(soft_rate, "share of an overlap, or of a joint's error, removed per second [1/s]; 0 in the relax phase")
PC_INFO_FIELD(soft_mass_scale, "of the rigid impulse that a soft row has; 1 in the relax phase")
PC_INFO_FIELD(
    soft_trend,
    "share of its last change by which an impulse goes on, so that a soft row is no stiffer at rest than in motion")
PC_INFO_FIELD(soft_impulse_scale, "share of its impulse that a soft row lets go of; 0 in the relax phase")
PC_INFO_FIELD(contact_preload,
              "where one body stands, or hangs on joints, of what the load goes beyond this change of velocity [m/s]")
PC_INFO_FIELD(settled_load, "rounds where a load grows by this factor, or friction changes by half of its limit")
PC_INFO_FIELD(least_load, "rounds are for loads that make more than this change of the velocity [m/s]")
PC_INFO_FIELD(load_ahead, "1 in the relax phase: friction goes by the load that the normal rows will take up; else 0")
PC_INFO_FIELD(push_speed, "largest speed at which an overlap is undone [m/s]")
PC_INFO_FIELD(row_push_speed, "the same of free bodies: what gravity gives in a step, or push_speed in a second [m/s]")
PC_INFO_FIELD(tree_push_speed,
              "the same of what stands in trees, by velocities: what gravity gives in a step; what is more moves poses "
              "alone [m/s]")
PC_INFO_FIELD(joint_push_speed, "[m/s] for pins, [rad/s] for angles")
PC_INFO_FIELD(sent, "1 in the sent phase: contacts of what joints have sent together in this sub-step; else 0")
PC_INFO_FIELD(push, "1 in the push phase: what contacts have changed moves poses alone; else 0")
PC_INFO_FIELD(rounds, "Newton steps of a net of springs, and most search directions in each")
PC_INFO_FIELD(net_made, "share of its energy that a net may make in a sub-step and owe")
PC_INFO_FIELD(limit_give, "how far beyond its limits a joint is turned back by its velocity [rad]")
PC_INFO_FIELD(loop_give, "compliance of a pin that closes a loop of a tree, as a share of what the bare bodies answer")
PC_INFO_FIELD(spin_floor, "least inertia of a joint's freedom, as a share of the sum over its axes")
PC_INFO_FIELD(limit_stiffness, "of an angle limit inside a tree, as a multiple of the joint's own inertia")
PC_INFO_FIELD(locked_interval, "an angle with narrower limits is locked [rad]")
PC_INFO_FIELD(stale_share,
              "joints of a tree are seen ahead until a body has turned by a radian, or by this where Newton's method "
              "does not find its way so far off [rad]")
PC_INFO_FIELD(tree_damping, "of rotations too fast for the sub-step")
PC_INFO_FIELD(lock_stiffness, "of a locked angle")
PC_INFO_FIELD(restitution_threshold, "approach speed below which nothing bounces [m/s]")
PC_INFO_FIELD(struck_speed, "where a body was struck, its contacts remember little: recall_share.inl [m/s]")
PC_INFO_FIELD(rounding, "relative: what is this far below what it is a difference of is none")
PC_INFO_FIELD(
    carries,
    "1 where there are kinematic bodies: contacts go by the arcs on which those that turn carry what they meet")
PC_INFO_FIELD(substeps, "how many a step of the class has")
PC_INFO_FIELD(step, "their sum: what a kernel of the host's own that runs once a step is told as its h [s]")
PC_INFO_FIELD(largest_state, "a body with larger numbers is frozen")
PC_INFO_FIELD(largest_momentum, "of a contact, that it remembers [N s]")
