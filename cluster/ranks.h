#pragma once
// Ranks: the processes of one job on one or more machines, as started by `mpirun -n N`.
//
//   const std::unique_ptr<cluster::Ranks> ranks = cluster::join();  // null: a single process
//   ranks->begin(block);                                            // one block of bytes per rank
//   ...                                                             // work meanwhile
//   for (const auto block : ranks->finish()) ...                    // the blocks of all ranks
//
// Only one source, a plug-in (cluster/mpi.cpp, `sensorfarm_mpi.so`), uses MPI. Only processes started as ranks load it.

#include <cstdint>
#include <memory>
#include <span>

#include "base/bytes.h"

namespace sf::cluster {

/// Bytes of one rank.
using Block = std::span<const std::uint8_t>;

/// Cost of the exchanges so far.
struct ExchangeCounts {
  std::uint64_t exchanges = 0;
  std::uint64_t bytes = 0;  ///< sent by this rank, counted once if every other rank receives them
  double wait_s = 0.0;      ///< [s] in `begin`, `finish` and `swap`
};

/// Single-threaded. All ranks call `begin` and `finish` in the same order.
class Ranks {
 public:
  virtual ~Ranks() = default;
  virtual unsigned rank() const = 0;        ///< in [0, size())
  virtual unsigned size() const = 0;        ///< at least 1
  virtual unsigned local_size() const = 0;  ///< number of ranks on this machine, including this one
  /// Starts an exchange. @param block at most 2 GiB together with those of all ranks; unchanged until after `finish`
  virtual void begin(Block block) = 0;
  /// Ends the exchange. @return one block per rank, valid until the next `begin`
  virtual std::span<const Block> finish() = 0;
  /// Sends each rank its own block. @param to one per rank @return one from each rank, valid until the next call
  virtual std::span<const Block> swap(std::span<const base::Bytes> to) = 0;
  /// Ends the processes of all ranks.
  [[noreturn]] virtual void abort(int code) = 0;

  std::span<const Block> exchange(Block block) {
    begin(block);
    return finish();
  }
  const ExchangeCounts& counts() const { return counts_; }

 protected:
  ExchangeCounts counts_;
};

/// Returns whether this process was started as a rank: by mpirun, or by srun with an interface for MPI.
bool is_rank();

/// Joins the other ranks; null if `is_rank` returns false. Call it once.
/// @throws base::InputError if the plug-in or MPI is missing
std::unique_ptr<Ranks> join();

/// The plug-in's symbol: `extern "C" sf::cluster::Ranks* sensorfarm_mpi()`, which returns null if MPI cannot start.
inline constexpr const char* kMpiSymbol = "sensorfarm_mpi";

}  // namespace sf::cluster
