#pragma once
// GDAL's messages and network requests within the plug-in.

#include <cpl_error.h>
#include <cpl_http.h>

#include <string>

namespace sf::world {

/// While a Guard exists, GDAL's messages in this thread are collected, and its network requests fail: a GeoJSON file
/// may refer to its coordinate system by a URL.
class Guard {
 public:
  explicit Guard(std::string& messages) {
    CPLPushErrorHandlerEx(collect, &messages);
    CPLHTTPPushFetchCallback(refuse, nullptr);
  }
  ~Guard() {
    CPLHTTPPopFetchCallback();
    CPLPopErrorHandler();
  }
  Guard(const Guard&) = delete;

 private:
  static void collect(CPLErr kind, CPLErrorNum, const char* text) {
    constexpr std::size_t kMost = 500;
    auto& messages = *static_cast<std::string*>(CPLGetErrorHandlerUserData());
    if (kind < CE_Warning || messages.size() > kMost || messages.find(text) != std::string::npos) return;
    messages += (messages.empty() ? "" : "; ") + std::string(text).substr(0, kMost);
  }
  static CPLHTTPResult* refuse(const char*, CSLConstList, GDALProgressFunc, void*, CPLHTTPFetchWriteFunc, void*,
                               void*) {
    CPLError(CE_Failure, CPLE_AppDefined, "the file refers to a network location, which is not used");
    auto* const result = static_cast<CPLHTTPResult*>(CPLCalloc(1, sizeof(CPLHTTPResult)));
    result->nStatus = 1;
    return result;
  }
};

}  // namespace sf::world
