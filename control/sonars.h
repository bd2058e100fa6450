#pragma once
// The sonars of a robot and how they are mounted, by the world file. A reading of a real robot's own sonar, which does
// not tell its mounting, is taken as one of sonar 0.

#include <optional>
#include <vector>

#include "control/controllers.h"
#include "sensors/cones/cone_array.h"

namespace sf::control {

class Sonars {
 public:
  Sonars() = default;
  explicit Sonars(const ControllerContext& context);
  bool empty() const { return all_.empty(); }
  const std::vector<sensors::ConeArray>& all() const { return all_; }

  struct Source {
    const sensors::ConeArray& sonar;  ///< valid as long as the Sonars
    base::Pose X_WS;                  ///< at the measurement
  };
  /// Returns the sonar of a reading; nullopt for readings of other types, and without a sonar in the world file.
  std::optional<Source> source_of(const base::ReadingBlock& reading) const;

 private:
  std::vector<sensors::ConeArray> all_;  ///< in the order of their numbers
};

}  // namespace sf::control
