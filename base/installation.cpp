#include "base/installation.h"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace sf::base {

namespace fs = std::filesystem;

std::string own_folder() {
  Dl_info info = {};
  std::error_code ignored;
  // The program's own name may be relative to a folder that it has left.
  const bool known = dladdr(reinterpret_cast<const void*>(&own_folder), &info) != 0 && info.dli_fname != nullptr;
  const fs::path file = known && std::string_view(info.dli_fname).find(".so") != std::string_view::npos
                            ? fs::canonical(info.dli_fname, ignored)
                            : fs::read_symlink("/proc/self/exe", ignored);
  return file.parent_path().string();
}

std::string installed_file(const std::string& file) {
  std::error_code ignored;
  if (fs::path(file).is_absolute() || fs::exists(file, ignored)) return file;
  const char* const data = std::getenv("SENSORFARM_DATA");
  for (const fs::path& folder :
       {fs::path(data != nullptr ? data : ""), fs::path(own_folder()) / ".." / "share" / "sensorfarm"})
    if (!folder.empty() && fs::exists(folder / file, ignored)) return (folder / file).lexically_normal().string();
  return file;
}

}  // namespace sf::base
