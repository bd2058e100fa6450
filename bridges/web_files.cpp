#include "bridges/web_files.h"

#include <string_view>

namespace sf::bridges {

namespace {

const char* type_of(std::string_view name) {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".css")) return "text/css; charset=utf-8";
  if (name.ends_with(".js")) return "text/javascript; charset=utf-8";
  if (name.ends_with(".svg")) return "image/svg+xml";
  if (name.ends_with(".txt")) return "text/plain; charset=utf-8";
  return "application/octet-stream";
}

}  // namespace

std::map<std::string, WebFile> web_files() {
  std::map<std::string, WebFile> files;
  for (std::size_t i = 0; i < kEmbeddedFileCount; ++i) {
    const EmbeddedFile& file = kEmbeddedFiles[i];
    files["/" + std::string(file.name)] = {type_of(file.name), file.text, false};
  }
  files["/"] = files["/index.html"];
  return files;
}

}  // namespace sf::bridges
