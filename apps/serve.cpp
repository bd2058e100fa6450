// `serve`: robots live elsewhere. Their states come in, what they would sense goes back to them.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "apps/commands.h"
#include "apps/facts.h"
#include "apps/lend.h"
#include "apps/post.h"
#include "apps/stop.h"
#include "apps/tradeoff.h"
#include "apps/wire_names.h"
#include "apps/wording.h"
#include "netio/inbox.h"
#include "netio/log.h"
#include "netio/relay.h"
#include "robots/fleet.h"

namespace sf::apps {

namespace {

using Clock = std::chrono::steady_clock;

class Service {
 public:
  Service(const world::World& world, const sensors::Roster& roster, gpu::Device& device, const Options& options)
      : world_(world),
        roster_(roster),
        names_(wire_names(world)),
        inbox_({.bind = {netio::resolve(options.bind), static_cast<std::uint16_t>(options.port)},
                .robots = ids_of(names_.robots),
                .tags = ids_of(names_.tags)}),
        answers_(inbox_.socket()),
        relay_(ids_of(names_.robots), {.range = options.radio}),
        post_(world, roster, options),
        farm_(world, device, farm::FarmOptions{.seed = options.seed, .true_poses = false}),
        fleet_(world),
        no_return_(roster, options.no_return_inf),
        forget_(options.forget > 0.0 ? std::max<std::int64_t>(0, std::llround(1e9 * options.forget) - netio::kSilence)
                                     : kNever),
        last_heard_(world.movers.size(), kNever) {
    reports_.reserve(netio::Inbox::kMaxPerReceive);
  }

  std::uint16_t port() const { return inbox_.port(); }
  std::size_t robots() const { return names_.robots.size(); }

  /// Sleeps until `when`, taking in what comes meanwhile. Never less: at a tick that is early, a sensor of the same
  /// rate would not be due yet.
  void wait_until(Clock::time_point start, Clock::time_point when) {
    for (;;) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(when - Clock::now()).count();
      if (left <= 0 || stop_requested()) return;
      inbox_.wait(static_cast<int>(std::min<long>(left, 100)));
      take_in((Clock::now() - start).count());
    }
  }

  void tick(std::int64_t now) {
    take_in(now);
    for (const auto& [id, row] : names_.robots) {
      forget_silent(id, row, now);
      farm_.hear(row, wanted(id, now));
    }
    const auto readings = no_return_.apply(farm_.tick(now, fleet_.predict(now)));
    for (const base::ReadingBlock& reading : readings) {
      // A reading that was on its way when its robot fell silent has nobody to go to.
      const auto to = inbox_.address(world_.movers[reading.mover].id);
      if (to) post_.queue(reading, to->address);
    }
    post_.flush();
    relay_.pass_on(inbox_, now, answers_);
    answers_.flush();
    ++ticks_;
  }

  /// All that waits, at `now` [ns].
  void take_in(std::int64_t now) {
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
    inbox_.receive(now, take,
                   [&](const netio::Packet& packet, const netio::Endpoint& who) { complain(packet, who, now); });
    fleet_.apply(reports_);
  }

  RunFacts facts() const {
    RunFacts facts;
    facts.robots = static_cast<std::uint32_t>(names_.robots.size());
    facts.ticks = ticks_;
    facts.farm = farm_.stats();
    facts.hash = farm_.hash();
    facts.sent = facts.received = true;
    facts.post = post_.counts();
    facts.inbox = inbox_.counts();
    facts.relayed = relay_.counts();
    facts.lines_left_out = log_.left_out();
    return facts;
  }

 private:
  /// Bit k: robot `id` is heard, and wants its sensors of kind k.
  std::uint32_t wanted(std::uint32_t id, std::int64_t now) const {
    std::uint32_t kinds = 0;
    for (const sensors::Roster::Group& group : roster_.groups())
      if (inbox_.wants(id, group.kind->id, now)) kinds |= 1u << group.kind->id;
    return kinds;
  }

