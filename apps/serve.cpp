// `serve`: robots live elsewhere. Their states come in, what they would sense goes back to them.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <thread>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "apps/automatic_accuracy.h"
#include "apps/commands.h"
#include "apps/default_robot.h"
#include "apps/exposure_warning.h"
#include "apps/layout_options.h"
#include "apps/option_parsers.h"
#include "apps/rate_warnings.h"
#include "apps/report.h"
#include "apps/stop_signals.h"
#include "base/error.h"
#include "netio/inbox.h"
#include "netio/rate_limited_log.h"
#include "netio/relay.h"
#include "netio/server/no_return_filter.h"
#include "netio/server/reading_publisher.h"
#include "netio/server/wire_ids.h"
#include "raycast/caster_choice.h"
#include "robots/fleet.h"

namespace sf::apps {

namespace {

using Clock = std::chrono::steady_clock;

netio::Inbox open_inbox(const server::WireNames& names, const Options& options) {
  const netio::Endpoint bind{netio::resolve(options.bind), static_cast<std::uint16_t>(options.port)};
  try {
    return netio::Inbox({.bind = bind, .robots = server::ids_of(names.robots), .tags = server::ids_of(names.tags)});
  } catch (const netio::PortInUse&) {
    throw base::InputError(netio::text(bind) +
                           " is taken, by another `sensorfarm serve` perhaps: end that one, or serve on another port "
                           "(--port N, or --port 0 for any free one) and tell the robots (robot --port N)");
  }
}

class Service {
 public:
  Service(const world::World& world, const sensors::SensorSet& sensor_set, gpu::Device& device,
          const server::StreamLayout& plan, const Options& options)
      : world_(world),
        sensor_set_(sensor_set),
        names_(server::wire_names(world)),
        inbox_(open_inbox(names_, options)),
        answers_(inbox_.socket()),
        relay_(server::ids_of(names_.robots), {.range = options.radio}),
        plan_(plan),
        publisher_(world, sensor_set, plan, netio::Outbox(inbox_.socket(), server::outbox_options(sensor_set))),
        farm_(world, device,
              farm::FarmOptions{.seed = options.seed, .true_poses = false, .no_return_inf = options.no_return_inf}),
        fleet_(world),
        no_return_filter_(sensor_set, options.no_return_inf),
        forget_(options.forget > 0.0
                    ? std::max<std::int64_t>(0, std::llround(1e9 * options.forget) - netio::kClientTimeout)
                    : kNever),
        last_active_(world.movers.size(), kNever),
        capped_(options.rate > 0.0) {
    reports_.reserve(netio::Inbox::kMaxPerReceive);
  }

  std::uint16_t port() const { return inbox_.port(); }
  std::size_t robots() const { return names_.robots.size(); }

  /// [ns] When the farm has something to read or to deliver.
  std::int64_t next_due() const { return capped_ ? farm::kNever : std::min(farm_.next_due(), farm_.next_delivery()); }

  /// Sleeps until `when`, taking in what comes meanwhile. Never less: at a tick that is early, a sensor of the same
  /// rate would not be due yet.
  void wait_until(Clock::time_point start, Clock::time_point when) {
    for (;;) {
      const auto left = when - Clock::now();
      if (left <= Clock::duration::zero() || stop_requested()) return;
      const auto whole = std::chrono::duration_cast<std::chrono::milliseconds>(left).count();
      if (whole == 0) std::this_thread::sleep_for(left);
      if (whole > 0) inbox_.wait(static_cast<int>(std::min<long>(whole, 100)));
      receive_pending((Clock::now() - start).count());
    }
  }

  /// Everything that goes by ticks.
  void tick(std::int64_t now) {
    sample(now, false);
    relay_.forward(inbox_, now, answers_);
    answers_.flush();
    ++ticks_;
  }

