// The one list of everything a world stores. It generates the C++ tables, the GLSL declarations,
// snapshots, hashes and docs/properties.md.
//
//   PC_TABLE(table, doc)
//   PC_BUFFER(table, buffer, quads, doc)      one row per object, `quads` times four reals
//   PC_PROPERTY(table, buffer, offset, type, name, role, default, unit, doc)
//
// A property is a field of a buffer's row; buffers group what kernels read together, since a kernel may
// bind at most eight. type: real, vec3, quat, sym3. role: input (the host writes it), state (what a
// snapshot and the hash hold), derived (follows from others), scratch (meaningless between steps).
// Row 0 of every table is the padding row: the ground body, a joint and a contact that do nothing.

PC_TABLE(body, "rigid bodies; row 0 is the ground")
PC_BUFFER(body, motion, 2, "what the solvers work on")
PC_PROPERTY(body, motion, 0, vec3, displacement_rate, state, 0, "m/s",
            "u = (p - p_last) / h, the mean velocity of the last sub-step")
PC_PROPERTY(body, motion, 3, real, inverse_mass, derived, 0, "1/kg", "0 for fixed and kinematic bodies")
PC_PROPERTY(body, motion, 4, vec3, angular_momentum, state, 0, "kg m^2/s",
            "world axes, half a sub-step behind the orientation; for kinematic bodies the angular velocity")
PC_PROPERTY(body, motion, 7, real, phase, state, 0, "N s",
            "above 0: largest contact impulse of the last sub-step; -1: the velocity was just set and is in phase with "
            "the position; -2: the body is frozen")
PC_BUFFER(body, pose, 4, "where a body stands")
PC_PROPERTY(body, pose, 0, vec3, position, state, 0, "m", "of the centre of mass, rounded; the rest is in position_low")
PC_PROPERTY(body, pose, 4, quat, orientation, state, 1, "1", "body to world, unit")
PC_PROPERTY(body, pose, 8, vec3, position_low, state, 0, "m",
            "what rounding dropped from position: their sum is the position")
PC_PROPERTY(body, pose, 12, quat, orientation_low, state, 0, "1", "the same of orientation")
PC_BUFFER(body, velocity_parts, 4, "what belongs to the velocities besides motion")
PC_PROPERTY(body, velocity_parts, 0, vec3, velocity_half_change, state, 0, "m/s",
            "velocity in phase with the position = displacement_rate + this")
PC_PROPERTY(body, velocity_parts, 4, vec3, momentum_half_change, state, 0, "kg m^2/s", "the same of angular_momentum")
PC_PROPERTY(
    body, velocity_parts, 7, real, some_left, scratch, 0, "1",
    "of the ground's row alone: 1 since a body in flight was about to leave the range of numbers (Backend::take_flag)")
PC_PROPERTY(body, velocity_parts, 8, vec3, velocity_low, state, 0, "m/s",
            "what rounding dropped from displacement_rate when forces and lasting contacts changed it")
PC_PROPERTY(body, velocity_parts, 11, real, some_struck, scratch, 0, "1",
            "of the ground's row alone: 1 since an impact struck some body, until another sweep has looked "
            "(Backend::take_flag)")
PC_PROPERTY(body, velocity_parts, 12, vec3, momentum_low, state, 0, "kg m^2/s", "the same of angular_momentum")
PC_PROPERTY(body, velocity_parts, 15, real, settling, state, 0, "1",
            "steps left in which contacts of a body that was just placed are visited more often")
PC_BUFFER(body, mass, 2, "mass properties in the principal frame")
PC_PROPERTY(body, mass, 0, vec3, moments, input, 0, "kg m^2", "principal moments of inertia")
PC_PROPERTY(body, mass, 3, real, mass, input, 0, "kg", "0 for fixed and kinematic bodies")
PC_PROPERTY(body, mass, 4, vec3, inverse_moments, derived, 0, "1/(kg m^2)",
            "1 for kinematic bodies, whose angular_momentum is a velocity")
