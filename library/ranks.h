#pragma once
// The ranks of this process' job, which all its simulations share.

#include "cluster/ranks.h"

namespace sf::library {

/// Joins the other ranks at the first call, until the process ends. Null: mpirun has started this process alone, or not
/// at all. @throws base::InputError where MPI is missing
cluster::Ranks* joined_ranks();

}  // namespace sf::library
