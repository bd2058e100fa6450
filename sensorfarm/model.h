#pragma once
// Your own controllers of models: objects of the world that are not robots, such as doors
// (docs/own_controller.md#controllers-of-models).
//
//   class Lift : public sensorfarm::ModelController {
//    public:
//     Lift(const sensorfarm::ModelSite&, sensorfarm::Settings& settings) : speed_(settings.number("speed", 0.2, 0, 1))
//     {}
//     void tick(sensorfarm::Model& model) override { model.set_velocity({model.robots().empty() ? 0.0 : speed_}); }
//     double range() const override { return 2.0; }
//
//    private:
//     double speed_;
//   };
//
//   SENSORFARM_PLUGIN(plugin) { plugin.add_model_controller<Lift>("lift", "moves while a robot is near"); }
//
// In a world file: model( name "lift" ctrl "./liblift.so speed=0.3" )

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "sensorfarm/controller.h"

namespace sensorfarm {

/// The model that a controller moves, at the time when the controller is created.
struct ModelSite {
  std::string name;          ///< name in the world file
  std::uint32_t row = 0;     ///< among all robots and objects that move
  Pose pose;                 ///< pose at the start
  double radius = 0.0;       ///< [m] radius of the circle about its origin that contains its body
  double max_forward = 0.0;  ///< [m/s] largest speed in any direction
  double max_turn = 0.0;     ///< [rad/s]
  double interval = 0.0;     ///< [s] from one call of `tick` to the next
  std::uint64_t seed = 0;    ///< seed of the run
  std::string world;         ///< path of the world file, as given by the user
};

/// A robot near the model, with its true state.
struct NearRobot {
  std::string_view name;
  std::uint32_t row = 0;  ///< among all robots and objects that move
  Pose pose;
  Twist velocity;
  double radius = 0.0;    ///< [m] radius of the circle about its origin that contains its body
  double distance = 0.0;  ///< [m] between the origins of robot and model, in the plane
};

/// The beginning of a contact: at this tick, but not at the previous one, the other's surface is within 1 mm of the
/// model's outline, or inside it.
struct ModelContact {
  std::string_view name;      ///< name of the other model: a robot, an object or a static model
  std::uint32_t row = kNone;  ///< row of the other among all robots and objects that move; kNone: it is static
  bool robot = false;         ///< the other is a robot
  double x = 0.0, y = 0.0;    ///< [m] world frame: the point of the other's outline that is nearest to the model's, or
                              ///< inside it
};

/// The most robots that a model receives per tick: the nearest.
inline constexpr std::size_t kMostNearRobots = 1024;

/// An object in one call: its state at this tick, and changes. Changes of all objects take effect together, after the
/// calls of the tick and before the motion that follows. The last value counts: of a call, of a later call of the same
/// tick, or of another model's controller in a later row. Valid during the call.
class WorldObject {
 public:
  virtual ~WorldObject() = default;
  virtual Pose pose() const = 0;       ///< its last one while it is absent
  virtual Twist velocity() const = 0;  ///< true velocity, 0 after a stop by an obstacle
  virtual bool present() const = 0;    ///< it is in the world
  /// false: changes have no effect, because a robot's controller, the user (`drive`) or, in `serve`, packets move it
  virtual bool changeable() const = 0;

  /// Places the object, at rest, whatever is at that place. @throws std::invalid_argument, with nothing changed, for
  /// numbers that are not finite, and for x, y or z beyond 1e7 m
  virtual void set_pose(const Pose& pose) = 0;
  /// Sets the velocity for all following ticks, within its `velocity_bounds`. Walls, robots and other objects stop the
  /// object, as they stop robots; in `serve` nothing stops it. Objects without `ctrl` move sideways only with
  /// `drive "omni"`. @throws std::invalid_argument for numbers that are not finite
  virtual void set_velocity(const Twist& velocity) = 0;
  /// Removes the object from the world, or restores it, at rest, at its last pose.
  virtual void set_present(bool present) = 0;
  /// Gives the object a shape of the world file (`shape( name "crate" ... )`), with its size and colour, or "original".
  /// Costs a rebuild of the tables of all sensors, as do other sizes, so do it when something changes, not at each
  /// tick. @throws std::exception, with nothing changed, for an unknown shape, and where shapes do not change
  /// (experiments, tiles)
  virtual void set_shape(std::string_view name) = 0;
  /// Scales the object's own outline. @param x, y, z [m] in (0, 1000] @throws as set_shape
  virtual void set_size(double x, double y, double z) = 0;
  /// @param color an X11 name such as "steel blue", or "#RRGGBB" @throws as set_shape
  virtual void set_color(std::string_view color) = 0;
};

/// The controller's own model in one call.
class Model : public WorldObject {
 public:
  virtual double time() const = 0;  ///< [s] of the tick
  /// Returns the robots within `ModelController::range`, the nearest first, then by row; at most kMostNearRobots.
  virtual std::span<const NearRobot> robots() const = 0;
  /// Returns another object of the world that moves: a model named `tag<N>`, or one with `ctrl`. An object without
  /// `ctrl` may be moved in this way, too. @param name in the world file
  /// @throws std::invalid_argument for an unknown name, a robot, and a model that does not move
  virtual WorldObject& object(std::string_view name) = 0;
  virtual double uniform() = 0;  ///< next random number in (0, 1) of this model, by the seed of the run
  virtual double normal() = 0;   ///< next random number of the standard normal distribution
};

/// One object per model. Calls are made one after another, in order of the models' rows, never in parallel, after the
/// readings and decisions of a tick. For each model: `contact` for each contact that begins, in the order of the world
/// file, then `tick`. An exception ends the run with its message.
class ModelController {
 public:
  virtual ~ModelController() = default;
  virtual void tick(Model& model) = 0;
  virtual void contact(const ModelContact&, Model&) {}
  /// Returns the range [m] of `Model::robots`, at most 1000. Read once. 0: no robots.
  virtual double range() const { return 0.0; }
};

/// A kind of model controller: its name, and how to create one.
struct ModelEntry {
  std::string name;     ///< name by which `ctrl` chooses it
  std::string summary;  ///< one line
  /// Throws an exception to refuse the model; its message is reported.
  std::function<std::unique_ptr<ModelController>(const ModelSite&, Settings&)> make;
};

}  // namespace sensorfarm
