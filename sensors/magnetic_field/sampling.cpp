#include "sensors/magnetic_field/sampling.h"

#include <algorithm>

namespace sf::sensors {

namespace {

/// Points per batch: about half a second with 200 000 magnets and no cut-off.
constexpr std::size_t kBatch = std::size_t{SF_FIELD_POINTS} * 1024;

void sum_on_device(MagneticField& field, gpu::Batch& batch, bool again) {
  if (again) {
    batch.begin();
    field.record(batch);
    batch.end();
  }
  field.add_copies(batch);
  batch.run();
}

}  // namespace

std::vector<FieldSum> sample_field(const world::World& world, gpu::Device& device, std::span<const FieldPoint> points,
                                   const FieldSampleOptions& options) {
  base::ThreadPool thread_pool(options.threads);
  MagneticField field(world, device, thread_pool, options.magnitudes, world.magnet_cutoff);
  gpu::Batch batch(device);
  std::vector<FieldSum> sums;
  std::vector<std::uint32_t> ends;
  for (std::size_t first = 0; first < points.size(); first += kBatch) {
    const auto some = points.subspan(first, std::min(kBatch, points.size() - first));
    ends.clear();
    for (std::size_t end = 0; end < some.size();) {
      end = std::min(end + SF_FIELD_POINTS, some.size());
      ends.push_back(static_cast<std::uint32_t>(end));
    }
    const bool again = field.prepare(some, ends);
    field.on_device() ? sum_on_device(field, batch, again) : field.sum_on_host();
    for (std::size_t i = 0; i < some.size(); ++i) sums.push_back(field.at(i / SF_FIELD_POINTS, i % SF_FIELD_POINTS));
    if (options.progress) options.progress(static_cast<double>(sums.size()) / static_cast<double>(points.size()));
  }
  return sums;
}

}  // namespace sf::sensors
