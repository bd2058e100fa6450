// Plug-ins as files, shared libraries or Python; each is loaded once.

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <map>
#include <utility>

#include "base/error.h"
#include "base/installation.h"
#include "base/plugin.h"
#include "base/plugin_calls.h"
#include "base/printable.h"
#include "base/suggest.h"
#include "control/own_controllers.h"
#include "control/plugin_guard.h"
#include "sensors/derived/own_derived.h"
#include "sensors/own_sensors.h"

namespace sf::control {

namespace {

namespace fs = std::filesystem;

struct PluginControllers {
  std::vector<const ControllerType*> robots;
  std::vector<const sensorfarm::ModelEntry*> models;
  std::vector<const sensorfarm::DynamicsEntry*> dynamics;
};

/// Controllers and dynamics of the files loaded so far, by canonical path.
using Loaded = std::map<std::string, PluginControllers>;
Loaded& loaded() {
  static Loaded files;
  return files;
}

/// Splits "libmine.so:name" into the file and the controller after the colon; the name is empty if there is none.
std::pair<std::string, std::string> parts_of(const std::string& name) {
  const std::size_t slash = name.rfind('/');
  const std::size_t colon = name.find(':', slash == std::string::npos ? 0 : slash);
  if (colon == std::string::npos) return {name, ""};
  return {name.substr(0, colon), name.substr(colon + 1)};
}

bool is_python(const std::string& file) { return file.ends_with(".py"); }

/// Adds the classes of a Python file (python/interpreter.cpp). @param whole its canonical path
void fill_from_python(const std::string& file, const std::string& whole, sensorfarm::Plugin& plugin) {
  const void* const symbol = base::load_plugin("sensorfarm_python", "controllers in Python cannot run",
                                               "libpython3 and NumPy (Debian: libpython3.11 python3-numpy)");
  const auto fill = reinterpret_cast<void (*)(const char*, sensorfarm::Plugin&)>(const_cast<void*>(symbol));
  try {
    fill(whole.c_str(), plugin);
  } catch (const std::exception& error) {
    throw base::InputError(file, 0, "cannot be loaded: " + base::one_line(error.what()));
  }
}

void fill_from_library(const std::string& file, sensorfarm::Plugin& plugin) {
  const base::SharedLibrary library(file);
  const auto interface = reinterpret_cast<int (*)()>(library.find("sensorfarm_plugin_interface"));
  const auto fill = reinterpret_cast<void (*)(sensorfarm::Plugin&)>(library.find("sensorfarm_plugin"));
  if (interface == nullptr || fill == nullptr)
    throw base::InputError(file, 0, "is not a plug-in: it has no SENSORFARM_PLUGIN (sensorfarm/plugin.h)");
  if (interface() != sensorfarm::kPluginInterface)
    throw base::InputError(file, 0,
                           fmt::format("was built for plug-in interface {}, and this program has {}: build it again "
                                       "with this version's headers",
                                       interface(), sensorfarm::kPluginInterface));
  guarded_call([&] { fill(plugin); },
               [&](const char* why) {
                 return base::InputError(file, 0, "its SENSORFARM_PLUGIN failed: " + base::one_line(why));
               });
}

const sensorfarm::DynamicsEntry* add_dynamics(sensorfarm::DynamicsEntry entry, const std::string& from) {
  if (entry.name.empty() || !entry.make)
    throw base::InputError(
        from, 0,
        fmt::format("dynamics '{}' have no name, or no function that creates them; expected both", entry.name));
  static std::deque<sensorfarm::DynamicsEntry> entries;
  return &entries.emplace_back(std::move(entry));
}

PluginControllers load(const std::string& file, const std::string& whole) {
  sensorfarm::Plugin plugin;
  {
    const base::PluginCall under_way(base::one_line("plug-in " + file));
    if (is_python(file))
      fill_from_python(file, whole, plugin);
    else
      fill_from_library(file, plugin);
  }
  base::renew_plugin_watch();
  PluginControllers types;
  for (sensorfarm::ControllerEntry& entry : plugin.controllers)
    types.robots.push_back(add_own_controller(std::move(entry), file));
  for (sensorfarm::ModelEntry& entry : plugin.models)
    types.models.push_back(add_own_model_controller(std::move(entry), file));
  for (sensorfarm::DynamicsEntry& entry : plugin.dynamics)
    types.dynamics.push_back(add_dynamics(std::move(entry), file));
  for (sensorfarm::SensorEntry& entry : plugin.sensors) sensors::add_own_sensor(std::move(entry), file);
  for (sensorfarm::DerivedEntry& entry : plugin.derived) sensors::add_own_derived(std::move(entry), file);
  return types;
}

const PluginControllers& controllers_in(const std::string& file) {
  std::error_code error;
  const std::string whole = fs::canonical(file, error).string();
  if (error) throw base::InputError(file, 0, "cannot be opened: " + error.message());
  const auto known = loaded().find(whole);
  return known != loaded().end() ? known->second : loaded().emplace(whole, load(file, whole)).first->second;
}

/// Returns the one with the name after the colon, or the only one. @param kind "controller"
template <class Type>
const Type* chosen(const std::string& name, const std::vector<const Type*>& types, std::string_view kind) {
  const auto [file, wanted] = parts_of(name);
  if (types.empty()) throw base::InputError(file, 0, fmt::format("has no {}", kind));
  if (wanted.empty() && types.size() == 1) return types.front();
  const auto found = std::find_if(types.begin(), types.end(), [&](const auto* type) { return type->name == wanted; });
  if (found != types.end()) return *found;
  std::string names;
  for (const Type* type : types) names += fmt::format("{}{}:{}", names.empty() ? "" : ", ", file, type->name);
  throw base::InputError(file, 0,
                         fmt::format("has {}; expected one of: {}",
                                     wanted.empty() ? fmt::format("several {}{}", kind, kind.ends_with('s') ? "" : "s")
                                                    : fmt::format("no {} '{}'", kind, wanted),
                                     names));
}

}  // namespace

const ControllerType* load_controller(const std::string& name) {
  return chosen(name, controllers_in(parts_of(name).first).robots, "controller");
}

const sensorfarm::ModelEntry& find_model_controller(const std::string& name) {
  if (base::names_a_plugin(name)) return *chosen(name, controllers_in(parts_of(name).first).models, "model controller");
  for (const sensorfarm::ModelEntry& entry : model_controllers())
    if (entry.name == name) return entry;
  throw base::InputError(
      fmt::format("there is no model controller '{}'{}", name, base::expected_one_of(name, model_controller_names())));
}

const sensorfarm::DynamicsEntry& find_dynamics(const std::string& name) {
  return *chosen(name, controllers_in(parts_of(name).first).dynamics, "dynamics");
}

void load_plugin_file(const std::string& file) { controllers_in(file); }

void load_plugin_list(const std::string& list) {
  for (std::size_t at = 0; at <= list.size();) {
    const std::size_t end = std::min(list.find(':', at), list.size());
    const std::string entry = list.substr(at, end - at);
    at = end + 1;
    if (entry.empty()) continue;
    if (!fs::is_directory(entry)) {
      load_plugin_file(entry);
      continue;
    }
    std::vector<std::string> files;
    for (const fs::directory_entry& file : fs::directory_iterator(entry))
      if (file.path().extension() == ".so") files.push_back(file.path().string());
    std::sort(files.begin(), files.end());
    for (const std::string& file : files) load_plugin_file(file);
  }
}

}  // namespace sf::control
