#pragma once
// Follows tags from camera to camera: selects the cameras, and the parts of their images, in which the followed tags
// can be. The other cameras sleep.

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "vision/search_region.h"
#include "vision/tracker.h"

namespace sf::vision {

/// Counts of one camera's images while following is set.
struct CameraUse {
  std::uint64_t whole = 0;     ///< searched as a whole
  std::uint64_t parts = 0;     ///< searched in parts
  std::uint64_t asleep = 0;    ///< not searched
  std::uint64_t unread = 0;    ///< of those: not even decoded
  std::uint64_t searched = 0;  ///< [px]

  std::uint64_t pixels = 0;  ///< [px] of all images together, searched or not

  std::uint64_t images() const { return whole + parts + asleep; }
  double share() const { return pixels > 0 ? static_cast<double>(searched) / static_cast<double>(pixels) : 0.0; }
};

/// Counts of one followed tag.
struct TagUse {
  std::uint64_t seen = 0, unseen = 0;  ///< moments in which it was followed, with and without a sighting
  std::uint64_t hand_overs = 0;        ///< from one camera to another
  double longest_gap = 0.0;            ///< [s] without a sighting after its first
};

struct FollowCounts {
  std::vector<CameraUse> cameras;  ///< in the order of the testbed file
  std::map<std::uint32_t, TagUse> tags;
  std::uint64_t starts = 0, stops = 0;
};

/// Not thread-safe.
class Follower {
 public:
  static constexpr double kMessagePeriod = 1.0;  ///< [s] of the images' time, at least between two messages

  /// @param testbed with `follow`; must outlive this
  /// @throws base::InputError for tags that the dictionary or the testbed lacks, and for events that no camera can see
  explicit Follower(const Testbed& testbed);

  /// Starts or stops at a time. Call before `plan`. @param time [s] of the images
  void begin(double time);
  /// Replaces `out` by the search of an image of each camera. @param times [s] of their exposures' beginning
  void plan(std::span<const double> times, const Tracker& tracker, std::vector<Search>& out) const;
  /// @param searches of each camera: as planned, or empty if its image was not searched @param absent not 0: the
  /// camera had no image @param sightings of each camera
  /// @param tracked by all of them; reduced to the tags that are followed
  void observe(double time, std::span<const Search> searches, std::span<const std::uint8_t> absent,
               std::span<const std::vector<Sighting>> sightings, const Tracker& tracker,
               std::vector<TrackedTag>& tracked);

  /// Returns whether following starts by itself until `time` [s].
  bool starts_by(double time) const;
  /// Returns the tags to detect: those that are followed, and that of the event for which this waits.
  const std::set<std::uint32_t>& wanted() const { return wanted_; }
  /// Returns the tags that are followed now: none before the start and after the stop.
  const std::set<std::uint32_t>& followed() const;
  /// True after a stop without a start that could follow it.
  bool is_over() const { return is_over_; }

  void count(std::size_t camera, const Search& search, bool is_read);
  const FollowCounts& counts() const { return counts_; }
  /// Returns messages about events and tags since the last call, at most one in `kMessagePeriod`.
  std::vector<std::string> messages();

 private:
  struct Track {
    std::optional<std::size_t> holder;  ///< camera that saw it last
    std::optional<double> seen;         ///< [s]
    bool searched = false;              ///< all cameras were searched since it was lost
    bool is_lost = false;               ///< for longer than `search`
  };

  void check_tags() const;
  void check_event(const FollowEvent& event) const;
  const FollowEvent& awaited() const;
  void change(bool to_active, double time, const std::string& why, std::span<const TrackedTag> tracked);
  void react(double time, std::span<const TrackedTag> tracked);
  bool is_lost(std::uint32_t id, double time, const Tracker& tracker) const;
  TagPlace place_of(std::uint32_t id, const Tracker::Prediction& prediction, const Camera& camera) const;
  void observe_tag(std::uint32_t id, double time, std::span<const std::vector<Sighting>> sightings);
  void say(double time, std::string text);

  const Testbed& testbed_;
  const FollowSettings& settings_;
  int cells_ = 0;
  bool is_active_ = false, is_over_ = false;
  std::set<std::uint32_t> wanted_;
  std::optional<bool> was_inside_;  ///< the awaited event's tag, when last seen
  std::map<std::uint32_t, Track> tracks_;
  std::size_t turn_ = 0;  ///< camera that is searched as a whole while a tag is lost
  FollowCounts counts_;
  std::vector<std::string> messages_;
  std::optional<double> last_message_;  ///< [s]
  std::uint64_t unsaid_ = 0;
};

}  // namespace sf::vision
