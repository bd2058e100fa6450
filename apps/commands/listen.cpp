// `listen`: receives the packets of `run --send`.

#include <cmath>

#include "apps/commands/commands.h"
#include "apps/options/default_robot.h"
#include "apps/options/layout_options.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/exposure_warning.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "server/sensor_streams.h"

namespace sf::apps {

int listen(const ListenOptions& options) {
  const world::World world = load_with_robots(options, options);
  const sensors::SensorSet sensor_set(world);
  const server::StreamLayout sent = stream_layout_of(world, sensor_set, options);
  const std::vector<server::SensorStream> sources = server::sensor_streams(sensor_set, sent);
  netio::StreamMonitorOptions monitor_options;
  monitor_options.address = netio::resolve(options.bind);
  if (!options.from.empty()) monitor_options.farm = netio::resolve(options.from);
  monitor_options.headerless = options.wire == sensors::WireFormat::thesis;
  monitor_options.inspect = [&](std::size_t i, const netio::Header& header, std::span<const std::uint8_t> payload) {
    return server::inspect_payload(sources[i], options.wire, header, payload);
  };
  for (const server::SensorStream& source : sources)
    monitor_options.streams.push_back({world.movers[source.row->mover].id, source.row->sensor, sent.ports(*source.type),
                                       std::string(source.type->name)});
  netio::StreamMonitor monitor(monitor_options);
  warn_of_exposure(monitor_options.address, "send readings");
  install_stop_handlers();
  print_message("listening on {} of {}", counted(monitor_options.streams.size(), "port"), options.bind);
  monitor.run(stop_requested(), static_cast<int>(1000.0 * options.silence), std::llround(1000.0 * options.duration));
  const netio::StreamSummary summary = monitor.summary();
  print(options.json ? with_warnings(stream_summary_json(summary), world.warnings) : stream_summary_text(summary));
  return summary.good > 0 ? 0 : 1;
}

}  // namespace sf::apps
