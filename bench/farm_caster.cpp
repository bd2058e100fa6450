#include "bench/farm_caster.h"

#include <cmath>

#include "bench/farm_rounds.h"

namespace sf::bench {

namespace {

class FarmCaster final : public Caster {
 public:
  FarmCaster(const Scans& scans, gpu::Device& device)
      : farm_(scans.world, device, scans.rounds, std::llround(1e9 / scans.laser.rate)) {}

  std::string name() const override { return "farm"; }
  void poison() override { farm_.poison(); }
  void cast(std::size_t round) override { farm_.tick(round); }
  std::size_t unwritten() const override { return bench::unwritten(farm_.readings()); }
  double range(std::size_t robot, std::size_t beam) const override { return farm_.readings()[robot].values[beam]; }
  std::uint64_t hash() const override { return hash_ranges(farm_.readings()); }

 private:
  FarmRounds farm_;
};

}  // namespace

std::unique_ptr<Caster> make_farm_caster(const Scans& scans, gpu::Device& device) {
  return std::make_unique<FarmCaster>(scans, device);
}

}  // namespace sf::bench
