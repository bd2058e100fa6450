#include "sensors/fiducial.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "base/elementary.h"
#include "base/random.h"
#include "sensors/host_backend.h"
#include "sensors/illumination.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

using base::Pose;
using world::Fiducial;
using world::Segment;

struct Detection {
  std::uint32_t fiducial = 0;  ///< row in `World::fiducials`
  double range = 0.0, bearing = 0.0, orientation = 0.0;
};

std::vector<Segment> opaque_to_finders(const world::World& world) {
  std::vector<Segment> walls;
  if (world.fiducials.empty()) return walls;
  std::copy_if(world.walls.begin(), world.walls.end(), std::back_inserter(walls),
               [](const Segment& wall) { return wall.seen_by_laser; });
  return walls;
}

class FiducialFinders : public HostBackend {
 public:
  FiducialFinders(const SensorContext& context, const ParsedSensors& sensors)
      : HostBackend(context, fiducial_type, sensors),
        settings_(sensors.settings_as<FiducialFinder>()),
        noise_(context.noise),
        walls_(opaque_to_finders(context.world)) {}

 private:
  void measure(std::span<const HostSample> samples) const override {
    for (const HostSample& sample : samples) measure(sample);
  }
  void measure(const HostSample& sample) const;
  Pose place_of(const Fiducial& fiducial, std::uint32_t finder) const;
  std::uint32_t carrier_of(const Fiducial& fiducial, std::uint32_t finder) const;
  bool hidden(const Fiducial& fiducial, const Pose& X_WF, const HostSample& sample) const;
  bool hidden_by(std::uint32_t mover, const glm::dvec3& from, const glm::dvec3& to) const;

  const std::vector<FiducialFinder>& settings_;  ///< per row
  bool noise_;
  world::CopyIndex copies_{world()};
  world::WallTree walls_;
};

// NaN if its mover is absent.
Pose FiducialFinders::place_of(const Fiducial& fiducial, std::uint32_t finder) const {
  const std::uint32_t mover = carrier_of(fiducial, finder);
  if (mover == world::kNone) return fiducial.X_BF;
  return base::compose(states()[mover].X_WM, fiducial.X_BF);
}

/// Returns the mover that carries the fiducial in the finder's copy of the world.
std::uint32_t FiducialFinders::carrier_of(const Fiducial& fiducial, std::uint32_t finder) const {
  const std::uint32_t row = world().models[fiducial.model].mover;
  return row == world::kNone ? row : copies_.in_copy_of(finder, row);
}

bool FiducialFinders::hidden(const Fiducial& fiducial, const Pose& X_WF, const HostSample& sample) const {
  const glm::dvec3 from{sample.X_WS.x, sample.X_WS.y, sample.X_WS.z}, to{X_WF.x, X_WF.y, X_WF.z};
  const auto hides = [&](const Segment& wall) { return wall.model != fiducial.model && crosses_sight(from, to, wall); };
  if (walls_.any(base::box_of({from.x, from.y}, {to.x, to.y}), hides)) return true;
  const std::uint32_t own = rows()[sample.row].mover, carrier = carrier_of(fiducial, own);
  const auto [first, end] = copies_.rows_with(own, static_cast<std::uint32_t>(world().movers.size()));
  for (std::uint32_t m = first; m < end; ++m)
    if (m != own && m != carrier && hidden_by(m, from, to)) return true;
  return false;
}

bool FiducialFinders::hidden_by(std::uint32_t mover, const glm::dvec3& from, const glm::dvec3& to) const {
  const world::Mover& body = world().movers[mover];
  const Pose& X_WM = states()[mover].X_WM;
  if (!(world::distance({X_WM.x, X_WM.y}, {from.x, from.y}, {to.x, to.y}) <= body.radius)) return false;
  return std::any_of(body.body.begin(), body.body.end(), [&](Segment part) {
    part.a = base::transform(X_WM, part.a);
    part.b = base::transform(X_WM, part.b);
    part.z_min += X_WM.z;
    part.z_max += X_WM.z;
    return part.seen_by_laser && crosses_sight(from, to, part);
  });
}

