// The one list of kernels. It generates the C++ loops, the GLSL programs, and what the plan knows of
// hazards. A kernel's text is <name>.inl beside this file.
//
//   PC_KERNEL(name, domain, stage, accesses)
//
// domain: body (the rows listed in `bodies`), contact or joint (slots, colour by colour or all at once; free_contact
// and tree_contact are those without and with a body of a tree, free_joint and tree_joint the same of joints that close
// loops), tree (a joint tree a lane, blocks of trees of one shape; tree_nodes where a work group may share one that
// stands alone, see nodes.inl), net (a net of springs a lane, blocks of nets of one shape), row (every row of bodies),
// edge (two bodies that act on each other).
// stage: whose backend runs it; islands: a device's, in place of the host's union-find (plan/islands.h).
// accesses: PC_READ(buffer) gives `const T*` in C++ and `readonly` in GLSL; PC_WRITE(buffer) allows both directions.
// At most eight of them (the GL 4.3 minimum).
// Buffers beside those of properties.inl: `bodies` (rows to visit), `<domain>_ends` (the two body rows of a slot),
// `<domain>_order` (a slot's table row), and the slots' scratch listed below.
//
//   PC_ROWS(domain, buffer, reals)            array of structures of arrays, the backend's width; contact_reach has
//                                             slots for the steps of a contact's way through trees (tree_reach.inl)

#ifdef PC_ROWS
PC_ROWS(contact, contact_rows, 64)
PC_ROWS(contact, frictionless_rows, 48)
PC_ROWS(contact, contact_impulses, 16)
PC_ROWS(contact, rolling_impulses, 4)
PC_ROWS(contact, contact_reach, 12)
PC_ROWS(joint, joint_rows, 96)
PC_ROWS(joint, tree_rows, 192)
PC_ROWS(joint, tree_drive_rows, 36)
PC_ROWS(joint, net_rows, 84)
#endif

#ifdef PC_KERNEL
PC_KERNEL(begin, body, integrate,
          PC_READ(bodies) PC_READ(force) PC_WRITE(velocity_parts) PC_WRITE(motion) PC_WRITE(delta))
PC_KERNEL(begin_drag, body, integrate,
          PC_READ(bodies) PC_READ(force) PC_WRITE(velocity_parts) PC_WRITE(motion) PC_WRITE(delta) PC_WRITE(drag_terms))
PC_KERNEL(begin_seed, body, integrate, PC_READ(bodies) PC_WRITE(velocity_parts) PC_WRITE(motion) PC_WRITE(delta))
PC_KERNEL(integrate, body, integrate, PC_READ(bodies) PC_READ(force) PC_WRITE(velocity_parts) PC_WRITE(motion))
PC_KERNEL(integrate_drag, body, integrate,
          PC_READ(bodies) PC_READ(force) PC_WRITE(velocity_parts) PC_WRITE(motion) PC_READ(drag_terms))
PC_KERNEL(integrate_seed, body, integrate, PC_READ(bodies) PC_READ(force) PC_WRITE(velocity_parts) PC_WRITE(motion))
PC_KERNEL(inertia, body, integrate, PC_READ(bodies) PC_READ(pose) PC_READ(mass) PC_READ(motion) PC_WRITE(inertia))
PC_KERNEL(remember, body, integrate, PC_READ(bodies) PC_READ(motion) PC_WRITE(velocity_parts))
PC_KERNEL(advance, body, integrate, PC_READ(bodies) PC_READ(motion) PC_READ(mass) PC_WRITE(pose) PC_WRITE(delta))
PC_KERNEL(advance_round, body, integrate, PC_READ(bodies) PC_READ(motion) PC_READ(mass) PC_WRITE(pose) PC_WRITE(delta))
PC_KERNEL(advance_still, body, integrate, PC_READ(bodies) PC_READ(motion) PC_WRITE(pose) PC_WRITE(delta))
PC_KERNEL(advance_seed, body, integrate, PC_READ(bodies) PC_READ(mass) PC_WRITE(motion) PC_WRITE(pose) PC_WRITE(delta))
PC_KERNEL(synchronise, body, integrate,
          PC_READ(bodies) PC_READ(motion) PC_READ(mass) PC_READ(force) PC_WRITE(velocity_parts))
PC_KERNEL(synchronise_drag, body, integrate,
          PC_READ(bodies) PC_READ(motion) PC_READ(mass) PC_READ(force) PC_WRITE(velocity_parts) PC_READ(drag_terms))
