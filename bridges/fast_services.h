#pragma once
// Services for clients of rmw_fastrtps, by Fast DDS in a separate process. A malicious datagram may crash that process,
// which is then restarted, but never the run.

#include <memory>
#include <vector>

#include "bridges/dds.h"
#include "bridges/dds_outbox.h"
#include "bridges/pipe_frames.h"

namespace sf::bridges {

struct FastService {
  DdsEndpoint requests, replies;
};

struct FastOptions {
  DdsOptions dds;  ///< received messages have `DdsSender::fast`, and the number of their service as `reader`
  std::vector<FastService> services;
};

class FastServices {
 public:
  virtual ~FastServices() = default;  ///< nothing is received afterwards
  /// Queues the reply to a request. Never blocks.
  /// @param reply its writer is the number of the service
  virtual void add(DdsReply&& reply) = 0;
  virtual DdsOutbox::Counts counts() const = 0;
};

/// @throws std::runtime_error with the reason
using OpenFastServices = std::unique_ptr<FastServices> (*)(const FastOptions& options);
/// Starts the process `sensorfarm_fastdds`, which is installed next to the plug-ins.
std::unique_ptr<FastServices> open_fast_services(const FastOptions& options);

}  // namespace sf::bridges
