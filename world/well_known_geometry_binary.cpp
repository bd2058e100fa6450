#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "world/geometry_reader.h"

namespace sf::world {

namespace {

class BinaryReader {
 public:
  BinaryReader(std::string_view bytes, WellKnownGeometry& geometry) : bytes_(bytes), geometry_(geometry) {}

  [[noreturn]] void fail(std::string_view expected) {
    throw base::InputError(fmt::format("expected {} at byte {} of {}", expected, at_, bytes_.size()));
  }
  GeometryType type(std::optional<GeometryType>) {
    if (at_ == bytes_.size()) fail("a geometry");
    const char order = bytes_[at_++];
    if (order != 0 && order != 1) fail("a byte order of 0 or 1");
    swap_ = (order == 1) != (std::endian::native == std::endian::little);
    const TypeCode code{value<std::uint32_t>()};
    if (code.has_srid()) geometry_.srid = value<std::uint32_t>();
    if (!code.valid()) fail(fmt::format("a type of geometry instead of {}", code.plain()));
    more_ = code.more();
    return code.type();
  }
  template <class F>
  void each(const F& f) {
    for (auto left = value<std::uint32_t>(); left > 0; --left) f();
  }
  glm::dvec2 point() {
    const glm::dvec2 p = any_point();
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) fail("finite coordinates");
    return p;
  }
  void skip_points(GeometryType type_of_all) {
    if (type_of_all == GeometryType::point) return void(any_point());  // an empty one has NaN
    each([&] {
      type({});
      any_point();
    });
  }
  /// Returns whether only zeros follow, since some writers pad.
  bool at_end() const { return bytes_.find_first_not_of('\0', at_) == std::string_view::npos; }

 private:
  glm::dvec2 any_point() {
    const auto x = value<double>();
    const auto y = value<double>();
    for (int i = 0; i < more_; ++i) value<double>();
    return {x, y};
  }
  template <class T>
  T value() {
    if (bytes_.size() - at_ < sizeof(T)) fail(fmt::format("{} bytes more", sizeof(T)));
    char raw[sizeof(T)];
    std::memcpy(raw, bytes_.data() + at_, sizeof(T));
    if (swap_) std::reverse(std::begin(raw), std::end(raw));
    at_ += sizeof(T);
    return std::bit_cast<T>(raw);
  }
  std::string_view bytes_;
  WellKnownGeometry& geometry_;
  std::size_t at_ = 0;
  bool swap_ = false;  ///< byte order of the current geometry, and its coordinates beyond x and y
  int more_ = 0;
};

}  // namespace

void WellKnownGeometry::clear() {
  points.clear();
  parts.clear();
  points_left_out = faces_left_out = srid = 0;
}

void read_binary_geometry(std::string_view bytes, double arc_error, WellKnownGeometry& geometry) {
  geometry.clear();
  BinaryReader in(bytes, geometry);
  GeometryReader(in, arc_error, geometry).read();
  if (!in.at_end()) in.fail("the end of the geometry");
}

}  // namespace sf::world
