#include "sensors/encoder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/displacement.h"
#include "base/elementary.h"
#include "base/tilted_pose.h"
#include "sensors/host_backend.h"
#include "sensors/odometer.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr double kSkidScrub = 1.5;  // of a Pioneer 3-AT: docs/sensors.md

/// Last known pose of a mover.
struct Track {
  Pose X_WM;
  std::int64_t since = 0;  ///< [ns] time of that pose
  bool moved = false;      ///< true once the mover has moved since the start
  bool away = false;       ///< the mover is absent from the world
};

class Encoders : public HostBackend {
 public:
  Encoders(const SensorContext& context, const ParsedSensors& sensors);

  void accumulate(std::int64_t now, bool between) override;
  void write_state(std::uint32_t row, base::ByteWriter& out) const override;
  void read_state(std::uint32_t row, base::ByteReader& in) override;
  void restart(std::uint32_t row, std::int64_t now) override {
    wheels_[row] = wheels_of(row);
    tracks_[row] = {states()[rows()[row].mover].X_WM, now};
  }

 private:
  void measure(std::span<const HostSample> samples) const override;
  Wheels wheels_of(std::uint32_t row) const {
    const SensorSpec& spec = rows()[row];
    return {settings_[row], episodes().key(base::RandomStream::slip, spec.mover, spec.sensor), noise_};
  }
  Wheels& counting(std::size_t row) { return (between_ ? ahead_ : wheels_)[row]; }
  bool drove(const Track& track, const Pose& X_WM, double max_forward, std::int64_t now) const;

  const std::vector<Encoder>& settings_;  ///< per row
  bool noise_;
  std::vector<Wheels> wheels_;  ///< per row, at the last tick
  std::vector<Wheels> ahead_;   ///< per row, in a sample between two ticks
  bool between_ = false;        ///< `ahead_` is current
  std::vector<Track> tracks_;   ///< per row
  std::int64_t last_ = 0;       ///< [ns] of the last tick
};

ParsedSensors parse_encoders(const world::World& world) {
  return parse_each(world, encoder_type, [&](const world::Sensor& sensor, SensorSpec& row) {
    const Encoder encoder = read_encoder(sensor, world.movers[row.mover]);
    row.sigma = encoder.slip > 0.0 ? HUGE_VAL : 0.0;
    row.reach = 0.0;
    return encoder;
  });
}

Encoders::Encoders(const SensorContext& context, const ParsedSensors& sensors)
    : HostBackend(context, encoder_type, sensors), settings_(sensors.settings_as<Encoder>()), noise_(context.noise) {
  for (std::uint32_t i = 0; i < rows().size(); ++i) {
    wheels_.push_back(wheels_of(i));
    tracks_.push_back({context.world.movers[rows()[i].mover].X_WM});
  }
}

/// Returns false for a relocation. The time since the last pose may exceed a tick when reports are late. Before the
/// first movement, it is measured from the last tick.
bool Encoders::drove(const Track& track, const Pose& X_WM, double max_forward, std::int64_t now) const {
  const double seconds = 1e-9 * static_cast<double>(now - (track.moved ? track.since : last_));
  return base::is_drivable(track.X_WM, X_WM, max_forward, std::max(0.0, seconds));
}

void Encoders::accumulate(std::int64_t now, bool between) {
  between_ = between;
  if (between) ahead_ = wheels_;
  for (std::size_t i = 0; i < wheels_.size(); ++i) {
    const std::uint32_t mover = rows()[i].mover;
    const base::Report& state = states()[mover];
    const Pose& X_WM = state.X_WM;
    Track& track = tracks_[i];
    // Only for a state of this tick: a mover that was at rest or absent and is now elsewhere was relocated. Older
    // states may be late.
    const bool fresh = state.time == now;
    if (base::is_absent(X_WM)) {
      if (!between) track.away = true;
      continue;
    }
    if (track.away && fresh) {
      if (!between) track = {X_WM, now, true};
      continue;
    }
    if (fresh && state.wheels.are_known()) {
      const double seconds = 1e-9 * static_cast<double>(now - track.since);
      counting(i).add({seconds * state.wheels.left, seconds * state.wheels.right});
      if (!between) track = {X_WM, now, true};
      continue;
    }
    if (X_WM.x == track.X_WM.x && X_WM.y == track.X_WM.y && X_WM.yaw == track.X_WM.yaw) {
      if (!between && fresh) track.since = now;
      continue;
    }
    if (drove(track, X_WM, world().movers[mover].max_forward, now)) {
      // Level robots that change their height do not drive up.
      const double rise = base::is_level(state.tilt) ? 0.0 : X_WM.z - track.X_WM.z;
      counting(i).roll(track.X_WM, X_WM, world().variation_of(mover).slip, rise);
    }
    if (!between) track = {X_WM, now, true};
  }
  if (!between) last_ = now;
}

// For wheels that slip, the number of steps of a random walk is part of the state.
static_assert(std::is_trivially_copyable_v<Rolled> && std::is_trivially_copyable_v<Slippage> &&
              std::is_trivially_copyable_v<Track>);

