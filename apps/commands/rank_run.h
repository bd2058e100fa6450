#pragma once
// A run whose fleet is shared by several ranks (docs/cluster.md): error handling and the combined report.

#include <cstdint>
#include <functional>

#include "cluster/ranks.h"

namespace sf::apps {

struct RunOptions;
struct RunReport;

/// Cost of sharing the fleet.
struct RankReport {
  unsigned ranks = 0;
  double bytes = 0.0;   ///< [byte] sent per robot and tick, summed over all ranks; each block counts once
  double wait_s = 0.0;  ///< [s] spent in exchanges, mean over the ranks
  std::optional<std::uint64_t> passed_on = {};  ///< number of times robots moved to another tile; nullopt: no tiles
  double imbalance = 0.0;                       ///< [-] sensing time of the slowest rank over the mean; 1: balanced
};

/// Joins the other ranks and runs `body` with them, or with null if this process runs alone. An error on one rank ends
/// all of them.
/// @return the exit code of `body`, or that of an error which all ranks have detected
int with_ranks(const std::function<int(cluster::Ranks*)>& body);

/// Runs `body`. With ranks, an error on one of them is thrown on all.
void on_all(cluster::Ranks* ranks, const std::function<void()>& body);

/// Returns the number of threads for this rank. Ranks on one machine share its cores.
unsigned threads_of(const RunOptions& options, const cluster::Ranks* ranks);

/// @throws base::InputError for options that are not supported with several ranks
void check_for_ranks(const RunOptions& options);

/// Sums the counts of all ranks; collective. @param passed_on of this rank, see RankReport
void add_up(cluster::Ranks& ranks, RunReport& facts, std::optional<std::uint64_t> passed_on);

}  // namespace sf::apps
