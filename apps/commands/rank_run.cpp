#include "apps/commands/rank_run.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "apps/options/options.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/bytes.h"
#include "base/error.h"
#include "cluster/failure.h"
#include "cluster/shares.h"

namespace sf::apps {

namespace {

int run_shared(cluster::Ranks& ranks, const std::function<int(cluster::Ranks*)>& body) {
  mute(ranks.rank() > 0);
  std::string message;
  int code = 1;
  try {
    return body(&ranks);
  } catch (const cluster::Failure& failure) {
    print_message("{}", failure.what());
    return failure.code();
  } catch (const std::exception&) {
    code = cluster::code_of_current(message);
  }
  mute(false);
  print_message("rank {}: {}", ranks.rank(), message);
  ranks.abort(code);
  return code;  // g++ does not detect that the virtual function never returns
}

/// Counts of the robots owned by this rank.
std::vector<std::uint64_t*> counts_of(RunReport& f) {
  sensors::SensorStats& work = f.farm.work;
  netio::OutboxCounts& packets = f.publisher.packets;
  std::vector<std::uint64_t*> counts{&f.farm.readings, &f.farm.missed,          &f.farm.reused,       &f.farm.batches,
                                     &work.rays,       &work.uncertain,         &work.cells_built,    &work.dipoles,
                                     &work.host_scans, &work.movers_in_range,   &work.movers_visible, &f.recorded_bytes,
                                     &packets.queued,  &packets.sent,           &packets.sent_bytes,  &packets.failed,
                                     &packets.dropped, &f.publisher.not_numbers};
  for (std::uint64_t& affected : f.farm.faults) counts.push_back(&affected);
  return counts;
}

std::vector<double*> seconds_of(RunReport& f) {
  return {&f.farm.place_s, &f.farm.lists_s, &f.farm.device_s, &f.farm.collect_s, &f.move_s, &f.out_s};
}

}  // namespace

int with_ranks(const std::function<int(cluster::Ranks*)>& body) {
  const std::unique_ptr<cluster::Ranks> ranks = cluster::join();
  return !ranks || ranks->size() == 1 ? body(nullptr) : run_shared(*ranks, body);
}

void on_all(cluster::Ranks* ranks, const std::function<void()>& body) { cluster::agree(ranks, body); }

unsigned threads_of(const RunOptions& options, const cluster::Ranks* ranks) {
  return cluster::threads_of(options.threads, ranks);
}

void check_for_ranks(const RunOptions& options) {
  if (options.automatic)
    throw base::InputError(
        "--auto measures each machine separately: with several ranks, give the accuracy modes with --accuracy");
  if (!options.video.empty())
    throw base::InputError(
        "a video can show the fleet of one process only: record the run (--record DIR), then use `plot DIR --video "
        "FILE`");
  if (!options.map_file.empty() || options.map_view)
    throw base::InputError(
        "--map-file and --map-view can show the fleet of one process only: leave them out, or run without mpirun");
  if (options.BridgeOptions::any())
    throw base::InputError("bridges can show the fleet of one process only: leave them out, or run without mpirun");
}

void add_up(cluster::Ranks& ranks, RunReport& facts, std::optional<std::uint64_t> passed_on) {
  const cluster::ExchangeCounts exchanges = ranks.counts();
  RankReport report{ranks.size()};
  report.passed_on = passed_on;
  std::vector<std::uint64_t*> counts = counts_of(facts);
  if (passed_on) counts.push_back(&*report.passed_on);
  const std::vector<double*> seconds = seconds_of(facts);
  base::Bytes block;
  base::ByteWriter out(block);
  for (std::uint64_t* count : counts) out.put(std::exchange(*count, 0));
  const double own = facts.farm.sensing_s();
  for (double* value : seconds) out.put(std::exchange(*value, 0.0));
  out.put(own);
  out.put(exchanges.bytes);
  out.put(exchanges.wait_s);
  double slowest = 0.0, all = 0.0;
  for (const cluster::Block other : ranks.exchange(block)) {
    base::ByteReader in(other);
    for (std::uint64_t* count : counts) *count += in.get<std::uint64_t>();
    for (double* value : seconds) *value += in.get<double>() / ranks.size();
    const auto sensing = in.get<double>();
    slowest = std::max(slowest, sensing), all += sensing;
    report.bytes += static_cast<double>(in.get<std::uint64_t>());
    report.wait_s += in.get<double>() / ranks.size();
  }
  report.bytes /= static_cast<double>(std::max<std::uint64_t>(1, facts.ticks * facts.robots));
  report.imbalance = all > 0.0 ? slowest * ranks.size() / all : 1.0;
  facts.shared = report;
  std::string& failure = facts.publisher.packets.first_failure;
  if (facts.publisher.packets.failed > 0 && failure.empty()) failure = "on another rank";
}

}  // namespace sf::apps
