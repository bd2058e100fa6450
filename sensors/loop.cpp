#include "sensors/loop.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "base/displacement.h"
#include "base/elementary.h"
#include "robots/kinematics.h"
#include "sensors/host_backend.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"
#include "world/wall_tree.h"

namespace sf::sensors {

namespace {

constexpr double kLoopRate = 1.0;          // [Hz]
constexpr std::int64_t kMostTests = 1000;  // of one vehicle between two ticks

/// A loop at one time.
struct Detector {
  std::uint64_t count = 0;
  std::int64_t covered = 0;       ///< [ns] since the start
  double speeds = 0.0;            ///< [m/s] sum over `timed` vehicles
  std::uint64_t timed = 0;        ///< vehicles that entered with a known speed
  std::vector<std::uint32_t> on;  ///< movers, ascending
};

/// A detector at its last reading.
struct LastReading {
  std::int64_t time = 0;  ///< [ns]
  std::int64_t covered = 0;
  double speeds = 0.0;
  std::uint64_t timed = 0;
  std::uint64_t count = 0;
};

/// [ns]
struct Span {
  std::int64_t from = 0, to = 0;
};

class Loops : public HostBackend {
 public:
  Loops(const SensorContext& context, const ParsedSensors& sensors)
      : HostBackend(context, loop_type, sensors),
        copies_(context.world),
        sizes_(sensors.settings_as<LoopSize>()),
        detectors_(rows().size()),
        last_readings_(rows().size()) {}

  bool update_outlines(const world::World&) override { return true; }  // read at each tick
  void accumulate(std::int64_t now, bool between) override;
  void take_over(SensorBackend& before, std::uint32_t rows) override;
  void restart(std::uint32_t row, std::int64_t now) override;

 private:
  void measure(std::span<const HostSample> samples) const override;
  void start(std::int64_t now);
  void advance(std::size_t row, Detector& detector);
  /// Returns the movers in the loop's copy of the world.
  std::pair<std::uint32_t, std::uint32_t> rows_with(std::size_t row) const {
    return copies_.rows_with(rows()[row].mover, static_cast<std::uint32_t>(states().size()));
  }
  bool may_cover(std::size_t row, std::uint32_t mover) const;
  bool covered(std::size_t row, std::uint32_t mover, std::int64_t time, base::Report* at = nullptr) const;
  bool trace(std::size_t row, std::uint32_t mover, bool on, Detector& detector);
  bool drove(std::uint32_t mover) const;

