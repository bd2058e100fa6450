#pragma once
// Fast DDS participants with the endpoints of services.

#include <memory>

#include "bridges/dds.h"

namespace sf::bridges {

/// Messages have the format of rmw_cyclonedds, with a header before their fields: a number of the request and its
/// sequence number.
/// @throws std::runtime_error with the reason
std::unique_ptr<DdsParticipant> open_fast_dds(const DdsOptions& options);

}  // namespace sf::bridges
