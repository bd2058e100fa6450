#include "vision/opencv/gstreamer.h"

#include <dlfcn.h>

#include <cstdint>

namespace sf::vision {

namespace {

/// The layout of GLib's GError. The header of GStreamer is not needed to build the program.
struct GlibError {
  std::uint32_t domain = 0;
  int code = 0;
  char* message = nullptr;
};

}  // namespace

std::string pipeline_problem(const std::string& pipeline) {
  constexpr int kFatalErrors = 1;  // GST_PARSE_FLAG_FATAL_ERRORS: missing elements are not left out
  void* const library = dlopen("libgstreamer-1.0.so.0", RTLD_LAZY | RTLD_NOLOAD);
  if (library == nullptr) return {};
  const auto init = reinterpret_cast<int (*)(int*, char***, GlibError**)>(dlsym(library, "gst_init_check"));
  const auto parse =
      reinterpret_cast<void* (*)(const char*, void*, int, GlibError**)>(dlsym(library, "gst_parse_launch_full"));
  const auto unref = reinterpret_cast<void (*)(void*)>(dlsym(library, "gst_object_unref"));
  const auto free_error = reinterpret_cast<void (*)(GlibError*)>(dlsym(library, "g_error_free"));
  if (init == nullptr || parse == nullptr || unref == nullptr || free_error == nullptr ||
      init(nullptr, nullptr, nullptr) == 0)
    return {};
  GlibError* error = nullptr;
  void* const made = parse(pipeline.c_str(), nullptr, kFatalErrors, &error);
  if (made != nullptr) unref(made);
  if (error == nullptr) return {};
  std::string message = error->message;
  free_error(error);
  return message;
}

}  // namespace sf::vision
