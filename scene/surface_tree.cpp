#include "scene/surface_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <utility>

#include "scene/closed_bodies.h"

namespace sf::scene {

namespace {

constexpr int kBins = 24;
constexpr float kUnused = 1e30f;  // [m]
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double area_of(const Bounds& box) {
  const glm::dvec3 d = box.high - box.low;
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

/// A node of the binary tree: `first` and `count` are a range of `Builder::order_`.
struct BinaryNode {
  Bounds box;
  std::uint32_t first = 0, count = 0;
  std::int32_t left = -1, right = -1;  ///< rows; -1: a leaf
};

class Builder {
 public:
  explicit Builder(SurfaceTree& tree) : tree_(tree), mesh_(tree.mesh) {}
  void build();

 private:
  void add_planes();
  std::int32_t split(std::uint32_t first, std::uint32_t end);
  std::uint32_t partition(std::uint32_t first, std::uint32_t end, const Bounds& centres);
  std::int32_t collapse(std::int32_t binary);
  std::int32_t make_leaf(const BinaryNode& node);
  void write_face(TreeLeaf& leaf, std::uint32_t i, std::uint32_t face);
  void write_bodies(TreeLeaf& leaf) const;

  SurfaceTree& tree_;
  const Mesh& mesh_;
  FaceSides sides_;
  std::vector<Bounds> boxes_;         ///< per face, relative to the centre
  std::vector<std::uint32_t> order_;  ///< rows of faces
  std::vector<BinaryNode> binary_;
};

void Builder::build() {
  Bounds all;
  for (const glm::dvec3& vertex : mesh_.vertices) all.add(vertex);
  tree_.centre = 0.5 * (all.low + all.high);
  for (const glm::dvec3& vertex : mesh_.vertices)
    tree_.radius = std::max(tree_.radius, glm::length(vertex - tree_.centre));
  add_planes();
  sides_ = find_closed_bodies(mesh_);
  order_.resize(mesh_.faces.size());
  std::iota(order_.begin(), order_.end(), 0u);
  split(0, static_cast<std::uint32_t>(order_.size()));
  tree_.root = collapse(0);
}

void Builder::add_planes() {
  for (const Face& face : mesh_.faces) {
    Bounds box;
    for (const std::uint32_t corner : face) box.add(mesh_.vertices[corner] - tree_.centre);
    boxes_.push_back(box);
    tree_.planes.push_back(plane_of(mesh_, face));
  }
}

std::int32_t Builder::split(std::uint32_t first, std::uint32_t end) {
  BinaryNode node{.first = first, .count = end - first};
  Bounds centres;
  for (std::uint32_t i = first; i < end; ++i) {
    const Bounds& box = boxes_[order_[i]];
    node.box.add(box);
    centres.add(0.5 * (box.low + box.high));
  }
  const auto self = static_cast<std::int32_t>(binary_.size());
  binary_.push_back(node);
  if (node.count <= kWidth) return self;
  const std::uint32_t middle = partition(first, end, centres);
  const std::int32_t left = split(first, middle);
  const std::int32_t right = split(middle, end);
  binary_[self].left = left, binary_[self].right = right;
  return self;
}

/// Reorders a range of faces into two. @return the start of the second, which like the first is not empty
std::uint32_t Builder::partition(std::uint32_t first, std::uint32_t end, const Bounds& centres) {
  const auto bin_of = [&](std::uint32_t face, int axis) {
    const double c = 0.5 * (boxes_[face].low[axis] + boxes_[face].high[axis]);
    const double width = centres.high[axis] - centres.low[axis];
    return std::min(kBins - 1, static_cast<int>(kBins * ((c - centres.low[axis]) / width)));
  };
  double least = kInfinity;
  int best_axis = -1, best_bin = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(centres.high[axis] > centres.low[axis])) continue;
    std::array<Bounds, kBins> bins;
    std::array<std::uint32_t, kBins> counts{};
    for (std::uint32_t i = first; i < end; ++i) {
      const int bin = bin_of(order_[i], axis);
      bins[bin].add(boxes_[order_[i]]), ++counts[bin];
    }
    std::array<double, kBins> above{};  // cost of all bins from this one
    Bounds box;
    std::uint32_t count = 0;
    for (int k = kBins - 1; k > 0; --k) {
      if (counts[k] > 0) box.add(bins[k]);
      count += counts[k];
      above[k] = count == 0 ? kInfinity : area_of(box) * ((count + kWidth - 1) / kWidth);
    }
    box = {}, count = 0;
    for (int k = 1; k < kBins; ++k) {
      if (counts[k - 1] > 0) box.add(bins[k - 1]);
      count += counts[k - 1];
      if (count == 0) continue;
      const double cost = area_of(box) * ((count + kWidth - 1) / kWidth) + above[k];
      if (cost < least) least = cost, best_axis = axis, best_bin = k;
    }
  }
  if (best_axis < 0) return first + (end - first) / 2;  // all centres coincide
  const auto middle = std::partition(order_.begin() + first, order_.begin() + end,
                                     [&](std::uint32_t face) { return bin_of(face, best_axis) < best_bin; });
  return static_cast<std::uint32_t>(middle - order_.begin());
}

/// Converts a binary node with its descendants. @return as TreeNode::child
std::int32_t Builder::collapse(std::int32_t binary) {
  if (binary_[binary].left < 0) return make_leaf(binary_[binary]);
  std::vector<std::int32_t> children{binary_[binary].left, binary_[binary].right};
  while (children.size() < kWidth) {  // replace the largest by its two
    auto largest = children.end();
    for (auto c = children.begin(); c != children.end(); ++c)
      if (binary_[*c].left >= 0 &&
          (largest == children.end() || area_of(binary_[*c].box) > area_of(binary_[*largest].box)))
        largest = c;
    if (largest == children.end()) break;
    const BinaryNode& node = binary_[*largest];
    *largest = node.left;
    children.push_back(node.right);
  }
  const std::size_t self = tree_.nodes.size();
  tree_.nodes.emplace_back();
  TreeNode node{};
  for (std::uint32_t i = 0; i < kWidth; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      node.bound[axis][i] = kUnused, node.bound[axis + 3][i] = -kUnused;
      if (i >= children.size()) continue;
      const Bounds& box = binary_[children[i]].box;
      node.bound[axis][i] = std::nextafter(static_cast<float>(box.low[axis]), -HUGE_VALF);
      node.bound[axis + 3][i] = std::nextafter(static_cast<float>(box.high[axis]), HUGE_VALF);
    }
    if (i < children.size()) node.child[i] = collapse(children[i]);
  }
  tree_.nodes[self] = node;
  return static_cast<std::int32_t>(self);
}

