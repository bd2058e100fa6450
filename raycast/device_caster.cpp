#include "raycast/device_caster.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "base/error.h"
#include "raycast/casters.h"
#include "raycast/range_bounds.h"
#include "shaders/laser.comp.h"
#include "shaders/laser_uncertain.comp.h"

namespace sf::raycast {

namespace {

/// Lanes with beams that 32 bits could not certify. The first kernel writes this list and the second reads it.
struct UncertainLanes {
  struct Entry {
    std::uint32_t lane;   ///< row in `LaneTable::lanes`
    std::uint32_t flags;  ///< SF_UNCERTAIN, SF_GRAZING
  };
  std::uint32_t across = 0, down = 0, one = 1;  ///< groups of the second dispatch
  std::uint32_t count = 0;
};

/// Returns the number of movers with scanners, which are sorted by mover.
std::uint32_t count_sensing_movers(const std::vector<Scanner>& scanners) {
  std::uint32_t sensing_movers = 0;
  for (std::size_t i = 0; i < scanners.size(); ++i)
    sensing_movers += i == 0 || scanners[i].mover != scanners[i - 1].mover;
  return sensing_movers;
}

/// Returns the inputs. @throws base::DeviceError if the device cannot run kernels
const CasterInputs& checked(const CasterInputs& in) {
  if (in.context.device.is_host())
    throw base::DeviceError(
        "the caster 'vulkan' requires a Vulkan device, but the device is the host; choose the caster 'host' or 'auto', "
        "or a Vulkan device (Debian: mesa-vulkan-drivers)");
  return in;
}

}  // namespace

DeviceCaster::DeviceCaster(const CasterInputs& in)
    : Caster(checked(in)),
      host_(in, false),
      scene_(in.world, in.plan.configs, in.context.device, in.context.thread_pool, in.context.scene,
             count_sensing_movers(in.plan.scanners)),
      rows_(in.context.device, "due sensors", gpu::Role::upload, gpu::Texel::u32x4,
            gpu::texels_of<RayRow>(std::max<std::size_t>(1, in.plan.scanners.size()))) {
  const gpu::Buffer& ranges = results_.ranges;
  const bool texel_results = !ranges.fits_storage_buffer() || ranges.bytes() > in.context.scene.largest_buffer;
  make_pass(in.context.device, exact_, uploads_.exact(), false, texel_results);
  if (uploads_.single()) make_pass(in.context.device, single_.emplace(), *uploads_.single(), true, texel_results);
}

void DeviceCaster::make_pass(gpu::Device& device, Pass& pass, LaneTable& lanes, bool is_single, bool texel_results) {
  pass.lanes = &lanes;
  const std::uint32_t constants[] = {scene_.has_movers(), is_single, texel_results, device.rounds32()};
  const std::size_t most = lanes.lanes.bytes() / sizeof(Lane);
  pass.uncertain = std::make_unique<gpu::Buffer>(device, "uncertain lanes", gpu::Role::download, gpu::Texel::u32,
                                                 (sizeof(UncertainLanes) + sizeof(UncertainLanes::Entry) * most) / 4);
  if (!pass.uncertain->fits_storage_buffer())
    throw base::DeviceError(
        fmt::format("{} million beams exceed the storage buffers of the device; use fewer robots or beams, or --caster "
                    "host",
                    SF_BEAMS_PER_LANE * plan_.result_lanes / 1'000'000));
  pass.begin();  // no lanes until the first cast
  pass.kernel =
      std::make_unique<gpu::Kernel>(device, is_single ? "laser in 32 bits" : "laser", laser_comp_spv, constants);
  pass.uncertain_kernel = std::make_unique<gpu::Kernel>(
      device, is_single ? "uncertain beams in 32 bits" : "uncertain beams", laser_uncertain_comp_spv, constants);
}

/// Clears the list of uncertain lanes.
void DeviceCaster::Pass::begin() { *reinterpret_cast<UncertainLanes*>(uncertain->host<std::uint32_t>().data()) = {}; }

void DeviceCaster::place() {
  host_.place();
  scene_.place_movers(states_);
}

bool DeviceCaster::prepare(const DueScans& due, bool cast) {
  begin_passes();
  const bool replaced = write_rows(due);
  uploads_.turn_all_beams(due.samples, thread_pool_);
  find_host_scans(due);
  if (cast) host_.scan(due, host_scans_);
  if (!replaced && bound_) return false;
  bind(exact_);
  if (single_) bind(*single_);
  return bound_ = true;
}

/// Clears the lists of uncertain lanes and the flags of the last cast.
void DeviceCaster::begin_passes() {
  for (const std::uint32_t lane : flagged_) results_.beam_flags[lane] = 0;
  flagged_.clear();
  exact_.begin();
  if (single_) single_->begin();
}

/// Builds the lists and rows of all due scanners. @return true if tables were replaced
bool DeviceCaster::write_rows(const DueScans& due) {
  const auto ray_rows = rows_.host<RayRow>().first(due.samples.size());
  const bool replaced = scene_.prepare(due.views, ray_rows);
  thread_pool_.parallel_for(ray_rows.size(), 512, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) {
      const ScannerRow& row = row_of(due.samples[i]);
      ray_rows[i].beams = row.beams;
      ray_rows[i].results = row.out;
      ray_rows[i].range_min = row.range_min;
    }
  });
  return replaced;
}

