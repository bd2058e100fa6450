#include "base/installation.h"

#include <dlfcn.h>

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace sf::base {

namespace {

namespace fs = std::filesystem;

/// Returns the folder of the program or shared library that contains this code.
fs::path own_folder() {
  Dl_info info = {};
  std::error_code ignored;
  const bool known = dladdr(reinterpret_cast<const void*>(&plugin_file), &info) != 0 && info.dli_fname != nullptr;
  // The program's own name may be relative to a folder that it has left.
  const bool is_library = known && std::string_view(info.dli_fname).find(".so") != std::string_view::npos;
  return (is_library ? fs::canonical(info.dli_fname, ignored) : fs::read_symlink("/proc/self/exe", ignored))
      .parent_path();
}

/// Returns the prefix of the installation: own_folder() without `bin` or the library folder. Empty in a build folder.
fs::path prefix() {
  const fs::path own = own_folder();
  if (own.filename() == "bin") return own.parent_path();
  const std::string end = "/" SF_LIBDIR, text = own.string();
  return text.ends_with(end) ? fs::path(text.substr(0, text.size() - end.size())) : fs::path();
}

}  // namespace

std::vector<std::string> plugin_folders() {
  std::vector<std::string> folders{own_folder().string()};
  if (const fs::path installed = prefix(); !installed.empty())
    folders.push_back((installed / SF_LIBDIR / "sensorfarm").string());
  return folders;
}

std::string plugin_file(const std::string& name) {
  std::error_code ignored;
  const std::string file = name + ".so";
  for (const fs::path folder : plugin_folders())
    if (fs::exists(folder / file, ignored)) return (folder / file).string();
  return file;
}

bool names_a_plugin(std::string_view name) {
  const std::size_t slash = name.rfind('/');
  const std::string_view file = name.substr(0, name.find(':', slash == std::string_view::npos ? 0 : slash));
  return slash != std::string_view::npos || file.ends_with(".so") || file.ends_with(".py");
}

std::string installed_file(const std::string& file) {
  std::error_code ignored;
  if (fs::path(file).is_absolute() || fs::exists(file, ignored)) return file;
  const char* const data = std::getenv("SENSORFARM_DATA");
  const fs::path share = fs::path("share") / "sensorfarm";  // links to the sources in a build folder
  for (const fs::path& folder : {fs::path(data != nullptr ? data : ""), prefix() / share, own_folder() / share})
    if (folder.is_absolute() && fs::exists(folder / file, ignored)) return (folder / file).string();
  return file;
}

}  // namespace sf::base
