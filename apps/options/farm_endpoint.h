#pragma once
// Address of the farm that a command connects to.

#include "apps/options/options.h"
#include "netio/endpoint.h"

namespace sf::apps {

/// @throws base::InputError for an unknown host
inline netio::Endpoint farm_of(const FarmOptions& options) {
  return {netio::resolve(options.server), static_cast<std::uint16_t>(options.port)};
}

}  // namespace sf::apps
