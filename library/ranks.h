#pragma once
// The ranks of this process' job, shared by all its simulations.

#include "cluster/ranks.h"

namespace sf::library {

/// Joins the other ranks at the first call, until the process ends. Null if the process was not started by mpirun, or
/// is its only rank. @throws base::InputError if MPI is missing
cluster::Ranks* joined_ranks();

}  // namespace sf::library
