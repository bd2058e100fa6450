#include "bench/farm_caster.h"

#include "bench/poison.h"
#include "farm/farm.h"

namespace sf::bench {

namespace {

class FarmCaster final : public Caster {
 public:
  FarmCaster(const Scans& scans, gpu::Device& device) : farm_(scans.world, device) {
    farm_.hear_all();
    for (const std::vector<base::Pose>& poses : scans.rounds) {
      std::vector<base::Report>& reports = reports_.emplace_back();
      for (std::uint32_t m = 0; m < poses.size(); ++m) reports.push_back({m, 0, poses[m], {}});
    }
    interval_ = std::llround(1e9 / scans.laser.rate);
  }

  std::string name() const override { return "farm"; }
  void poison() override { bench::poison(readings_); }
  void cast(std::size_t round) override {
    readings_ = farm_.tick(time_, reports_[round]);
    time_ += interval_;
  }
  std::size_t unwritten() const override { return bench::unwritten(readings_); }
  double range(std::size_t robot, std::size_t beam) const override { return readings_[robot].values[beam]; }
  std::uint64_t hash() const override { return hash_ranges(readings_); }

 private:
  farm::Farm farm_;
  std::vector<std::vector<base::Report>> reports_;
  std::span<const base::ReadingBlock> readings_;
  std::int64_t time_ = 0;      ///< [ns]
  std::int64_t interval_ = 0;  ///< [ns]
};

}  // namespace

std::unique_ptr<Caster> make_farm_caster(const Scans& scans, gpu::Device& device) {
  return std::make_unique<FarmCaster>(scans, device);
}

}  // namespace sf::bench