void FiducialFinders::measure(const HostSample& sample) const {
  const FiducialFinder& s = settings_[sample.row];
  const SensorSpec& row = rows()[sample.row];
  thread_local std::vector<Detection> seen;  // keeps its memory between ticks
  seen.clear();
  for (std::uint32_t i = 0; i < world().fiducials.size(); ++i) {
    const Fiducial& fiducial = world().fiducials[i];
    if (fiducial.key != s.key || carrier_of(fiducial, row.mover) == row.mover) continue;
    const Pose X_WF = place_of(fiducial, row.mover);
    const glm::dvec2 d{X_WF.x - sample.X_WS.x, X_WF.y - sample.X_WS.y};
    const double range = glm::length(d), bearing = base::wrap_angle(base::atan2(d.y, d.x) - sample.X_WS.yaw);
    if (!(range >= s.range_min && range <= s.range_max) || std::abs(bearing) > 0.5 * s.fov) continue;
    if (hidden(fiducial, X_WF, sample)) continue;
    seen.push_back({i, range, bearing, base::wrap_angle(X_WF.yaw - sample.X_WS.yaw)});
  }
  std::sort(seen.begin(), seen.end(), [](const auto& p, const auto& q) {
    return std::pair(p.range, p.fiducial) < std::pair(q.range, q.fiducial);
  });
  std::fill(sample.values.begin(), sample.values.end(), std::nan(""));
  for (std::size_t k = 0; k < std::min<std::size_t>(seen.size(), row.elements); ++k) {
    const Detection& d = seen[k];
    const Fiducial& fiducial = world().fiducials[d.fiducial];
    const base::RandomKey key = episodes().key(base::RandomStream::fiducials, row.mover, row.sensor, sample.sequence);
    const auto [n, m] = noise_ ? base::random_normal(key, 2 * d.fiducial) : std::array{0.0, 0.0};
    const double o = noise_ ? base::random_normal(key, 2 * d.fiducial + 1)[0] : 0.0;
    const auto out = sample.values.subspan(kFiducialNumbers * k, kFiducialNumbers);
    out[0] = d.range <= s.range_max_id ? fiducial.id : 0.0;
    out[1] = static_cast<double>(fiducial.type);
    out[2] = std::max(0.0, d.range + s.range_noise * n);
    out[3] = base::wrap_angle(d.bearing + s.bearing_noise * m);
    out[4] = base::wrap_angle(d.orientation + s.orientation_noise * o);
  }
}

ParsedSensors parse_finders(const world::World& world) {
  return parse_each(world, fiducial_type, [](const world::Sensor& sensor, SensorSpec& row) {
    const FiducialFinder s = read_finder(sensor);
    row.X_MS.z += 0.5 * sensor.height;
    row.elements = whole(sensor, "detections", 8, 1, kMostDetections);
    row.reach = s.range_max;
    row.sigma = s.range_noise > 0.0 || s.bearing_noise > 0.0 || s.orientation_noise > 0.0 ? HUGE_VAL : 0.0;
    return s;
  });
}

constexpr std::string_view kKeys[] = {"range_min",    "range_max",  "range_max_id", "fov",
                                      "fiducial_key", "detections", "noise"};
constexpr Column kColumns[] = {{"id"}, {"fiducial_type"}, {"range_m"}, {"bearing_rad"}, {"orientation_rad"}};
constexpr PlainNumber kNumbers[] = {{1.0, 0.0, 65535.0}, {1.0, 0.0, 2.0}, {1e-3, 0.0}, {1e-6}, {1e-6}};
constexpr PlainForm kForm{kFiducial, "fiducial", kNumbers};

}  // namespace

FiducialFinder read_finder(const world::Sensor& sensor) {
  FiducialFinder s;
  s.range_max = length(sensor, "range_max", s.range_max, 1e-3, 1e6);
  s.range_min = length(sensor, "range_min", s.range_min, 0.0, s.range_max);
  s.range_max_id = length(sensor, "range_max_id", std::min(s.range_max_id, s.range_max), 0.0, 1e6);
  s.fov = angle(sensor, "fov", s.fov, 1e-6, 2.0 * M_PI);
  s.key = whole(sensor, "fiducial_key", 0, 0, 65535);
  const auto noise = tuple(sensor, "noise", 1, "[range bearing orientation]");
  if (!noise) return s;
  for (const double sigma : *noise)
    if (!(sigma >= 0.0)) refuse(sensor, "noise", "'noise' is negative; expected standard deviations of 0 or more");
  s.range_noise = (*noise)[0] * sensor.metres_per_unit;
  if (noise->size() > 1) s.bearing_noise = (*noise)[1] * sensor.radians_per_unit;
  if (noise->size() > 2) s.orientation_noise = (*noise)[2] * sensor.radians_per_unit;
  return s;
}

constinit const SensorType fiducial_type = plain<kForm>({
    .word = {"fiducial", kKeys},
    .base_port = 62000,
    .list = "detections",
    .columns = kColumns,
    .parse = parse_finders,
    .make = make_backend<FiducialFinders>,
});

}  // namespace sf::sensors
