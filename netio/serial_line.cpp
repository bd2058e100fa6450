#include "netio/serial_line.h"

#include <fcntl.h>
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

Socket open_device(const std::string& device) {
  Socket line(open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (line.descriptor() < 0) fail(device, errno);
  return line;
}

bool is_later() { return errno == EAGAIN || errno == EINTR; }

}  // namespace

SerialLine::SerialLine(const std::string& device, unsigned baud, int stop_bits)
    : ByteLine(open_device(device), kMostWaiting) {
  const speed_t speed = speed_of(baud);
  const int line = descriptor().descriptor();
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

std::optional<std::size_t> SerialLine::receive(std::span<std::uint8_t> bytes) {
  const ssize_t n = ::read(descriptor().descriptor(), bytes.data(), bytes.size());
  if (n > 0) return static_cast<std::size_t>(n);
  return n < 0 && is_later() ? std::optional<std::size_t>(0) : std::nullopt;
}

std::optional<std::size_t> SerialLine::send(std::span<const std::uint8_t> bytes) {
  const ssize_t n = ::write(descriptor().descriptor(), bytes.data(), bytes.size());
  if (n >= 0) return static_cast<std::size_t>(n);
  return is_later() ? std::optional<std::size_t>(0) : std::nullopt;
}

}  // namespace sf::netio
