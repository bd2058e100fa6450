#include "vision/accuracy.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/elementary.h"

namespace sf::vision {

void RmsError::add(double error) {
  sum += error * error;
  largest = std::max(largest, std::abs(error));
  ++count;
}

double RmsError::rms() const { return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0; }

AccuracyMeter::AccuracyMeter(const Testbed& testbed, const RenderedFleet& fleet)
    : testbed_(testbed), fleet_(fleet), sightings_(fleet.size()) {}

void AccuracyMeter::compare(const TrackedTag& tracked, std::size_t tag) {
  const TrueTag truth = fleet_.truth(tag, tracked.time);
  const double off = base::hypot(tracked.X_WT.x - truth.X_WT.x, tracked.X_WT.y - truth.X_WT.y);
  if (off > kWrong) {
    ++accuracy_.wrong;
    return;
  }
  accuracy_.position.add(off);
  if (tracked.height_sigma > 0.0) accuracy_.height.add(tracked.X_WT.z - truth.X_WT.z);
  accuracy_.heading.add(base::wrap_angle(tracked.X_WT.yaw - truth.X_WT.yaw));
  if (++sightings_[tag] < 6) return;
  accuracy_.velocity.add(glm::distance(tracked.velocity, truth.velocity));
  accuracy_.turn.add(tracked.turn - truth.turn);
}

void AccuracyMeter::add(double time, std::span<const TrackedTag> tracked, const std::set<std::uint32_t>* wanted) {
  std::size_t known = 0;
  for (std::size_t tag = 0; tag < fleet_.size(); ++tag) {
    const std::uint32_t id = fleet_.truth(tag, time).id;
    const auto found =
        std::find_if(tracked.begin(), tracked.end(), [&](const TrackedTag& each) { return each.id == id; });
    if (found != tracked.end()) {
      compare(*found, tag);
      ++known;
      continue;
    }
    if (wanted != nullptr && wanted->count(id) == 0) continue;
    // No tag is reported in the first updates if `report_from` is above 1.
    const auto sees = [&](const TestbedCamera& each) { return fleet_.is_visible(each.camera, tag, time); };
    if (updates_ + 1 >= testbed_.report_from && std::any_of(testbed_.cameras.begin(), testbed_.cameras.end(), sees))
      ++accuracy_.missed;
  }
  accuracy_.wrong += tracked.size() - known;
  ++updates_;
}

}  // namespace sf::vision