PC_KERNEL(synchronise_seed, body, integrate, PC_READ(bodies) PC_WRITE(velocity_parts))
PC_KERNEL(restagger, body, integrate, PC_READ(bodies) PC_READ(force) PC_WRITE(velocity_parts) PC_WRITE(motion))
PC_KERNEL(restagger_drag, body, integrate, PC_READ(bodies) PC_READ(force) PC_WRITE(velocity_parts) PC_WRITE(motion))
PC_KERNEL(fly, body, integrate,
          PC_READ(bodies) PC_READ(force) PC_READ(mass) PC_WRITE(motion) PC_WRITE(pose) PC_WRITE(velocity_parts))
PC_KERNEL(fly_round, body, integrate,
          PC_READ(bodies) PC_READ(force) PC_READ(mass) PC_WRITE(motion) PC_WRITE(pose) PC_WRITE(velocity_parts))
PC_KERNEL(fly_still, body, integrate,
          PC_READ(bodies) PC_READ(force) PC_READ(mass) PC_WRITE(motion) PC_WRITE(pose) PC_WRITE(velocity_parts))
PC_KERNEL(fly_drag, body, integrate,
          PC_READ(bodies) PC_READ(force) PC_READ(mass) PC_WRITE(motion) PC_WRITE(pose) PC_WRITE(velocity_parts))
PC_KERNEL(fly_round_drag, body, integrate,
          PC_READ(bodies) PC_READ(force) PC_READ(mass) PC_WRITE(motion) PC_WRITE(pose) PC_WRITE(velocity_parts))
PC_KERNEL(fly_still_drag, body, integrate,
          PC_READ(bodies) PC_READ(force) PC_READ(mass) PC_WRITE(motion) PC_WRITE(pose) PC_WRITE(velocity_parts))
PC_KERNEL(joint_drives, joint, joints,
          PC_READ(joint_ends) PC_READ(joint_order) PC_READ(joint_frame) PC_READ(joint_drive) PC_READ(pose) PC_READ(mass)
              PC_READ(motion) PC_WRITE(joint_rows))
PC_KERNEL(joint_prepare, joint, joints,
          PC_READ(joint_ends) PC_READ(joint_order) PC_READ(joint_solved) PC_READ(pose) PC_READ(inertia) PC_READ(motion)
              PC_WRITE(joint_impulse) PC_WRITE(joint_rows))
PC_KERNEL(joint_warm, free_joint, joints,
          PC_READ(joint_ends) PC_READ(joint_order) PC_READ(joint_rows) PC_READ(joint_impulse) PC_READ(inertia)
              PC_WRITE(motion))
PC_KERNEL(joint_solve, free_joint, joints,
          PC_READ(joint_ends) PC_READ(joint_order) PC_READ(joint_rows) PC_READ(pose) PC_READ(inertia)
              PC_WRITE(joint_impulse) PC_WRITE(motion))
PC_KERNEL(joint_solve_driven, free_joint, joints,
          PC_READ(joint_ends) PC_READ(joint_order) PC_WRITE(joint_rows) PC_READ(pose) PC_READ(inertia)
              PC_WRITE(joint_impulse) PC_WRITE(motion))
PC_KERNEL(tree_joint_warm, tree_joint, joints,
          PC_READ(joint_paths) PC_READ(joint_order) PC_READ(joint_rows) PC_WRITE(joint_impulse) PC_READ(inertia)
              PC_WRITE(motion) PC_WRITE(node_pending))
PC_KERNEL(tree_joint_mass, tree_joint, joints,
          PC_READ(joint_paths) PC_READ(node_operator) PC_READ(node_response) PC_READ(motion) PC_READ(inertia)
              PC_WRITE(joint_rows))
PC_KERNEL(tree_joint_mass_driven, tree_joint, joints,
          PC_READ(joint_paths) PC_READ(node_operator) PC_READ(node_response) PC_READ(motion) PC_READ(inertia)
              PC_WRITE(joint_rows))
PC_KERNEL(tree_joint_solve, tree_joint, joints,
          PC_READ(joint_paths) PC_READ(joint_order) PC_READ(joint_rows) PC_READ(node_operator) PC_READ(inertia)
              PC_WRITE(joint_impulse) PC_WRITE(motion) PC_WRITE(node_pending))
PC_KERNEL(tree_joint_solve_driven, tree_joint, joints,
          PC_READ(joint_paths) PC_READ(joint_order) PC_WRITE(joint_rows) PC_READ(node_operator) PC_READ(inertia)
              PC_WRITE(joint_impulse) PC_WRITE(motion) PC_WRITE(node_pending))
