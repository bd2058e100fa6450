#pragma once
// What the sources of sensors::MagneticField share: the device's tables and how work is dealt out.

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

/// Most magnets of one item: its turns stay far below the 65 535 of all loops of an invocation, after which Mesa before
/// 25.0 ends them silently; and a few sensors among very many magnets still keep all lanes busy.
inline constexpr std::uint32_t kMostItemMagnets = 8192;
inline constexpr std::uint32_t kMostTurns = 60'000;

/// Neighbouring places, which share their lists of magnets.
struct PointGroup {
  glm::dvec2 centre;   ///< [m]
  double reach = 0.0;  ///< [m] from the centre: every magnet that counts for one of its places is nearer
  std::uint32_t points = 0;
  std::uint32_t spans = 0;    ///< found, first of them at its number times `stride`
  std::uint32_t magnets = 0;  ///< in these
  std::uint32_t item = 0;     ///< its first one
  std::uint32_t items = 0;
};

/// An item and how long it takes.
struct PlannedItem {
  FieldItem item;
  std::uint32_t loop_turns = 0;
};

struct MagneticField::Tables {
  const world::World& world;
  gpu::Device& device;
  base::ThreadPool& thread_pool;
  double cutoff;
  std::uint32_t fixed_magnets = 0;  ///< magnets of the world; the movers' come behind them
  std::uint32_t moving_magnets = 0;
  MagnetGrid fixed_grid, moving_grid;
  std::vector<glm::dvec2> moving_points;  ///< [m] this tick
  std::vector<DipoleRow> moving_rows;

  std::unique_ptr<gpu::Kernel> kernel;
  std::unique_ptr<gpu::Buffer> items, spans, dipoles, points, results, groups;
  bool bound = false;       ///< to the tables of now
  bool fixed_sent = false;  ///< the world's magnets are on the device

  std::vector<PointGroup> point_groups;
  std::vector<PlannedItem> planned;
  std::vector<std::uint32_t> sorted;          ///< planned items, longest first
  std::array<std::uint32_t, 1025> lengths{};  ///< scratch of the sort
  std::uint32_t stride = 1;                   ///< spans a group has room for
  std::uint64_t dipoles_summed = 0;

  Tables(const world::World& w, gpu::Device& d, base::ThreadPool& k, bool magnitudes, double c);
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
