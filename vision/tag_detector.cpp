#include "vision/tag_detector.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "vision/tag_family.h"

namespace sf::vision {

TagDetector::TagDetector(const Testbed& testbed, const Camera& camera)
    : testbed_(testbed),
      camera_(camera),
      cells_(family_pattern(testbed.dictionary, 0).cells),
      finder_(make_family_finder(testbed.dictionary)) {}

TagDetector::~TagDetector() = default;
TagDetector::TagDetector(TagDetector&&) noexcept = default;

bool TagDetector::is_plausible(const TagFit& fit, const TagMount& mount) const {
  const double error = mount.fit == TagFreedom::plane ? std::abs(fit.side - mount.side) / (kMaxSideError * mount.side)
                                                      : std::abs(fit.X_WT.z - mount.height) / kMaxHeightError;
  return error <= 1.0 && fit.residual <= kMaxResidual * fit.pixel;
}

bool TagDetector::measure(const Image& image, const TagOutline& outline, Sighting& out) {
  const TagMount& mount = testbed_.mount(outline.id);
  if (testbed_.only_listed && testbed_.tags.count(outline.id) == 0) {
    ++counts_.unlisted;
    return false;
  }
  find_edges(image, outline, cells_, edges_);
  auto fit = fit_tag(camera_, edges_, mount.height);
  if (fit && mount.fit == TagFreedom::height) fit = at_measured_height(camera_, *fit, mount.side);
  if (fit && mount.fit == TagFreedom::tilt) fit = fit_tag_in_space(camera_, edges_, *fit, mount.side);
  if (!fit) {
    ++counts_.unfitted;
    return false;
  }
  if (!is_plausible(*fit, mount)) {
    ++counts_.misfitted;
    return false;
  }
  out.id = outline.id;
  out.fit = *fit;
  return true;
}

void TagDetector::keep_best_of_each(std::vector<Sighting>& sightings) {
  const auto error = [&](const Sighting& s) {
    const TagMount& mount = testbed_.mount(s.id);
    return std::abs(s.fit.side - mount.side) + std::abs(s.fit.X_WT.z - mount.height);
  };
  std::sort(sightings.begin(), sightings.end(),
            [&](const Sighting& a, const Sighting& b) { return a.id != b.id ? a.id < b.id : error(a) < error(b); });
  repeated_.clear();
  const Sighting* best = nullptr;
  const auto is_second = [&](const Sighting& s) {
    if (best == nullptr || best->id != s.id) return best = &s, false;
    const glm::dvec2 a{best->fit.X_WT.x, best->fit.X_WT.y}, b{s.fit.X_WT.x, s.fit.X_WT.y};
    // The same tag may be found twice, by its inner and its outer edge.
    const bool is_new = repeated_.empty() || repeated_.back().id != s.id;
    if (is_new && glm::distance(a, b) > 0.5 * best->fit.side) repeated_.push_back({s.id, s.time, {a, b}});
    return true;
  };
  std::vector<Sighting> kept;
  for (const Sighting& s : sightings)
    if (!is_second(s)) kept.push_back(s);
  sightings = std::move(kept);
  counts_.repeated += repeated_.size();
}

bool TagDetector::search(const Image& image, const Region& region, double time, const std::set<std::uint32_t>* wanted,
                         std::vector<Sighting>& out) {
  const bool is_readable = finder_->find(image, region, outlines_);
  for (const TagOutline& outline : outlines_) {
    Sighting sighting;
    if (wanted != nullptr && wanted->count(outline.id) == 0) {
      ++counts_.unwanted;
      continue;
    }
    if (!measure(image, outline, sighting)) continue;
    sighting.time = time + middle_of_exposure(camera_, sighting.fit.row);
    out.push_back(sighting);
  }
  return is_readable;
}

void TagDetector::finish(bool is_readable, std::vector<Sighting>& out) {
  ++counts_.images;
  if (!is_readable) ++counts_.unreadable;
  keep_best_of_each(out);
  counts_.sightings += out.size();
}

void TagDetector::detect(const Image& image, double time, std::vector<Sighting>& out) {
  out.clear();
  finish(search(image, whole(image), time, nullptr, out), out);
}

void TagDetector::detect(const Image& image, double time, const Search& parts, const std::set<std::uint32_t>& wanted,
                         std::vector<Sighting>& out) {
  out.clear();
  bool is_readable = !parts.whole || search(image, whole(image), time, &wanted, out);
  for (const Region& region : parts.regions)
    is_readable = !image.pixels.empty() && search(image, region, time, &wanted, out) && is_readable;
  finish(is_readable, out);
}

}  // namespace sf::vision
