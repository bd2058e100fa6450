#include "cluster/failure.h"

#include "base/bytes.h"
#include "base/error.h"

namespace sf::cluster {

int code_of_current(std::string& message) {
  try {
    throw;
  } catch (const base::InputError& error) {
    message = error.what();
    return 2;
  } catch (const base::DeviceError& error) {
    message = error.what();
    return 3;
  } catch (const std::exception& error) {
    message = error.what();
    return 1;
  }
}

void agree(Ranks& ranks, const std::function<void()>& body) {
  base::Bytes block;
  base::ByteWriter out(block);
  try {
    body();
  } catch (const std::exception&) {
    std::string message;
    out.put(static_cast<std::uint8_t>(code_of_current(message)));
    out.put_string(message);
  }
  for (const Block other : ranks.exchange(block)) {
    if (other.empty()) continue;
    base::ByteReader in(other);
    const int code = in.get<std::uint8_t>();
    throw Failure(code, in.get_string());
  }
}

void agree(Ranks* ranks, const std::function<void()>& body) {
  if (ranks != nullptr)
    agree(*ranks, body);
  else
    body();
}

}  // namespace sf::cluster
