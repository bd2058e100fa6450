#pragma once
// A run whose fleet several ranks share (docs/cluster.md): its end, with or without an error, and one report of all.

#include <cstdint>
#include <functional>

#include "cluster/ranks.h"

namespace sf::apps {

struct RunOptions;
struct RunReport;

/// What sharing the fleet cost.
struct RankReport {
  unsigned ranks = 0;
  double bytes = 0.0;   ///< [byte] sent per robot and tick, all ranks together, each block counted once
  double wait_s = 0.0;  ///< [s] in exchanges, mean of the ranks
  std::optional<std::uint64_t> passed_on = {};  ///< robots that have crossed from one tile to another; none: no tiles
  double imbalance = 0.0;  ///< [-] of the time spent on sensing: the slowest rank's over the mean; 1: none
};

/// Joins the other ranks, and runs `body` with them; null: a process of its own.
/// @return its exit code, or that of an error that all ranks know of; an error of one rank ends all of them
int with_ranks(const std::function<int(cluster::Ranks*)>& body);

/// Runs `body`; with ranks, an error of one is thrown on all of them.
void on_all(cluster::Ranks* ranks, const std::function<void()>& body);

/// Threads of this rank; ranks on one machine share its cores.
unsigned threads_of(const RunOptions& options, const cluster::Ranks* ranks);

/// @throws base::InputError for options that several ranks cannot follow
void check_for_ranks(const RunOptions& options);

/// Adds up the counts of all ranks, which all call this. @param passed_on see RankReport, of this rank
void add_up(cluster::Ranks& ranks, RunReport& facts, std::optional<std::uint64_t> passed_on);

}  // namespace sf::apps
