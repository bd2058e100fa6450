// `light`: the traffic lights of a world, sent as SPaT and MAP like those of a street.

#include <fmt/format.h>

#include <algorithm>

#include "apps/commands.h"
#include "apps/default_robot.h"
#include "apps/option_parsers.h"
#include "apps/stop_signals.h"
#include "apps/text.h"
#include "base/elapsed.h"
#include "base/error.h"
#include "base/suggest.h"
#include "netio/outbox.h"
#include "netio/server/signal_messages.h"
#include "netio/v2x/frame.h"
#include "world/fields.h"
#include "world/roads/roads.h"

namespace sf::apps {

namespace {

/// "light1=flashing red" in place of that light's plan.
void hold_state(world::World& world, const std::string& setting) {
  const auto [name, word] = *read_setting(setting);
  std::vector<std::string_view> names;
  world::Light* found = nullptr;
  for (world::Light& light : world.lights) {
    names.emplace_back(light.name);
    if (light.name == name) found = &light;
  }
  if (found == nullptr)
    throw base::InputError(fmt::format("--set {}: no light of that name{}; the world's lights are {}", setting,
                                       base::suggest(name, names), fmt::join(names, ", ")));
  const auto states = world::words_of(world::LightState{});
  const auto state = std::find(states.begin(), states.end(), word);
  if (state == states.end())
    throw base::InputError(fmt::format("--set {}: expected NAME=STATE with one of {}{}", setting,
                                       fmt::join(states, ", "), base::suggest(word, states)));
  found->phases = {{static_cast<world::LightState>(state - states.begin()), 1.0}};
}

/// Sends all intersections' messages to one address.
class Sender {
 public:
  Sender(const LightOptions& options, const world::World& world)
      : world_(world), roads_(world::roads_of(world)), address_(netio::resolve(options.send)), ports_(options.ports) {
    for (server::Intersection& one : server::intersections_of(world, roads_ ? &*roads_ : nullptr)) {
      const auto map = roads_ ? map_of(*roads_, one, {options.latitude, options.longitude}) : std::nullopt;
      if (map) maps_.push_back(encoded(*map, one));
      intersections_.push_back(std::move(one));
    }
  }
  void send_maps() {
    for (const base::Bytes& map : maps_) queue(map);
  }
  void send_states(double time, std::int64_t utc) {
    for (const server::Intersection& one : intersections_) queue(encoded(spat_of(world_, one, time, utc), one));
    outbox_.flush();
  }
  const std::vector<server::Intersection>& intersections() const { return intersections_; }
  netio::OutboxCounts counts() const { return outbox_.counts(); }
  std::string to() const { return fmt::format("{}:{}", netio::text_of(address_), fmt::join(ports_, ",")); }

 private:
  void queue(const base::Bytes& bytes) {
    for (const std::uint16_t port : ports_) outbox_.queue({address_, port}, bytes);
  }
  template <class Message>
  static base::Bytes encoded(const Message& message, const server::Intersection& of) {
    v2x::Frame frame;
    frame.message = message;
    base::Bytes bytes;
    v2x::encode(frame, bytes);
    if (bytes.size() > netio::kMaxHeaderlessDatagram)
      throw base::InputError(fmt::format("the {} of intersection {} has {} bytes; a datagram holds {}", message.kTag,
                                         of.id, bytes.size(), netio::kMaxHeaderlessDatagram));
    return bytes;
  }

  const world::World& world_;
  std::optional<world::RoadNetwork> roads_;
  std::uint32_t address_;
  std::vector<std::uint16_t> ports_;
  std::vector<server::Intersection> intersections_;
  std::vector<base::Bytes> maps_;
  netio::Outbox outbox_;
};

}  // namespace

int light(const LightOptions& options) {
  world::World world = load_lights(options.world);
  for (const std::string& setting : options.set) hold_state(world, setting);
  Sender sender(options, world);
  install_stop_handlers();
  print_message("{} of {} to {} at {:g} Hz; Ctrl-C ends it", counted(world.lights.size(), "light"),
                counted(sender.intersections().size(), "intersection"), sender.to(), options.rate);

  const auto start = std::chrono::steady_clock::now();
  std::uint64_t ticks = 0;
  std::int64_t next_map = 0;  // [s]
  for (double at = 0.0; !stop_requested() && (options.duration <= 0.0 || at < options.duration); ++ticks) {
    if (at >= static_cast<double>(next_map)) {
      sender.send_maps();
      ++next_map;
    }
    sender.send_states(options.time + base::seconds_since(start), base::unix_time() / 1'000'000);
    at = static_cast<double>(ticks + 1) / options.rate;
    keep_pace(start, at);
  }
  const netio::OutboxCounts counts = sender.counts();
  if (counts.sent == 0) throw base::InputError("nothing was sent: " + counts.first_failure);
  print_message("sent {} to {}", counted(counts.sent, "message"), sender.to());
  return 0;
}

}  // namespace sf::apps
