#include "netio/serial_line.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <utility>

#include "base/error.h"
#include "netio/posix.h"

namespace sf::netio {

namespace {

constexpr std::array<std::pair<unsigned, speed_t>, 5> kSpeeds{
    {{9600, B9600}, {19200, B19200}, {38400, B38400}, {57600, B57600}, {115200, B115200}}};

speed_t speed_of(unsigned baud) {
  for (const auto& [rate, speed] : kSpeeds)
    if (rate == baud) return speed;
  throw base::InputError("a serial line of " + std::to_string(baud) +
                         " baud; expected 9600, 19200, 38400, 57600 or 115200");
}

[[noreturn]] void fail(const std::string& device, int error) {
  const char* remedy = "check the cable and the name";
  if (error == ENOENT) remedy = "`ls /dev/ttyUSB* /dev/ttyACM*` lists those of this machine";
  if (error == EACCES)
    remedy = "add yourself to its group, usually `dialout`: sudo usermod -aG dialout $USER, and log in again";
  if (error == EBUSY) remedy = "another program uses it; stop that program";
  if (error == ENOTTY) remedy = "it is not a serial line; expected one such as /dev/ttyUSB0";
  throw base::InputError("cannot open the serial line '" + device + "': " + error_text(error) + "; " + remedy);
}

}  // namespace

SerialLine::SerialLine(const std::string& device, unsigned baud, int stop_bits) {
  const speed_t speed = speed_of(baud);
  descriptor_ = Socket(open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  const int line = descriptor_.descriptor();
  if (line < 0) fail(device, errno);
  termios settings{};
  if (tcgetattr(line, &settings) != 0) fail(device, ENOTTY);
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~(CSTOPB | CRTSCTS);
  if (stop_bits == 2) settings.c_cflag |= CSTOPB;
  settings.c_cc[VMIN] = 1;  // without bytes read() fails with EAGAIN; 0 means that the line hung up
  settings.c_cc[VTIME] = 0;
  if (cfsetspeed(&settings, speed) != 0 || tcsetattr(line, TCSANOW, &settings) != 0) fail(device, errno);
  ioctl(line, TIOCEXCL);  // excludes other programs, except those of root
  tcflush(line, TCIOFLUSH);
}

std::size_t SerialLine::read(std::span<std::uint8_t> bytes) {
  if (lost_) return 0;
  flush();
  const ssize_t n = ::read(descriptor_.descriptor(), bytes.data(), bytes.size());
  if (n > 0) return static_cast<std::size_t>(n);
  lost_ = lost_ || n == 0 || (errno != EAGAIN && errno != EINTR);
  return 0;
}

bool SerialLine::write(std::span<const std::uint8_t> bytes) {
  flush();
  if (lost_ || waiting_.size() + bytes.size() > kMostWaiting) return false;
  waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
  flush();
  return true;
}

void SerialLine::flush() {
  if (lost_ || waiting_.empty()) return;
  const ssize_t n = ::write(descriptor_.descriptor(), waiting_.data(), waiting_.size());
  if (n > 0) waiting_.erase(waiting_.begin(), waiting_.begin() + n);
  lost_ = n < 0 && errno != EAGAIN && errno != EINTR;
}

void SerialLine::drain() {
  for (int tries = 0; tries < 10 && !lost_ && !waiting_.empty(); ++tries) {
    pollfd line{descriptor_.descriptor(), POLLOUT, 0};
    poll(&line, 1, 10);
    flush();
  }
}

}  // namespace sf::netio