PC_PROPERTY(body, mass, 7, real, middle_axis, derived, 0, "1", "0, 1 or 2: the axis of the middle moment")
PC_BUFFER(body, force, 2, "what acts over the whole step")
PC_PROPERTY(body, force, 0, vec3, force, input, 0, "N", "constant force and the sum of the callbacks, without gravity")
PC_PROPERTY(body, force, 3, real, linear_drag, input, 0, "1/s", "F in v' = -F v")
PC_PROPERTY(body, force, 4, vec3, torque, input, 0, "N m", "world axes")
PC_PROPERTY(body, force, 7, real, angular_drag, input, 0, "1/s", "F in L' = -F L")
PC_BUFFER(body, drag_terms, 2, "what drag makes of a sub-step, in worlds that have any")
PC_PROPERTY(body, drag_terms, 0, quat, linear_decay, scratch, 0, "1",
            "e = exp(-F h), 1 - e, phi and phi2 of F h, with F the linear drag")
PC_PROPERTY(body, drag_terms, 4, quat, angular_decay, scratch, 0, "1", "the same of the angular drag")
PC_BUFFER(body, inertia, 2, "inverse inertia in world axes, of this sub-step")
PC_PROPERTY(body, inertia, 0, sym3, inverse_inertia, scratch, 0, "1/(kg m^2)", "xx xy xz yy yz zz")
PC_PROPERTY(body, inertia, 6, real, response, scratch, 0, "1", "1 where impulses act, 0 for fixed and kinematic bodies")
PC_PROPERTY(body, inertia, 7, real, unlike_moments, scratch, 0, "1", "largest over smallest moment, minus 1")
PC_BUFFER(body, delta, 3, "motion since the start of the step, impacts, and what is recalled")
PC_PROPERTY(body, delta, 0, vec3, displacement, scratch, 0, "m", "")
PC_PROPERTY(body, delta, 3, real, turned, scratch, 0, "rad^2", "sum of the squares of the turns of the sub-steps")
PC_PROPERTY(body, delta, 4, vec3, rotation, scratch, 0, "rad", "rotation vector, world axes")
PC_PROPERTY(body, delta, 7, real, struck, scratch, 0, "1", "how often impacts struck it in this step")
PC_PROPERTY(body, delta, 8, real, struck_at, scratch, 0, "s",
            "when in this sub-step an impact struck it last; 0: none has")
PC_PROPERTY(body, delta, 9, real, struck_before, scratch, 0, "1", "1 where the sweep of impacts before struck it")
PC_PROPERTY(body, delta, 10, real, recalled_share, scratch, 0, "1",
            "of what its contacts remember that acts in this sub-step")
PC_PROPERTY(body, delta, 11, real, recalled_before, scratch, 0, "1", "1 since a sub-step of this step has recalled")
PC_BUFFER(body, pushed, 2, "what undoes overlaps with trees, on bodies in none, for one advance")
PC_PROPERTY(body, pushed, 0, vec3, pushed_impulse, scratch, 0, "N s", "zero between sub-steps")
PC_PROPERTY(body, pushed, 4, vec3, pushed_torque, scratch, 0, "N m s", "about its centre")
PC_BUFFER(body, recalled, 2,
          "what contacts remember, as a sub-step recalls it, and the velocity that it was recalled at")
PC_PROPERTY(body, recalled, 0, vec3, recalled_impulse, scratch, 0, "N s",
            "sum of the remembered impulses of the body's contacts; zero between sub-steps")
PC_PROPERTY(body, recalled, 3, real, recalled_tree, scratch, 0, "1/kg",
            "inverse mass of the joint tree that answers with the body; 0: it stands in none")
PC_PROPERTY(body, recalled, 4, vec3, recalled_at, scratch, 0, "m/s", "displacement_rate when this was summed up last")
PC_BUFFER(body, material, 2, "read when a contact is made")
PC_PROPERTY(body, material, 0, real, static_friction, input, 0.5, "1", "")
PC_PROPERTY(body, material, 1, real, kinetic_friction, input, 0.5, "1", "")
PC_PROPERTY(body, material, 2, real, restitution, input, 0, "1", "")
PC_PROPERTY(body, material, 3, real, friction_rule, input, 1, "1",
            "mean, geometric mean, minimum, product, maximum: 0 to 4; of two bodies the larger holds")