PC_KERNEL(tree_joint_arms, tree_joint, joints, PC_READ(joint_paths) PC_READ(pose) PC_WRITE(joint_rows))
PC_KERNEL(net_prepare, net, joints,
          PC_READ(nets) PC_READ(pose) PC_READ(mass) PC_READ(motion) PC_READ(joint_frame) PC_READ(joint_drive)
              PC_READ(joint_impulse) PC_WRITE(net_rows))
PC_KERNEL(net_solve, net, joints, PC_READ(nets) PC_READ(pose) PC_READ(mass) PC_WRITE(motion) PC_WRITE(net_rows))
PC_KERNEL(net_settle, net, joints,
          PC_READ(nets) PC_READ(pose) PC_READ(mass) PC_READ(joint_frame) PC_WRITE(motion) PC_WRITE(velocity_parts)
              PC_WRITE(joint_impulse) PC_WRITE(net_rows))
PC_KERNEL(joint_keep, joint, joints, PC_READ(joint_order) PC_WRITE(joint_impulse))
PC_KERNEL(tree_prepare, tree_nodes, joints,
          PC_READ(tree_blocks) PC_READ(tree_parents) PC_READ(tree_ends) PC_READ(pose) PC_READ(mass)
              PC_READ(joint_solved) PC_READ(joint_impulse) PC_WRITE(tree_rows))
PC_KERNEL(tree_drive_rates, tree_nodes, joints,
          PC_READ(tree_blocks) PC_READ(tree_parents) PC_READ(tree_ends) PC_READ(pose) PC_READ(mass) PC_READ(motion)
              PC_WRITE(tree_drive_rows))
PC_KERNEL(tree_drives, tree_nodes, joints,
          PC_READ(tree_blocks) PC_READ(tree_parents) PC_READ(tree_ends) PC_READ(pose) PC_READ(joint_frame)
              PC_READ(joint_drive) PC_READ(tree_rows) PC_WRITE(tree_drive_rows))
PC_KERNEL(tree_solve, tree_nodes, joints,
          PC_READ(tree_blocks) PC_READ(tree_parents) PC_READ(tree_ends) PC_READ(inertia) PC_WRITE(tree_rows)
              PC_WRITE(motion))
PC_KERNEL(tree_solve_driven, tree_nodes, joints,
          PC_READ(tree_blocks) PC_READ(tree_parents) PC_READ(tree_ends) PC_READ(inertia) PC_WRITE(tree_rows)
              PC_WRITE(tree_drive_rows) PC_WRITE(motion))
PC_KERNEL(tree_limits, tree_nodes, joints, PC_READ(tree_blocks) PC_READ(tree_parents) PC_WRITE(tree_rows))
PC_KERNEL(tree_limits_driven, tree_nodes, joints,
          PC_READ(tree_blocks) PC_READ(tree_parents) PC_WRITE(tree_rows) PC_WRITE(tree_drive_rows))
PC_KERNEL(tree_again, tree_nodes, joints,
          PC_READ(tree_blocks) PC_READ(tree_parents) PC_READ(tree_ends) PC_READ(inertia) PC_WRITE(tree_rows)
              PC_WRITE(motion) PC_WRITE(joint_impulse) PC_WRITE(velocity_parts))
PC_KERNEL(tree_relax, tree_nodes, joints,
          PC_READ(tree_blocks) PC_READ(tree_parents) PC_READ(tree_ends) PC_READ(joint_solved) PC_WRITE(tree_rows)
              PC_WRITE(motion) PC_WRITE(pose))
PC_KERNEL(tree_keep, tree, joints, PC_READ(tree_blocks) PC_READ(tree_ends) PC_WRITE(joint_impulse))
PC_KERNEL(smooth_prepare, tree_nodes, joints,
          PC_READ(tree_blocks) PC_READ(tree_parents) PC_READ(tree_ends) PC_READ(mass) PC_READ(force)
              PC_READ(joint_solved) PC_WRITE(velocity_parts) PC_WRITE(tree_rows))
PC_KERNEL(smooth_step, tree_nodes, joints,
          PC_READ(tree_blocks) PC_READ(tree_parents) PC_READ(tree_ends) PC_WRITE(tree_rows) PC_WRITE(pose)
              PC_WRITE(velocity_parts) PC_WRITE(motion) PC_WRITE(joint_impulse))
PC_KERNEL(pivot_turn, tree, joints,
          PC_READ(tree_blocks) PC_READ(tree_ends) PC_READ(joint_pivot) PC_READ(force) PC_WRITE(pose)
              PC_WRITE(velocity_parts) PC_WRITE(tree_rows) PC_WRITE(motion))
