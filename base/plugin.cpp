#include "base/plugin.h"

#include <dlfcn.h>
#include <elf.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "base/error.h"
#include "base/installation.h"

namespace sf::base {

namespace {

/// Checks that the file contains all parts that dlopen maps. Reading a truncated mapping would raise SIGBUS and end the
/// process. Leaves files of other formats and machines to dlopen, which reports a reason.
/// @throws InputError for a truncated file
void require_whole(const std::string& file) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  const auto size = static_cast<std::uint64_t>(std::max<std::streamoff>(0, in.tellg()));
  const auto require = [&](std::uint64_t first, std::uint64_t count) {
    if (count <= size && first <= size - count) return;
    throw InputError(
        file, 0,
        fmt::format("is truncated: it has {} bytes, but its header refers to byte {}; copy or build it again", size,
                    first + count));
  };
  Elf64_Ehdr header{};
  in.seekg(0).read(reinterpret_cast<char*>(&header), sizeof header);
  if (!in || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_ident[EI_CLASS] != ELFCLASS64 ||
      header.e_ident[EI_DATA] != ELFDATA2LSB || header.e_phentsize != sizeof(Elf64_Phdr))
    return;
  require(header.e_phoff, std::uint64_t{header.e_phnum} * sizeof(Elf64_Phdr));
  in.seekg(static_cast<std::streamoff>(header.e_phoff));
  for (int i = 0; i < header.e_phnum; ++i) {
    Elf64_Phdr part{};
    in.read(reinterpret_cast<char*>(&part), sizeof part);
    if (part.p_type == PT_LOAD || part.p_type == PT_DYNAMIC) require(part.p_offset, part.p_filesz);
  }
}

}  // namespace

const void* load_plugin(const char* name, const char* without, const char* library) {
  const std::string file = plugin_file(name);
  require_whole(file);
  void* module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  const void* symbol = module != nullptr ? dlsym(module, name) : nullptr;
  if (symbol != nullptr) return symbol;
  const char* const why = dlerror();
  const std::string remedy = file.find('/') != std::string::npos
                                 ? fmt::format("install {}", library)
                                 : fmt::format(
                                       "this installation lacks it; install the Debian package of sensorfarm, or put "
                                       "the file into {}; it requires {}",
                                       fmt::join(plugin_folders(), " or "), library);
  throw InputError(file, 0,
                   fmt::format("cannot be loaded, so {} ({}): {}", without, why != nullptr ? why : "?", remedy));
}

SharedLibrary::SharedLibrary(const std::string& file) {
  std::error_code error;
  const auto whole = std::filesystem::canonical(file, error);  // dlopen searches elsewhere for a name without a folder
  if (error) throw InputError(file, 0, "cannot be opened: " + error.message());
  require_whole(whole.string());
  handle_ = dlopen(whole.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle_ != nullptr) return;
  const char* const why = dlerror();
  throw InputError(file, 0, fmt::format("cannot be loaded as a shared library: {}", why != nullptr ? why : "?"));
}

void* SharedLibrary::find(const char* symbol) const { return dlsym(handle_, symbol); }

}  // namespace sf::base
