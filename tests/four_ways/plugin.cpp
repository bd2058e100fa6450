// As a plug-in.

#include <sensorfarm/plugin.h>

#include "tests/four_ways/avoid.h"

namespace {

class Avoid : public sensorfarm::Controller {
 public:
  Avoid(const sensorfarm::Robot&, sensorfarm::Settings&) {}
  sensorfarm::Twist step(const sensorfarm::Input& input) override { return avoid(input.newest("laser")->values); }
};

}  // namespace

SENSORFARM_PLUGIN(plugin) {
  plugin.add_controller<Avoid>("four-ways", "drives on, turns before obstacles").stops_on_bumper = false;
}
