#pragma once
// Methods of the cone comparison.

#include <memory>
#include <string>

#include "bench/cone_comparison.h"
#include "bench/grid.h"
#include "sensors/cones/cone_array.h"

namespace sf::bench {

class ConeMethod {
 public:
  virtual ~ConeMethod() = default;
  virtual std::string name() const = 0;
  /// Overwrites the results of the last turn.
  virtual void poison() = 0;
  /// The timed part: from poses to ranges.
  virtual void measure(std::size_t round) = 0;
  /// [m] NaN if it was not written.
  virtual double range(std::size_t robot, std::size_t transducer) const = 0;
};

/// `scene`, `arrays` and `device` must outlive the methods. @param arrays one per robot
std::unique_ptr<ConeMethod> make_farm_cones(const ConeScene& scene, gpu::Device& device);
std::unique_ptr<ConeMethod> make_plain_cones(const ConeScene& scene, const std::vector<sensors::ConeArray>& arrays,
                                             const std::string& name, Walk walk);

}  // namespace sf::bench
