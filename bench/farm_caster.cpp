#include "bench/farm_caster.h"

#include <cmath>

#include "bench/farm_rounds.h"

namespace sf::bench {

namespace {

class FarmCaster final : public Caster {
 public:
  FarmCaster(const Scans& scans, gpu::Device& device, std::string name)
      : name_(std::move(name)), farm_(scans.world, device, scans.rounds, std::llround(1e9 / scans.laser.rate)) {}

  std::string name() const override { return name_; }
  void poison() override { farm_.poison(); }
  void cast(std::size_t round) override { farm_.tick(round); }
  std::size_t unwritten() const override { return bench::unwritten(farm_.readings()); }
  double range(std::size_t robot, std::size_t beam) const override { return farm_.readings()[robot].values[beam]; }
  std::uint64_t hash() const override { return hash_ranges(farm_.readings()); }

 private:
  std::string name_;
  FarmRounds farm_;
};

}  // namespace

std::unique_ptr<Caster> make_farm_caster(const Scans& scans, gpu::Device& device, const std::string& name) {
  return std::make_unique<FarmCaster>(scans, device, name);
}

}  // namespace sf::bench
