// The controller of tests/python/controllers.py in C++, operation by operation.

#include <sensorfarm/plugin.h>

#include <algorithm>

namespace {

class Careful : public sensorfarm::Controller {
 public:
  Careful(const sensorfarm::Robot&, sensorfarm::Settings& settings)
      : near_(settings.number("near", 0.6, 0.0, 10.0)), turn_(settings.number("turn", 0.5, -2.0, 2.0)) {}
  sensorfarm::Twist step(const sensorfarm::Input& input) override {
    const auto& ranges = input.newest("laser")->values;
    const double least = *std::min_element(ranges.begin(), ranges.end());
    return least < near_ ? sensorfarm::Twist{0.0, 0.0, turn_} : sensorfarm::Twist{0.1 * least, 0.0, 0.0};
  }

 private:
  double near_, turn_;
};

}  // namespace

SENSORFARM_PLUGIN(plugin) { plugin.add_controller<Careful>("careful", "turns where something is near"); }
