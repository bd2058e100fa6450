#pragma once
// The robot's end of a serial line: a pseudo-terminal whose other end a driver opens by name.

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace sf {

class PseudoTerminal {
 public:
  using Bytes = std::vector<std::uint8_t>;

  PseudoTerminal() : computer_(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    if (computer_ < 0 || grantpt(computer_) != 0 || unlockpt(computer_) != 0) return;
    device_ = ptsname(computer_);
    line_ = open(device_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  }
  ~PseudoTerminal() { hang_up(); }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  const std::string& device() const { return device_; }
  void hang_up() {
    for (int* end : {&computer_, &line_})
      if (*end >= 0) close(std::exchange(*end, -1));
  }
  /// Returns the number of stop bits that the driver set; 0: unknown.
  int stop_bits() const {
    termios settings{};
    return tcgetattr(line_, &settings) != 0 ? 0 : (settings.c_cflag & CSTOPB) != 0 ? 2 : 1;
  }
  void send(const Bytes& bytes) {
    const int before = waiting();
    if (write(computer_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) return;
    for (int k = 0; alone && k < 10'000 && waiting() < before + static_cast<int>(bytes.size()); ++k)
      poll(nullptr, 0, 1);
  }

  bool alone = true;  ///< no other thread reads while it sends, so it waits until the data is at the computer's end

 protected:
  /// Passes received bytes to `take` until `done`; false after ten seconds.
  template <class Done, class Take>
  bool awaited(Done done, Take take) {
    for (int k = 0; k < 10'000 && !done(); ++k) {
      pollfd end{computer_, POLLIN, 0};
      poll(&end, 1, 1);
      std::uint8_t byte;
      while (!done() && read(computer_, &byte, 1) == 1) take(byte);
    }
    return done();
  }

 private:
  int waiting() const {
    int bytes = 0;
    ioctl(line_, FIONREAD, &bytes);
    return bytes;
  }

  int computer_, line_ = -1;
  std::string device_;
};

}  // namespace sf
