// `listen`: the other end of `run --send`.

#include <cstdio>

#include "apps/commands.h"
#include "apps/facts.h"
#include "apps/lend.h"
#include "apps/post.h"
#include "apps/stop.h"

namespace sf::apps {

namespace {

/// The sensor behind one port.
struct Source {
  const sensors::SensorKind* kind = nullptr;
  const sensors::SensorRow* row = nullptr;
};

netio::Reason reason_of(sensors::Fault fault) {
  switch (fault) {
    case sensors::Fault::none:
      return netio::Reason::accepted;
    case sensors::Fault::too_short:
      return netio::Reason::too_short;
    case sensors::Fault::too_long:
      return netio::Reason::too_long;
    case sensors::Fault::out_of_range:
      break;
  }
  return netio::Reason::out_of_range;
}

netio::Verdict judge(const Source& source, sensors::Wire wire, const netio::Header& header,
                     std::span<const std::uint8_t> payload) {
  std::uint8_t type = source.kind->id;
  if (wire == sensors::Wire::farm) {
    if (netio::kind_of(header.type) != source.kind->id) return {netio::Reason::wrong_source};
    type = static_cast<std::uint8_t>(header.type);
  }
  const sensors::Part part = source.kind->decode(*source.row, payload, type, wire);
  return {reason_of(part.fault), part.elements, part.part, part.parts};
}

std::vector<Source> sources_of(const sensors::Roster& roster) {
  std::vector<Source> sources;
  for (const sensors::Roster::Group& group : roster.groups())
    for (const sensors::SensorRow& row : group.rows) sources.push_back({group.kind, &row});
  return sources;
}

}  // namespace

int listen(const Options& options) {
  const world::World world = load_with_robots(options.world, options.load, options.robots, options.seed);
  const sensors::Roster roster(world);
  require_sendable(world, roster, options);
  const std::vector<Source> sources = sources_of(roster);
  netio::ListenerOptions plan;
  plan.address = netio::resolve(options.bind);
  plan.headerless = options.wire == sensors::Wire::thesis;
  plan.judge = [&](std::size_t i, const netio::Header& header, std::span<const std::uint8_t> payload) {
    return judge(sources[i], options.wire, header, payload);
  };
  for (const Source& source : sources)
    plan.streams.push_back({world.movers[source.row->mover].id, source.row->sensor, port_rule(options, *source.kind),
                            std::string(source.kind->name)});
  netio::Listener listener(plan);
  catch_stop_signals();
  std::fprintf(stderr, "sensorfarm: listening on %zu ports of %s\n", plan.streams.size(), options.bind.c_str());
  listener.run(stop_requested(), static_cast<int>(1000.0 * options.silence));
  const netio::Summary summary = listener.summary();
  std::fputs((options.json ? json_of(summary) : text_of(summary)).c_str(), stdout);
  return summary.good > 0 ? 0 : 1;
}

}  // namespace sf::apps
