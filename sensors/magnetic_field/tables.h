#pragma once
// Tables shared by the sources of sensors::MagneticField, and the partition of work into items.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "sensors/magnetic_field/magnet_grid.h"
#include "sensors/magnetic_field/magnetic_field.h"

namespace sf::sensors {

/// Largest number of magnets in a work item. Mesa before 25.0 silently ends loops after 65 535 iterations per
/// invocation; items stay far below. Small items also keep all lanes busy when few sensors are near very many magnets.
inline constexpr std::uint32_t kMostItemMagnets = 8192;
inline constexpr std::uint32_t kMostTurns = 60'000;

/// Neighbouring points that share their lists of magnets.
struct PointGroup {
  glm::dvec2 centre;   ///< [m]
  double reach = 0.0;  ///< [m] from the centre: all magnets that affect any of its points are nearer
  std::uint32_t points = 0;
  std::uint32_t spans = 0;    ///< number of spans found; the first is at the group's index times `stride`
  std::uint32_t magnets = 0;  ///< in these spans
  std::uint32_t item = 0;     ///< index of its first item
  std::uint32_t items = 0;
};

/// An item with its number of loop iterations.
struct PlannedItem {
  FieldItem item;
  std::uint32_t loop_turns = 0;
};

struct MagneticField::Tables {
  const world::World& world;
  gpu::Device& device;
  base::ThreadPool& thread_pool;
  double cutoff;
  bool magnitudes;
  std::uint32_t fixed_magnets = 0;  ///< magnets of the world; the movers' magnets follow
  std::uint32_t moving_magnets = 0;
  MagnetGrid fixed_grid, moving_grid;
  std::vector<glm::dvec2> moving_points;  ///< [m] this tick
  std::vector<DipoleRow> moving_rows;

  std::unique_ptr<gpu::Kernel> kernel;
  std::unique_ptr<gpu::Buffer> items, spans, dipoles, points, results, groups;
  bool bound = false;       ///< the kernel is bound to the current tables
  bool fixed_sent = false;  ///< the world's magnets are on the device

  std::vector<PointGroup> point_groups;
  std::vector<PlannedItem> planned;
  std::vector<std::uint32_t> sorted;          ///< planned items, longest first
  std::array<std::uint32_t, 1025> lengths{};  ///< scratch of the sort
  std::uint32_t stride = 1;                   ///< [spans] capacity of a group
  std::uint64_t dipoles_summed = 0;

  Tables(const world::World& w, gpu::Device& d, base::ThreadPool& k, bool has_magnitudes, double c);
  void write_fixed();
  void write_moving();
  void gather(std::span<const FieldPoint> at, std::span<const std::uint32_t> ends);
  void write_places(std::size_t group, std::span<const FieldPoint> at);
  void find_spans(std::size_t group);
  void plan_items();
  void sort_items();
  void write_items();
  void bind();
};

}  // namespace sf::sensors
