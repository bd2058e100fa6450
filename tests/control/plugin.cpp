// A plug-in of tests: two controllers.

#include <sensorfarm/plugin.h>

#include <stdexcept>

namespace {

class Straight : public sensorfarm::Controller {
 public:
  Straight(const sensorfarm::Robot&, sensorfarm::Settings& settings)
      : speed_(settings.number("speed", 0.2, 0.0, 2.0)) {}
  sensorfarm::Twist step(const sensorfarm::Input&) override { return {speed_}; }

 private:
  double speed_;
};

class Picky : public sensorfarm::Controller {
 public:
  Picky(const sensorfarm::Robot& robot, sensorfarm::Settings&) {
    throw std::invalid_argument("robot " + robot.name + " is not good enough");
  }
  sensorfarm::Twist step(const sensorfarm::Input&) override { return {}; }
};

}  // namespace

SENSORFARM_PLUGIN(plugin) {
  plugin.add_controller<Straight>("test-straight", "drives straight on", 5.0);
  plugin.add_controller<Picky>("test-picky", "refuses every robot");
}