  /// A robot that spoke once and is silent now is taken out of the world until it speaks again.
  void forget_silent(std::uint32_t id, std::uint32_t row, std::int64_t now) {
    std::int64_t& last = last_heard_[row];
    const bool heard = inbox_.heard(id, now);
    const bool gone = !heard && forget_ != kNever && last != kNever && now - last >= forget_;
    if (heard) last = now;
    farm_.set_gone(row, gone);
    fleet_.set_gone(row, gone);
  }

  /// Of each binding's strangers, once.
  void complain(const netio::Packet& packet, const netio::Endpoint& who, std::int64_t now) {
    const bool tag = std::holds_alternative<netio::Tag>(packet.body);
    const std::uint32_t id = packet.header.robot;
    const netio::Endpoint bound = *(tag ? inbox_.tag_address(id) : inbox_.address(id));
    auto& said = (tag ? said_of_tags_ : said_of_robots_)[id];
    if (said == bound) return;
    said = bound;
    log_.line(
        fmt::format("{} ({} {}) is heard from {}; what {} says as the same is dropped until that one leaves or is "
                    "silent for 2 s",
                    world_.movers[(tag ? names_.tags : names_.robots).at(id)].name, tag ? "tag" : "id", id,
                    netio::text(bound), netio::text(who)),
        now);
  }

  static constexpr std::int64_t kNever = -1;

  const world::World& world_;
  const sensors::Roster& roster_;
  WireNames names_;
  netio::Inbox inbox_;
  netio::Outbox answers_;  ///< from where the robots speak to
  netio::Relay relay_;
  Post post_;
  farm::Farm farm_;
  robots::Fleet fleet_;
  NoReturn no_return_;
  std::vector<base::Report> reports_;
  std::int64_t forget_;                   ///< [ns] since it was last heard, or kNever
  std::vector<std::int64_t> last_heard_;  ///< [ns] per mover
  netio::Log log_;
  // By id: the binding whose strangers were spoken of.
  std::map<std::uint32_t, std::optional<netio::Endpoint>> said_of_robots_;
  std::map<std::uint32_t, std::optional<netio::Endpoint>> said_of_tags_;
  std::uint64_t ticks_ = 0;
};

}  // namespace

int serve(const Options& options) {
  world::World world = load_with_robots(options.world, options.load, 0, options.seed);
  require_sendable(world, sensors::Roster(world), options);
  gpu::Device device(options.device);
  choose_accuracy(world, device, options);
  const sensors::Roster roster(world);
  Service service(world, roster, device, options);
  catch_stop_signals();
  const double interval = options.rate > 0.0 ? 1.0 / options.rate : world.interval;
  std::fprintf(stderr, "sensorfarm: serving %s of %s on %s:%u, %g ticks/s, on %s; Ctrl-C ends it\n",
               counted(service.robots(), "robot").c_str(), world.file.c_str(), options.bind.c_str(), service.port(),
               1.0 / interval, device.facts().name.c_str());

  const auto start = Clock::now();
  const auto step = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(interval));
  for (auto next = start; !stop_requested(); next = std::max(next + step, Clock::now() - step)) {
    service.wait_until(start, next);
    if (stop_requested()) break;
    const auto now = Clock::now() - start;
    if (options.duration > 0.0 && std::chrono::duration<double>(now).count() >= options.duration) break;
    service.tick(now.count());
  }

  service.take_in((Clock::now() - start).count());  // what still waits is counted too
  RunFacts facts = service.facts();
  facts.device = device.facts().name;
  facts.software = device.facts().software;
  facts.wall_s = facts.simulated_s = std::chrono::duration<double>(Clock::now() - start).count();
  std::fputs((options.json ? json_of(facts) : text_of(facts)).c_str(), stdout);
  return 0;
}

}  // namespace sf::apps
