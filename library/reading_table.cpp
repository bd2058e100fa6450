#include "library/reading_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sensors/camera.h"

namespace sf::library {

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

bool at_every_tick(const sensors::SensorSpec& row, double interval) {
  return std::abs(row.rate * interval - 1.0) < 1e-9 && row.phase == 0.0 && row.latency == 0.0;
}

ReadingTable::ReadingTable(const sensors::SensorSet::Group& group, double interval)
    : group_(group), has_hits_(group.type->is_scan || group.type->beams != nullptr) {
  const std::vector<sensors::SensorSpec>& rows = group.rows;
  every_tick_ = std::all_of(rows.begin(), rows.end(), [&](const auto& row) {
    return at_every_tick(row, interval) && row.elements == rows.front().elements && row.width == rows.front().width;
  });
  for (const sensors::SensorSpec& row : rows) {
    view_.elements = std::max<std::size_t>(view_.elements, row.elements);
    widths_.push_back(static_cast<std::uint32_t>(sensors::element_width(*group.type, row)));
    view_.columns = std::max<std::size_t>(view_.columns, widths_.back());
    robots_.push_back(row.mover);
    if (group.type->id == sensors::kCamera)
      image_sizes_.insert(image_sizes_.end(), {row.across, row.elements / row.across});
  }
  view_.type = group.type->name;
  view_.sensors = rows.size();
  times_.resize(rows.size()), bounds_.resize(rows.size()), bound_without_noise_.resize(rows.size());
  sigma_.resize(rows.size()), fresh_.resize(rows.size()), flagged_.resize(rows.size());
  flags_.resize(rows.size() * view_.elements);
  for (std::size_t row = 0; row < rows.size(); ++row) clear(row);
  view_.widths = widths_, view_.image_sizes = image_sizes_;
  view_.robots = robots_, view_.times = times_, view_.fresh = fresh_, view_.flags = flags_;
  view_.bounds = bounds_, view_.bound_without_noise = bound_without_noise_, view_.sigma = sigma_;
}

/// Sets a row to that of a sensor without a reading. Rows in the farm's memory have been read again already.
void ReadingTable::clear(std::size_t row) {
  times_[row] = kNan;
  bounds_[row] = bound_without_noise_[row] = std::numeric_limits<double>::infinity();
  sigma_[row] = 0.0;
  fresh_[row] = flagged_[row] = 0;
  std::fill_n(flags_.begin() + static_cast<std::ptrdiff_t>(row * view_.elements), view_.elements, std::uint8_t{0});
  if (view_.values == nullptr || view_.values != values_.data()) return;
  std::fill_n(values_.begin() + static_cast<std::ptrdiff_t>(row * view_.stride), view_.stride, kNan);
  if (has_hits_)
    std::fill_n(hits_.begin() + static_cast<std::ptrdiff_t>(row * view_.elements), view_.elements, base::kNoHit);
}

void ReadingTable::forget(std::uint32_t first, std::uint32_t end) {
  for (std::size_t row = 0; row < robots_.size(); ++row)
    if (robots_[row] >= first && robots_[row] < end) clear(row);
}

std::size_t ReadingTable::row_of(const base::ReadingBlock& reading) const {
  return group_.first[reading.mover] + reading.sensor;
}

/// Returns whether these readings are equidistant rows of the farm's buffer.
bool ReadingTable::is_one_table(std::span<const base::ReadingBlock> readings) const {
  if (!every_tick_ || readings.size() != view_.sensors) return false;
  const auto step = readings.size() > 1 ? readings[1].values.data() - readings[0].values.data() : 0;
  const auto hit_step = readings.size() > 1 ? readings[1].hits.data() - readings[0].hits.data() : 0;
  if (readings.size() > 1 && step < static_cast<std::ptrdiff_t>(view_.elements * view_.columns)) return false;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const auto k = static_cast<std::ptrdiff_t>(i);
    if (row_of(readings[i]) != i || readings[i].values.data() != readings[0].values.data() + k * step ||
        readings[i].hits.data() != readings[0].hits.data() + k * hit_step)
      return false;
  }
  return true;
}

/// Returns whether the view already shows these readings.
bool ReadingTable::are_in_place(std::span<const base::ReadingBlock> readings) const {
  return std::ranges::all_of(readings, [&](const base::ReadingBlock& reading) {
    const std::size_t row = row_of(reading);
    return reading.values.data() == view_.values + row * view_.stride &&
           reading.hits.data() == view_.hits + row * view_.hit_stride;
  });
}

