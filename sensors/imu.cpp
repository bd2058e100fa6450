#include "sensors/imu.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/tilted_pose.h"
#include "base/time.h"
#include "sensors/attitude_filter.h"
#include "sensors/host_backend.h"
#include "sensors/inertial_motion.h"
#include "sensors/mover_trail.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"
#include "sensors/triad_backend.h"

namespace sf::sensors {

namespace {

constexpr std::size_t kPiece = 16;          // sensors per piece of work
constexpr std::uint32_t kPlainNumbers = 7;  // of readings without an orientation
constexpr std::uint64_t kNone = ~std::uint64_t{0};

/// One unit during a run.
struct ImuState {
  InertialMotion motion;
  Triad gyros, accels;
  AttitudeFilter attitude;
  std::uint64_t last = kNone;  ///< number of the reading that the orientation is of
};

class Imus : public HostBackend {
 public:
  Imus(const SensorContext& context, const ParsedSensors& sensors);

  void accumulate(std::int64_t now, bool between) override;
  void write_state(std::uint32_t row, base::ByteWriter& out) const override;
  void read_state(std::uint32_t row, base::ByteReader& in) override;
  void restart(std::uint32_t row, std::int64_t now) override;

 private:
  void measure_all() override;
  void measure_one(const HostSample& sample);
  glm::dquat orientation(const HostSample& sample, const glm::dvec3& rate, const glm::dvec3& force, bool goes_on);
  ImuState state_at_start(std::uint32_t row) const;
  base::Report report_of(std::size_t row) const {
    base::Report report = states()[rows()[row].mover];
    report.time = now_;
    return report;
  }

