// Your own controller: keeps a distance to the wall on its right.
//
//   cmake -B build && cmake --build build
//   sensorfarm run worlds/cave.world --robots 20 --controller build/libfollow_wall.so --set distance=0.6

#include <sensorfarm/plugin.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace {

class FollowWall : public sensorfarm::Controller {
 public:
  FollowWall(const sensorfarm::Robot& robot, sensorfarm::Settings& settings)
      : distance_(settings.number("distance", 0.8, 0.1, 5.0)), speed_(0.6 * robot.max_forward) {
    for (const sensorfarm::SensorInfo& sensor : robot.sensors)
      if (sensor.type == "laser" && sensor.number == 0) bearings_ = sensor.bearings;
    if (bearings_.empty()) throw std::invalid_argument("it has no laser; follow_wall requires one");
  }

  sensorfarm::Twist step(const sensorfarm::Input& input) override {
    const sensorfarm::Reading* const scan = input.newest("laser");
    if (scan == nullptr) return {};
    const double ahead = nearest(*scan, -0.4, 0.4), right = nearest(*scan, -1.6, -0.8);
    error_ = right - distance_;
    if (input.contact) return {-0.5 * speed_, 0.0, 0.5};
    if (ahead < 1.5 * distance_) return {0.0, 0.0, 1.0};
    return {speed_, 0.0, std::clamp(-1.5 * error_, -0.8, 0.8)};
  }

  double error() const override { return error_; }

 private:
  /// Returns the smallest range [m] among the beams between two bearings [rad].
  double nearest(const sensorfarm::Reading& scan, double first, double last) const {
    double range = HUGE_VAL;
    for (std::size_t i = 0; i < bearings_.size(); ++i)
      if (bearings_[i] >= first && bearings_[i] <= last) range = std::min(range, scan.values[i]);
    return range;
  }

  double distance_;               // [m]
  double speed_;                  // [m/s]
  double error_ = 0.0;            // [m] positive if too far from the wall
  std::vector<double> bearings_;  // [rad] of the beams
};

}  // namespace

SENSORFARM_PLUGIN(plugin) {
  plugin.add_controller<FollowWall>("follow-wall", "keeps a distance to the wall on its right").stops_on_bumper = false;
}
