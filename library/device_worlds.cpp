#include "sensorfarm/device_worlds.h"

#include "library/device_worlds_state.h"
#include "library/errors.h"

namespace sensorfarm {

using namespace sf;

DeviceWorlds::DeviceWorlds(const std::string& world, const Options& options)
    : state_(library::translated([&] {
        return std::make_shared<State>(library::WorldSource{library::found(world), ""}, options);
      })) {}

DeviceWorlds::DeviceWorlds(std::shared_ptr<State> state) : state_(std::move(state)) {}
DeviceWorlds::DeviceWorlds(DeviceWorlds&&) noexcept = default;
DeviceWorlds& DeviceWorlds::operator=(DeviceWorlds&&) noexcept = default;
DeviceWorlds::~DeviceWorlds() = default;

DeviceWorlds DeviceWorlds::from_text(const std::string& text, const Options& options, const std::string& name) {
  return library::translated([&] {
    return DeviceWorlds(std::make_shared<State>(library::WorldSource{name, text}, options));
  });
}

void DeviceWorlds::step(std::span<const Twist> commands) {
  library::translated([&] { state_->step(commands); });
}
void DeviceWorlds::reset(std::span<const std::uint32_t> worlds, std::span<const std::uint64_t> seeds,
                         const WorldStarts& starts) {
  library::translated([&] { state_->reset(worlds, seeds, starts); });
}

std::size_t DeviceWorlds::copies() const { return state_->world.copies; }
std::size_t DeviceWorlds::size() const { return state_->poses.size(); }
const std::vector<Robot>& DeviceWorlds::robots() const { return state_->robots; }
double DeviceWorlds::interval() const { return state_->world.interval; }

std::span<const Pose> DeviceWorlds::poses() const {
  library::translated([&] { state_->read_states(); });
  return state_->poses;
}
std::span<const Twist> DeviceWorlds::velocities() const {
  library::translated([&] { state_->read_states(); });
  return state_->velocities;
}
std::span<const std::uint8_t> DeviceWorlds::contacts() const {
  library::translated([&] { state_->read_states(); });
  return state_->fleet->contacts();
}
Readings DeviceWorlds::readings() const {
  library::translated([&] { state_->read_ranges(); });
  return state_->readings;
}

void DeviceWorlds::observe(const ObservationOptions& options) {
  library::translated([&] { state_->observe(options); });
}
void DeviceWorlds::set_goals(std::span<const double> goals) {
  library::translated([&] { state_->set_goals(goals); });
}
std::size_t DeviceWorlds::agents() const { return state_->observed ? state_->observed->rows.size() : 0; }
std::size_t DeviceWorlds::columns() const { return state_->observed ? state_->observed->columns() : 0; }
std::span<const float> DeviceWorlds::observations() const {
  library::translated([&] { state_->read_observations(); });
  return state_->observer->values();
}
std::span<const double> DeviceWorlds::distances() const {
  library::translated([&] { state_->read_observations(); });
  return state_->observer->distances();
}
std::span<const double> DeviceWorlds::progress() const {
  library::translated([&] { state_->read_observations(); });
  return state_->observer->progress();
}

DeviceArray DeviceWorlds::array(DeviceTable table) {
  return library::translated([&] { return state_->array(table); });
}
void DeviceWorlds::update() {
  library::translated([&] { state_->update(); });
}

}  // namespace sensorfarm
