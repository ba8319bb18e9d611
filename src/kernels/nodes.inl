// How kernels of trees say their loops over nodes, so that a work group can share a tree that stands alone in its block
// (docs/joint-trees.md). Here as one lane or invocation runs them: one node after the other. Shared,
// glcompute/team.glsl: every invocation of the group runs the kernel, and of a loop's nodes does its share. The bits
// are the same: what is summed is summed in the same order by one invocation.
//
//   PC_NODES(k, from, t)  each node from `from` on by itself: stores its own rows alone
//   PC_DOWN(k, from, t)   parents before children: may read what its parent stored
//   PC_UP(k, t)           children before parents, without the root: may add to its parent. Brothers have one
//                         invocation, the last first
//   PC_CHILDREN(k, t)     adds to its parent, the first brother first; what it reads of the node it does not change
//   PC_ALL(k, from, t)    every invocation goes over all nodes: for sums, and stores nothing but under PC_ONE
//   PC_THEN(loop)         within a loop's braces: what follows is a loop of its own where a tree is shared, and this
//                         one's where it is not
//   PC_ONE                before a statement: of one invocation, which is also that of the root in PC_NODES
//   PC_MEET               all have come here before any goes on; what they stored can be read by others. PC_UP and
//                         PC_DOWN end with one
//   PC_MOST(x)            x becomes the largest of all invocations; meets
//
// In PC_NODES a node is always of the same invocation: loops over nodes' own rows follow each other without PC_MEET.
// One stands wherever another node's rows are read after they were stored, or stored after they were read. Conditions
// around it are the same for the whole tree.
#ifndef PC_TEAM
#define PC_NODES(k, from, t) for (uint k = from; k < t.count; k++)  // lint: allow (the plain form)
#define PC_DOWN(k, from, t) for (uint k = from; k < t.count; k++)   // lint: allow (the plain form)
#define PC_UP(k, t) for (uint k = t.count - 1u; k > 0u; k--)        // lint: allow (the plain form)
#define PC_CHILDREN(k, t) for (uint k = 1u; k < t.count; k++)       // lint: allow (the plain form)
#define PC_ALL(k, from, t) for (uint k = from; k < t.count; k++)    // lint: allow (the plain form)
#define PC_THEN(loop)
#define PC_ONE
#define PC_MEET
#define PC_MOST(x)
#endif