  const std::vector<Imu>& settings_;  ///< per row
  bool noise_;
  std::vector<ImuState> imus_;      ///< per row
  std::vector<base::Report> last_;  ///< per row, in the last tick or sample
  std::int64_t now_ = 0;            ///< [ns]
};

ParsedSensors parse_imus(const world::World& world) {
  ParsedSensors sensors = parse_each(world, imu_type, [](const world::Sensor& sensor, SensorSpec& row) {
    const Imu imu = read_imu(sensor);
    row.rate = rate_of(sensor, kImuRate);
    if (row.rate < kLeastImuRate)
      refuse(sensor, find(sensor, "rate") != nullptr ? "rate" : "update_interval",
             fmt::format("the rate is {:g} Hz; expected at least {:g}: each reading is a mean since the last one",
                         row.rate, kLeastImuRate));
    row.X_MS = planar_mount(imu.X_MS);
    if (std::isfinite(imu.gyro.range)) row.limit = imu.gyro.range;
    row.sigma = imu.g_sensitivity > 0.0 ? HUGE_VAL : reading_deviation(imu.gyro, 1.0 / row.rate);
    row.reach = 0.0;
    return imu;
  });
  const bool orientation = std::ranges::any_of(sensors.settings_as<Imu>(), &Imu::orientation);
  for (SensorSpec& row : sensors.rows) row.width = orientation ? 0 : kPlainNumbers;
  return sensors;
}

Imus::Imus(const SensorContext& context, const ParsedSensors& sensors)
    : HostBackend(context, imu_type, sensors),
      settings_(sensors.settings_as<Imu>()),
      noise_(context.noise),
      last_(rows().size()) {
  for (std::uint32_t i = 0; i < rows().size(); ++i) imus_.push_back(state_at_start(i));
}

ImuState Imus::state_at_start(std::uint32_t row) const {
  const SensorSpec& spec = rows()[row];
  const Imu& s = settings_[row];
  const base::RandomKey noise = episodes().key(base::RandomStream::instrument_noise, spec.mover, spec.sensor),
                        drift = episodes().key(base::RandomStream::instrument_drift, spec.mover, spec.sensor);
  const double interval = 1.0 / spec.rate;
  return {{s.X_MS, base::nanoseconds(interval), world().movers[spec.mover].max_forward, s.gravity},
          {s.gyro, s.g_sensitivity, interval, noise, drift, 0, noise_},
          {s.accel, 0.0, interval, noise, drift, 1, noise_},
          {s.gain, s.bias_gain, s.gravity}};
}

void Imus::restart(std::uint32_t row, std::int64_t now) {
  now_ = now;
  imus_[row] = state_at_start(row);
  last_[row] = report_of(row);
  imus_[row].motion.add(last_[row]);
}

void Imus::accumulate(std::int64_t now, bool between) {
  now_ = now;
  thread_pool().parallel_for(imus_.size(), kPiece, [&](std::size_t first, std::size_t end, unsigned) {
    for (std::size_t row = first; row < end; ++row) {
      last_[row] = report_of(row);
      if (!between) imus_[row].motion.add(last_[row]);
    }
  });
}

/// The filter starts with the true heading. So it does after readings that were not taken, and for a single one at
/// another pose. A single one at the present pose has the last orientation.
glm::dquat Imus::orientation(const HostSample& sample, const glm::dvec3& rate, const glm::dvec3& force, bool goes_on) {
  ImuState& imu = imus_[sample.row];
  if (goes_on && imu.last != kNone && sample.sequence <= imu.last) return imu.attitude.q_WS();
  AttitudeFilter attitude = imu.attitude;
  if (goes_on && imu.last != kNone && sample.sequence == imu.last + 1) {
    attitude.update(rate, force, 1.0 / rows()[sample.row].rate);
  } else {
    const base::Report& state = states()[rows()[sample.row].mover];
    const auto X_WS = base::compose(base::transform_of(state.X_WM, state.tilt), settings_[sample.row].X_MS);
    attitude.align(base::tilted_pose_of(X_WS).X.yaw, force);
  }
  if (goes_on) imu.attitude = attitude, imu.last = sample.sequence;
  return attitude.q_WS();
}

/// A mover at the pose of a single reading, where no tick has put it, is at rest.
void Imus::measure_one(const HostSample& sample) {
  ImuState& imu = imus_[sample.row];
  const base::Report now = report_of(sample.row);
  const bool goes_on = is_same_place(now, last_[sample.row]);
  const InertialMeans truth = goes_on ? imu.motion.mean(now) : imu.motion.at_rest(now);
  const Triad::Output rate = imu.gyros.measure(truth.rate, truth.force, sample.sequence),
                      force = imu.accels.measure(truth.force, {}, sample.sequence);
  const double row[] = {rate.values.x,
                        rate.values.y,
                        rate.values.z,
                        force.values.x,
                        force.values.y,
                        force.values.z,
                        static_cast<double>(rate.saturated | force.saturated << 3)};
  std::copy(std::begin(row), std::end(row), sample.values.begin());
  if (sample.values.size() == kPlainNumbers) return;
  glm::dquat q(NAN, NAN, NAN, NAN);
  if (settings_[sample.row].orientation) q = orientation(sample, rate.values, force.values, goes_on);
  std::ranges::copy(std::array{q.w, q.x, q.y, q.z}, sample.values.begin() + kPlainNumbers);
}

void Imus::measure_all() {
  thread_pool().parallel_for(samples().size(), kPiece, [&](std::size_t first, std::size_t end, unsigned) {
    for (std::size_t i = first; i < end; ++i) measure_one(samples()[i]);
  });
}

void Imus::write_state(std::uint32_t row, base::ByteWriter& out) const {
  const ImuState& imu = imus_[row];
  imu.motion.write(out);
  imu.gyros.write(out), imu.accels.write(out);
  if (!settings_[row].orientation) return;
  imu.attitude.write(out), out.put(imu.last);
}

void Imus::read_state(std::uint32_t row, base::ByteReader& in) {
  ImuState& imu = imus_[row];
  imu.motion.read(in);
  imu.gyros.read(in), imu.accels.read(in);
  if (!settings_[row].orientation) return;
  imu.attitude.read(in), imu.last = in.get<std::uint64_t>();
}

// --- Settings ---

constexpr double kDegree = M_PI / 180.0, kHour = 3600.0, kRootHour = 60.0;
constexpr double kFloor = 1.0 / 0.664;  // B of an Allan deviation at its lowest
constexpr double kG = kStandardGravity;

/// A real device, by its data sheet.
struct Preset {
  std::string_view name;
  TriadErrors gyro, accel;
  double g_sensitivity = 0.0;
};

// Limits ("+-3 %") are three deviations. Figures that a sheet does not state are 0. Densities are of one side, so N is
// the density over sqrt(2). Bias instabilities are read off Allan deviations at their lowest.
// InvenSense PS-MPU-6000A-00 Rev. 3.4, at 250 deg/s and 2 g: 0.005 deg/s/sqrt(Hz), 20 deg/s, 3 %, 2 %, 0.1 deg/s/g;
// 400 ug/sqrt(Hz), 50 mg, 3 %, 2 %; 131 and 16 384 counts.
// Analog Devices ADIS16470 Rev. C: 0.34 deg/sqrt(h), 8 deg/h, 2000 deg/s; 0.037 m/s/sqrt(h), 13 ug, 40 g.
// Sensonor STIM300 Rev. 9, of 10 g: 0.15 deg/sqrt(h), 0.5 deg/h, 500 ppm, 1 mrad, 1 deg/h/g, 400 deg/s; 0.06
// m/s/sqrt(h), 0.05 mg, 0.75 mg, 300 ppm, 1 mrad.
constexpr Preset kPresets[] = {
    {"MPU-6050",
     {.noise = 0.005 * kDegree * M_SQRT1_2,
      .bias = 20.0 / 3.0 * kDegree,
      .scale = 0.01,
      .misalignment = 0.02 / 3.0,
      .step = kDegree / 131.0,
      .range = 250.0 * kDegree},
     {.noise = 400e-6 * kG * M_SQRT1_2,
      .bias = 50e-3 / 3.0 * kG,
      .scale = 0.01,
      .misalignment = 0.02 / 3.0,
      .step = kG / 16384.0,
      .range = 2.0 * kG},
     0.1 * kDegree / kG},
    {"ADIS16470",
     {.noise = 0.34 * kDegree / kRootHour, .drift = {8.0 * kDegree / kHour * kFloor}, .range = 2000.0 * kDegree},
     {.noise = 0.037 / kRootHour, .drift = {13e-6 * kG * kFloor}, .range = 40.0 * kG}},
    {"STIM300",
     {.noise = 0.15 * kDegree / kRootHour,
      .drift = {0.5 * kDegree / kHour * kFloor},
      .scale = 500e-6,
      .misalignment = 1e-3,
      .range = 400.0 * kDegree},
     {.noise = 0.06 / kRootHour,
      .drift = {0.05e-3 * kG * kFloor},
      .bias = 0.75e-3 * kG,
      .scale = 300e-6,
      .misalignment = 1e-3,
      .range = 10.0 * kG},
     kDegree / kHour / kG}};

constexpr std::string_view kKeys[] = {"preset",
                                      "pose6",
                                      "gravity",
                                      "g_sensitivity",
                                      "orientation",
                                      "gains",
                                      "gyro_noise",
                                      "gyro_instability",
                                      "gyro_walk",
                                      "gyro_bias",
                                      "gyro_scale",
                                      "gyro_step",
                                      "gyro_misalignment",
                                      "gyro_range",
                                      "accel_noise",
                                      "accel_walk",
                                      "accel_instability",
                                      "accel_bias",
                                      "accel_scale",
                                      "accel_step",
                                      "accel_range",
                                      "accel_misalignment"};
constexpr Column kColumns[] = {{"rate_x_rad_s"},  {"rate_y_rad_s"},  {"rate_z_rad_s"},       {"force_x_m_s2"},
                               {"force_y_m_s2"},  {"force_z_m_s2"},  {"saturated", 1, true}, {"orientation_w"},
                               {"orientation_x"}, {"orientation_y"}, {"orientation_z"}};
constexpr PlainNumber kReal{.real = true};
constexpr PlainNumber kNumbers[] = {kReal, kReal, kReal, kReal, kReal, kReal, {1.0, 0.0, 63.0},
                                    kReal, kReal, kReal, kReal};
constexpr PlainForm kForm{kImu, "imu", kNumbers, kPlainNumbers};

/// States that of the three rates and the three forces.
double noise_of_imu(const ParsedSensors& sensors, std::size_t row, std::uint32_t offset) {
  if (offset >= 6) return HUGE_VAL;
  const Imu& imu = sensors.settings_as<Imu>()[row];
  return reading_noise(offset < 3 ? imu.gyro : imu.accel, sensors.rows[row].rate);
}

}  // namespace

Imu read_imu(const world::Sensor& sensor) {
  constexpr double kMostRate = 1e3, kMostForce = 1e5;  // [rad/s], [m/s^2]
  const Preset* const known = preset_of(sensor, kPresets);
  const Preset preset = known != nullptr ? *known : Preset{};
  Imu imu{.X_MS = spatial_mount(sensor), .gyro = preset.gyro, .accel = preset.accel};
  imu.gravity = length(sensor, "gravity", imu.gravity, 0.0, 1e3);
  imu.g_sensitivity = angle(sensor, "g_sensitivity", preset.g_sensitivity * kG, 0.0, kMostRate) / kG;
  imu.orientation = whole(sensor, "orientation", 0, 0, 1) == 1;
  if (const auto gains = tuple(sensor, "gains", 2, "[proportional integral]"))
    imu.gain = (*gains)[0], imu.bias_gain = (*gains)[1];
  const auto is_gain = [](double gain) { return gain >= 0.0 && gain <= 1e3; };
  if (find(sensor, "gains") != nullptr && !(imu.orientation && is_gain(imu.gain) && is_gain(imu.bias_gain)))
    refuse(sensor, "gains", "expected 'orientation 1' with 'gains', which are two numbers from 0 to 1000");
  read_errors(sensor, "gyro_", angle, kMostRate, imu.gyro);
  read_errors(sensor, "accel_", length, kMostForce, imu.accel);
  return imu;
}

constinit const SensorType imu_type = plain<kForm>({
    .word = {"imu", kKeys},
    .base_port = 12000,
    .list = "",
    .columns = kColumns,
    .noise = noise_of_imu,
    .parse = parse_imus,
    .make = make_backend<Imus>,
});

}  // namespace sf::sensors
