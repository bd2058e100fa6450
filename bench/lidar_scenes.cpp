#include "bench/lidar_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <random>
#include <stdexcept>
#include <utility>

namespace sf::bench {

namespace {

using glm::dvec3;
using scene::Mesh;

using Random = std::mt19937_64;
double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

void add_quad(Mesh& mesh, dvec3 a, dvec3 b, dvec3 c, dvec3 d) { mesh.add(std::array{a, b, c, d}, 0); }

/// The sides and the top of a box on the ground, or all six sides.
void add_box(Mesh& mesh, dvec3 low, dvec3 high, bool bottom, bool top = true) {
  const auto at = [&](int x, int y, int z) {
    return dvec3{x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z};
  };
  add_quad(mesh, at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1));
  add_quad(mesh, at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1));
  add_quad(mesh, at(1, 1, 0), at(0, 1, 0), at(0, 1, 1), at(1, 1, 1));
  add_quad(mesh, at(0, 1, 0), at(0, 0, 0), at(0, 0, 1), at(0, 1, 1));
  if (top) add_quad(mesh, at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1));
  if (bottom) add_quad(mesh, at(0, 0, 0), at(0, 1, 0), at(1, 1, 0), at(1, 0, 0));
}

/// A closed grid of triangles. @param at (row, column) -> vertex; both wrap or end at `rows`
template <class At>
void add_grid(Mesh& mesh, std::uint32_t rows, std::uint32_t columns, bool closed, const At& at) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const std::uint32_t height = closed ? rows : rows + 1, width = closed ? columns : columns + 1;
  for (std::uint32_t r = 0; r < height; ++r)
    for (std::uint32_t c = 0; c < width; ++c) mesh.vertices.push_back(at(r, c));
  const auto vertex = [&](std::uint32_t r, std::uint32_t c) { return first + r % height * width + c % width; };
  for (std::uint32_t r = 0; r < rows; ++r)
    for (std::uint32_t c = 0; c < columns; ++c) {
      const std::uint32_t a = vertex(r, c), b = vertex(r, c + 1), d = vertex(r + 1, c), e = vertex(r + 1, c + 1);
      mesh.faces.push_back({a, b, e, e}), mesh.faces.push_back({a, e, d, d});
      mesh.owners.push_back(0), mesh.owners.push_back(0);
    }
}

dvec3 on_circle(double angle) { return {std::cos(angle), std::sin(angle), 0.0}; }

LidarScene city(int blocks, int poses, Random& random) {
  LidarScene out;
  for (int i = 0; i < blocks; ++i)
    for (int j = 0; j < blocks; ++j) {
      const dvec3 corner{10.0 * i, 10.0 * j, 0.0};
      add_box(out.mesh, corner, corner + dvec3{6.0, 6.0, uniform(random, 3.0, 20.0)}, false);
      add_quad(out.mesh, corner, corner + dvec3{10, 0, 0}, corner + dvec3{10, 10, 0}, corner + dvec3{0, 10, 0});
    }
  for (int k = 0; k < poses; ++k) {
    dvec3 p{10.0 * std::floor(uniform(random, 0, blocks)) + uniform(random, 6.5, 9.5),
            uniform(random, 0, 10.0 * blocks), uniform(random, 0.5, 1.8)};
    if (k % 2) std::swap(p.x, p.y);
    out.poses.push_back({{}, p});
  }
  return out;
}

