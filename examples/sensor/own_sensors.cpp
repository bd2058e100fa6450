// Two sensor types of your own: one measured on the host, one by a Vulkan kernel.
//
//   cmake -B build && cmake --build build
//   SENSORFARM_PLUGINS=build/libown_sensors.so sensorfarm sense sensor.world --type rangefinder

#include <sensorfarm/plugin.h>

#include <cmath>

namespace {

/// One ray ahead, with noise proportional to the range.
class Rangefinder : public sensorfarm::Sensor {
 public:
  Rangefinder(const sensorfarm::SensorSite&, const sensorfarm::SensorSettings& settings)
      : range_(settings.length("range_max", 4.0, 0.1, 1000.0)),
        noise_(settings.number("relative_noise", 0.0, 0.0, 1.0)) {}

  void read(const sensorfarm::Measurement& m, std::span<double> values) const override {
    const sensorfarm::Hit hit = m.around.cast(m.X_WS.x, m.X_WS.y, m.X_WS.z, m.X_WS.yaw, range_);
    values[0] = hit.range * (1.0 + noise_ * m.around.normal(0)[0]);
    values[1] = hit.model == sensorfarm::kNone ? 0.0 : 1.0;
  }

 private:
  double range_;  // [m]
  double noise_;  // standard deviation divided by range
};

/// Free distances all around, computed by openness.comp.
class Openness : public sensorfarm::Sensor {
 public:
  Openness(const sensorfarm::SensorSite&, const sensorfarm::SensorSettings& settings)
      : range_(settings.length("range_max", 4.0, 0.1, 1000.0)),
        directions_(static_cast<std::uint32_t>(settings.number("directions", 8, 1, 256))) {}

  std::uint32_t elements() const override { return directions_; }
  std::array<double, 8> parameters() const override { return {range_}; }
  void read(const sensorfarm::Measurement&, std::span<double>) const override {}

 private:
  double range_;  // [m]
  std::uint32_t directions_;
};

}  // namespace

SENSORFARM_PLUGIN(plugin) {
  plugin.add_sensor<Rangefinder>({.name = "rangefinder",
                                  .id = 13,
                                  .columns = {{"range_m", 1e-4}, {"hit", 1.0}},
                                  .keys = {"range_max", "relative_noise"}});
  plugin.add_sensor<Openness>({.name = "openness",
                               .id = 14,
                               .columns = {{"free_m"}},
                               .keys = {"range_max", "directions"},
                               .kernel = "openness.spv"});
}
