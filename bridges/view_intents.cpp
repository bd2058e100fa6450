#include "bridges/view_intents.h"

#include <algorithm>
#include <cmath>

#include "record/cdr.h"
#include "record/ros_messages.h"
#include "world/roads/roads.h"

namespace sf::bridges {

namespace {

bool is_any(const base::Intent& intent) {
  return intent.docking || intent.follows != base::kNoId || intent.checkpoint != base::kNoId;
}

}  // namespace

ViewIntents::ViewIntents(const world::World& world) {
  if (const auto roads = world::roads_of(world); roads)
    for (const world::RoadCheckpoint& each : roads->checkpoints)
      checkpoints_[static_cast<std::uint32_t>(each.id)] = each.p;
}

void ViewIntents::encode(std::int64_t time, base::Bytes& out) const {
  record::CdrWriter cdr(out);
  record::put_header(cdr, time, "world");
  cdr.put_count(static_cast<std::size_t>(std::ranges::count_if(intents_, is_any)));
  for (std::uint32_t mover = 0; mover < intents_.size(); ++mover) {
    const base::Intent& intent = intents_[mover];
    if (!is_any(intent)) continue;
    const auto found = checkpoints_.find(intent.checkpoint);
    const glm::dvec2 p = found == checkpoints_.end() ? glm::dvec2{NAN} : found->second;
    for (const std::uint32_t id : {mover, intent.follows, intent.checkpoint}) cdr.put(id);
    cdr.put(p.x);
    cdr.put(p.y);
    cdr.put(intent.docking);
  }
}

}  // namespace sf::bridges