/// Lists the scans whose lists exceed the device's limits.
void DeviceCaster::find_host_scans(const DueScans& due) {
  host_scans_.clear();
  const auto ray_rows = rows_.host<RayRow>();
  for (std::uint32_t i = 0; i < due.samples.size(); ++i) {
    if (!scene_.needs_host(i)) continue;
    host_scans_.push_back(i);
    ray_rows[i].results = plan_.result_lanes;
  }
  host_scans_in_all_ += host_scans_.size();
}

void DeviceCaster::bind(Pass& pass) {
  const std::vector<gpu::TableBinding> tables{{"rows", &rows_},
                                              {"lanes", &pass.lanes->lanes},
                                              {"bearings", &uploads_.mid_bearings()},
                                              {"directions", &uploads_.directions64()},
                                              {"lists", &scene_.lists()},
                                              {"segment_ids", &scene_.segment_ids()},
                                              {"mover_rows", &scene_.mover_rows()},
                                              {"segments", &scene_.segments()},
                                              {"models", &scene_.models()},
                                              {"range_texels", &results_.ranges},
                                              {"hit_texels", &results_.hits},
                                              {"ranges", &results_.ranges},
                                              {"hits", &results_.hits},
                                              {"uncertain", pass.uncertain.get()}};
  pass.kernel->bind(tables);
  pass.uncertain_kernel->bind(tables);
}

void DeviceCaster::record(gpu::Batch& batch) {
  batch.dispatch(*exact_.kernel, exact_.lanes->groups, 0);
  if (single_) batch.dispatch(*single_->kernel, single_->lanes->groups, 0);
  batch.barrier();
  batch.dispatch(*exact_.uncertain_kernel, *exact_.uncertain, 0);
  if (single_) batch.dispatch(*single_->uncertain_kernel, *single_->uncertain, 0);
}

void DeviceCaster::add_copies(gpu::Batch& batch, const DueScans& due, bool results) {
  scene_.upload(batch);
  batch.upload(rows_, 0, due.samples.size() * sizeof(RayRow));
  const auto send = [&batch](const Pass& pass) {
    batch.upload(*pass.uncertain, 0, sizeof(UncertainLanes));
    batch.download(*pass.uncertain, 0, pass.uncertain->bytes());
  };
  send(exact_);
  if (single_) send(*single_);
  for (const std::uint32_t i : host_scans_) results_.upload(batch, row_of(due.samples[i]));
  if (results) download(batch, due);
}

/// Copies results to the host, with one copy for scans with adjacent results.
void DeviceCaster::download(gpu::Batch& batch, const DueScans& due) {
  for (std::size_t i = 0; i < due.samples.size();) {
    const std::size_t first = row_of(due.samples[i]).out;
    std::size_t lanes = 0;
    for (; i < due.samples.size() && row_of(due.samples[i]).out == first + lanes; ++i)
      lanes += row_of(due.samples[i]).plan.lanes();
    batch.download(results_.ranges, sizeof(LaneRanges) * first, sizeof(LaneRanges) * lanes);
    batch.download(results_.hits, sizeof(LaneHits) * first, sizeof(LaneHits) * lanes);
  }
}

void DeviceCaster::collect(const DueScans& due) {
  take_uncertain(due, exact_);
  if (single_) take_uncertain(due, *single_);
}

/// Reads the flags of the last cast, except for scans that the host computed.
void DeviceCaster::take_uncertain(const DueScans& due, Pass& pass) {
  const std::span<const std::uint32_t> words = pass.uncertain->host<std::uint32_t>();
  const std::uint32_t count = reinterpret_cast<const UncertainLanes*>(words.data())->count;
  const std::span<const Lane> lanes = pass.lanes->lanes.host<Lane>();
  const auto* entries =
      reinterpret_cast<const UncertainLanes::Entry*>(words.data() + sizeof(UncertainLanes) / sizeof words[0]);
  for (const UncertainLanes::Entry& entry : std::span(entries, count)) {
    const Lane& lane = lanes[entry.lane];
    const std::uint32_t place = row_of(due.samples[lane.row]).out + lane.lane;
    std::uint32_t& flags = results_.beam_flags[place];
    if (scene_.needs_host(lane.row) || flags != 0) continue;  // padding repeats the last lane
    flags = entry.flags;
    flagged_.push_back(place);
    uncertain_beams_ += static_cast<std::uint64_t>(std::popcount(flags / SF_UNCERTAIN));
  }
}

SensorStats DeviceCaster::stats() const {
  const DeviceScene::Counts scene = scene_.counts();
  SensorStats stats = host_.stats();
  stats.uncertain += uncertain_beams_;
  stats.cells_built += scene.cells_built;
  stats.movers_in_range += scene.movers_in_range;
  stats.movers_visible += scene.movers_visible;
  stats.host_scans = host_scans_in_all_;
  return stats;
}

constinit const CasterType device_caster{
    .name = "vulkan",
    .summary = "kernels on the device",
    .on_device = true,
    .describe = [] { return std::string("Vulkan kernels"); },
    .bound = exact_bound,
    .make = [](const CasterInputs& in) -> std::unique_ptr<Caster> { return std::make_unique<DeviceCaster>(in); },
};

}  // namespace sf::raycast