LidarScene room(int poses, bool roof, Random& random) {
  LidarScene out;
  add_box(out.mesh, {0, 0, 0}, {20, 15, 4}, true, roof);
  for (int k = 0; k < 12; ++k) {
    const dvec3 c{uniform(random, 1, 19), uniform(random, 1, 14), uniform(random, 0.4, 3.0)};
    const double radius = uniform(random, 0.3, 0.8);
    add_grid(out.mesh, 24, 48, true, [&](std::uint32_t r, std::uint32_t col) {  // a torus
      const double u = 2.0 * M_PI * r / 24, v = 2.0 * M_PI * col / 48;
      return c + radius * (1.0 + 0.4 * std::cos(u)) * on_circle(v) + dvec3{0, 0, 0.4 * radius * std::sin(u)};
    });
    add_grid(out.mesh, 12, 48, false, [&](std::uint32_t r, std::uint32_t col) {  // a lamp: an open ball
      const double u = M_PI * (r / 12.0 * 0.98 + 0.01);
      return dvec3{20.0 - c.x, 15.0 - c.y, c.z} +
             0.5 * radius * (std::sin(u) * on_circle(2.0 * M_PI * col / 48) + dvec3{0, 0, std::cos(u)});
    });
  }
  for (int k = 0; k < 40; ++k) {  // chairs
    const dvec3 p{uniform(random, 0.5, 19), uniform(random, 0.5, 14), 0.0};
    for (int leg = 0; leg < 4; ++leg)
      add_box(out.mesh, p + dvec3{0.4 * (leg % 2), 0.4 * (leg / 2), 0},
              p + dvec3{0.4 * (leg % 2) + 0.04, 0.4 * (leg / 2) + 0.04, 0.45}, true);
    add_box(out.mesh, p + dvec3{0, 0, 0.45}, p + dvec3{0.44, 0.44, 0.5}, true);
    add_box(out.mesh, p + dvec3{0, 0, 0.5}, p + dvec3{0.04, 0.44, 0.95}, true);
  }
  for (int k = 0; k < poses; ++k)
    out.poses.push_back({{}, {uniform(random, 0.5, 19.5), uniform(random, 0.5, 14.5), uniform(random, 0.3, 1.8)}});
  return out;
}

LidarScene terrain(int poses, Random& random) {
  LidarScene out;
  const auto height = [](double x, double y) {
    return 6.0 * std::sin(0.05 * x) * std::cos(0.04 * y) + 1.5 * std::sin(0.21 * x + 0.3) * std::sin(0.17 * y) +
           0.2 * std::sin(1.3 * x) * std::sin(1.1 * y);
  };
  std::vector<float> heights;
  for (int r = 0; r <= 512; ++r)
    for (int c = 0; c <= 512; ++c) heights.push_back(static_cast<float>(height(0.5 * c, 0.5 * r)));
  out.field = scene::build_height_field(513, 513, {0.5, 0.5}, heights);
  add_grid(out.mesh, 512, 512, false, [&](std::uint32_t r, std::uint32_t c) {
    return dvec3{0.5 * c, 0.5 * r, heights[513 * r + c]};
  });
  for (int k = 0; k < poses; ++k) {
    const double x = uniform(random, 50, 206), y = uniform(random, 50, 206);
    out.poses.push_back({{}, {x, y, height(x, y) + uniform(random, 0.9, 2.0)}});
  }
  return out;
}

/// A crown of leaves in two triangles each, within a ball above a trunk.
world::Mesh tree(Random& random) {
  constexpr std::uint32_t kLeaves = 9'900, kSides = 100;
  world::Mesh mesh;
  const auto add = [&](dvec3 a, dvec3 b, dvec3 c, dvec3 d) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {a, b, c, d});
    for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.corners.push_back(first + k);
  };
  const auto unit = [&] {
    return glm::normalize(dvec3{uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)});
  };
  for (std::uint32_t k = 0; k < kLeaves; ++k) {
    const dvec3 p = dvec3{0, 0, 3.5} + 1.5 * std::cbrt(uniform(random, 0.1, 1.0)) * unit(), u = 0.05 * unit(),
                v = 0.05 * glm::normalize(glm::cross(u, unit()));
    add(p - u - v, p + u - v, p + u + v, p - u + v);
  }
  for (std::uint32_t k = 0; k < kSides; ++k) {
    const dvec3 a = 0.15 * on_circle(2.0 * M_PI * k / kSides), b = 0.15 * on_circle(2.0 * M_PI * (k + 1) / kSides),
                up{0, 0, 3.0};
    add(a, b, b + up, a + up);
  }
  return mesh;
}