PC_PROPERTY(body, material, 4, real, rolling_friction, input, 0, "m", "lever of the couple that resists rolling")
PC_PROPERTY(body, material, 5, real, torsional_friction, input, 0, "m", "the same about the normal")
PC_PROPERTY(body, material, 6, real, restitution_rule, input, 0, "1", "as friction_rule")

PC_BUFFER(body, rest, 1, "who sleeps (docs/sleeping.md); no kernel reads it")
PC_PROPERTY(body, rest, 0, real, quiet_time, state, 0, "s",
            "how long it has been slow, up to StepSettings::sleep_time; hashed where some of these three is not 0")
PC_PROPERTY(body, rest, 1, real, asleep, state, 0, "1", "1 while it sleeps")
PC_PROPERTY(body, rest, 2, real, stirred, state, 0, "1",
            "1 where the host has changed it since the last step and something sleeps that this may wake")
PC_PROPERTY(body, rest, 3, real, can_sleep, input, 1, "1", "0: it never sleeps, nor does its island")

PC_TABLE(joint, "a pin between two bodies, with an angle constraint")
PC_BUFFER(joint, joint_frame, 6, "what the host gave")
PC_PROPERTY(joint, joint_frame, 0, vec3, anchor_a, input, 0, "m", "of the pin, in body a")
PC_PROPERTY(joint, joint_frame, 3, real, freedom_kind, input, 0, "1",
            "0 pin alone, 1 cone and twist, 2 pitch, yaw and roll")
PC_PROPERTY(joint, joint_frame, 4, quat, axes_a, input, 1, "1", "joint frame in body a")
PC_PROPERTY(joint, joint_frame, 8, vec3, anchor_b, input, 0, "m", "of the pin, in body b")
PC_PROPERTY(joint, joint_frame, 11, real, largest_force, input, 0, "N", "of the pin, at most; 0: any")
PC_PROPERTY(joint, joint_frame, 12, quat, axes_b, input, 1, "1", "joint frame in body b")
PC_PROPERTY(joint, joint_frame, 16, vec3, lower, input, 0, "rad", "of roll, pitch, yaw; or (-twist, -cone, -)")
PC_PROPERTY(joint, joint_frame, 20, vec3, upper, input, 0, "rad", "of roll, pitch, yaw; or (twist, cone, -)")
PC_PROPERTY(joint, joint_frame, 23, real, limit_restitution, input, 0, "1",
            "share of its speed at which the joint leaves a limit that it meets")
PC_BUFFER(joint, joint_solved, 6,
          "what the solver holds: joint_frame, or of several pins between two bodies one joint in their place; made by "
          "the step (docs/joints.md)")
PC_PROPERTY(joint, joint_solved, 0, vec3, solved_anchor_a, scratch, 0, "m", "as anchor_a")
PC_PROPERTY(joint, joint_solved, 3, real, solved_kind, scratch, 0, "1", "as freedom_kind")
PC_PROPERTY(joint, joint_solved, 4, quat, solved_axes_a, scratch, 1, "1", "as axes_a")
PC_PROPERTY(joint, joint_solved, 8, vec3, solved_anchor_b, scratch, 0, "m", "as anchor_b")
PC_PROPERTY(joint, joint_solved, 11, real, solved_largest_force, scratch, 0, "N", "as largest_force")
PC_PROPERTY(joint, joint_solved, 12, quat, solved_axes_b, scratch, 1, "1", "as axes_b")
PC_PROPERTY(joint, joint_solved, 16, vec3, solved_lower, scratch, 0, "rad", "as lower")
PC_PROPERTY(joint, joint_solved, 20, vec3, solved_upper, scratch, 0, "rad", "as upper")
PC_PROPERTY(joint, joint_solved, 23, real, solved_restitution, scratch, 0, "1", "as limit_restitution")
PC_BUFFER(joint, joint_impulse, 2, "what warm starting remembers")
PC_PROPERTY(joint, joint_impulse, 0, vec3, pin_impulse, state, 0, "N s", "on b, world axes, of the last sub-step")
PC_PROPERTY(joint, joint_impulse, 4, vec3, angle_impulse, state, 0, "N m s",
            "on b about the joint's roll, pitch and yaw axes")
