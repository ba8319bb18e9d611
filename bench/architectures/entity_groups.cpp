// Entities whose components stand in one order.
#define PC_SCALAR float
#define PC_LANES 1
#define PC_NAMESPACE entity_groups
#define PCPHYS_GROUPS
#include "entities.inl"

std::unique_ptr<pcphys::architectures::Design> pcphys::architectures::make_entity_groups() {
  return std::make_unique<entity_groups::systems::Entities>();
}