  /// Reads and delivers everything that is due. @param between two ticks
  void sample(std::int64_t now, bool between) {
    receive_pending(now);
    for (const auto& [id, row] : names_.robots) {
      remove_silent(id, row, now);
      farm_.subscribe(row, subscribed_types(id, now));
    }
    const auto states = fleet_.predict(now);
    const auto readings = no_return_filter_.apply(between ? farm_.sample(now, states) : farm_.tick(now, states));
    for (const base::ReadingBlock& reading : readings) {
      // A reading that was on its way when its robot fell silent has nobody to go to.
      const std::uint32_t id = world_.movers[reading.mover].id;
      const auto to = inbox_.address(id);
      if (to) addressed_readings_.push_back({&reading, to->address, inbox_.session_token_for(id)});
    }
    publisher_.queue(addressed_readings_);
    publisher_.flush();
    addressed_readings_.clear();
    warn_of_missed();
  }

  /// All that waits, at `now` [ns].
  void receive_pending(std::int64_t now) {
    reports_.clear();
    const auto take = [&](const netio::Packet& packet) {
      relay_.take(packet);
      if (const auto* state = std::get_if<netio::V2v>(&packet.body)) {
        reports_.push_back(netio::report(packet.header, *state, names_.robots.at(packet.header.robot)));
      } else if (const auto* tag = std::get_if<netio::Tag>(&packet.body)) {
        const std::uint32_t row = names_.tags.at(packet.header.robot);
        reports_.push_back(netio::report(packet.header, *tag, row, world_.movers[row].X_MT));
      } else {
        return;
      }
      // Senders' clocks are their own: a state is true when it arrives.
      reports_.back().time = now;
    };
    const auto on_rejected = [&](netio::PacketStatus reason, const netio::Packet& packet, const netio::Endpoint& who) {
      if (reason == netio::PacketStatus::wrong_source) return report_wrong_source(packet, who, now);
      if (inbox_.challenge(packet, who, now, challenge_)) answers_.queue(who, challenge_);
    };
    inbox_.receive(now, take, on_rejected);
    answers_.flush();
    fleet_.apply(reports_);
  }

  RunReport facts() const {
    RunReport facts;
    facts.robots = static_cast<std::uint32_t>(names_.robots.size());
    facts.ticks = ticks_;
    facts.farm = farm_.stats();
    facts.hash = farm_.hash();
    facts.sent = facts.received = true;
    facts.publisher = publisher_.counts();
    facts.inbox = inbox_.counts();
    facts.kernel_drops = inbox_.kernel_drops();
    facts.relayed = relay_.counts();
    facts.lines_left_out = log_.left_out();
    return facts;
  }

 private:
  /// Once, when more than one reading in twenty is missed.
  void warn_of_missed() {
    const farm::FarmStats stats = farm_.stats();
    if (warned_of_missed_ || capped_ || stats.missed < 20 || 20 * stats.missed < stats.readings) return;
    warned_of_missed_ = true;
    std::fprintf(
        stderr,
        "sensorfarm: this machine is too slow for the sensors' rates: readings are missed; lower the rates, or "
        "let fewer robots ask for them\n");
  }

  /// Bit k: robot `id` is heard, and wants its sensors of kind k.
  std::uint32_t subscribed_types(std::uint32_t id, std::int64_t now) const {
    std::uint32_t kinds = 0;
    for (const sensors::SensorSet::Group& group : sensor_set_.groups())
      if (inbox_.is_subscribed(id, group.kind->id, now) && plan_.sends_any(group)) kinds |= 1u << group.kind->id;
    return kinds;
  }

  /// A robot that spoke once and is silent now is taken out of the world until it speaks again.
  void remove_silent(std::uint32_t id, std::uint32_t row, std::int64_t now) {
    std::int64_t& last = last_active_[row];
    const bool active = inbox_.is_active(id, now);
    const bool gone = !active && forget_ != kNever && last != kNever && now - last >= forget_;
    if (active) last = now;
    farm_.set_absent(row, gone);
    fleet_.set_absent(row, gone);
  }

