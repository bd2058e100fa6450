#include "farm/steady.h"

#include <algorithm>

namespace sf::farm {

namespace {

/// Searches in 32 bits may look a little farther than a sensor's range; what they decide does not.
constexpr double kMargin = 1e-5;

double reach_of(const sensors::SensorSpec& row) {
  return (1.0 + kMargin) * (row.dependency_radius + glm::length(glm::dvec2{row.X_MS.x, row.X_MS.y})) + kMargin;
}

}  // namespace

Steady::Steady(std::span<const sensors::SensorSpec> rows, bool noise)
    : carrier_of_(rows.size()), calm_(rows.size(), Calm::never), stored_(rows.size()) {
  for (std::uint32_t i = 0; i < rows.size(); ++i) {
    const sensors::SensorSpec& row = rows[i];
    if (!(row.dependency_radius > 0.0) || (noise && row.noisy)) continue;
    calm_[i] = Calm::no;
    if (carriers_.empty() || carriers_.back().mover != row.mover)
      carriers_.push_back({row.mover, i, i, 0.0, row.depends_on_magnets, false});
    Carrier& carrier = carriers_.back();
    carrier_of_[i] = static_cast<std::uint32_t>(carriers_.size() - 1);
    carrier.end = i + 1;
    carrier.reach = std::max(carrier.reach, reach_of(row));
  }
}

void Steady::rouse(Carrier& carrier) {
  for (std::uint32_t row = carrier.first; row < carrier.end; ++row)
    if (calm_[row] != Calm::never) calm_[row] = Calm::no;
  carrier.calm = false;
  --calm_carriers_;
}

void Steady::disturb(Moves& moves, std::span<const base::Pose> poses) {
  if (calm_carriers_ == 0 || !moves.any()) return;
  for (Carrier& carrier : carriers_) {
    if (!carrier.calm) continue;
    const glm::dvec2 p{poses[carrier.mover].x, poses[carrier.mover].y};
    if (moves.moved(carrier.mover) || (carrier.depends_on_magnets ? moves.magnets() : moves.within(p, carrier.reach)))
      rouse(carrier);
  }
}

void Steady::taken(std::uint32_t row, const base::ReadingBlock& block) {
  if (calm_[row] == Calm::never) return;
  if (calm_[row] == Calm::since) {
    if (!stored_[row]) stored_[row] = std::make_unique<StoredReading>();
    stored_[row]->take(block);
    calm_[row] = Calm::kept;
    return;
  }
  calm_[row] = Calm::since;
  Carrier& carrier = carriers_[carrier_of_[row]];
  if (!carrier.calm) ++calm_carriers_;
  carrier.calm = true;
}

}  // namespace sf::farm
