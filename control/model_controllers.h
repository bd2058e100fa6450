#pragma once
// The users' controllers of a run's models (sensorfarm/model.h): calls them once per tick, and collects the changes
// that they request.
//
//   ModelControllers models(world, controlled_models(world), {.seed = 7, .interval = 0.1});
//   for (const ModelControllers::Change& change : models.call({time, states, absent, fleet})) ...

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/report.h"
#include "robots/fleet.h"
#include "robots/neighbour_grid.h"
#include "world/shapes.h"
#include "world/world.h"

namespace sensorfarm {
struct NearRobot;
}

namespace sf::control {

/// Returns the rows of the movers that are not robots and have a controller in the world file.
std::vector<std::uint32_t> controlled_models(const world::World& world);

/// Not thread-safe. The world must outlive it.
class ModelControllers {
 public:
  struct Options {
    std::uint64_t seed = 1;  ///< seed of the models' random numbers
    double interval = 0.1;   ///< [s] between calls
  };
  /// The movers at one tick, as passed to the controllers.
  struct Scene {
    std::int64_t time = 0;  ///< [ns]
    std::span<const base::Report> states;
    const std::vector<bool>& absent;
    const robots::Fleet& fleet;  ///< with the outlines of the movers, and the absent ones marked
    bool shapes_change = false;  ///< controllers may change shape, size and colour
  };
  /// The requests of all controllers for one object. The caller applies shape and presence first, then the pose, then
  /// the velocity.
  struct Change {
    std::uint32_t mover = 0;
    std::optional<bool> present = {};
    std::optional<base::Pose> X_WM = {};       ///< at rest
    std::optional<base::Twist> velocity = {};  ///< until the next change; nullopt: no controller has moved the object
    world::ShapeChange shape = {};
  };

  /// Loads the plug-ins and creates the controllers.
  /// @param rows ascending
  /// @throws base::InputError with the line of `ctrl`
  ModelControllers(const world::World& world, std::span<const std::uint32_t> rows, const Options& options);
  ~ModelControllers();

  bool empty() const { return models_.empty(); }
  /// Ends the control of a mover by all controllers of models: others move it from now on.
  /// @return whether it had a controller
  bool remove(std::uint32_t mover);

  /// Calls all controllers in order of their rows.
  /// @return one change per model, and per other object that a controller has changed so far, in order of rows; valid
  /// until the next call
  /// @throws base::InputError with the name of the model whose controller failed
  std::span<const Change> call(const Scene& scene);

 private:
  struct Controlled;
  template <class Interface>
  class Handle;
  class ModelHandle;
  bool is_taken(std::uint32_t mover) const { return mover < taken_.size() && taken_[mover]; }
  Change& change_of(std::uint32_t mover);
  std::uint32_t object_named(std::string_view name);
  void find_near(const Controlled& model, const Scene& scene);
  void call_one(Controlled& model, const Scene& scene);
  void call_contacts(Controlled& model, ModelHandle& handle);

  const world::World& world_;
  Options options_;
  std::vector<std::unique_ptr<Controlled>> models_;  ///< by row
  robots::NeighbourGrid grid_;
  double widest_ = 0.0;              ///< [m] largest radius of a mover
  std::vector<std::uint32_t> near_;  ///< scratch, ascending
  std::vector<sensorfarm::NearRobot> robots_;
  std::vector<robots::Fleet::Touch> touches_;
  std::vector<bool> taken_;                                  ///< per mover: removed; shorter: the others are not
  std::map<std::string, std::uint32_t, std::less<>> named_;  ///< rows of the movers so far, by name
  std::map<std::uint32_t, Change> requested_;                ///< by row
  Change ignored_;                                           ///< of movers that are taken
  std::vector<Change> changes_;                              ///< as `requested_`
};

}  // namespace sf::control
