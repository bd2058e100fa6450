#include "viz/range_layer.h"

#include <algorithm>
#include <cmath>

#include "base/bearing.h"
#include "base/echo.h"
#include "base/rigid_transform.h"
#include "viz/color.h"
#include "viz/theme.h"
#include "viz/view_sector.h"

namespace sf::viz {
namespace {

using Message = record::StandardTopic::Message;

constexpr double kEchoDot = 3.6;  // [px]
constexpr SectorStyle kEchoCone{theme::kFieldOfView, 0.22, 0.8, 24};
constexpr SectorStyle kOpenCone{theme::kFieldOfView, 0.08, 0.3, 24};

void draw_scan(Axes& axes, const RangeReading& reading) {
  const record::SensorInfo& sensor = *reading.sensor;
  const base::RangeLimits limits{sensor.range_min, sensor.range_max};
  const auto samples = static_cast<std::uint32_t>(std::min<std::size_t>(sensor.samples, reading.values.size()));
  const base::RigidTransform X_WS = base::transform_of(reading.X_WS, reading.tilt);
  std::vector<glm::dvec2> outline{axes.pixel({reading.X_WS.x, reading.X_WS.y})};
  std::vector<Line> echoes;
  for (std::uint32_t i = 0; i < samples; ++i) {
    const double range = reading.values[i], bearing = base::bearing_of(sensor.fov, samples, i);
    if (std::isnan(range)) continue;
    const glm::dvec2 end_W{
        transform(X_WS, std::clamp(range, limits.min, limits.max) * glm::dvec3(base::direction(bearing), 0.0))};
    const glm::dvec2 end = axes.pixel(end_W);
    outline.push_back(end);
    if (base::echo_of(range, limits) == base::Echo::valid) echoes.push_back({end, end});
  }
  axes.canvas().polygon(outline, with_opacity(theme::kFieldOfView, 0.14));
  axes.canvas().lines(echoes, kEchoDot, theme::kFieldOfView);
}

void draw_cone(Axes& axes, const RangeReading& reading, const record::StandardTopic& cone, double range) {
  if (std::isnan(range)) return;
  const base::RangeLimits limits{cone.range_min, cone.range_max};
  const bool is_open = base::echo_of(range, limits) == base::Echo::none;
  draw_view_sector(axes, compose(reading.X_WS, cone.X_SE), -0.5 * cone.fov, 0.5 * cone.fov,
                   std::clamp(range, limits.min, limits.max), is_open ? kOpenCone : kEchoCone);
}

bool is_cone(const record::StandardTopic& element) { return element.message == Message::range; }

}  // namespace

bool has_ranges(const record::RunInfo& info, const record::SensorInfo& sensor) {
  const record::SensorTypeInfo* const type = record::find_sensor_type(info, sensor.type);
  return (type != nullptr && type->is_scan) || std::any_of(sensor.standard.begin(), sensor.standard.end(), is_cone);
}

void draw_ranges(Axes& axes, const RangeReading& reading) {
  const std::vector<record::StandardTopic>& elements = reading.sensor->standard;
  if (elements.empty()) return draw_scan(axes, reading);
  const std::size_t width = reading.values.size() / elements.size();
  for (const record::StandardTopic& element : elements)
    if (is_cone(element) && element.element * width < reading.values.size())
      draw_cone(axes, reading, element, reading.values[element.element * width]);
}

}  // namespace sf::viz
