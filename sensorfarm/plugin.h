#pragma once
// A plug-in: a shared library with your own controllers, model controllers, dynamics and sensors. It needs only these
// headers, and no library of the farm.

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sensorfarm/controller.h"
#include "sensorfarm/derived.h"
#include "sensorfarm/dynamics.h"
#include "sensorfarm/model.h"
#include "sensorfarm/sensor.h"

namespace sensorfarm {

/// Incremented with every change of these headers that changes the layout of a type. A library with another number is
/// refused.
inline constexpr int kPluginInterface = 7;

/// The controllers, model controllers, dynamics, sensors and derived sensors of a plug-in.
struct Plugin {
  std::vector<ControllerEntry> controllers;
  std::vector<ModelEntry> models;
  std::vector<SensorEntry> sensors;
  std::vector<DerivedEntry> derived;
  std::vector<DynamicsEntry> dynamics;

  /// Adds a controller. `Made` is constructed from (const Robot&, Settings&).
  template <class Made>
  ControllerEntry& add_controller(std::string name, std::string summary, double rate = 10.0) {
    return controllers.emplace_back(ControllerEntry{
        std::move(name), std::move(summary), rate, true,
        [](const Robot& robot, Settings& settings) { return std::make_unique<Made>(robot, settings); }});
  }

  /// Adds a model controller. `Made` is constructed from (const ModelSite&, Settings&).
  template <class Made>
  ModelEntry& add_model_controller(std::string name, std::string summary) {
    return models.emplace_back(
        ModelEntry{std::move(name), std::move(summary),
                   [](const ModelSite& site, Settings& settings) { return std::make_unique<Made>(site, settings); }});
  }

  /// Adds dynamics of robots. `Made` is constructed from (const DynamicsSite&, Settings&).
  template <class Made>
  DynamicsEntry& add_dynamics(std::string name, std::string summary) {
    return dynamics.emplace_back(DynamicsEntry{
        std::move(name), std::move(summary),
        [](const DynamicsSite& site, Settings& settings) { return std::make_unique<Made>(site, settings); }});
  }

  /// Adds a sensor type. `Made` is constructed from (const SensorSite&, const SensorSettings&). @param entry without
  /// `make`
  template <class Made>
  SensorEntry& add_sensor(SensorEntry entry) {
    entry.make = [](const SensorSite& site, const SensorSettings& settings) {
      return std::make_unique<Made>(site, settings);
    };
    return sensors.emplace_back(std::move(entry));
  }

  /// Adds a derived sensor type. `Made` is constructed from (const DerivedSite&, const SensorSettings&). @param entry
  /// without `make`
  template <class Made>
  DerivedEntry& add_derived(DerivedEntry entry) {
    entry.make = [](const DerivedSite& site, const SensorSettings& settings) {
      return std::make_unique<Made>(site, settings);
    };
    return derived.emplace_back(std::move(entry));
  }
};

}  // namespace sensorfarm

/// Begins the function that fills in `plugin`. Use it once per library.
#define SENSORFARM_PLUGIN(plugin)                                                       \
  extern "C" __attribute__((visibility("default"))) int sensorfarm_plugin_interface() { \
    return sensorfarm::kPluginInterface;                                                \
  }                                                                                     \
  extern "C" __attribute__((visibility("default"))) void sensorfarm_plugin(sensorfarm::Plugin& plugin)