PC_KERNEL(pivot_settle, tree, joints,
          PC_READ(tree_blocks) PC_READ(tree_parents) PC_READ(tree_ends) PC_READ(tree_rows) PC_WRITE(motion)
              PC_WRITE(delta) PC_WRITE(joint_impulse))
PC_KERNEL(tree_collect, tree_nodes, joints,
          PC_READ(tree_blocks) PC_READ(tree_parents) PC_READ(tree_order) PC_READ(node_pending) PC_WRITE(tree_rows))
PC_KERNEL(tree_respond, tree_nodes, joints,
          PC_READ(tree_blocks) PC_READ(tree_parents) PC_READ(tree_order) PC_WRITE(tree_rows) PC_WRITE(node_operator)
              PC_WRITE(node_pending))
PC_KERNEL(tree_answer, tree_nodes, joints,
          PC_READ(tree_blocks) PC_READ(tree_parents) PC_READ(tree_order) PC_READ(tree_rows) PC_WRITE(node_response))
PC_KERNEL(tree_flush, tree_nodes, joints,
          PC_READ(tree_blocks) PC_READ(tree_parents) PC_READ(tree_ends) PC_READ(tree_order) PC_WRITE(tree_rows)
              PC_WRITE(node_pending) PC_WRITE(motion) PC_WRITE(velocity_parts))
PC_KERNEL(contact_prepare, contact, impulses,
          PC_READ(contact_ends) PC_READ(contact_order) PC_READ(contact) PC_READ(inertia) PC_READ(motion) PC_READ(delta)
              PC_WRITE(contact_rows) PC_WRITE(contact_impulses))
PC_KERNEL(contact_prepare_frictionless, contact, impulses,
          PC_READ(contact_ends) PC_READ(contact_order) PC_READ(contact) PC_READ(inertia) PC_READ(motion) PC_READ(delta)
              PC_WRITE(frictionless_rows) PC_WRITE(contact_impulses))
PC_KERNEL(contact_refresh, free_contact, impulses,
          PC_READ(contact_ends) PC_READ(inertia) PC_READ(delta) PC_READ(motion) PC_WRITE(contact_rows)
              PC_WRITE(contact_impulses))
PC_KERNEL(contact_refresh_frictionless, free_contact, impulses,
          PC_READ(contact_ends) PC_READ(inertia) PC_READ(delta) PC_READ(motion) PC_WRITE(frictionless_rows)
              PC_WRITE(contact_impulses))
PC_KERNEL(contact_impact, free_contact, impulses,
          PC_READ(contact_ends) PC_READ(inertia) PC_READ(force) PC_WRITE(contact_rows) PC_WRITE(delta) PC_WRITE(pose)
              PC_WRITE(velocity_parts) PC_WRITE(motion))
PC_KERNEL(contact_impact_frictionless, free_contact, impulses,
          PC_READ(contact_ends) PC_READ(inertia) PC_READ(force) PC_WRITE(frictionless_rows) PC_WRITE(delta)
              PC_WRITE(pose) PC_WRITE(velocity_parts) PC_WRITE(motion))
PC_KERNEL(contact_recall, contact, impulses,
          PC_READ(contact_ends) PC_READ(contact_rows) PC_READ(contact_impulses) PC_READ(motion) PC_WRITE(recalled))
PC_KERNEL(contact_recall_frictionless, contact, impulses,
          PC_READ(contact_ends) PC_READ(frictionless_rows) PC_READ(contact_impulses) PC_READ(motion) PC_WRITE(recalled))
PC_KERNEL(tree_recall, tree_nodes, joints,
          PC_READ(tree_blocks) PC_READ(tree_parents) PC_READ(tree_ends) PC_READ(tree_rows) PC_READ(motion)
              PC_WRITE(recalled))
PC_KERNEL(recall_share, body, impulses, PC_READ(bodies) PC_READ(motion) PC_WRITE(recalled) PC_WRITE(delta))
PC_KERNEL(contact_warm, free_contact, impulses,
          PC_READ(contact_ends) PC_WRITE(velocity_parts) PC_READ(inertia) PC_READ(delta) PC_WRITE(contact_rows)
              PC_WRITE(contact_impulses) PC_WRITE(motion))
PC_KERNEL(contact_warm_frictionless, free_contact, impulses,
          PC_READ(contact_ends) PC_WRITE(velocity_parts) PC_READ(inertia) PC_READ(delta) PC_WRITE(frictionless_rows)
              PC_WRITE(contact_impulses) PC_WRITE(motion))