PC_BUFFER(joint, joint_pivot, 3,
          "of a pin that alone holds one body to a fixed one: that body about the pin; made by the step "
          "(docs/joint-trees.md)")
PC_PROPERTY(joint, joint_pivot, 0, vec3, pivot_inverse_moments, scratch, 0, "1/(kg m^2)", "principal, about the pin")
PC_PROPERTY(joint, joint_pivot, 3, real, pivot_middle_axis, scratch, 0, "1", "0, 1 or 2: the axis of the middle moment")
PC_PROPERTY(joint, joint_pivot, 4, quat, pivot_axes, scratch, 1, "1", "principal axes about the pin, in the body")
PC_PROPERTY(joint, joint_pivot, 8, vec3, pivot_arm, scratch, 0, "m",
            "from the body's centre of mass to the pin, in the body")
PC_PROPERTY(joint, joint_pivot, 11, real, pivot_mass, scratch, 0, "kg", "of the body")

PC_BUFFER(joint, joint_drive, 3, "motor and spring of a joint; or a spring that stands for itself")
PC_PROPERTY(joint, joint_drive, 0, quat, rest_orientation, input, 1, "1",
            "of b's joint frame in a's, where the angular spring is at rest")
PC_PROPERTY(joint, joint_drive, 4, real, motor_speed, input, 0, "rad/s", "wanted, about the x axis of a's joint frame")
PC_PROPERTY(joint, joint_drive, 5, real, motor_torque, input, 0, "N m", "at most; 0: no motor")
PC_PROPERTY(joint, joint_drive, 6, real, spring_stiffness, input, 0, "N m/rad", "or N/m of a spring between two points")
PC_PROPERTY(joint, joint_drive, 7, real, spring_damping, input, 0, "N m s/rad", "or N s/m")
PC_PROPERTY(joint, joint_drive, 8, real, drive_kind, input, 0, "1",
            "0 none, 1 of a joint, 2 a spring between two points: no pin")
PC_PROPERTY(joint, joint_drive, 9, real, rest_length, input, 0, "m", "of a spring between two points")

PC_TABLE(node, "a body of a joint tree, as contacts see it; made by the step (docs/joint-trees.md)")
PC_BUFFER(node, node_operator, 8, "how the body follows its parent, of this sub-step")
PC_PROPERTY(node, node_operator, 0, vec3, follow_rows, scratch, 0, "1",
            "six rows of W, in the first three reals of quads 0 to 5; of a root the factor of its answer, in those of "
            "quads 0 to 6")
PC_PROPERTY(
    node, node_operator, 3, real, freedom_factor, scratch, 0, "1/(kg^(1/2) m)",
    "factor of the inverse inertia of the joint's freedom: xx xy xz yy yz zz in the fourth reals of quads 0 to 5")
PC_PROPERTY(node, node_operator, 24, vec3, parent_arm, scratch, 0, "m",
            "from the parent's centre of mass to the body's, at the joint")
PC_PROPERTY(node, node_operator, 28, vec3, pin_arm, scratch, 0, "m", "from the body's centre of mass to the pin")
PC_BUFFER(node, node_response, 6, "how the body answers impulses, of this sub-step, where joints close loops")
PC_PROPERTY(node, node_response, 0, vec3, body_response, scratch, 0, "1/kg",
            "its inverse inertia among its joints, symmetric 6 x 6; see node_answer.inl")
PC_BUFFER(node, node_pending, 4, "what contacts have changed and the tree has not taken over yet")
PC_PROPERTY(node, node_pending, 0, vec3, pending_turn, scratch, 0, "N^(1/2) m^(1/2)",
            "turning about the joint, in units in which its inertia is 1; of a root the first half of its motion")
PC_PROPERTY(node, node_pending, 4, vec3, pending_root_turn, scratch, 0, "N^(1/2) m^(1/2)", "of a root the second half")
PC_PROPERTY(node, node_pending, 8, vec3, pending_impulse, scratch, 0, "N s",
            "sum of the contacts' impulses on the body")
