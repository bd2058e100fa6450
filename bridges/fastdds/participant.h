#pragma once
// Participants of Fast DDS with the endpoints of services.

#include <memory>

#include "bridges/dds.h"

namespace sf::bridges {

/// Messages are as clients of rmw_cyclonedds write and read them, with a header before their fields: a number of the
/// request, and its sequence number. @throws std::runtime_error saying why it cannot
std::unique_ptr<DdsParticipant> open_fast_dds(const DdsOptions& options);

}  // namespace sf::bridges