PC_KERNEL(contact_rolling, contact, impulses,
          PC_READ(contact_ends) PC_READ(contact_rows) PC_READ(contact_impulses) PC_READ(inertia) PC_READ(material)
              PC_WRITE(rolling_impulses) PC_WRITE(motion))
PC_KERNEL(contact_solve, free_contact, impulses,
          PC_READ(contact_ends) PC_READ(contact_rows) PC_READ(inertia) PC_READ(delta) PC_WRITE(velocity_parts)
              PC_WRITE(contact_impulses) PC_WRITE(motion))
PC_KERNEL(contact_solve_frictionless, free_contact, impulses,
          PC_READ(contact_ends) PC_READ(frictionless_rows) PC_READ(inertia) PC_READ(delta) PC_WRITE(velocity_parts)
              PC_WRITE(contact_impulses) PC_WRITE(motion))
PC_KERNEL(contact_solve_placed, free_contact, impulses,
          PC_READ(contact_ends) PC_READ(contact_rows) PC_READ(inertia) PC_READ(delta) PC_WRITE(velocity_parts)
              PC_WRITE(contact_impulses) PC_WRITE(motion))
PC_KERNEL(contact_solve_placed_frictionless, free_contact, impulses,
          PC_READ(contact_ends) PC_READ(frictionless_rows) PC_READ(inertia) PC_READ(delta) PC_WRITE(velocity_parts)
              PC_WRITE(contact_impulses) PC_WRITE(motion))
PC_KERNEL(tree_contact_warm, tree_contact, impulses,
          PC_READ(contact_paths) PC_READ(inertia) PC_READ(delta) PC_READ(contact_rows) PC_WRITE(contact_impulses)
              PC_WRITE(motion) PC_WRITE(node_pending) PC_WRITE(contact_reach))
PC_KERNEL(tree_contact_prepare, tree_contact, impulses,
          PC_READ(contact_paths) PC_READ(node_operator) PC_READ(motion) PC_READ(inertia) PC_READ(delta)
              PC_WRITE(contact_rows) PC_WRITE(contact_impulses) PC_WRITE(contact_reach))
PC_KERNEL(tree_contact_solve, tree_contact, impulses,
          PC_READ(contact_paths) PC_READ(contact_rows) PC_READ(inertia) PC_READ(delta) PC_WRITE(contact_impulses)
              PC_WRITE(motion) PC_WRITE(node_pending) PC_WRITE(contact_reach))
PC_KERNEL(tree_contact_push, tree_contact, impulses,
          PC_READ(contact_paths) PC_READ(contact_rows) PC_READ(inertia) PC_READ(delta) PC_WRITE(pushed) PC_WRITE(motion)
              PC_WRITE(node_pending) PC_WRITE(contact_reach))
PC_KERNEL(push_back, body, impulses, PC_READ(bodies) PC_READ(inertia) PC_WRITE(pushed) PC_WRITE(motion))
PC_KERNEL(contact_restitution, free_contact, impulses,
          PC_READ(contact_ends) PC_READ(contact_rows) PC_WRITE(contact_impulses) PC_READ(inertia) PC_READ(delta)
              PC_WRITE(motion))
PC_KERNEL(contact_restitution_frictionless, free_contact, impulses,
          PC_READ(contact_ends) PC_READ(frictionless_rows) PC_WRITE(contact_impulses) PC_READ(inertia) PC_READ(delta)
              PC_WRITE(motion))
PC_KERNEL(contact_touch, contact, impulses,
          PC_READ(contact_order) PC_READ(contact_rows) PC_READ(contact_impulses) PC_WRITE(touch))
PC_KERNEL(contact_touch_frictionless, contact, impulses,
          PC_READ(contact_order) PC_READ(frictionless_rows) PC_READ(contact_impulses) PC_WRITE(touch))
PC_KERNEL(contact_store, contact, impulses,
          PC_READ(contact_order) PC_READ(contact_rows) PC_READ(contact_impulses) PC_WRITE(contact))
PC_KERNEL(contact_store_frictionless, contact, impulses,
          PC_READ(contact_order) PC_READ(frictionless_rows) PC_READ(contact_impulses) PC_WRITE(contact))
PC_KERNEL(island_start, row, islands, PC_WRITE(island_labels))
PC_KERNEL(island_join, edge, islands, PC_READ(island_ends) PC_WRITE(island_labels))
#endif
