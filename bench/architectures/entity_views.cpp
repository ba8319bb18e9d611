// Entities, each component looked up by its entity.
#define PC_SCALAR float
#define PC_LANES 1
#define PC_NAMESPACE entity_views
#include "entities.inl"

std::unique_ptr<pcphys::architectures::Design> pcphys::architectures::make_entity_views() {
  return std::make_unique<entity_views::systems::Entities>();
}
