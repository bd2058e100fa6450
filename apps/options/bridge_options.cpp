#include "apps/options/bridge_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "apps/options/address.h"
#include "apps/reports/exposure_warning.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "base/installation.h"
#include "bridges/player_bridge.h"
#include "bridges/ros2_bridge.h"
#include "bridges/viewer.h"

namespace sf::apps {

namespace {

/// Folders from which users of bridges may load worlds: the folder of the run's world and the installed one.
std::vector<std::string> world_folders(const world::World& world) {
  namespace fs = std::filesystem;
  std::vector<std::string> folders;
  std::error_code ignored;
  const fs::path own = fs::path(world.file).parent_path();
  for (const fs::path& folder : {own.empty() ? fs::path(".") : own, fs::path(base::installed_file("worlds"))})
    if (fs::is_directory(folder, ignored) &&
        std::none_of(folders.begin(), folders.end(),
                     [&](const std::string& other) { return fs::equivalent(other, folder, ignored); }))
      folders.push_back(folder.string());
  return folders;
}

}  // namespace

void print_taken_names(const std::vector<std::string>& notes) {
  constexpr std::size_t kMost = 3;
  for (std::size_t i = 0; i < std::min(notes.size(), kMost); ++i) print_message("topics: {}", notes[i]);
  if (notes.size() <= kMost) return;
  const std::size_t more = notes.size() - kMost;
  print_message("topics: {} taken", more == 1 ? "1 more name is" : fmt::format("{} more names are", more));
}

LiveBridges::LiveBridges(const BridgeOptions& options, const world::World& world, const sensors::SensorSet& sensor_set,
                         const scenarios::RunSettings& settings, bool simulated, server::DriveRelay* drives)
    : options_(options),
      world_(world),
      sensor_set_(sensor_set),
      settings_(settings),
      simulated_(simulated),
      drives_(drives) {
  settings_.images.compressed = settings_.images.raw = true;  // encoded for subscribers alone
  if (!options.any()) return;
  info_ = scenarios::run_info(world, sensor_set, settings_);
  print_taken_names(record::name_frames(info_));
  if (options.ros2) open_ros2();
  if (!options.player.empty()) {
    open_player();
    warn_of_exposure(read_own_address(options.player, "--player").address,
                     simulated || drives != nullptr ? "read sensors and drive robots" : "read sensors",
                     "Player has no passwords", "--player");
  }
  if (options.view) open_view();
  for (const std::string& line : bridges_.describe()) print_message("{}", line);
}

void LiveBridges::open_ros2() {
  const bridges::Scene scene{world_, sensor_set_, info_, simulated_,
                             simulated_ ? world_folders(world_) : std::vector<std::string>()};
  bridges_.add(std::make_unique<bridges::Ros2Bridge>(bridges::ros2_options(*options_.ros2), scene));
}

void LiveBridges::open_player() {
  const netio::Endpoint bind = read_own_address(options_.player, "--player");
  bridges::player::Follows follows;
  if (drives_ != nullptr) follows = [drives = drives_](std::uint32_t mover) { return drives->follows(mover); };
  auto player = std::make_unique<bridges::PlayerBridge>(bridges::Scene{world_, sensor_set_, info_, simulated_}, bind,
                                                        bridges::player::kSilent, 2, follows);
  options_.player = netio::endpoint_text(player->endpoint());
  bridges_.add(std::move(player));
}

void LiveBridges::open_view() {
  const bridges::ViewerOptions view{*options_.view,
                                    simulated_ ? bridges::ViewerMode::run : bridges::ViewerMode::service};
  auto viewer = std::make_unique<bridges::Viewer>(bridges::Scene{world_, sensor_set_, info_, simulated_}, view);
  options_.view->port = viewer->server().port();
  bridges_.add(std::move(viewer));
}

void LiveBridges::prepare_change() {
  bridges_.remove_if([](const bridges::Bridge& bridge) { return !bridge.keeps_on(); });
}

void LiveBridges::show_scene(bool is_new) {
  if (!options_.any()) return;
  info_ = scenarios::run_info(world_, sensor_set_, settings_);
  record::name_frames(info_);
  bridges_.show_scene(is_new);
  const auto reopen = [](auto&& open) {
    try {
      open();
    } catch (const base::InputError& error) {
      print_message("{}", error.what());  // another program has taken the port
    }
  };
  if (!options_.player.empty()) reopen([this] { open_player(); });
  if (options_.view) reopen([this] { open_view(); });
}

void LiveBridges::write(const base::TickRecord& record) {
  bridges_.take(requests_);  // other requests are answered, but change nothing
  for (const bridges::Command& command : requests_.commands)
    if (drives_ != nullptr) drives_->command(command.mover, command.twist);
  bridges_.publish(record, {});
}

}  // namespace sf::apps
