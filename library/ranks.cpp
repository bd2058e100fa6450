#include "library/ranks.h"

#include <cstdlib>
#include <memory>

#include "sensorfarm/simulation.h"

namespace sf::library {

namespace {

cluster::Ranks* known = nullptr;  // used by `abort_ranks`, which does not join any ranks

}  // namespace

cluster::Ranks* joined_ranks() {
  static const std::unique_ptr<cluster::Ranks> ranks = cluster::join();
  known = ranks.get();
  return ranks && ranks->size() > 1 ? ranks.get() : nullptr;
}

}  // namespace sf::library

namespace sensorfarm {

void abort_ranks(int code) {
  if (sf::library::known != nullptr) sf::library::known->abort(code);
  std::_Exit(code);
}

}  // namespace sensorfarm
