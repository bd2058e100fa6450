#include "scene/closed_bodies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <span>
#include <tuple>

#include "scene/faces_apart.h"

namespace sf::scene {

namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFFu;
constexpr std::size_t kPairsPerFace = 4'000;  // overlapping intervals that are tested, on average

/// A face on the other side of an edge.
struct Neighbour {
  std::uint32_t face = kNone;
  bool turned = false;  ///< goes along the edge in the same direction, so that its orientation is the opposite
};

class Finder {
 public:
  explicit Finder(const Mesh& mesh)
      : mesh_(mesh), pairs_left_(kPairsPerFace * mesh.faces.size()), welded_(equal_vertices(mesh)) {}
  FaceSides find();

 private:
  void connect();
  void collect(std::uint32_t first);
  bool orient();
  double volume() const;
  bool meets_itself();

  glm::dvec3 corner(std::uint32_t face, std::uint32_t k) const { return mesh_.vertices[mesh_.faces[face][k]]; }

  const Mesh& mesh_;
  std::size_t pairs_left_;
  std::vector<std::uint32_t> welded_;  ///< equal_vertices
  std::vector<std::array<Neighbour, 4>> neighbours_;
  std::vector<std::uint8_t> open_;  ///< per face: an edge without exactly one other face
  FaceSides sides_;
  std::vector<std::uint32_t> members_;  ///< faces of one body
  Bounds box_;                          ///< of one body
};

void Finder::connect() {
  neighbours_.resize(mesh_.faces.size()), open_.resize(mesh_.faces.size());
  const auto link = [&](const FaceEdge& from, const FaceEdge& to) {
    for (Neighbour& slot : neighbours_[from.face])
      if (slot.face == kNone) return void(slot = {to.face, from.forward == to.forward});
  };
  for_each_edge(edges_of(mesh_, welded_), [&](std::span<const FaceEdge> same) {
    const bool pair = same.size() == 2 && same[0].face != same[1].face;
    if (pair) link(same[0], same[1]), link(same[1], same[0]);
    for (const FaceEdge& edge : same)
      if (!pair || edge.low == edge.high) open_[edge.face] = 1;
  });
}

/// Collects the faces that are connected to one.
void Finder::collect(std::uint32_t first) {
  members_.assign(1, first);
  const auto body = static_cast<std::uint32_t>(sides_.bounds.size());
  sides_.body[first] = body;
  for (std::size_t i = 0; i < members_.size(); ++i)
    for (const Neighbour& next : neighbours_[members_[i]])
      if (next.face != kNone && sides_.body[next.face] == kNone) {
        sides_.body[next.face] = body;
        members_.push_back(next.face);
      }
  box_ = {};
  for (const std::uint32_t face : members_)
    for (const std::uint32_t vertex : mesh_.faces[face]) box_.add(mesh_.vertices[vertex]);
}

/// Orients the faces like the first. @return false if that is impossible
bool Finder::orient() {
  sides_.outward[members_[0]] = 1;
  for (const std::uint32_t face : members_)  // each face after the first has a neighbour before it
    for (const Neighbour& next : neighbours_[face]) {
      if (next.face == kNone) continue;
      const auto side = static_cast<std::int8_t>(next.turned ? -sides_.outward[face] : sides_.outward[face]);
      std::int8_t& known = sides_.outward[next.face];
      if (known != 0 && known != side) return false;
      known = side;
    }
  return true;
}

/// Six times the volume [m^3], positive if the faces are counter-clockwise seen from outside.
double Finder::volume() const {
  const glm::dvec3 origin = corner(members_[0], 0);
  double sum = 0.0;
  for (const std::uint32_t f : members_) {
    const glm::dvec3 a = corner(f, 0) - origin, b = corner(f, 1) - origin, c = corner(f, 2) - origin,
                     d = corner(f, 3) - origin;
    sum += sides_.outward[f] * (glm::dot(a, glm::cross(b, c)) + glm::dot(a, glm::cross(c, d)));
  }
  return sum;
}

/// Returns false if the body's faces certainly have no points in common but shared edges and corners. Sweeps along the
/// longest axis.
bool Finder::meets_itself() {
  const glm::dvec3 size = box_.high - box_.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::vector<SweptFace> faces;
  for (const std::uint32_t f : members_) {
    const Face& face = mesh_.faces[f];
    SweptFace& swept = faces.emplace_back();
    swept.corners = corners_of(face);
    for (std::uint32_t k = 0; k < swept.corners; ++k) {
      swept.vertex[k] = welded_[face[k]];
      swept.at[k] = mesh_.vertices[face[k]] - box_.low;
      swept.box.add(swept.at[k]);
    }
  }
  std::ranges::sort(faces, {}, [&](const SweptFace& f) { return f.box.low[axis]; });
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t k = i + 1; k < faces.size() && faces[k].box.low[axis] <= faces[i].box.high[axis]; ++k) {
      if (pairs_left_ == 0) return true;
      --pairs_left_;
      if (overlap(faces[i].box, faces[k].box) && !are_apart(faces[i], faces[k])) return true;
    }
  return false;
}

FaceSides Finder::find() {
  connect();
  sides_.outward.resize(mesh_.faces.size());
  sides_.body.assign(mesh_.faces.size(), kNone);
  for (std::uint32_t first = 0; first < mesh_.faces.size(); ++first) {
    if (sides_.body[first] != kNone) continue;
    collect(first);
    sides_.bounds.push_back(box_);
    const bool open = std::ranges::any_of(members_, [&](std::uint32_t f) { return open_[f] != 0; });
    const glm::dvec3 size = box_.high - box_.low;
    const double longest = std::max({size.x, size.y, size.z});
    bool closed = !open && orient();
    const double space = closed ? volume() : 0.0;
    closed = closed && std::abs(space) > 1e-9 * longest * longest * longest && !meets_itself();
    for (const std::uint32_t f : members_) {
      if (!closed) sides_.outward[f] = 0;
      if (space < 0.0) sides_.outward[f] = static_cast<std::int8_t>(-sides_.outward[f]);
    }
  }
  return std::move(sides_);
}

}  // namespace

FaceSides find_closed_bodies(const Mesh& mesh) { return Finder(mesh).find(); }

}  // namespace sf::scene
