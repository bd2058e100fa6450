// `light`: sends the traffic lights of a world or a plan as SPaT and MAP messages, as real lights do, and to a farm as
// V2I.

#include <fmt/format.h>

#include <algorithm>

#include "apps/commands/commands.h"
#include "apps/commands/light_radio.h"
#include "apps/options/default_robot.h"
#include "apps/options/option_parsers.h"
#include "apps/options/peers_option.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/text.h"
#include "base/elapsed.h"
#include "base/error.h"
#include "base/files.h"
#include "base/suggest.h"
#include "netio/outbox.h"
#include "netio/own_end.h"
#include "server/signal_messages.h"
#include "v2x/frame.h"
#include "world/actuated_lights.h"
#include "world/fields.h"
#include "world/roads/roads.h"

namespace sf::apps {

namespace {

/// "light1=flashing red" replaces the plan and program of that light.
void hold_state(world::World& world, world::LightPlan& plan, const std::string& setting) {
  const auto [name, word] = *read_setting(setting);
  std::vector<std::string_view> names;
  world::Light* found = nullptr;
  for (world::Light& light : world.lights) {
    names.emplace_back(light.name);
    if (light.name == name) found = &light;
  }
  if (found == nullptr)
    throw base::InputError(
        fmt::format("--set {}: no light of that name{}", setting, base::expected_one_of(name, names)));
  const auto states = world::words_of(world::LightState{});
  const auto state = std::find(states.begin(), states.end(), word);
  if (state == states.end())
    throw base::InputError(fmt::format("--set {}: expected NAME=STATE with one of {}{}", setting,
                                       fmt::join(states, ", "), base::suggest(word, states)));
  found->phases = {{static_cast<world::LightState>(state - states.begin()), 1.0}};
  const auto row = static_cast<std::uint32_t>(found - world.lights.data());
  for (world::LightProgram& program : plan.programs)
    std::replace(program.lights.begin(), program.lights.end(), row, world::kNone);
}

/// Loads a world file, or a plan and the world that it names.
std::pair<world::World, world::LightPlan> load(const LightOptions& options) {
  std::pair<world::World, world::LightPlan> both;
  if (options.file.ends_with(".toml")) {
    const std::string text = base::read_text(options.file);
    both.first = load_lights(world::world_of_plan(options.file, text));
    both.second = world::parse_light_plan(options.file, text, both.first);
  } else {
    both.first = load_lights(options.file);
  }
  for (const std::string& setting : options.set) hold_state(both.first, both.second, setting);
  return both;
}

/// Detectors that cover an area receive the robots' states through the farm.
void require_farm(const LightOptions& options, const world::LightPlan& plan) {
  if (options.send.empty() && options.farm.empty())
    throw base::InputError("expected a receiver: --send HOST for SPaT and MAP, --farm HOST:PORT for V2I, or both");
  const auto place = std::find_if(plan.detectors.begin(), plan.detectors.end(),
                                  [](const world::LightDetector& detector) { return detector.p.has_value(); });
  if (options.farm.empty() && place != plan.detectors.end())
    print_message(
        "warning: detector '{}' receives robot states through a farm, but no farm is given: add --farm HOST:PORT",
        place->name);
}

/// Sends SPaT and MAP of all intersections to one address.
class Sender {
 public:
  Sender(const LightOptions& options, const world::World& world, const world::RoadNetwork* roads)
      : address_(options.send.empty() ? std::nullopt : std::optional(netio::resolve(options.send))),
        ports_(options.ports),
        outbox_({.bind = netio::own_end_for(address_.value_or(0))}) {
    for (server::Intersection& one : server::intersections_of(world, roads, options.first_id)) {
      const auto map = roads != nullptr ? map_of(*roads, one, {options.latitude, options.longitude}) : std::nullopt;
      if (map) maps_.push_back(encoded(*map, one));
      intersections_.push_back(std::move(one));
    }
  }
  void send_maps() {
    for (const base::Bytes& map : maps_) queue(map);
  }
  void send_states(std::span<const world::SignalForecast> forecasts, std::int64_t utc) {
    for (const server::Intersection& one : intersections_) queue(encoded(spat_of(one, forecasts, utc), one));
    outbox_.flush();
  }
  const std::vector<server::Intersection>& intersections() const { return intersections_; }
  netio::OutboxCounts counts() const { return outbox_.counts(); }
  std::string to() const {
    return address_ ? fmt::format("{}:{}", netio::ipv4_text(*address_), fmt::join(ports_, ",")) : "";
  }

 private:
  void queue(const base::Bytes& bytes) {
    for (const std::uint16_t port : ports_)
      if (address_) outbox_.queue({*address_, port}, bytes);
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

  std::optional<std::uint32_t> address_;
  std::vector<std::uint16_t> ports_;
  std::vector<server::Intersection> intersections_;
  std::vector<base::Bytes> maps_;
  netio::Outbox outbox_;
};

/// Sends at the configured rate until stopped. Processes received states before each transmission.
void run(const LightOptions& options, Sender& sender, LightRadio* radio, world::ActuatedLights& actuated) {
  const auto start = std::chrono::steady_clock::now();
  std::int64_t next_map = 0;  // [s]
  for (double at = 0.0; !stop_requested() && (options.duration <= 0.0 || at < options.duration);) {
    const double elapsed = base::seconds_since(start), time = options.time + elapsed;
    const std::int64_t now = static_cast<std::int64_t>(1e9 * elapsed);
    if (radio != nullptr) {
      radio->receive(now, [&](glm::dvec2 p) { actuated.detect(p, time); });
      radio->report_trouble(now);
    }
    actuated.step(time);
    const std::vector<world::SignalForecast> forecasts = actuated.forecasts(time);
    if (at >= static_cast<double>(next_map)) {
      sender.send_maps();
      next_map = static_cast<std::int64_t>(at) + 1;
    }
    sender.send_states(forecasts, base::unix_time() / 1'000'000);
    if (radio != nullptr) radio->send(forecasts, now);
    // After a pause of the process, skip the missed messages.
    at = std::max(at + 1.0 / options.rate, base::seconds_since(start));
    keep_pace(start, at);
  }
}

}  // namespace

int light(const LightOptions& options) {
  const auto [world, plan] = load(options);
  require_farm(options, plan);
  const auto roads = world::roads_of(world);
  Sender sender(options, world, roads ? &*roads : nullptr);
  std::optional<LightRadio> radio;
  if (!options.farm.empty())
    radio.emplace(world, roads ? &*roads : nullptr, options.farm, peers_of(options, nullptr), options.first_id);
  world::ActuatedLights actuated(world, plan, options.time);
  install_stop_handlers();
  std::string to = sender.to();
  if (radio) to += fmt::format("{}{} (V2I)", to.empty() ? "" : " and ", radio->to());
  print_message("{} of {} to {} at {:g} Hz; press Ctrl-C to stop", counted(world.lights.size(), "light"),
                counted(sender.intersections().size(), "intersection"), to, options.rate);
  run(options, sender, radio ? &*radio : nullptr, actuated);
  const netio::OutboxCounts counts = sender.counts();
  if (counts.sent == 0 && !counts.first_failure.empty())
    throw base::InputError("nothing was sent: " + counts.first_failure);
  if (!options.send.empty()) print_message("sent {} to {}", counted(counts.sent, "message"), sender.to());
  if (radio) print_message("{}", radio->summary());
  return 0;
}

}  // namespace sf::apps
