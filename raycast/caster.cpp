#include "raycast/caster.h"

namespace sf::raycast {

Caster::Caster(const CasterInputs& in)
    : thread_pool_(in.context.thread_pool),
      states_(in.context.states),
      plan_(in.plan),
      uploads_(in.uploads),
      results_(in.results) {}

void Caster::record(gpu::Batch&) {}

void Caster::add_copies(gpu::Batch& batch, const DueScans& due, bool) {
  for (const DueSample& sample : due.samples) results_.upload(batch, row_of(sample));
}

void Caster::collect(const DueScans&) {}

}  // namespace sf::raycast