  world::CopyIndex copies_;
  const std::vector<LoopSize>& sizes_;              ///< per row
  std::vector<Detector> detectors_;                 ///< per row, at the last tick
  std::vector<Detector> ahead_;                     ///< per row, in a sample between two ticks
  bool between_ = false;                            ///< `ahead_` is current
  std::int64_t now_ = 0;                            ///< [ns]
  std::int64_t ticked_ = -1;                        ///< [ns] of the last tick; -1: none
  std::vector<base::Report> before_;                ///< per mover, at the last tick
  std::vector<std::uint32_t> on_;                   ///< of the row under way
  std::vector<Span> spans_;                         ///< in which the row under way was covered
  mutable std::vector<LastReading> last_readings_;  ///< per row
};

void Loops::start(std::int64_t now) {
  ticked_ = now;
  before_.assign(states().begin(), states().end());
  for (std::uint32_t row = 0; row < detectors_.size(); ++row) restart(row, now);
}

void Loops::restart(std::uint32_t row, std::int64_t now) {
  const auto [first, end] = rows_with(row);
  std::copy_n(states().begin() + first, end - first, before_.begin() + first);
  detectors_[row] = {};
  last_readings_[row] = {.time = now};
  for (std::uint32_t m = first; m < end; ++m)
    if (covered(row, m, now)) detectors_[row].on.push_back(m);
}

void Loops::accumulate(std::int64_t now, bool between) {
  now_ = now;
  if (ticked_ < 0) return start(now);
  between_ = between;
  if (between) ahead_ = detectors_;
  for (std::size_t row = 0; row < detectors_.size(); ++row) advance(row, (between ? ahead_ : detectors_)[row]);
  if (between) return;
  ticked_ = now;
  before_.assign(states().begin(), states().end());
}

/// Returns false for a mover that was relocated, or absent.
bool Loops::drove(std::uint32_t mover) const {
  const Pose &from = before_[mover].X_WM, &to = states()[mover].X_WM;
  if (base::is_absent(from) || base::is_absent(to) || now_ <= ticked_) return false;
  return base::is_drivable(from, to, world().movers[mover].max_forward, 1e-9 * static_cast<double>(now_ - ticked_));
}

/// Returns false if the mover is certainly off the loop from the last tick until now.
bool Loops::may_cover(std::size_t row, std::uint32_t mover) const {
  const std::uint32_t carrier = rows()[row].mover;
  if (mover == carrier) return false;
  const Pose &X_WM = states()[mover].X_WM, &X_WC = states()[carrier].X_WM;
  if (!(std::abs(X_WM.z - X_WC.z) <= kLevelHeight)) return false;  // also if one of them is absent
  const auto way = [&](std::uint32_t m) {
    const double d = base::hypot(states()[m].X_WM.x - before_[m].X_WM.x, states()[m].X_WM.y - before_[m].X_WM.y);
    return std::isnan(d) ? 0.0 : M_PI_2 * d;  // an arc of half a turn
  };
  const Pose& X_CL = rows()[row].X_MS;
  const double reach = world().movers[mover].radius + 0.5 * base::hypot(sizes_[row].length, sizes_[row].width) +
                       base::hypot(X_CL.x, X_CL.y);
  return base::hypot(X_WM.x - X_WC.x, X_WM.y - X_WC.y) <= reach + way(mover) + way(carrier);
}

/// @param time [ns] from the last tick to now  @param at if not null: the mover's state then
bool Loops::covered(std::size_t row, std::uint32_t mover, std::int64_t time, base::Report* at) const {
  const SensorSpec& spec = rows()[row];
  const auto state = [&](std::uint32_t m) {
    if (time >= now_ || !drove(m)) return states()[m];
    base::Report from = before_[m], to = states()[m];
    from.time = ticked_, to.time = now_;
    return robots::interpolate(from, to, time);
  };
  const base::Report vehicle = state(mover);
  if (at != nullptr) *at = vehicle;
  const Pose X_WC = state(spec.mover).X_WM;
  if (mover == spec.mover || !(std::abs(vehicle.X_WM.z - X_WC.z) <= kLevelHeight)) return false;
  return covers(sizes_[row], base::compose(X_WC, spec.X_MS), world().movers[mover], vehicle.X_WM);
}

/// Follows a mover from the last tick until now. @param on whether it covered the loop then @return whether it does now
bool Loops::trace(std::size_t row, std::uint32_t mover, bool on, Detector& detector) {
  std::int64_t since = ticked_;
  const auto enter = [&](std::int64_t time, const base::Report* at) {
    since = time;
    ++detector.count;
    if (at != nullptr) detector.speeds += base::hypot(at->velocity.forward, at->velocity.left), ++detector.timed;
  };
  std::int64_t steps = 1;
  if (drove(mover)) {
    const auto moved = [&](std::uint32_t m, double radius) {
      const Pose &from = before_[m].X_WM, &to = states()[m].X_WM;
      const double turn = std::abs(base::wrap_angle(to.yaw - from.yaw));
      const double d = M_PI_2 * base::hypot(to.x - from.x, to.y - from.y) + radius * turn;
      return std::isnan(d) ? 0.0 : d;
    };
    const double reach = base::hypot(rows()[row].X_MS.x, rows()[row].X_MS.y);
    const double way = moved(mover, world().movers[mover].radius) + moved(rows()[row].mover, reach);
    const double step = 0.25 * std::min(sizes_[row].length, sizes_[row].width);
    steps = std::clamp<std::int64_t>(std::llround(std::ceil(std::min(way / step, 1e6))), 1, kMostTests);
  }
  std::int64_t tested = ticked_;
  for (std::int64_t k = 1; k <= steps; ++k) {
    std::int64_t low = tested, high = tested = k == steps ? now_ : ticked_ + (now_ - ticked_) * k / steps;
    if (covered(row, mover, high) == on) continue;
    while (drove(mover) && high - low > 1) {
      const std::int64_t middle = low + (high - low) / 2;
      (covered(row, mover, middle) == on ? low : high) = middle;
    }
    base::Report at;
    covered(row, mover, std::min(high, now_ - 1), &at);  // a time at which the velocity is that of this motion
    if (on) spans_.push_back({since, high});
    if (!on) enter(high, drove(mover) ? &at : nullptr);
    on = !on;
  }
  if (on) spans_.push_back({since, now_});
  return on;
}

void Loops::advance(std::size_t row, Detector& detector) {
  on_.clear();
  spans_.clear();
  std::size_t next = 0;  // in the movers on it before
  const auto [first, end] = rows_with(row);
  for (std::uint32_t m = first; m < end; ++m) {
    const bool on = next < detector.on.size() && detector.on[next] == m;
    next += on;
    if ((on || may_cover(row, m)) && trace(row, m, on, detector)) on_.push_back(m);
  }
  detector.on.assign(on_.begin(), on_.end());
  std::ranges::sort(spans_, {}, [](const Span& span) { return std::pair(span.from, span.to); });
  std::int64_t until = ticked_;
  for (const Span& span : spans_) {
    detector.covered += std::max<std::int64_t>(0, span.to - std::max(span.from, until));
    until = std::max(until, span.to);
  }
}

void Loops::take_over(SensorBackend& before, std::uint32_t rows) {
  auto& from = dynamic_cast<Loops&>(before);
  std::move(from.detectors_.begin(), from.detectors_.begin() + rows, detectors_.begin());
  std::copy_n(from.last_readings_.begin(), rows, last_readings_.begin());
  std::copy(from.before_.begin(), from.before_.end(), before_.begin());
  ticked_ = from.ticked_;
}

void Loops::measure(std::span<const HostSample> samples) const {
  for (const HostSample& sample : samples) {
    const Detector& now = (between_ ? ahead_ : detectors_)[sample.row];
    LastReading& last = last_readings_[sample.row];
    const auto passed = static_cast<double>(now.timed - std::min(now.timed, last.timed));
    const auto seconds = static_cast<double>(now_ - last.time);
    const std::uint64_t count = std::max(now.count, last.count);
    const double share = seconds > 0.0 ? static_cast<double>(now.covered - last.covered) / seconds : !now.on.empty();
    const double row[] = {static_cast<double>(count), std::clamp(share, 0.0, 1.0),
                          passed > 0.0 ? std::max(0.0, now.speeds - last.speeds) / passed : NAN,
                          static_cast<double>(now.on.size())};
    std::copy(std::begin(row), std::end(row), sample.values.begin());
    last = {now_, now.covered, now.speeds, now.timed, count};
  }
}

ParsedSensors parse_loops(const world::World& world) {
  return parse_each(world, loop_type, [](const world::Sensor& sensor, SensorSpec& row) {
    row.rate = rate_of(sensor, kLoopRate);
    LoopSize size;
    const auto sides = tuple(sensor, "size", 2, "[along across]");
    if (!sides) return size;
    size = {(*sides)[0] * sensor.metres_per_unit, (*sides)[1] * sensor.metres_per_unit};
    if (!(std::min(size.length, size.width) >= 1e-3 && std::max(size.length, size.width) <= 1e3))
      refuse(sensor, "size", "'size' expects two lengths from 1 mm to 1 km: [along across]");
    return size;
  });
}

constexpr std::string_view kKeys[] = {"size"};
constexpr Column kColumns[] = {{"count", 1, true}, {"occupancy"}, {"speed_m_s"}, {"vehicles", 1, true}};
constexpr PlainNumber kNumbers[] = {{1.0, 0.0}, {1e-6, 0.0, 1.0}, {1e-4, 0.0}, {1.0, 0.0}};
constexpr PlainForm kForm{kLoop, "loop", kNumbers};

}  // namespace

bool covers(const LoopSize& size, const Pose& X_WL, const world::Mover& mover, const Pose& X_WM) {
  const Pose X_ML = base::compose(base::inverse(X_WM), X_WL), X_LM = base::inverse(X_ML);
  const double x = 0.5 * size.length, y = 0.5 * size.width;
  if (mover.body.empty() || base::hypot(X_ML.x, X_ML.y) > mover.radius + base::hypot(x, y)) return false;
  const glm::dvec2 corners[] = {base::transform(X_ML, {-x, -y}), base::transform(X_ML, {x, -y}),
                                base::transform(X_ML, {x, y}), base::transform(X_ML, {-x, y})};
  for (const world::Segment& edge : mover.body) {
    const glm::dvec2 p_L = base::transform(X_LM, edge.a);
    if (std::abs(p_L.x) <= x && std::abs(p_L.y) <= y) return true;
    for (int k = 0; k < 4; ++k)
      if (world::segments_meet(edge.a, edge.b, corners[k], corners[(k + 1) % 4])) return true;
  }
  return world::winding_number(mover.body, {X_ML.x, X_ML.y}) != 0;
}

constinit const SensorType loop_type = plain<kForm>({
    .word = {"loop", kKeys},
    .base_port = 8000,
    .list = "",
    .columns = kColumns,
    .parse = parse_loops,
    .make = make_backend<Loops>,
});

}  // namespace sf::sensors
