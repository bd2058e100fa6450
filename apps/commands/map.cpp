// `map`: draws the maps that robots build and send over the network (the ASCII and graphical displays of the thesis).

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "apps/commands/commands.h"
#include "apps/commands/live_map.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/exposure_warning.h"
#include "apps/reports/text.h"
#include "base/elapsed.h"
#include "base/error.h"
#include "maps/map_assembler.h"
#include "maps/map_text.h"
#include "maps/merge.h"
#include "netio/endpoint.h"
#include "netio/farm_lock.h"
#include "netio/packets.h"
#include "netio/port_listener.h"
#include "netio/reading_assembler.h"
#include "netio/sequence_guard.h"
#include "sensors/occupancy.h"
#include "viz/map_figure.h"

namespace sf::apps {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kMapPatience = 10;                     ///< [ms] timeout of one wait for packets
constexpr std::size_t kMapReceiveBuffer = 1u << 22;  ///< [byte] requested from the kernel: large maps arrive in bursts

/// The map of one robot, received on one port.
struct Source {
  std::uint16_t port = 0;
  netio::FarmLock farm;
  std::uint64_t farms = 0;  ///< number of changes of the farm so far
  netio::SequenceGuard sequences{netio::ReadingAssembler::kMaxDropout};
  maps::MapAssembler assembler;
  std::uint16_t robot = 0;
  std::uint64_t used = 0;      ///< datagrams
  std::uint64_t left_out = 0;  ///< datagrams that are late, duplicate, too far ahead, faulty or of another type

  Source(std::uint16_t on, std::uint32_t host) : port(on), farm(host) {}
};

/// True if a valid part comes from the source's current farm and is close in sequence to the previous ones.
bool follow(Source& source, const netio::Endpoint& from, const netio::Header& header, std::int64_t now) {
  if (!source.farm.admit(from, header.session, now)) return false;
  if (source.farms != source.farm.changes()) {
    source.farms = source.farm.changes();
    source.sequences = netio::SequenceGuard(netio::ReadingAssembler::kMaxDropout);
  }
  return !source.sequences.rejects(header.sequence);
}

std::string source_name(const Source& source, sensors::WireFormat wire) {
  return wire == sensors::WireFormat::farm ? "robot " + std::to_string(source.robot)
                                           : "port " + std::to_string(source.port);
}

/// Processes the datagram `bytes`, received from `from` at time `now` [ns].
maps::MapPartStatus take(Source& source, sensors::WireFormat wire, std::span<const std::uint8_t> bytes,
                         const netio::Endpoint& from, std::int64_t now) {
  if (!source.farm.allows(from)) return maps::MapPartStatus::faulty;
  if (wire == sensors::WireFormat::thesis) {
    maps::PlainPart part;
    const bool sound = maps::read_plain(bytes, part) == maps::PartFault::none;
    return sound && source.farm.admit(from, 0, now) ? source.assembler.add_plain_part(bytes)
                                                    : maps::MapPartStatus::faulty;
  }
  netio::Packet packet;
  if (netio::decode(bytes, packet) != netio::PacketStatus::accepted) return maps::MapPartStatus::faulty;
  const auto* reading = std::get_if<netio::Reading>(&packet.body);
  if (reading == nullptr || static_cast<std::uint8_t>(packet.header.type) != sensors::kOccupancy)
    return maps::MapPartStatus::faulty;
  maps::MapPart part;
  if (maps::read_part(reading->payload, part) != maps::PartFault::none) return maps::MapPartStatus::faulty;
  if (!follow(source, from, packet.header, now)) return maps::MapPartStatus::faulty;
  source.robot = packet.header.robot;
  return source.assembler.add_part(packet.header.sequence, reading->payload);
}

/// Returns one plan per port, in the given order. @throws base::InputError for a port that is given twice.
std::vector<netio::StreamSpec> plans_of(const std::vector<std::uint16_t>& ports) {
  std::vector<std::uint16_t> sorted = ports;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end())
    throw base::InputError("--listen: port " + std::to_string(*twice) + " is given twice; give each port once");
  std::vector<netio::StreamSpec> plans;
  for (const std::uint16_t port : ports) plans.push_back({0, 0, netio::PortRule{port, 1}, "map"});
  return plans;
}

