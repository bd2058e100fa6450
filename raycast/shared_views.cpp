#include "raycast/shared_views.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/elementary.h"

namespace sf::raycast {

namespace {

/// [places] limit of the distance of a beam from its place in an even pattern.
constexpr float kMaxSlack = 4.0F;

SharedPattern merge(std::span<const Scanner> scanners, std::span<const BeamPlan* const> plans) {
  struct Beam {
    double bearing, own_bearing;
    SharedPattern::Source source;
  };
  SharedPattern pattern;
  std::vector<Beam> beams;
  for (std::uint32_t f = 0; f < scanners.size(); ++f) {
    const BeamPlan& plan = *plans[f];
    const std::size_t first = SF_BEAMS_PER_LANE * std::size_t{pattern.lanes};
    pattern.lanes += plan.lanes();
    for (std::size_t k = 0; k < plan.samples.size(); ++k) {
      const double bearing = bearing_of(scanners[f].scan, plan.samples[k]);
      const std::size_t place = first + plan.place(k);
      const std::size_t next =
          k + 1 < plan.samples.size() ? first + plan.place(k + 1) : SF_BEAMS_PER_LANE * pattern.lanes;
      beams.push_back({base::wrap_angle(scanners[f].scan.X_MS.yaw - scanners[0].scan.X_MS.yaw + bearing),
                       bearing,
                       {f, static_cast<std::uint32_t>(place), static_cast<std::uint32_t>(next - place)}});
    }
  }
  std::sort(beams.begin(), beams.end(), [](const Beam& p, const Beam& q) {
    return p.bearing < q.bearing || (p.bearing == q.bearing && p.source.place < q.source.place);
  });
  std::vector<double> bearings, directions;
  for (const Beam& beam : beams) {
    bearings.push_back(beam.bearing);
    const auto [s, c] = base::sin_cos(beam.bearing);
    directions.insert(directions.end(), {c, s});
    pattern.sources.push_back(beam.source);
  }
  pattern.beams.assign(bearings, directions, bearings.front(), bearings.back());
  for (std::size_t b = 0; b < beams.size(); ++b) {
    const auto [s, c] = base::sin_cos(beams[b].own_bearing);
    pattern.beams.cos64[b] = c, pattern.beams.sin64[b] = s;
  }
  return pattern;
}

}  // namespace

bool same_viewpoint(const Scanner& p, const Scanner& q) {
  const ScanSettings &a = p.scan, &b = q.scan;
  return p.mover == q.mover && p.single == q.single && a.X_MS.x == b.X_MS.x && a.X_MS.y == b.X_MS.y &&
         a.X_MS.z == b.X_MS.z && a.range_max == b.range_max && a.range_min == b.range_min;
}

bool SharedViews::add(std::uint32_t first, std::span<const Scanner> scanners, std::span<const BeamPlan* const> plans) {
  std::vector<double> key;
  for (const Scanner& scanner : scanners)
    key.insert(key.end(), {scanner.scan.X_MS.yaw, scanner.scan.fov, static_cast<double>(scanner.scan.samples),
                           static_cast<double>(scanner.scan.resolution)});
  const auto [known, fresh] = known_.try_emplace(std::move(key), static_cast<std::uint32_t>(patterns_.size()));
  if (fresh) patterns_.push_back(merge(scanners, plans));
  if (patterns_[known->second].beams.slack > kMaxSlack) return false;
  views_.push_back({first, static_cast<std::uint32_t>(scanners.size()), known->second});
  return true;
}

}  // namespace sf::raycast