void ReadingTable::point_at(std::span<const base::ReadingBlock> readings) {
  const bool several = readings.size() > 1;
  const std::size_t length = view_.elements * view_.columns;
  view_.values = readings[0].values.data();
  view_.hits = has_hits_ ? readings[0].hits.data() : nullptr;
  view_.stride = several ? static_cast<std::size_t>(readings[1].values.data() - view_.values) : length;
  view_.hit_stride =
      several ? static_cast<std::size_t>(readings[1].hits.data() - readings[0].hits.data()) : view_.elements;
}

void ReadingTable::copy(std::span<const base::ReadingBlock> readings) {
  const std::size_t length = view_.elements * view_.columns;
  values_.resize(view_.sensors * length, kNan);
  if (has_hits_) hits_.resize(view_.sensors * view_.elements, base::kNoHit);
  for (const base::ReadingBlock& reading : readings) {
    const std::size_t row = row_of(reading);
    const std::size_t width = sensors::element_width(*group_.type, group_.rows[row]);
    for (std::size_t i = 0; i * width < reading.values.size(); ++i)
      std::copy_n(reading.values.begin() + static_cast<std::ptrdiff_t>(i * width), width,
                  values_.begin() + static_cast<std::ptrdiff_t>(row * length + i * view_.columns));
    if (!hits_.empty())
      std::copy(reading.hits.begin(), reading.hits.end(),
                hits_.begin() + static_cast<std::ptrdiff_t>(row * view_.elements));
  }
  view_.values = values_.data(), view_.stride = length;
  view_.hits = hits_.empty() ? nullptr : hits_.data(), view_.hit_stride = view_.elements;
}

/// Copies the values and hits of a table with the first of these rows.
void ReadingTable::copy_rows(const sensorfarm::Readings& from) {
  copy({});
  const std::size_t length = from.elements * from.columns;
  for (std::size_t row = 0; row < from.sensors && from.values != nullptr; ++row) {
    std::copy_n(from.values + row * from.stride, length, values_.begin() + row * view_.stride);
    if (from.hits != nullptr)
      std::copy_n(from.hits + row * from.hit_stride, from.elements, hits_.begin() + row * view_.hit_stride);
  }
}

void ReadingTable::hold() {
  if (view_.values == nullptr || view_.values == values_.data()) return;
  held_ = group_.type->is_scan;
  if (!held_) copy_rows(sensorfarm::Readings(view_));
}

void ReadingTable::note(const base::ReadingBlock& reading) {
  const std::size_t row = row_of(reading);
  times_[row] = 1e-9 * static_cast<double>(reading.time);
  bounds_[row] = reading.bound;
  bound_without_noise_[row] = reading.bound_without_noise;
  sigma_[row] = reading.sigma;
  fresh_[row] = 1;
  const auto flags = std::span(flags_).subspan(row * view_.elements, view_.elements);
  if (flagged_[row] != 0) std::fill(flags.begin(), flags.end(), std::uint8_t{0});
  flagged_[row] = !reading.quality.empty();
  for (std::size_t i = 0; i < reading.quality.size(); ++i) flags[i] = static_cast<std::uint8_t>(reading.quality[i]);
}

void ReadingTable::take(std::span<const base::ReadingBlock> readings) {
  std::fill(fresh_.begin(), fresh_.end(), std::uint8_t{0});
  for (const base::ReadingBlock& reading : readings) note(reading);
  const bool held = std::exchange(held_, false);
  if (is_one_table(readings)) return point_at(readings);
  if (held && are_in_place(readings)) return;
  if (held) copy_rows(sensorfarm::Readings(view_));
  copy(readings);
}

void ReadingTable::go_on(const ReadingTable& before) {
  const sensorfarm::Readings& old = before.view_;
  const auto take = [](auto& rows, const auto& from) { std::copy(from.begin(), from.end(), rows.begin()); };
  take(times_, before.times_), take(bounds_, before.bounds_), take(fresh_, before.fresh_);
  take(bound_without_noise_, before.bound_without_noise_), take(sigma_, before.sigma_);
  take(flagged_, before.flagged_);
  copy_rows(old);
  for (std::size_t row = 0; row < old.sensors && old.values != nullptr; ++row)
    std::copy_n(before.flags_.begin() + row * old.elements, old.elements, flags_.begin() + row * view_.elements);
}

}  // namespace sf::library
