#include "bench/map_comparison.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "base/hash.h"
#include "base/thread_pool.h"
#include "bench/farm_rounds.h"
#include "bench/scans.h"
#include "maps/grid_update.h"
#include "sensors/occupancy_batch.h"
#include "tests/maps/plain_scan.h"
#include "tests/sensors/scenes.h"

namespace sf::bench {

namespace {

constexpr double kCell = 0.03;  // [m]

/// Scans of one round.
struct Round {
  std::vector<base::Pose> X_WS;
  std::vector<std::vector<double>> ranges;
};

std::vector<Round> rounds_of(const Scans& scans, gpu::Device& device) {
  FarmRounds farm(scans.world, device, scans.rounds, 1'000'000'000);
  std::vector<Round> rounds;
  for (std::size_t i = 0; i < scans.rounds.size(); ++i) {
    farm.tick(i);
    Round round;
    for (const base::ReadingBlock& r : farm.readings()) {
      round.X_WS.push_back(r.X_WS);
      round.ranges.emplace_back(r.values.begin(), r.values.end());
    }
    rounds.push_back(std::move(round));
  }
  return rounds;
}

std::vector<sensors::MapSettings> map_settings_of(const Scans& scans, bool weighs) {
  const auto words = static_cast<std::uint32_t>(std::ceil((2.0 * scans.laser.range_max + 0.5) / (4.0 * kCell)));
  const double half = 2.0 * kCell * words;
  std::vector<sensors::MapSettings> map_settings;
  for (const base::Pose& X : scans.rounds[0]) {
    sensors::MapSettings settings;
    settings.grid = {X.x - half, X.y + half, kCell, words, words};
    if (weighs) settings.odds = maps::LogOddsUpdate{};
    settings.fov = scans.laser.fov;
    settings.samples = scans.laser.samples;
    settings.range_max = scans.laser.range_max;
    map_settings.push_back(settings);
  }
  return map_settings;
}

class Mapper {
 public:
  virtual ~Mapper() = default;
  virtual std::string name() const = 0;
  virtual void update(const Round& round) = 0;
  virtual std::vector<std::uint32_t> words(std::uint32_t map) const = 0;
};

class FarmMapper : public Mapper {
 public:
  FarmMapper(gpu::Device& device, const std::vector<sensors::MapSettings>& map_settings)
      : batch_(device, thread_pool_, map_settings, device.info().software) {
    for (std::uint32_t i = 0; i < map_settings.size(); ++i) wanted_.push_back(i);
  }
  std::string name() const override { return "farm"; }
  void update(const Round& round) override {
    scans_.clear();
    for (std::uint32_t i = 0; i < wanted_.size(); ++i) scans_.push_back({i, round.X_WS[i], round.ranges[i]});
    batch_.update(scans_, wanted_);
  }
  std::vector<std::uint32_t> words(std::uint32_t map) const override {
    const auto words = batch_.words(map);
    return {words.begin(), words.end()};
  }

 private:
  base::ThreadPool thread_pool_;
  sensors::MapBatch batch_;
  std::vector<std::uint32_t> wanted_;
  std::vector<sensors::MapScan> scans_;
};

/// Marks the cells of each beam, on all cores.
class PlainMapper : public Mapper {
 public:
  PlainMapper(const std::vector<sensors::MapSettings>& map_settings, bool weighs)
      : map_settings_(map_settings), weighs_(weighs) {
    for (const sensors::MapSettings& settings : map_settings) {
      grids_.emplace_back(settings.grid);
      odds_.emplace_back(settings.grid, maps::LogOddsUpdate{});
    }
    beams_ = maps::beam_directions(map_settings[0].fov, map_settings[0].samples);
    ends_.resize(thread_pool_.threads(), std::vector<std::uint32_t>(beams_.size()));
    covered_.resize(thread_pool_.threads(), maps::OccupancyGrid(map_settings[0].grid));  // the same size for all
  }
  std::string name() const override { return "plain C++ mapper, -O3"; }
  void update(const Round& round) override {
    thread_pool_.parallel_for(map_settings_.size(), 4, [&](std::size_t first, std::size_t last, unsigned thread) {
      for (std::size_t i = first; i < last; ++i) {
        const maps::ScanView view{round.X_WS[i], round.ranges[i], beams_, map_settings_[i].range_min,
                                  map_settings_[i].range_max};
        const maps::TracedScan scan = maps::trace_scan(map_settings_[i].grid, view, ends_[thread]);
        if (weighs_) trial::add_plainly(odds_[i], scan, ends_[thread], covered_[thread]);
        if (!weighs_) trial::add_plainly(grids_[i], scan, ends_[thread]);
      }
    });
  }
  std::vector<std::uint32_t> words(std::uint32_t map) const override {
    return weighs_ ? trial::plain_words(odds_[map]) : grids_[map].words;
  }

 private:
  base::ThreadPool thread_pool_;
  const std::vector<sensors::MapSettings>& map_settings_;
  bool weighs_;
  std::vector<maps::OccupancyGrid> grids_;
  std::vector<maps::LogOddsGrid> odds_;
  std::vector<glm::dvec2> beams_;
  std::vector<maps::OccupancyGrid> covered_;
  std::vector<std::vector<std::uint32_t>> ends_;  ///< per thread
};

/// Result of one method.
struct MapMethodResult : Timing {
  std::size_t different = 0;  ///< words in all maps that differ from the plain mapper's
  std::uint64_t hash = 0;     ///< of all maps after the last turn
};

void check_accuracy(const Mapper& mapper, const Mapper& plain, std::size_t robots, MapMethodResult& method_result) {
  for (std::uint32_t i = 0; i < robots; ++i) {
    const auto words = mapper.words(i);
    const auto right = plain.words(i);
    for (std::size_t w = 0; w < right.size(); ++w) method_result.different += words[w] != right[w];
    method_result.hash = base::hash_bytes(words.data(), 4 * words.size(), method_result.hash);
  }
}

}  // namespace

Report compare_maps(gpu::Device& device, std::uint32_t robots, double range, bool weighs, std::size_t repeats) {
  const Scans scans = make_scans("cave", load_cave(), robots, scenes::laser(361, M_PI, range));
  const std::vector<Round> rounds = rounds_of(scans, device);
  const std::vector<sensors::MapSettings> map_settings = map_settings_of(scans, weighs);
  std::vector<std::unique_ptr<Mapper>> mappers;
  mappers.push_back(std::make_unique<FarmMapper>(device, map_settings));
  mappers.push_back(std::make_unique<PlainMapper>(map_settings, weighs));
  std::vector<MapMethodResult> results;
  for (const auto& mapper : mappers) {
    mapper->update(rounds[0]);
    results.emplace_back().method = mapper->name();
  }
  take_turns(results, repeats, mappers.back()->name(), [&](std::size_t k, std::size_t turn) {
    const Cost start = now();
    mappers[k]->update(rounds[turn % rounds.size()]);
    return since(start);
  });
  for (std::size_t k = 0; k < mappers.size(); ++k) check_accuracy(*mappers[k], *mappers.back(), robots, results[k]);

  Report report{"maps", "",
                "robots,beams,range_m,log_odds,method,wall_ms_median,cpu_ms_median,ratio_to_plain,cpu_ratio_to_plain,"
                "words_different,hash"};
  report.text = fmt::format("\n{} maps of 3 cm cells, {} beams up to {:g} m{}\n{}  words that differ\n", robots,
                            scans.rays(), range, weighs ? ", log odds" : "", heading("Mbeams/s"));
  const auto csv = [&](const MapMethodResult& e) {
    return fmt::format("{},{},{:g},{},\"{}\",{:.3f},{:.3f},{:.3f},{:.3f},{},{}\n", robots, scans.rays(), range,
                       weighs ? 1 : 0, e.method, 1e3 * e.typical.wall_s, 1e3 * e.typical.cpu_s, e.ratio, e.cpu_ratio,
                       e.different, base::hash_hex(e.hash));
  };
  add_methods(report, results, csv, [&](const MapMethodResult& e) {
    return row(e, static_cast<double>(scans.rays())) + fmt::format(" {:>18}\n", e.different);
  });
  return report;
}

}  // namespace sf::bench
