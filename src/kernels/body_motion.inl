// What kernels that move a body hold of it: rows of motion and the last two of velocity_parts; of pose;
// what acts on it.
struct BodyMotion {
  Quad linear;
  Quad angular;
  Quad linear_low;
  Quad angular_low;
};
struct BodyPose {
  Quad place;
  Quad turned;
  Quad place_low;
  Quad turned_low;
};
struct BodyForce {
  Quad push;
  Quad turn;
#ifdef PC_DRAG
  Decay slow;
  Decay calm;
#endif
};
