#pragma once
// What rays can meet, on the device: walls and movers as exact segments, and sector lists where sensors are.

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "raycast/bodies.h"
#include "raycast/options.h"
#include "raycast/sectors.h"
#include "raycast/view_cells.h"
#include "world/world.h"

namespace sf::raycast {

/// Not thread-safe. `world` need not outlive it.
class Scene {
 public:
  /// @param families complete, of `world`; to outlive it  @param carriers movers with sensors that look: the lists get
  /// room accordingly
  Scene(const world::World& world, const Families& families, gpu::Device& device, base::Workers& workers,
        const SceneOptions& options, std::uint32_t carriers);
  ~Scene();

  /// Takes this tick's poses, one per mover.
  void place(std::span<const Pose> poses);

  /// Makes lists for all `views` and fills what `rows` says of them (all but beams and out), row by row.
  /// @return true when tables were replaced, so that kernels must be bound again.
  bool serve(std::span<const Viewpoint> views, std::span<RayRow> rows);

  /// Whether the i-th view of the last `serve` has more surfaces than lists hold: its row names empty lists.
  bool is_for_host(std::size_t i) const { return for_host_[i] != 0; }
  /// Names what changed since the last call for copying to the device.
  void upload(gpu::Batch& batch);

  gpu::Buffer& headers() { return *headers_; }
  gpu::Buffer& entries() { return *entries_; }
  gpu::Buffer& ids() { return *ids_; }
  gpu::Buffer& nearest() { return *nearest_; }
  gpu::Buffer& segments() { return *segments_; }
  gpu::Buffer& models() { return *models_; }

  struct Counts {
    std::uint64_t cells_built = 0;  ///< ever
    std::uint32_t cells_held = 0;   ///< now
    std::uint64_t movers_near = 0;  ///< ever: pairs of a view's robot and a mover within its range
    std::uint64_t movers_met = 0;   ///< of these, not hidden, nor outside of its view
  };
  Counts counts() const;

 private:
  struct FamilyTables;
  /// Views of one robot and family, which share a list of movers.
  struct Group {
    std::size_t first;
    std::size_t end;
    Vec2 origin;
    double radius;
    bool in_solid;          ///< some view is
    bool alone = false;     ///< no mover can be met: it shares the list of nobody
    bool for_host = false;  ///< too many are
  };
  struct Scratch;

  void add_tables();
  void find_groups(std::span<const Viewpoint> views);
  void build_missing();
  void fill_walls(const Viewpoint& view, std::size_t row, RayRow& out);
  bool fill_movers(std::span<const Viewpoint> views, std::span<RayRow> rows);
  bool fill_some_movers(std::span<const Viewpoint> views, bool more_room);
  void name_movers(std::span<const Viewpoint> views, std::span<RayRow> rows);
  void make_room(std::uint32_t carriers);
  void grow(std::uint32_t pool_cells, std::uint32_t pool_chunks, std::uint32_t views, std::uint32_t mover_chunks);
  bool try_to_grow(std::uint32_t pool_cells, std::uint32_t pool_chunks, std::uint32_t mover_chunks);
  ListTables tables();

  base::Workers& workers_;
  gpu::Device& device_;
  const SceneOptions most_;
  SceneOptions options_;  ///< room now
  const Families& families_;
  std::map<const Sight*, std::unique_ptr<Depth>> depths_;
  std::vector<FamilyTables> tables_of_;  ///< per family
  std::unique_ptr<Sight> all_walls_;
  std::unique_ptr<Bodies> bodies_;
  ViewCells cells_;
  std::vector<std::uint8_t> too_long_;             ///< per slot: its lists are empty, since they would be too long
  std::vector<std::uint8_t> for_host_;             ///< per view of this tick: its lists would be too long
  std::vector<std::uint32_t> words_;               ///< of every exact segment, as lists call it
  std::vector<float> own_clearances_;              ///< [m] of movers' segments: how near their own mover's others come
  std::vector<Group> groups_;                      ///< of this tick's views
  std::vector<std::unique_ptr<Scratch>> scratch_;  ///< per thread
  std::vector<std::uint32_t> fresh_slots_;         ///< cells built since the last upload
  std::uint32_t mover_chunks_ = 0;                 ///< capacity for movers' lists, behind the pool
  std::uint32_t mover_chunks_used_ = 0;            ///< may exceed the capacity while a tick is being retried
  std::uint32_t view_capacity_ = 0;                ///< groups of movers' headers; nobody's are behind them
  bool replaced_ = false;                          ///< tables were, since `serve` began
  bool upload_all_ = true;

  std::unique_ptr<gpu::Buffer> headers_, entries_, ids_, nearest_, segments_, models_;
};

}  // namespace sf::raycast