std::int32_t Builder::make_leaf(const BinaryNode& node) {
  TreeLeaf leaf{};
  const glm::dvec3 centre = tree_.centre + 0.5 * (node.box.low + node.box.high);
  double radius = 0.0;
  for (std::uint32_t i = 0; i < node.count; ++i)
    for (const std::uint32_t corner : mesh_.faces[order_[node.first + i]])
      radius = std::max(radius, glm::length(mesh_.vertices[corner] - centre));
  for (int axis = 0; axis < 3; ++axis) leaf.centre[axis] = centre[axis];
  leaf.radius = std::nextafter(static_cast<float>(radius), HUGE_VALF);
  leaf.count = node.count;
  for (std::uint32_t i = 0; i < node.count; ++i) write_face(leaf, i, order_[node.first + i]);
  write_bodies(leaf);
  tree_.leaves.push_back(leaf);
  return ~static_cast<std::int32_t>(tree_.leaves.size() - 1);
}

void Builder::write_face(TreeLeaf& leaf, std::uint32_t i, std::uint32_t row) {
  const Face& face = mesh_.faces[row];
  const glm::dvec3 centre{leaf.centre[0], leaf.centre[1], leaf.centre[2]};
  std::array<glm::dvec3, 4> corners;
  for (std::uint32_t k = 0; k < 4; ++k) corners[k] = mesh_.vertices[face[k]] - centre;
  if (corners_of(face) == 3) corners[3] = 0.5 * (corners[2] + corners[0]);
  double longest = 0.0;
  for (std::uint32_t k = 0; k < 4; ++k) {
    longest = std::max(longest, glm::length(corners[(k + 1) % 4] - corners[k]));
    for (int axis = 0; axis < 3; ++axis) leaf.corner[k][axis][i] = static_cast<float>(corners[k][axis]);
  }
  for (int axis = 0; axis < 3; ++axis) leaf.normal[axis][i] = static_cast<float>(tree_.planes[row].normal[axis]);
  leaf.extent[i] = static_cast<float>((2.0 * static_cast<double>(leaf.radius) + 6.0 * longest) * 1.001);
  leaf.face[i] = row;
  tree_.longest_edge = std::max(tree_.longest_edge, longest);
}

void Builder::write_bodies(TreeLeaf& leaf) const {
  Bounds bodies;
  for (std::uint32_t i = 0; i < leaf.count; ++i) {
    const std::int8_t side = sides_.outward[leaf.face[i]];
    if (side == 0) continue;
    leaf.outward |= 1u << (side > 0 ? i : i + kWidth);
    bodies.add(sides_.bounds[sides_.body[leaf.face[i]]]);
  }
  if (leaf.outward == 0) return;
  const glm::dvec3 centre{leaf.centre[0], leaf.centre[1], leaf.centre[2]};
  const glm::dvec3 low = bodies.low - centre, high = bodies.high - centre;
  const double room = 1e-5 * std::max(glm::length(low), glm::length(high));
  for (int axis = 0; axis < 3; ++axis) {
    leaf.body[axis] = static_cast<float>(low[axis] - room);
    leaf.body[axis + 3] = static_cast<float>(high[axis] + room);
  }
}

}  // namespace

SurfaceTree build_tree(Mesh mesh) {
  SurfaceTree tree;
  tree.mesh = std::move(mesh);
  if (!tree.empty()) Builder(tree).build();
  return tree;
}

}  // namespace sf::scene