/// Displays the maps received on the ports.
class Display {
 public:
  explicit Display(const MapOptions& options)
      : options_(options),
        port_listener_(netio::resolve(options.bind), kMapReceiveBuffer, plans_of(options.map_ports)),
        on_terminal_(isatty(STDOUT_FILENO) != 0) {
    const std::uint32_t host = options.from.empty() ? 0 : netio::resolve(options.from);
    for (const std::uint16_t port : options.map_ports) sources_.emplace_back(port, host);
    if (!options.view && (options.out.empty() || options.interval <= 0.0)) return;
    std::vector<std::string> names;
    for (const std::uint16_t port : options.map_ports) names.push_back("port-" + std::to_string(port));
    if (options.merge) names = {"merged"};
    live_.emplace(LiveMapOptions{"maps", std::move(names), options.view,
                                 options.interval > 0.0 ? options.interval : 1.0, options.page});
  }

  /// Processes pending packets, waiting a moment for the first. @return true if there were any
  bool drain();
  bool all_whole() const;
  bool any() const;
  void redraw();
  void print_maps() const;
  void save(const std::string& file) const;
  /// Passes changed maps on to be drawn.
  void draw_live();
  void finish_live() {
    if (live_) live_->finish();
  }
  void print_status() const;

 private:
  std::vector<maps::OccupancyGrid> pictures() const;
  viz::MapFigure figure_of(const Source* source) const;
  std::string own_file(const std::string& file, const Source& source) const;

  const MapOptions& options_;
  netio::PortListener port_listener_;
  std::vector<Source> sources_;
  bool on_terminal_;
  bool changed_ = false, drawn_ = true;  ///< since the last text, and picture
  std::optional<LiveMap> live_;
};

bool Display::drain() {
  const std::int64_t now = (Clock::now() - Clock::time_point{}).count();
  const auto on_datagram = [&](std::size_t i, std::span<const std::uint8_t> bytes, const netio::Endpoint& from) {
    Source& source = sources_[i];
    const maps::MapPartStatus taken = take(source, options_.wire, bytes, from, now);
    const bool used = taken == maps::MapPartStatus::incomplete || taken == maps::MapPartStatus::complete;
    ++(used ? source.used : source.left_out);
    if (taken == maps::MapPartStatus::complete) changed_ = true, drawn_ = false;
  };
  return port_listener_.drain(kMapPatience, on_datagram) > 0;
}

bool Display::all_whole() const {
  for (const Source& source : sources_)
    if (source.assembler.complete_maps() == 0) return false;
  return true;
}

bool Display::any() const {
  for (const Source& source : sources_)
    if (source.assembler.map() != nullptr) return true;
  return false;
}

/// Returns one map per port that has received one, or a single merged map if they are compatible. Packets of strangers
/// must not end the program.
std::vector<maps::OccupancyGrid> Display::pictures() const {
  std::vector<const maps::OccupancyGrid*> grids;
  for (const Source& source : sources_)
    if (source.assembler.map() != nullptr) grids.push_back(source.assembler.map());
  std::vector<maps::OccupancyGrid> out;
  const bool merged = options_.merge && grids.size() > 1 && maps::merge_problem(grids).empty();
  if (merged)
    out.push_back(maps::merge(grids));
  else
    for (const maps::OccupancyGrid* grid : grids) out.push_back(*grid);
  return out;
}

void Display::redraw() {
  if (!on_terminal_ || !changed_) return;
  changed_ = false;
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) size = {24, 80, 0, 0};
  const std::vector<maps::OccupancyGrid> all = pictures();
  const int down = std::max(1, (size.ws_row - 1) / static_cast<int>(all.size()));
  std::string text = "\x1b[H\x1b[2J";  // cursor home, clear the screen
  for (const maps::OccupancyGrid& grid : all) text += maps::text_within(grid, size.ws_col, down);
  print(text);
  flush_output();
}

