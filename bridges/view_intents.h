#pragma once
// Intents of robots for the live view over camera images: `sensorfarm_msgs/msg/Intents`.

#include <glm/ext/vector_double2.hpp>
#include <map>
#include <span>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "base/report.h"
#include "world/world.h"

namespace sf::bridges {

inline constexpr std::string_view kIntentsTopic = "/view/intents";

class ViewIntents {
 public:
  /// Reads the checkpoints of the world's roads.
  explicit ViewIntents(const world::World& world);
  /// Keeps the newest intents. @param intents by row of the mover
  void take(std::span<const base::Intent> intents) { intents_.assign(intents.begin(), intents.end()); }
  /// Appends the intents of all movers that follow another one, dock, or are heading for a checkpoint, with the
  /// checkpoint's place; NaN without one. @param time [ns]
  void encode(std::int64_t time, base::Bytes& out) const;

 private:
  std::map<std::uint32_t, glm::dvec2> checkpoints_;  ///< [m] by id
  std::vector<base::Intent> intents_;
};

}  // namespace sf::bridges
