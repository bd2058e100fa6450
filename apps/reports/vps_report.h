#pragma once
// The report of `vps`.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/options/camera_inputs.h"
#include "netio/outbox.h"
#include "vision/accuracy.h"
#include "vision/follower.h"

namespace sf::apps {

struct VpsReport {
  std::vector<std::string> cameras;  ///< names
  std::string orientation;           ///< of the tags, where libraries differ (vision/tag_family.h)
  vision::DetectionCounts counts;
  std::uint64_t refused = 0;                         ///< by the tracker
  double processing_s = 0.0;                         ///< [s] of detection and tracking, on all cores
  double processing_cpu_s = 0.0;                     ///< [s] CPU time of both
  std::map<std::uint32_t, vision::TrackedTag> tags;  ///< newest state of each tag
  std::map<std::uint32_t, std::uint64_t> reported;   ///< number of states of each tag
  std::optional<vision::Accuracy> accuracy;          ///< for rendered images
  std::optional<netio::OutboxCounts> sent;
  std::uint64_t unaddressed = 0;
  std::optional<vision::FollowCounts> follow;
  std::optional<TruthCounts> truth;  ///< for rendered robots
};

std::string vps_report_text(const VpsReport& report);
std::string vps_report_json(const VpsReport& report);

}  // namespace sf::apps
