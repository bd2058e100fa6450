#include "cluster/ranks.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "base/error.h"
#include "base/plugin.h"

namespace sf::cluster {

bool is_rank() {
  // Open MPI's mpirun; PMIx and PMI-2, as set by srun --mpi. A plain srun starts independent programs.
  constexpr std::array kMarks{"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"};
  return std::any_of(kMarks.begin(), kMarks.end(), [](const char* mark) { return std::getenv(mark) != nullptr; });
}

std::unique_ptr<Ranks> join() {
  if (!is_rank()) return nullptr;
  const auto start = reinterpret_cast<Ranks* (*)()>(const_cast<void*>(
      base::load_plugin(kMpiSymbol, "ranks of mpirun cannot communicate; without mpirun the run requires no MPI",
                        "Open MPI 4.1 (Debian: libopenmpi3)")));
  std::unique_ptr<Ranks> ranks(start());
  if (!ranks) throw base::InputError("MPI did not start: check `mpirun -n 2 hostname`, or run without mpirun");
  return ranks;
}

}  // namespace sf::cluster