void Encoders::write_state(std::uint32_t row, base::ByteWriter& out) const {
  const Wheels& wheels = wheels_[row];
  out.put_bytes(&wheels.rolled, sizeof wheels.rolled);
  out.put_bytes(&wheels.left, sizeof wheels.left);
  out.put_bytes(&wheels.right, sizeof wheels.right);
  out.put_bytes(&tracks_[row], sizeof tracks_[row]);
}

void Encoders::read_state(std::uint32_t row, base::ByteReader& in) {
  Wheels& wheels = wheels_[row];
  in.get_into(&wheels.rolled, sizeof wheels.rolled);
  in.get_into(&wheels.left, sizeof wheels.left);
  in.get_into(&wheels.right, sizeof wheels.right);
  in.get_into(&tracks_[row], sizeof tracks_[row]);
}

void Encoders::measure(std::span<const HostSample> samples) const {
  for (const HostSample& sample : samples) {
    const Wheels& wheels = (between_ ? ahead_ : wheels_)[sample.row];
    const Rolled counts = wheels.counts(), counted = wheels.counted();
    const double row[] = {counted.left, counted.right, counts.left, counts.right};
    std::copy(std::begin(row), std::end(row), sample.values.begin());
  }
}

constexpr std::string_view kKeys[] = {"per_count", "slip", "scale", "track", "scrub", "slip_ratio", "slope_slip"};
// Counts are signed, but integer columns of recordings are not.
constexpr Column kColumns[] = {{"left_m"}, {"right_m"}, {"left_counts"}, {"right_counts"}};
constexpr PlainNumber kNumbers[] = {{1e-5}, {1e-5}, {1.0}, {1.0}};
constexpr PlainForm kForm{kEncoder, "encoder", kNumbers};

}  // namespace

void Wheels::roll(const base::Pose& before, const base::Pose& after, double slip, double rise) {
  Rolled step = sensors::roll(before, after, settings.track);
  double climb = 0.0;  // sine of the slope
  if (const double way = base::hypot(after.x - before.x, after.y - before.y); rise != 0.0 && way > 0.0) {
    const double slope = base::hypot(way, rise) / way;
    step = {step.left * slope, step.right * slope};
    climb = rise / (way * slope);
  }
  if (slip != 0.0) step = {step.left / (1.0 - slip), step.right / (1.0 - slip)};
  const auto slipping = [&](double way, double ratio) {
    return way / (1.0 - std::clamp(ratio + settings.slope_slip * climb, -world::kMostSlip, world::kMostSlip));
  };
  add({slipping(step.left, settings.slip_ratio_left), slipping(step.right, settings.slip_ratio_right)});
}

void Wheels::add(const Rolled& step) {
  rolled.left += step.left;
  rolled.right += step.right;
  left.advance(std::abs(step.left));
  right.advance(std::abs(step.right));
}

Rolled Wheels::counts() const {
  const auto count = [&](double distance, double scale, const Slippage& slippage) {
    return std::floor((distance * scale + slippage.error()) / settings.per_count + 0.5);
  };
  return {count(rolled.left, settings.scale_left, left), count(rolled.right, settings.scale_right, right)};
}

Encoder read_encoder(const world::Sensor& sensor, const world::Mover& mover) {
  Encoder e;
  for (const char* key : {"slip_ratio", "slope_slip"})
    if (mover.dynamics.name == "car" && find(sensor, key) != nullptr)
      refuse(sensor, key, fmt::format("the tyres of 'dynamics \"car\"' compute their slip; leave '{}' out", key));
  e.per_count = length(sensor, "per_count", e.per_count, 1e-7, 1e3);
  e.slip = number(sensor, "slip", 0.0, 0.0, 1.0);
  if (const auto scale = tuple(sensor, "scale", 2, "[left right]")) {
    e.scale_left = (*scale)[0];
    e.scale_right = (*scale)[1];
    if (!(std::min(e.scale_left, e.scale_right) >= 0.1 && std::max(e.scale_left, e.scale_right) <= 10.0))
      refuse(sensor, "scale",
             fmt::format("'scale' is [{:g} {:g}]; expected [left right], factors from 0.1 to 10", e.scale_left,
                         e.scale_right));
  }
  if (const auto slip = tuple(sensor, "slip_ratio", 2, "[left right]")) {
    e.slip_ratio_left = (*slip)[0], e.slip_ratio_right = (*slip)[1];
    if (!(std::max(std::abs(e.slip_ratio_left), std::abs(e.slip_ratio_right)) <= world::kMostSlip))
      refuse(sensor, "slip_ratio",
             fmt::format("'slip_ratio' is [{:g} {:g}]; expected [left right], from {:g} to {:g}", e.slip_ratio_left,
                         e.slip_ratio_right, -world::kMostSlip, world::kMostSlip));
  }
  e.slope_slip = number(sensor, "slope_slip", 0.0, 0.0, 10.0);
  const double scrub = number(sensor, "scrub", mover.drive == world::Drive::skid ? kSkidScrub : 1.0, 0.1, 10.0);
  e.track = scrub * length(sensor, "track", mover.track, 1e-3, 1e3);
  return e;
}

constinit const SensorType encoder_type = plain<kForm>({
    .word = {"encoder", kKeys},
    .base_port = 44000,
    .list = "",
    .columns = kColumns,
    .parse = parse_encoders,
    .make = make_backend<Encoders>,
});

}  // namespace sf::sensors
