#pragma once
// Four overhead cameras in a row, and one tag that crosses all of them between others: detection in all images,
// compared with following (vision/follower.h). Images are rendered, so that the truth is known.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "vision/follower.h"

namespace sf::scenarios {

inline constexpr std::size_t kFollowCameras = 4;
inline constexpr std::uint32_t kFollowedTag = 1;
inline constexpr std::uint32_t kFollowTags = 9;  ///< with the ids 1 to 9

struct FollowCase {
  std::string_view name;
  double speed = 1.0;    ///< [m/s] of the tag that crosses
  double covered = 0.0;  ///< [m] length of a board above the border of the second and third camera; 0: none
};
inline constexpr std::array<FollowCase, 3> kFollowCases{
    {{"crossing", 1.0, 0.0}, {"twice as fast", 2.0, 0.0}, {"covered for 2 s", 1.0, 2.0}}};

enum class FollowMethod : std::uint8_t {
  all,     ///< every image is searched
  follow,  ///< follows the tag that crosses
  others   ///< follows all tags
};
inline constexpr std::array<std::string_view, 3> kFollowMethods{"all cameras", "follow 1 tag", "follow 9 tags"};

/// One image of each camera, processed by one method.
struct FollowMoment {
  double cpu = 0.0;                       ///< [s] processor time of detection and tracking
  std::optional<vision::TrackedTag> tag;  ///< the tag that crosses; nullopt: not seen
  double error = 0.0;                     ///< [m] of its position, if seen
};

struct FollowRun {
  std::vector<double> times;  ///< [s]
  std::array<std::vector<FollowMoment>, kFollowMethods.size()> moments;
  /// Images of each camera that the method `follow` searched: 0 asleep, 1 parts, 2 whole.
  std::array<std::vector<double>, kFollowCameras> searches;
  std::array<std::optional<vision::FollowCounts>, kFollowMethods.size()> counts;
};

/// The result of one method in one case.
struct FollowRow {
  double cpu_ms = 0.0;                 ///< [ms] of four images, on average
  double pixels = 1.0, asleep = 0.0;   ///< shares of the pixels that were searched, and of the images that were not
  std::size_t seen = 0;                ///< moments
  double rms_mm = 0.0, most_mm = 0.0;  ///< error of the position
  double gap = 0.0;                    ///< [s] longest time between two sightings
  std::uint64_t hand_overs = 0;
  std::size_t missed = 0;     ///< moments in which `all` saw the tag and this did not
  std::size_t different = 0;  ///< poses, velocities or times that are not those of `all`, bit by bit
};

/// @param step called before each moment with the completed fraction; throws to end the run
/// @param duration [s] at most
FollowRun run_follow(const FollowCase& setup, std::uint64_t seed, const std::function<void(double)>& step,
                     double duration = 1e9);
FollowRow summarize(const FollowRun& run, FollowMethod method);

/// Returns the testbed of the runs.
vision::Testbed follow_testbed();

}  // namespace sf::scenarios
