#pragma once
// Scene on the device: walls and movers as exact segments, and sector lists around the sensors.
//
// One table holds all lists, in texels of 16 bytes: empty lists, outlines of movers, the pool of cells (list heads,
// entries, chunks of entries), and lists of the movers near each view, rebuilt each tick.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/thread_pool.h"
#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "raycast/candidate_walls.h"
#include "raycast/mover_geometry.h"
#include "raycast/records.h"
#include "raycast/scene_options.h"
#include "raycast/view_cells.h"
#include "world/world.h"

namespace sf::raycast {

/// Not thread-safe. `world` may be destroyed after construction.
class DeviceScene {
 public:
  /// @param configs complete list of configs, built for `world`; must outlive this object
  /// @param sensing_movers number of movers with scanners; determines the first allocation
  DeviceScene(const world::World& world, const ListConfigs& configs, gpu::Device& device, base::ThreadPool& thread_pool,
              const SceneOptions& options, std::uint32_t sensing_movers);
  ~DeviceScene();

  /// Moves the movers to this tick's poses. @param states one per mover; after a change, call again before `prepare`
  void place_movers(std::span<const base::Report> states);

  /// Replaces the movers' outlines by those of `world`, which has the same walls. Call `place_movers` before `prepare`.
  /// @return false, without changes, if the tables are too small
  bool update_outlines(const world::World& world);

  /// Builds the lists for all `views` and fills `rows`, one per view: all fields except beams, results and range_min.
  /// @return true if tables were replaced and kernels must be bound again
  bool prepare(std::span<const Viewpoint> views, std::span<RayRow> rows);

  /// Returns whether view `i` of the last `prepare` must be scanned by the host, because its lists would be too long or
  /// movers around it overlap. Its row then refers to empty lists.
  bool needs_host(std::size_t i) const { return needs_host_[i] != 0; }
  /// Records copies of all tables that changed since the last call.
  void upload(gpu::Batch& batch);

  bool has_movers() const { return movers_.segments() > 0; }
  gpu::Buffer& lists() { return *lists_; }
  gpu::Buffer& segment_ids() { return *segment_ids_; }
  gpu::Buffer& mover_rows() { return *mover_rows_; }
  gpu::Buffer& segments() { return *segments_; }
  gpu::Buffer& models() { return *models_; }

  struct Counts {
    std::uint64_t cells_built = 0;      ///< since construction
    std::uint64_t movers_in_range = 0;  ///< since construction: pairs of a view and a mover in its range
    std::uint64_t movers_visible = 0;   ///< of these, in the field of view
  };
  Counts counts() const;

 private:
  /// Cells and tables of one list config.
  struct ConfigTables {
    CellShape shape;
    double spread = 0.0;  ///< [rad] from the middle of a lane's beams to the outermost, plus the error of the search
  };
  /// Texels of one cell.
  struct Cell {
    std::uint32_t first = 0, count = 0;
    bool too_long = false;  ///< its lists would exceed the limit and are empty
  };
  struct NearbyMover;
  struct Scratch;

  void write_outlines();
  void build_missing_cells();
  Cell make_cell(const CellKey& key, Scratch& scratch);
  void fill_row(const Viewpoint& view, std::size_t i, RayRow& row);
  void find_nearby_movers(const Viewpoint& view, Scratch& scratch) const;
  void find_front_edges(const Viewpoint& view, NearbyMover& near, Scratch& scratch) const;
  std::uint32_t mover_lists_size(const Scratch& scratch, std::size_t most) const;
  void write_mover_lists(std::uint32_t at, const Scratch& scratch);
  bool build_mover_lists(std::span<const Viewpoint> views, std::span<RayRow> rows, bool more_room);
  void make_room(std::uint32_t sensing_movers);
  void grow(std::uint32_t pool_cells, std::uint32_t pool_chunks, std::uint32_t mover_texels);
  bool try_to_grow(std::uint32_t pool_cells, std::uint32_t pool_chunks, std::uint32_t mover_texels);
  std::uint32_t pool_end() const;

  base::ThreadPool& thread_pool_;
  gpu::Device& device_;
  const SceneOptions limits_;
  SceneOptions options_;  ///< current capacity
  const ListConfigs& configs_;
  std::vector<ConfigTables> config_tables_;  ///< per list config
  MoverGeometry movers_;
  ViewCells cells_;
  std::vector<Cell> cell_tables_;                  ///< per slot
  std::vector<std::uint32_t> first_mover_rows_;    ///< of each mover: one row per slice between its lowest and highest;
                                                   ///< then the end
  std::uint32_t pool_begin_ = SF_SECTORS;          ///< texel
  std::vector<std::uint8_t> needs_host_;           ///< per view of this tick: 1 if the host scans it
  std::vector<std::unique_ptr<Scratch>> scratch_;  ///< per thread
  std::vector<std::uint32_t> new_slots_;           ///< cells built since the last upload
  std::uint32_t mover_texels_ = 0;                 ///< capacity for lists of movers, after the pool
  std::uint32_t mover_texels_used_ = 0;            ///< may exceed the capacity while a tick is retried
  bool tables_replaced_ = false;                   ///< since `prepare` began
  bool upload_all_ = true;
  bool upload_outlines_ = false;

  std::unique_ptr<gpu::Buffer> lists_, segment_ids_, mover_rows_, segments_, models_;
};

}  // namespace sf::raycast
