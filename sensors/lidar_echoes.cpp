#include "sensors/lidar_echoes.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::sensors {

namespace {

/// Parts from `first` on that are one echo. @return their mean, and the end
std::pair<Echo, std::size_t> merge(std::span<const Echo> parts, std::size_t first, double separation) {
  Echo echo = parts[first];
  double weighted = 0.0, sum = 0.0, strongest = -1.0;
  std::size_t end = first;
  echo.power = 0.0;
  for (; end < parts.size() && parts[end].range - parts[first].range <= separation; ++end) {
    const Echo& part = parts[end];
    echo.power += part.power, weighted += part.power * part.range, sum += part.range;
    if (part.power > strongest) strongest = part.power, echo.cosine = part.cosine, echo.hit = part.hit;
    if (part.quality != base::QualityFlag::none) echo.quality = part.quality;
  }
  if (end - first > 1) echo.range = echo.power > 0.0 ? weighted / echo.power : sum / static_cast<double>(end - first);
  return {echo, end};
}

bool is_detected(const EchoSettings& s, const Echo& echo) {
  return s.detection_range == 0.0 ||
         echo.power * s.detection_range * s.detection_range >= s.detection_reflectance * echo.range * echo.range;
}

double intensity_of(const EchoSettings& s, const Echo& echo) {
  if (s.intensity_range == 0.0) return echo.power;
  const double ratio = s.intensity_range / std::max(echo.range, 1e-3 * s.intensity_range);
  return echo.power * ratio * ratio;
}

}  // namespace

Reflectances::Reflectances(const world::World& world, const std::vector<world::Material>& materials)
    : models_(world.models.size(), kUnstated), ground_(world::ground_of(world)) {
  for (const world::Reflectance& row : world.reflectances) models_[row.model] = row.value;
  for (const world::Material& material : materials) materials_.push_back(material.reflectance);
}

EchoFinder::Echoes EchoFinder::find(const EchoSettings& s, const BeamParts& parts, const Reflectances& reflectances) {
  echoes_.clear();
  const std::size_t count = parts.ranges.size();
  for (std::size_t k = 0; k < count; ++k) {
    if (parts.hits[k] == base::kNoHit) continue;
    const std::uint32_t material = parts.materials.empty() ? world::kNoMaterial : parts.materials[k];
    const double power = reflectances.of(parts.hits[k], material) * static_cast<double>(parts.cosines[k]);
    echoes_.push_back(
        {parts.ranges[k], power / static_cast<double>(count), parts.cosines[k], parts.hits[k], parts.quality[k]});
  }
  std::ranges::stable_sort(echoes_, {}, &Echo::range);
  Echoes found;
  for (std::size_t at = 0; at < echoes_.size();) {
    const auto [echo, end] = merge(echoes_, at, s.separation);
    at = end;
    if (!is_detected(s, echo)) continue;
    if (!found[0])
      found[0] = echo;
    else if (!found[1] || echo.power > found[1]->power)
      found[1] = echo;
  }
  return found;
}

double noisy_range(const EchoSettings& s, const Echo& echo, double normal) {
  const double cosine = std::max(static_cast<double>(echo.cosine), 0.05);
  const double tangent = std::min(10.0, std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) / cosine);
  const double sigma = base::hypot(base::hypot(s.sigma, s.proportional * echo.range), s.slope * tangent);
  return std::clamp(echo.range + sigma * normal, s.range_min, s.range_max);
}

void write_echoes(const EchoSettings& s, const EchoFinder::Echoes& echoes, std::span<double> values) {
  const auto& [first, second] = echoes;
  values[0] = first ? first->range : s.range_max;
  if (s.width > 1) values[1] = first ? intensity_of(s, *first) : 0.0;
  if (s.width > 2) values[2] = first ? base::acos(static_cast<double>(first->cosine)) : 0.0;
  if (s.width > 3) values[3] = second ? second->range : s.range_max;
  if (s.width > 4) values[4] = second ? intensity_of(s, *second) : 0.0;
}

}  // namespace sf::sensors
