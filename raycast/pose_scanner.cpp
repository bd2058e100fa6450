#include "raycast/pose_scanner.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "gpu/group_counts.h"
#include "raycast/pose_scanner_records.h"
#include "robots/device/device_tables.h"
#include "shaders/pose_scans.comp.h"

namespace sf::raycast {

namespace {

using gpu::Role;
using robots::table_of;

}  // namespace

/// The tables of all beams and surfaces.
struct PoseScanner::Contents {
  Contents(const world::World& world, std::span<const Scanner> scanners);
  void add_scan(const Scanner& scanner);
  void add_outline(const world::Mover& mover);

  PoseScanCounts counts{};
  std::vector<PoseScanRow> scans;
  std::vector<Noise> noises;
  std::vector<std::uint32_t> firsts{0}, scan_rows, samples;
  std::vector<BeamDirection> directions;
  robots::WallTables walls;
  std::vector<PoseScanOutline> outlines;
  std::vector<robots::FleetEdge> edges;
};

PoseScanner::Contents::Contents(const world::World& world, std::span<const Scanner> scanners)
    : walls(robots::wall_tables(world.walls, [](const world::Segment& wall) { return wall.seen_by_laser; })) {
  for (const Scanner& scanner : scanners) add_scan(scanner);
  for (const world::Mover& mover : world.movers) add_outline(mover);
  counts = {static_cast<std::uint32_t>(directions.size()),
            std::max(static_cast<std::uint32_t>(world.movers.size()) / std::max(world.copies, 1u), 1u), walls.count, 0};
  if (scans.empty()) scans.emplace_back(), scan_rows.emplace_back(), samples.emplace_back(), directions.emplace_back();
  if (outlines.empty()) outlines.emplace_back();
  if (edges.empty()) edges.emplace_back();
}

void PoseScanner::Contents::add_scan(const Scanner& scanner) {
  const ScanSettings& scan = scanner.scan;
  const base::Pose& mount = scan.X_MS;
  for (const std::uint32_t sample : plan_beams(scan, false).samples) {
    const glm::dvec2 d = base::direction(bearing_of(scan, sample));
    directions.push_back({d.x, d.y});
    scan_rows.push_back(static_cast<std::uint32_t>(scans.size()));
    samples.push_back(sample);
  }
  scans.push_back({mount.x, mount.y, mount.z, mount.yaw, scan.range_min, scan.range_max, scan.noise.range_sigma,
                   scan.noise.range_proportional, scanner.mover, 0, 0, 0});
  noises.push_back({scanner.mover, scanner.sensor});
  firsts.push_back(static_cast<std::uint32_t>(directions.size()));
}

void PoseScanner::Contents::add_outline(const world::Mover& mover) {
  const auto first = static_cast<std::uint32_t>(edges.size());
  double radius = 0.0;
  for (const world::Segment& s : mover.body) {
    if (!s.seen_by_laser) continue;
    edges.push_back({s.a.x, s.a.y, s.b.x, s.b.y, s.z_min, s.z_max, 0, 0, 0, 0});
    radius = std::max({radius, length(s.a), length(s.b)});
  }
  outlines.push_back({radius, first, static_cast<std::uint32_t>(edges.size()) - first});
}

std::string PoseScanner::refusal(std::span<const Scanner> scanners) {
  for (const Scanner& scanner : scanners) {
    if (scanner.scan.noise.angle_sigma > 0.0)
      return fmt::format("'{}' has angular noise, which the host draws for each scan", scanner.scan.name);
    if (scanner.single) return fmt::format("'{}' measures in 32 bits", scanner.scan.name);
  }
  return "";
}

PoseScanner::PoseScanner(const world::World& world, std::span<const Scanner> scanners, const Episodes& episodes,
                         gpu::Device& device, const gpu::Buffer& poses, const gpu::Buffer& absent)
    : PoseScanner(Contents(world, scanners), episodes, device, poses, absent) {}

PoseScanner::PoseScanner(const Contents& contents, const Episodes& episodes, gpu::Device& device,
                         const gpu::Buffer& poses, const gpu::Buffer& absent)
    : episodes_(episodes),
      noises_(contents.noises),
      firsts_(contents.firsts),
      counts_(table_of(device, "counts of scans", Role::upload, std::vector{contents.counts})),
      scans_(table_of(device, "scans from poses", Role::upload, contents.scans)),
      draws_(table_of(device, "draws of scans", Role::upload, std::vector<PoseScanDraw>(contents.scans.size()))),
      scan_rows_(table_of(device, "scans of beams", Role::upload, contents.scan_rows)),
      samples_(table_of(device, "samples of beams", Role::upload, contents.samples)),
      directions_(table_of(device, "beams from poses", Role::upload, contents.directions)),
      walls_(table_of(device, "visible walls", Role::upload, contents.walls.walls)),
      nodes_(table_of(device, "tree of visible walls", Role::upload, contents.walls.nodes)),
      outlines_(table_of(device, "outlines of movers", Role::upload, contents.outlines)),
      edges_(table_of(device, "edges of movers", Role::upload, contents.edges)),
      ranges_(device, "ranges from poses", Role::download, gpu::Texel::u32x4, contents.directions.size() / 2 + 1),
      groups_(table_of(device, "groups of beams", Role::upload, std::vector<std::uint32_t>(4))),
      kernel_(device, "scans from poses", pose_scans_comp_spv, robots::loop_constants(device)),
      reading_(device) {
  if (!ranges_.fits_storage_buffer())
    throw base::DeviceError(
        fmt::format("{} beams exceed the storage buffers of the device; use fewer robots or beams", firsts_.back()));
  kernel_.bind({{"counts", &counts_},
                {"poses", &poses},
                {"absent", &absent},
                {"scans", &scans_},
                {"draws", &draws_},
                {"scan_rows", &scan_rows_},
                {"samples", &samples_},
                {"directions", &directions_},
                {"walls", &walls_},
                {"nodes", &nodes_},
                {"outlines", &outlines_},
                {"edges", &edges_},
                {"ranges", &ranges_}});
  const std::size_t invocations = std::size_t{firsts_.back()} * robots::loop_constants(device)[0];
  gpu::write_counts(gpu::groups_for(invocations, kernel_.group_size()), groups_);
  reading_.begin();
  reading_.end();
  for (std::size_t i = 0; i < noises_.size(); ++i) write_draw(i, 0);
}

/// Writes the key of a scanner's random numbers (base::random_words).
void PoseScanner::write_draw(std::size_t scanner, std::uint32_t first) {
  const auto [mover, sensor] = noises_[scanner];
  const base::RandomKey key = episodes_.key(base::RandomStream::range_noise, mover, sensor);
  draws_.host<PoseScanDraw>()[scanner] = {key.sigma,
                                          static_cast<std::uint32_t>(key.seed),
                                          static_cast<std::uint32_t>(key.seed >> 32),
                                          key.a,
                                          key.b << 8 | static_cast<std::uint32_t>(key.stream),
                                          first,
                                          0};
  drawn_ = true;
}

void PoseScanner::prepare(gpu::Batch& batch, bool again) {
  if (!again) ++counts_.host<PoseScanCounts>()[0].ticks;
  batch.upload(counts_, 0, counts_.bytes());
  if (std::exchange(drawn_, false)) batch.upload(draws_, 0, draws_.bytes());
}

void PoseScanner::restart(std::uint32_t copy) {
  const std::uint32_t now = counts_.host<PoseScanCounts>()[0].ticks;
  for (std::size_t i = 0; i < noises_.size(); ++i)
    if (episodes_.copies().copy_of(noises_[i].mover) == copy) write_draw(i, now);
}

void PoseScanner::record(gpu::Batch& batch) {
  batch.dispatch(kernel_, groups_, 0);
  for (const gpu::Buffer* table : {&counts_, &scans_, &draws_, &scan_rows_, &samples_, &directions_, &walls_, &nodes_,
                                   &outlines_, &edges_, &groups_})
    batch.upload(*table, 0, table->bytes());
}

void PoseScanner::read() {
  reading_.download(ranges_, 0, ranges_.bytes());
  reading_.run();
  const auto ranges = ranges_.host<double>().first(firsts_.back());
  if (std::ranges::any_of(ranges, [](double range) { return std::isnan(range); }))
    throw base::DeviceError("a beam passed more surfaces than this device can test; use the caster 'host'");
}

std::span<const double> PoseScanner::ranges(std::size_t scanner) {
  return ranges_.host<double>().subspan(firsts_[scanner], firsts_[scanner + 1] - firsts_[scanner]);
}

}  // namespace sf::raycast