void Display::print_maps() const {
  if (on_terminal_) return;
  for (const maps::OccupancyGrid& grid : pictures()) print(maps::grid_text(grid));
}

/// @param source nullptr: all
viz::MapFigure Display::figure_of(const Source* source) const {
  viz::MapFigure figure{options_.merge && sources_.size() > 1 ? "Merged occupancy map" : "Occupancy map", "", {}};
  for (const Source& each : sources_)
    if (each.assembler.map() != nullptr && (source == nullptr || source == &each))
      figure.subtitle += (figure.subtitle.empty() ? "" : ", ") + source_name(each, options_.wire);
  return figure;
}

/// Returns the picture of one port: map.png becomes map_52000.png and so on.
std::string Display::own_file(const std::string& file, const Source& source) const {
  const std::size_t dot = file.rfind('.') > file.rfind('/') + 1 ? file.rfind('.') : std::string::npos;
  const std::string own = file.substr(0, dot) + "_" + std::to_string(source.port);
  return dot == std::string::npos ? own : own + file.substr(dot);
}

void Display::save(const std::string& file) const {
  const std::vector<maps::OccupancyGrid> all = pictures();
  if (all.size() == 1) return viz::draw_map(all[0], figure_of(nullptr), file, options_.page);
  std::size_t i = 0;
  for (const Source& source : sources_)
    if (source.assembler.map() != nullptr)
      viz::draw_map(all[i++], figure_of(&source), own_file(file, source), options_.page);
}

/// Maps that cannot be merged have pictures of their own, the first of them on the page.
void Display::draw_live() {
  if (!live_ || drawn_) return;
  drawn_ = true;
  const bool has_files = !options_.out.empty() && options_.interval > 0.0;
  const std::vector<maps::OccupancyGrid> all = pictures();
  const bool is_one = all.size() == 1 && (options_.merge || sources_.size() == 1);
  if (is_one) return live_->show(0, all[0], figure_of(nullptr), has_files ? options_.out : "");
  for (std::size_t i = 0, row = 0; row < sources_.size(); ++row) {
    const Source& source = sources_[row];
    if (source.assembler.map() == nullptr) continue;
    live_->show(row, all[i++], figure_of(&source), has_files ? own_file(options_.out, source) : "");
  }
}

void Display::print_status() const {
  for (const Source& source : sources_)
    print_message("port {}: {} complete maps, {} incomplete, {} datagrams used and {} ignored{}", source.port,
                  source.assembler.complete_maps(), source.assembler.incomplete_maps(), source.used, source.left_out,
                  source.assembler.map() != nullptr && source.assembler.true_poses() ? ", built from true poses" : "");
  if (const std::uint64_t drops = port_listener_.socket_drops(); drops > 0)
    print_message("{} dropped by the operating system: they arrived faster than they were read",
                  counted(drops, "datagram"));
}

}  // namespace

int map(const MapOptions& options) {
  Display display(options);
  warn_of_exposure(netio::resolve(options.bind), "send maps");
  install_stop_handlers();
  print_message("listening for maps on {} of {}", counted(options.map_ports.size(), "port"), options.bind);
  const auto start = Clock::now();
  auto last = start;
  bool begun = false;
  while (!stop_requested()) {
    if (display.drain()) {
      last = Clock::now();
      begun = true;
    }
    display.redraw();
    display.draw_live();
    if (options.once && display.all_whole()) break;
    if (options.duration > 0.0 && base::seconds_since(start) >= options.duration) break;
    if (begun && base::seconds_since(last) >= options.silence) break;
  }
  display.print_maps();
  display.print_status();
  display.finish_live();
  const bool cut = stop_requested() && options.once && !display.all_whole();
  if (!display.any()) return cut ? interrupted_code() : 1;
  if (!options.out.empty()) {
    display.save(options.out);
    print_message("wrote {}", options.out);
  }
  return cut ? interrupted_code() : 0;
}

}  // namespace sf::apps