/// A ball with dents, of triangles of 1 to 3 cm.
world::Mesh statue() {
  constexpr std::uint32_t kRings = 140, kColumns = 280;
  Mesh ball;
  add_grid(ball, kRings, kColumns, false, [&](std::uint32_t r, std::uint32_t c) {
    const double u = M_PI * (r + 0.01) / (kRings + 0.02), v = 2.0 * M_PI * c / kColumns;
    return dvec3{0, 0, 1.0} + (1.0 + 0.02 * std::sin(9.0 * u) * std::sin(8.0 * v)) *
                                  (std::sin(u) * on_circle(v) + dvec3{0, 0, std::cos(u)});
  });
  world::Mesh mesh{.vertices = ball.vertices};
  for (const scene::Face& face : ball.faces) mesh.corners.insert(mesh.corners.end(), face.begin(), face.begin() + 3);
  return mesh;
}

LidarScene forest(world::Mesh mesh, int poses, Random& random) {
  constexpr std::uint32_t kTrees = 1'000;
  LidarScene out;
  out.forest.meshes.push_back(std::move(mesh));
  out.forest.models.resize(kTrees);
  for (std::uint32_t i = 0; i < kTrees; ++i)
    out.forest.mesh_models.push_back(
        {0, i, {uniform(random, 0, 160), uniform(random, 0, 160), 0.0, uniform(random, -M_PI, M_PI)}});
  for (int k = 0; k < poses; ++k)
    out.poses.push_back({{}, {uniform(random, 40, 120), uniform(random, 40, 120), uniform(random, 0.9, 2.0)}});
  return out;
}

}  // namespace

LidarScene lidar_scene(const std::string& name, int poses) {
  Random random(7);
  int blocks = 0;
  LidarScene out = std::sscanf(name.c_str(), "city%d", &blocks) == 1 ? city(blocks, poses, random)
                   : name == "room" || name == "room32"              ? room(poses, true, random)
                   : name == "yard"                                  ? room(poses, false, random)
                   : name == "terrain"                               ? terrain(poses, random)
                   : name == "forest"                                ? forest(tree(random), poses, random)
                   : name == "statues"                               ? forest(statue(), poses, random)
                                                                     : LidarScene{};
  if (out.poses.empty())
    throw std::invalid_argument("no scene " + name +
                                "; expected cityN, room, room32, yard, terrain, forest or statues");
  if (name == "room32")
    for (dvec3& v : out.mesh.vertices) v = glm::round(v * 0x1p19) * 0x1p-19;  // as 32 bits at 16 m
  for (base::RigidTransform& X : out.poses)
    X.R = base::rotation_of(uniform(random, -0.05, 0.05), uniform(random, -0.05, 0.05), uniform(random, -M_PI, M_PI));
  return out;
}

std::vector<dvec3> lidar_beams(const std::string& name, std::uint32_t& row) {
  std::uint32_t a = 0, b = 0;
  std::vector<dvec3> beams;
  if (std::sscanf(name.c_str(), "lidar%ux%u", &a, &b) == 2) {
    row = b;
    const double fov = (a <= 16 ? 30.0 : 45.0) * M_PI / 180.0;
    for (std::uint32_t r = 0; r < a; ++r)
      for (std::uint32_t c = 0; c < b; ++c) {
        const double e = fov * ((r + 0.5) / a - 0.5);
        beams.push_back(std::cos(e) * on_circle(2.0 * M_PI * (c + 0.5) / b - M_PI) + dvec3{0, 0, std::sin(e)});
      }
  } else if (std::sscanf(name.c_str(), "camera%ux%u", &a, &b) == 2) {
    row = 0;
    for (std::uint32_t r = 0; r < b; ++r)
      for (std::uint32_t c = 0; c < a; ++c)
        beams.push_back(glm::normalize(dvec3{0.5 * a, 0.5 * a - c - 0.5, 0.5 * b - r - 0.5}));
  }
  if (beams.empty()) throw std::invalid_argument("no sensor " + name + "; expected lidarRxC or cameraWxH");
  return beams;
}

scene::BeamPattern lidar_pattern(std::span<const dvec3> beams, std::uint32_t row) {
  if (row > 0) return scene::make_pattern(beams, row);
  const auto height_of = [](const dvec3& d) { return d.z / d.x; };  // in the image
  const auto width =
      std::ranges::find_if(beams, [&](const dvec3& d) { return std::abs(height_of(d) - height_of(beams[0])) > 1e-9; });
  return scene::make_image_pattern(beams, static_cast<std::uint32_t>(width - beams.begin()));
}

}  // namespace sf::bench
