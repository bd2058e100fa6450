#pragma once
// The testbed file: cameras with their calibration, and the tags to detect. docs/vps.md describes its keys.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/pose.h"
#include "vision/camera.h"
#include "vision/follow.h"
#include "vision/image.h"

namespace sf::vision {

inline constexpr std::size_t kMaxCameras = 64;
/// Limit for the images of all cameras in total: 256 Mpx.
inline constexpr std::int64_t kMaxTestbedPixels = 4 * kMaxImagePixels;

/// Number of a tag's six coordinates that are measured, by the words of testbed files.
enum class TagFreedom {
  plane,   ///< position in the plane and heading; the tag is horizontal at its given height
  height,  ///< the height, too; the tag is horizontal
  tilt,    ///< all six
};

/// A printed square tag; `side` is that of the outline of its black border.
struct TagMount {
  double side = 0.15;   ///< [m] > 0
  double height = 0.0;  ///< [m] of the tag above the world's z = 0
  base::Pose X_OT;      ///< tag in the frame of its object, whose pose is sent; default: the tag is above the object's
                        ///< origin, which is on the floor where the tag is at `height`
  std::string address;  ///< "host:port" to which its packets are sent; empty: the default
  TagFreedom fit = TagFreedom::plane;
  std::optional<std::uint32_t> robot;  ///< id of the robot that carries the tag; nullopt: the tag's id
};

/// A flat tag at a known position, used to place cameras (vision/placement.h).
struct SurveyedTag {
  glm::dvec3 position;            ///< [m] of its centre in the world
  std::optional<double> heading;  ///< [rad] of its x axis; nullopt: unknown
};
inline constexpr std::size_t kMaxSurveyed = 1000;

struct TestbedCamera {
  Camera camera;
  std::string source;  ///< device, video, image folder or "rendered"; empty: none
};

struct Testbed {
  std::string file;
  std::string dictionary = "apriltag_36h11";      ///< a family of vision/tag_family.h
  TagMount tag;                                   ///< for tags without an entry
  std::map<std::uint32_t, TagMount> tags;         ///< by id
  bool only_listed = false;                       ///< ignore ids without an entry
  std::uint32_t report_from = 1;                  ///< number of the sighting from which a tag is reported, >= 1
  std::vector<TestbedCamera> cameras;             ///< 1 to `kMaxCameras`, names distinct
  std::map<std::uint32_t, SurveyedTag> surveyed;  ///< by id, at most `kMaxSurveyed`

  std::optional<FollowSettings> follow;  ///< nullopt: all cameras search for all tags

  const TagMount& mount(std::uint32_t id) const;
};

/// @throws base::InputError with file and line for unknown keys and values out of range
Testbed parse_testbed(const std::string& file, std::string_view text);
Testbed read_testbed(const std::string& file);

/// Returns the [[camera]] section of one camera.
std::string camera_section(const Camera& camera);

}  // namespace sf::vision
