#pragma once
// Errors of tracked tags relative to the ground truth of a rendered fleet.

#include <cstdint>
#include <set>
#include <span>

#include "vision/rendered_fleet.h"
#include "vision/tracker.h"

namespace sf::vision {

struct RmsError {
  double sum = 0.0, largest = 0.0;
  std::uint64_t count = 0;

  void add(double error);
  double rms() const;  ///< 0 if there are no errors
};

struct Accuracy {
  RmsError position;         ///< [m]
  RmsError heading;          ///< [rad]
  RmsError velocity;         ///< [m/s], from the sixth report on
  RmsError turn;             ///< [rad/s], from the sixth report on
  std::uint64_t missed = 0;  ///< a camera saw the whole tag, but it was not reported
  std::uint64_t wrong = 0;   ///< reported more than `kWrong` from its position, or with an unused id
  RmsError height;           ///< [m] of tags with a measured height
};

class AccuracyMeter {
 public:
  static constexpr double kWrong = 0.05;  ///< [m]

  /// @param testbed, fleet must outlive this
  AccuracyMeter(const Testbed& testbed, const RenderedFleet& fleet);
  /// @param time [s] at which the exposure of the images began
  /// @param wanted ids of the tags that the cameras are to find; null: all
  void add(double time, std::span<const TrackedTag> tracked, const std::set<std::uint32_t>* wanted = nullptr);
  const Accuracy& accuracy() const { return accuracy_; }

 private:
  void compare(const TrackedTag& tracked, std::size_t tag);

  const Testbed& testbed_;
  const RenderedFleet& fleet_;
  std::vector<std::uint32_t> sightings_;  ///< reported per tag, so far
  std::uint64_t updates_ = 0;
  Accuracy accuracy_;
};

}  // namespace sf::vision
