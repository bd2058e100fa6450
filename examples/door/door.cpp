// A controller of a model: a sliding door that opens for robots and closes behind them, but never on one.
//
//   cmake -B build && cmake --build build
//   sensorfarm run door.world --duration 20

#include <sensorfarm/plugin.h>

#include <algorithm>
#include <cmath>

namespace {

class Door : public sensorfarm::ModelController {
 public:
  Door(const sensorfarm::ModelSite& site, sensorfarm::Settings& settings)
      : closed_(site.pose),
        interval_(site.interval),
        speed_(settings.number("speed", 0.5, 0.01, site.max_forward)),
        way_(settings.number("way", 1.0, 0.01, 10.0)),
        reach_(settings.number("reach", 1.2, 0.0, 10.0)) {}

  double range() const override { return reach_ + way_; }

  void tick(sensorfarm::Model& model) override {
    bool open = model.time() < hold_;
    for (const sensorfarm::NearRobot& robot : model.robots()) open = open || from_closed(robot.pose) < reach_;
    const double left = (open ? way_ : 0.0) - from_closed(model.pose());  // [m] along its x
    model.set_velocity({std::clamp(left / interval_, -speed_, speed_)});
  }

  /// Opens again for a while after it touched a robot.
  void contact(const sensorfarm::ModelContact& contact, sensorfarm::Model& model) override {
    if (contact.robot) hold_ = model.time() + 2.0;
  }

 private:
  /// Distance [m] from the closed door.
  double from_closed(const sensorfarm::Pose& pose) const {
    const double x = pose.x - closed_.x, y = pose.y - closed_.y;
    return std::sqrt(x * x + y * y);
  }

  sensorfarm::Pose closed_;
  double interval_, speed_, way_, reach_;
  double hold_ = 0.0;  // [s] until then it stays open
};

}  // namespace

SENSORFARM_PLUGIN(plugin) {
  plugin.add_model_controller<Door>("door", "slides along its x axis while a robot is near");
}
