#include "bench/embree_caster.h"

namespace sf::bench {

std::unique_ptr<Caster> make_embree_caster(const Scans&, const EmbreeUse&) { return nullptr; }

}  // namespace sf::bench
