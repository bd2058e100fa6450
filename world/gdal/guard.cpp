#include "world/gdal/guard.h"

#include <cpl_error.h>
#include <cpl_http.h>

namespace sf::world {

namespace {

void collect(CPLErr kind, CPLErrorNum, const char* text) {
  constexpr std::size_t kMost = 500;
  auto& messages = *static_cast<std::string*>(CPLGetErrorHandlerUserData());
  if (kind < CE_Warning || messages.size() > kMost || messages.find(text) != std::string::npos) return;
  messages += (messages.empty() ? "" : "; ") + std::string(text).substr(0, kMost);
}

CPLHTTPResult* refuse_request(const char*, CSLConstList, GDALProgressFunc, void*, CPLHTTPFetchWriteFunc, void*, void*) {
  CPLError(CE_Failure, CPLE_AppDefined, "the file refers to a network location, which is not used");
  auto* const result = static_cast<CPLHTTPResult*>(CPLCalloc(1, sizeof(CPLHTTPResult)));
  result->nStatus = 1;
  return result;
}

}  // namespace

Guard::Guard(std::string& messages) {
  CPLPushErrorHandlerEx(collect, &messages);
  CPLHTTPPushFetchCallback(refuse_request, nullptr);
}

Guard::~Guard() {
  CPLHTTPPopFetchCallback();
  CPLPopErrorHandler();
}

}  // namespace sf::world