PC_PROPERTY(node, node_pending, 11, real, pending_touch, scratch, 0, "N s", "largest load of a contact on the body")
PC_PROPERTY(node, node_pending, 12, vec3, pending_torque, scratch, 0, "N m s",
            "and of their moments about its centre of mass")

PC_TABLE(contact, "one manifold of up to four points between two shapes")
PC_BUFFER(contact, contact, 11, "what the narrow phase found, and the impulses that hold it")
PC_PROPERTY(contact, contact, 0, vec3, normal, derived, 0, "1", "from body a to body b")
PC_PROPERTY(contact, contact, 3, real, point_count, state, 0, "1", "0 to 4")
PC_PROPERTY(
    contact, contact, 4, vec3, arm_0, state, 0, "m",
    "from a's centre of mass to the point between the surfaces: at the light body's own, midway between equal ones")
PC_PROPERTY(contact, contact, 7, real, separation_0, derived, 0, "m", "negative when the shapes overlap")
PC_PROPERTY(contact, contact, 8, vec3, arm_1, state, 0, "m", "")
PC_PROPERTY(contact, contact, 11, real, separation_1, derived, 0, "m", "")
PC_PROPERTY(contact, contact, 12, vec3, arm_2, state, 0, "m", "")
PC_PROPERTY(contact, contact, 15, real, separation_2, derived, 0, "m", "")
PC_PROPERTY(contact, contact, 16, vec3, arm_3, state, 0, "m", "")
PC_PROPERTY(contact, contact, 19, real, separation_3, derived, 0, "m", "")
PC_PROPERTY(contact, contact, 20, quat, normal_impulse, state, 0, "N s", "of the four points, last sub-step")
PC_PROPERTY(contact, contact, 24, vec3, friction_impulse, state, 0, "N s", "on b, world axes")
PC_PROPERTY(contact, contact, 27, real, twist_impulse, state, 0, "N m s", "on b about the normal")
PC_PROPERTY(contact, contact, 28, real, contact_static_friction, derived, 0, "1", "of the two materials, by their rule")
PC_PROPERTY(contact, contact, 29, real, contact_kinetic_friction, derived, 0, "1", "")
PC_PROPERTY(contact, contact, 30, real, contact_restitution, derived, 0, "1", "")
PC_PROPERTY(contact, contact, 31, real, impact_time, derived, 0, "s",
            "after the step's start, of shapes that meet in flight; 0: they are close; -1: a body hangs on joints")
PC_PROPERTY(contact, contact, 32, vec3, apart, scratch, 0, "m",
            "from a's centre of mass to b's, when the manifold was found")
PC_PROPERTY(contact, contact, 35, real, found_anew, scratch, 0, "1",
            "in this sub-step 0: the rows stand; 1: the manifold was found anew, and hands on what the rows hold; 2: "
            "it acts no longer")
PC_PROPERTY(contact, contact, 36, quat, from_point, scratch, 0, "1",
            "which point of the manifold before each one was, from 1; 0: none")

PC_TABLE(touch,
         "what a step did to each contact: rows are those of the table of contacts; only where StepSettings asks for "
         "events (docs/events.md)")
PC_BUFFER(touch, touch, 2, "")
PC_PROPERTY(touch, touch, 0, quat, touch_impulse, scratch, 0, "N s",
            "along the normal, of the four points: of impacts and bounces all, of the rest the largest of a sub-step")
PC_PROPERTY(touch, touch, 4, real, touch_speed, scratch, 0, "m/s",
            "at which the points that were pressed had approached, the largest; 0: none was")

PC_TABLE(shape, "what bodies collide with; read by the broad and narrow phase")
PC_BUFFER(shape, shape, 3, "")
PC_PROPERTY(
    shape, shape, 0, vec3, size, input, 0, "m",
    "sphere (radius), capsule and cylinder (radius, half length), box half extents, hull (radius, inner radius)")
PC_PROPERTY(shape, shape, 3, real, shape_kind, input, 0, "1", "sphere, capsule, box, cylinder, hull, plane: 0 to 5")
PC_PROPERTY(shape, shape, 4, vec3, local_position, input, 0, "m", "in its body")
PC_PROPERTY(shape, shape, 8, quat, local_orientation, input, 1, "1", "in its body")
