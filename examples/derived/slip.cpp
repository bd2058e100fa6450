// A derived sensor of your own: the turn rate by which encoders and gyro disagree, which shows slip.
//
//   cmake -B build && cmake --build build
//   SENSORFARM_PLUGINS=build/libslip.so sensorfarm run slip.world --duration 5

#include <sensorfarm/plugin.h>

#include <cmath>
#include <limits>

namespace {

class Slip : public sensorfarm::DerivedSensor {
 public:
  Slip(const sensorfarm::DerivedSite& site, const sensorfarm::SensorSettings& settings)
      : inputs_(site.inputs), track_(settings.length("track", 0.258, 0.01, 10.0)) {}

  void take(std::uint32_t input, const sensorfarm::Reading& reading) override {
    if (inputs_[input].port == 1) {
      gyro_ = reading.values[0];
      return;
    }
    const double turned = (reading.values[1] - reading.values[0]) / track_;  // [rad] by the wheels
    wheels_ = (turned - turned_) / (reading.time - time_);                   // NaN at the first reading
    turned_ = turned, time_ = reading.time;
  }

  void read(double, sensorfarm::DerivedReading out) override {
    out.values[0] = wheels_ - gyro_;
    out.valid[0] = std::isfinite(out.values[0]);
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<sensorfarm::DerivedInput> inputs_;
  double track_, turned_ = kNone, time_ = kNone, wheels_ = kNone, gyro_ = kNone;
};

}  // namespace

SENSORFARM_PLUGIN(plugin) {
  plugin.add_derived<Slip>({.name = "slip",
                            .id = 15,
                            .columns = {{"slip_rad_s", 1e-6}},
                            .ports = {{"wheels", {"left_m", "right_m"}, 1, 1}, {"gyro", {"rate_rad_s"}, 1, 1}},
                            .keys = {"track"}});
}
