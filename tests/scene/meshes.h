#pragma once
// Meshes and beams for tests of spatial scans.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "scene/rasterizer.h"
#include "scene/reference_scan.h"

namespace sf::scene {

inline glm::dvec3 toward(double azimuth, double elevation) {
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
}

/// Rings from the lowest up, each counter-clockwise from behind.
inline std::vector<glm::dvec3> rings(std::uint32_t channels, std::uint32_t columns, double low, double high,
                                     double fov = 2.0 * M_PI) {
  std::vector<glm::dvec3> beams;
  for (std::uint32_t r = 0; r < channels; ++r)
    for (std::uint32_t c = 0; c < columns; ++c)
      beams.push_back(toward(fov * ((c + 0.5) / columns - 0.5), low + (high - low) * (r + 0.5) / channels));
  return beams;
}

inline void add_box(Mesh& mesh, glm::dvec3 low, glm::dvec3 high) {
  const auto face = [&](std::array<glm::dvec3, 4> corners) { mesh.add(corners, 0); };
  const auto at = [&](int x, int y, int z) {
    return glm::dvec3{x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z};
  };
  face({at(0, 0, 0), at(0, 1, 0), at(0, 1, 1), at(0, 0, 1)}),
      face({at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1)});
  face({at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1)}),
      face({at(0, 1, 0), at(1, 1, 0), at(1, 1, 1), at(0, 1, 1)});
  face({at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0)}),
      face({at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1)});
}

/// Triangles of any size and direction.
inline Mesh soup(std::size_t count, double spread, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto vector = [&](double scale) { return scale * glm::dvec3{unit(random), unit(random), unit(random)}; };
  Mesh mesh;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 centre = vector(spread);
    const double size = std::pow(10.0, unit(random));
    mesh.add(std::array{centre + vector(size), centre + vector(size), centre + vector(size)},
             static_cast<std::uint32_t>(i));
  }
  return mesh;
}

/// A closed sphere of triangles that share vertices.
inline Mesh sphere(glm::dvec3 centre, double radius, std::uint32_t rows, std::uint32_t columns) {
  Mesh mesh;
  for (std::uint32_t r = 0; r <= rows; ++r)
    for (std::uint32_t c = 0; c < columns; ++c) {
      const bool pole = r == 0 || r == rows;  // all its vertices are equal
      const glm::dvec3 up{0.0, 0.0, r == 0 ? -1.0 : 1.0};
      mesh.vertices.push_back(centre +
                              radius * (pole ? up : toward(2.0 * M_PI * c / columns, M_PI * r / rows - 0.5 * M_PI)));
    }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.faces.push_back({a, b, c, c}), mesh.owners.push_back(0);
  };
  for (std::uint32_t r = 0; r < rows; ++r)
    for (std::uint32_t c = 0; c < columns; ++c) {
      const std::uint32_t a = r * columns + c, b = r * columns + (c + 1) % columns, d = a + columns, e = b + columns;
      if (r > 0) add(a, b, r + 1 == rows ? d : e);
      if (r > 0 && r + 1 < rows) add(a, e, d);
      if (r == 0) add(a, e, d);
    }
  return mesh;
}

/// A hilly surface of `cells` x `cells` squares of 1 m, two triangles each.
inline Mesh hills(std::uint32_t cells, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> height(-0.5, 0.5);
  Mesh mesh;
  const std::uint32_t row = cells + 1;
  for (std::uint32_t y = 0; y < row; ++y)
    for (std::uint32_t x = 0; x < row; ++x)
      mesh.vertices.emplace_back(x - 0.5 * cells, y - 0.5 * cells, -1.5 + height(random));
  for (std::uint32_t y = 0; y < cells; ++y)
    for (std::uint32_t x = 0; x < cells; ++x) {
      const std::uint32_t a = y * row + x;
      for (const Face& face : {Face{a, a + 1, a + row + 1, a + row + 1}, Face{a, a + row + 1, a + row, a + row}})
        mesh.faces.push_back(face), mesh.owners.push_back(0);
    }
  return mesh;
}

/// Heights drawn from [0, rough] on a surface with long waves.
inline HeightField waves(std::uint32_t columns, std::uint32_t rows, double rough, std::uint64_t seed,
                         glm::dvec2 cell = {1.0, 1.0}) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, rough);
  std::vector<float> heights;
  for (std::uint32_t y = 0; y < rows; ++y)
    for (std::uint32_t x = 0; x < columns; ++x)
      heights.push_back(static_cast<float>(2.0 * std::sin(0.3 * x) * std::cos(0.2 * y) + unit(random)));
  return build_height_field(columns, rows, cell, heights);
}

inline void move(Mesh& mesh, glm::dvec3 by) {
  for (glm::dvec3& vertex : mesh.vertices) vertex += by;
}

struct SpatialScan {
  std::vector<double> ranges;
  std::vector<std::uint32_t> hits;
  std::vector<base::QualityFlag> quality;
  std::uint64_t uncertain = 0;
  bool operator==(const SpatialScan&) const = default;
};

/// Casts into poisoned memory.
inline SpatialScan cast(const RigidTransform& X_WS, const std::vector<glm::dvec3>& beams, double range_max,
                        const SceneView& scene, std::uint32_t row = 0, bool single = false) {
  SpatialScan out{std::vector<double>(beams.size(), -1.0), std::vector<std::uint32_t>(beams.size(), 0xDEADu),
                  std::vector<base::QualityFlag>(beams.size())};
  Rasterizer rasterizer;
  const bool flagged =
      rasterizer.scan(X_WS, make_pattern(beams, row), range_max, scene,
                      {.ranges = out.ranges, .hits = out.hits, .quality = out.quality, .single = single});
  const bool found = std::ranges::any_of(out.quality, [](auto flag) { return flag != base::QualityFlag::none; });
  EXPECT_EQ(flagged, found);
  out.uncertain = rasterizer.counts().uncertain;
  return out;
}

/// Compares a scan with the reference. @return the number of flagged beams
inline std::size_t expect_bound(const SpatialScan& scan, const RigidTransform& X_WS,
                                const std::vector<glm::dvec3>& beams, double range_max, const SceneView& scene,
                                double bound = kRangeError) {
  std::size_t flagged = 0, wrong = 0;
  for (std::size_t i = 0; i < beams.size(); ++i) {
    if (scan.quality[i] != base::QualityFlag::none) {
      ++flagged;
      continue;
    }
    const ReferenceHit hit = reference_scan(X_WS, beams[i], range_max, scene);
    const double error = static_cast<double>(std::abs(scan.ranges[i] - hit.range));
    if (error <= bound) continue;
    if (++wrong < 4)
      ADD_FAILURE() << "beam " << i << ": " << scan.ranges[i] << ", expected " << static_cast<double>(hit.range);
  }
  EXPECT_EQ(wrong, 0u);
  return flagged;
}

struct Posed {
  RigidTransform X_WS;
  explicit Posed(std::uint64_t seed, double spread = 0.0) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    X_WS.R = base::rotation_of(M_PI * unit(random), 0.5 * M_PI * unit(random), M_PI * unit(random));
    X_WS.p = spread * glm::dvec3{unit(random), unit(random), unit(random)};
  }
};

}  // namespace sf::scene
