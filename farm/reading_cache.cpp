#include "farm/reading_cache.h"

#include <algorithm>

namespace sf::farm {

namespace {

/// Searches in 32 bits may extend slightly beyond a sensor's range; their results do not.
constexpr double kMargin = 1e-5;

double reach_of(const sensors::SensorSpec& row) {
  return (1.0 + kMargin) * (row.dependency_radius + glm::length(glm::dvec2{row.X_MS.x, row.X_MS.y})) + kMargin;
}

}  // namespace

ReadingCache::ReadingCache(std::span<const sensors::SensorSpec> rows, bool noise)
    : carrier_of_(rows.size()), validity_(rows.size(), Validity::never), stored_(rows.size()) {
  for (std::uint32_t i = 0; i < rows.size(); ++i) {
    const sensors::SensorSpec& row = rows[i];
    if (!(row.dependency_radius > 0.0) || (noise && row.sigma > 0.0)) continue;
    validity_[i] = Validity::changed;
    if (carriers_.empty() || carriers_.back().mover != row.mover)
      carriers_.push_back({row.mover, i, i, 0.0, row.depends_on_magnets, false});
    Carrier& carrier = carriers_.back();
    carrier_of_[i] = static_cast<std::uint32_t>(carriers_.size() - 1);
    carrier.end = i + 1;
    carrier.reach = std::max(carrier.reach, reach_of(row));
  }
}

void ReadingCache::invalidate_all(Carrier& carrier) {
  for (std::uint32_t row = carrier.first; row < carrier.end; ++row)
    if (validity_[row] != Validity::never) validity_[row] = Validity::changed;
  carrier.unchanged = false;
  --unchanged_carriers_;
}

void ReadingCache::invalidate(PoseChanges& pose_changes, std::span<const base::Report> states) {
  if (unchanged_carriers_ == 0 || !pose_changes.any()) return;
  for (Carrier& carrier : carriers_) {
    if (!carrier.unchanged) continue;
    const base::Pose& X = states[carrier.mover].X_WM;
    if (pose_changes.moved(carrier.mover) ||
        (carrier.depends_on_magnets ? pose_changes.magnets()
                                    : pose_changes.within(carrier.mover, {X.x, X.y}, carrier.reach)))
      invalidate_all(carrier);
  }
}

void ReadingCache::store(std::uint32_t row, const base::ReadingBlock& block) {
  if (validity_[row] == Validity::never) return;
  if (validity_[row] == Validity::unchanged) {
    if (!stored_[row]) stored_[row] = std::make_unique<StoredReading>();
    stored_[row]->take(block);
    validity_[row] = Validity::stored;
    return;
  }
  validity_[row] = Validity::unchanged;
  Carrier& carrier = carriers_[carrier_of_[row]];
  if (!carrier.unchanged) ++unchanged_carriers_;
  carrier.unchanged = true;
}

}  // namespace sf::farm
