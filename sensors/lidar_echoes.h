#pragma once
// Echoes of lidars: what a device reports of the surfaces that a beam, or the parts of a diverging beam, meet.
//
// A part returns the power rho cos(a) / n: reflectance rho, angle of incidence a, n parts per beam (Lambert's law).
// Parts within `separation` in range of the nearest of them are one echo, at the mean of their ranges weighted by power
// (a mixed pixel). An echo at range r is detected if its power times (detection_range / r)^2 is at least
// detection_reflectance, which is how data sheets state the range of a device.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/random.h"
#include "base/reading.h"
#include "world/world.h"

namespace sf::sensors {

struct EchoSettings {
  std::uint32_t width = 1;    ///< numbers per beam: 1 range, 2 and intensity, 3 and incidence, 5 and second echo
  double range_min = 0.0;     ///< [m] in [0, range_max]
  double range_max = 100.0;   ///< [m] > 0
  double sigma = 0.0;         ///< [m] standard deviation of ranges,
  double proportional = 0.0;  ///< its part that grows with the range,
  double slope = 0.0;         ///< [m] and that with the tangent of the angle of incidence, at most 10
  double intensity_range =
      0.0;  ///< [m] intensities fall with the square of the range and equal the power here; 0: are powers
  double detection_range = 0.0;        ///< [m] 0: every echo is detected
  double detection_reflectance = 0.0;  ///< >= 0
  double dropout = 0.0;                ///< probability that a beam has no echo, in [0, 1]
  double separation = 1.0;             ///< [m] >= 0

  bool is_noisy() const { return sigma > 0.0 || proportional > 0.0 || slope > 0.0 || dropout > 0.0; }
};

/// The parts of one beam; spans of equal length.
struct BeamParts {
  std::span<const double> ranges;       ///< [m]
  std::span<const float> cosines;       ///< of the angles of incidence
  std::span<const std::uint32_t> hits;  ///< as ReadingBlock::hits
  std::span<const base::QualityFlag> quality;
  std::span<const std::uint32_t> materials = {};  ///< as scene::ScanOutput::materials; empty: none
};

struct Echo {
  double range = 0.0;   ///< [m]
  double power = 0.0;   ///< relative to a white surface that faces the sensor
  float cosine = 0.0f;  ///< of the strongest part, as `hit`
  std::uint32_t hit = base::kNoHit;
  base::QualityFlag quality = base::QualityFlag::none;
};

/// Reflectances of a world's surfaces: that of the model if it states one, else of the material.
class Reflectances {
 public:
  static constexpr std::uint32_t kPaint = world::kNoMaterial - 1;  ///< material of lane markings

  /// @param materials by row of scene::ScanOutput::materials
  Reflectances(const world::World& world, const std::vector<world::Material>& materials);
  double of(std::uint32_t hit, std::uint32_t material) const {
    if (hit >= models_.size()) return material == kPaint ? ground_.paint : ground_.floor;
    if (models_[hit] != kUnstated) return models_[hit];
    return material < materials_.size() ? materials_[material] : world::kDefaultReflectance;
  }

 private:
  static constexpr double kUnstated = -1.0;
  std::vector<double> models_;     ///< by row
  std::vector<double> materials_;  ///< by row
  world::GroundReflectance ground_;
};

/// Returns the nearest detected echo and the strongest of the others, without noise.
class EchoFinder {
 public:
  using Echoes = std::array<std::optional<Echo>, 2>;
  Echoes find(const EchoSettings& settings, const BeamParts& parts, const Reflectances& reflectances);

 private:
  std::vector<Echo> echoes_;
};

/// Adds noise to the range of an echo. @param normal of standard deviation 1
double noisy_range(const EchoSettings& settings, const Echo& echo, double normal);

/// Writes the values of one beam. A missing echo reports range_max, and 0 for its other quantities.
void write_echoes(const EchoSettings& settings, const EchoFinder::Echoes& echoes, std::span<double> values);

}  // namespace sf::sensors