  /// Of each binding's strangers, once.
  void report_wrong_source(const netio::Packet& packet, const netio::Endpoint& who, std::int64_t now) {
    const bool tag = std::holds_alternative<netio::Tag>(packet.body);
    const std::uint32_t id = packet.header.robot;
    const netio::Endpoint bound = *(tag ? inbox_.tag_address(id) : inbox_.address(id));
    auto& reported = (tag ? reported_tags_ : reported_robots_)[id];
    if (reported == bound) return;
    reported = bound;
    log_.write(
        fmt::format("{} ({} {}) is heard from {}; what {} says as the same is dropped until that one leaves or is "
                    "silent for 2 s",
                    world_.movers[(tag ? names_.tags : names_.robots).at(id)].name, tag ? "tag" : "id", id,
                    netio::text(bound), netio::text(who)),
        now);
  }

  static constexpr std::int64_t kNever = -1;

  const world::World& world_;
  const sensors::SensorSet& sensor_set_;
  server::WireNames names_;
  netio::Inbox inbox_;
  netio::Outbox answers_;  ///< from where the robots speak to
  netio::Relay relay_;
  const server::StreamLayout& plan_;
  server::ReadingPublisher publisher_;
  farm::Farm farm_;
  robots::Fleet fleet_;
  server::NoReturnFilter no_return_filter_;
  std::vector<base::Report> reports_;
  std::vector<server::AddressedReading> addressed_readings_;  ///< of one tick
  base::Bytes challenge_;
  std::int64_t forget_;                    ///< [ns] since it was last heard, or kNever
  std::vector<std::int64_t> last_active_;  ///< [ns] per mover
  netio::RateLimitedLog log_;
  // By id: the binding whose strangers were spoken of.
  std::map<std::uint32_t, std::optional<netio::Endpoint>> reported_robots_;
  std::map<std::uint32_t, std::optional<netio::Endpoint>> reported_tags_;
  std::uint64_t ticks_ = 0;
  bool capped_;  ///< sensors are read at ticks alone
  bool warned_of_missed_ = false;
};

}  // namespace

int serve(const Options& options) {
  world::World world = load_with_robots(options.world, options.load, 0, options.seed);
  const server::StreamLayout plan = stream_layout_of(world, sensors::SensorSet(world), options);
  gpu::Device device(options.device);
  choose_accuracy(world, device, options);
  const sensors::SensorSet sensor_set(world);
  if (options.rate > 0.0) warn_of_fast_sensors(sensor_set, options.rate);
  if (options.rate == 0.0) warn_of_many_times(sensor_set);
  Service service(world, sensor_set, device, plan, options);
  warn_of_exposure(netio::resolve(options.bind), "say where robots are, and be sent readings");
  install_stop_handlers();
  const double interval = options.rate > 0.0 ? 1.0 / options.rate : world.interval;
  std::fprintf(stderr, "sensorfarm: serving %s of %s on %s:%u, %g ticks/s, on %s; Ctrl-C ends it\n",
               counted(service.robots(), "robot").c_str(), world.file.c_str(), options.bind.c_str(), service.port(),
               1.0 / interval, device.info().name.c_str());

  const auto start = Clock::now();
  const std::int64_t step = std::llround(interval * 1e9);
  std::int64_t next = 0;  // [ns] of the tick
  while (!stop_requested()) {
    service.wait_until(start, start + std::chrono::nanoseconds(std::min(next, service.next_due())));
    if (stop_requested()) break;
    const std::int64_t now = (Clock::now() - start).count();
    if (options.duration > 0.0 && 1e-9 * static_cast<double>(now) >= options.duration) break;
    if (now < next) {
      service.sample(now, true);
      continue;
    }
    service.tick(now);
    next = std::max(next + step, (Clock::now() - start).count() - step);
  }

  service.receive_pending((Clock::now() - start).count());  // what still waits is counted too
  RunReport facts = service.facts();
  facts.device = device.info().name;
  facts.software = device.info().software;
  facts.caster = raycast::describe_caster(device.info().software);
  facts.wall_s = facts.simulated_s = std::chrono::duration<double>(Clock::now() - start).count();
  std::fputs((options.json ? with_warnings(json_of(facts), world.warnings) : text_of(facts)).c_str(), stdout);
  return 0;
}

}  // namespace sf::apps
