// A library built against another plug-in interface.

#include <sensorfarm/plugin.h>

extern "C" __attribute__((visibility("default"))) int sensorfarm_plugin_interface() {
  return sensorfarm::kPluginInterface + 1;
}
extern "C" __attribute__((visibility("default"))) void sensorfarm_plugin(sensorfarm::Plugin&) { __builtin_trap(); }
