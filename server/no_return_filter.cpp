#include "server/no_return_filter.h"

#include "sensors/laser_noise.h"

namespace sf::server {

std::span<const base::ReadingBlock> NoReturnFilter::apply(std::span<const base::ReadingBlock> readings) {
  if (!infinite_) return readings;
  std::size_t count = 0;
  for (const base::ReadingBlock& r : readings) count += r.hits.empty() ? 0 : r.values.size();
  ranges_.resize(count);
  blocks_.assign(readings.begin(), readings.end());
  double* at = ranges_.data();
  for (base::ReadingBlock& r : blocks_) {
    if (r.hits.empty()) continue;  // not a laser: no beams
    sensors::mark_no_return(r, sensor_set_.row(r).limit, {at, r.values.size()});
    r.values = {at, r.values.size()};
    at += r.values.size();
  }
  return blocks_;
}

}  // namespace sf::server
