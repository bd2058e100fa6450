#include "vision/tag_family.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "vision/bch_code.h"
#include "vision/bch_finder.h"

namespace sf::vision {

namespace {

constexpr std::string_view kAprilTags = "apriltag_", kOpenCvTurn = "_opencv";

struct Family {
  std::string dictionary;  ///< OpenCV's name; empty: ARToolKitPlus's markers
  bool is_turned = false;  ///< by 180 degrees relative to OpenCV's
};

Family family_of(const std::string& name) {
  if (name == "artoolkitplus_bch") return {};
  if (name.empty()) throw base::InputError("a family of tags has no name; expected one such as apriltag_36h11");
  if (!name.starts_with(kAprilTags)) return {name, false};
  if (!name.ends_with(kOpenCvTurn)) return {name, true};
  return {name.substr(0, name.size() - kOpenCvTurn.size()), false};
}

/// Turns the tags of another finder by 180 degrees.
class TurnedFinder : public TagFinder {
 public:
  explicit TurnedFinder(std::unique_ptr<TagFinder> finder) : finder_(std::move(finder)) {}
  bool find(const Image& image, const Region& region, std::vector<TagOutline>& found) override {
    const bool is_readable = finder_->find(image, region, found);
    for (TagOutline& outline : found)
      std::rotate(outline.corners.begin(), outline.corners.begin() + 2, outline.corners.end());
    return is_readable;
  }

 private:
  std::unique_ptr<TagFinder> finder_;
};

}  // namespace

TagPattern family_pattern(const std::string& name, std::uint32_t id) {
  const Family family = family_of(name);
  const std::uint32_t size = family_size(name);
  if (id >= size)
    throw base::InputError(
        fmt::format("tag {} is not in dictionary '{}', which has the ids 0 to {}", id, name, size - 1));
  TagPattern pattern = family.dictionary.empty() ? bch_pattern(id) : opencv().tag_pattern(family.dictionary, id);
  if (family.is_turned) std::reverse(pattern.white.begin(), pattern.white.end());
  return pattern;
}

std::uint32_t family_size(const std::string& name) {
  const Family family = family_of(name);
  if (family.dictionary.empty()) return kBchIds;
  try {
    return opencv().tag_count(family.dictionary);
  } catch (const base::InputError& error) {
    throw base::InputError(
        fmt::format("{}, artoolkitplus_bch, or an apriltag_* followed by {}", error.what(), kOpenCvTurn));
  }
}

std::unique_ptr<TagFinder> make_family_finder(const std::string& name) {
  const Family family = family_of(name);
  if (family.dictionary.empty()) return make_bch_finder();
  family_size(name);  // reports unknown names
  auto finder = opencv().make_tag_finder(family.dictionary);
  return family.is_turned ? std::make_unique<TurnedFinder>(std::move(finder)) : std::move(finder);
}

std::string family_orientation(const std::string& name) {
  if (!name.starts_with(kAprilTags)) return "";
  if (name.ends_with(kOpenCvTurn))
    return "upright as OpenCV prints them; AprilRobotics' images read turned by 180 degrees";
  return fmt::format(
      "upright as AprilRobotics prints them; those printed by OpenCV read turned by 180 degrees "
      "(dictionary = \"{}{}\")",
      name, kOpenCvTurn);
}

}  // namespace sf::vision
