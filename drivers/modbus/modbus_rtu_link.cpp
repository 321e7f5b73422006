#include "drivers/modbus/modbus_rtu_link.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <modbus/modbus.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "core/check.h"
#include "drivers/io/deadline.h"
#include "drivers/io/os_fault.h"
#include "drivers/modbus/modbus_rtu_frame.h"

namespace luxrig::modbus {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLongestChatter(50);  // on a line that should be silent
// USB adapters pass bytes on every 16 ms, so a pause within a frame may be that long.
constexpr milliseconds kAdapterPause(20);
constexpr std::size_t kMaxBytesHeard = 2048;

const char* name_of(Parity parity) { return parity == Parity::none ? "none" : parity == Parity::even ? "even" : "odd"; }

char letter_of(Parity parity) { return parity == Parity::none ? 'N' : parity == Parity::even ? 'E' : 'O'; }

}  // namespace

RtuLink::RtuLink(SerialSettings settings) : settings_(std::move(settings)) {
  // 3.5 characters of 11 bits; above 19200 baud 1.75 ms (MODBUS over Serial Line 1.02, 2.5.1.1).
  silence_ = settings_.baud > 19200 ? milliseconds(2) : milliseconds(38500 / settings_.baud + 1);
}

milliseconds RtuLink::on_wire(std::size_t bytes) const {
  return milliseconds(static_cast<std::int64_t>(bytes) * 11 * 1000 / settings_.baud + 1);
}

milliseconds RtuLink::longest_on_wire() const { return on_wire(kLongestRtuFrame) + kLongestChatter + 2 * silence_; }

Fault RtuLink::absent(int error) const {
  Fault fault = os_fault("opening " + settings_.device, error);
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
    case EIO:
      fault.cause = Cause::network;
      fault.detail += ": plug the adapter in, or correct device (names in /dev/serial/by-id stay)";
      break;
    case EACCES:
      fault.detail += ": let this user open it, for example by the group dialout";
      break;
    case EBUSY:
      fault.detail += ": end the other program that has it";
      break;
    case ENOTTY:
      fault.detail += ": name a serial port";
      break;
    case EINVAL:
      fault.detail += fmt::format(": it does not take {} baud, parity {}, {} stop bit(s): choose others",
                                  settings_.baud, name_of(settings_.parity), settings_.stop_bits);
      break;
    default:
      break;
  }
  return fault;
}

Result<void> RtuLink::connect(milliseconds) {
  shut();
  if (settings_.device.empty()) return tl::unexpected(absent(ENOENT));
  context_ =
      modbus_new_rtu(settings_.device.c_str(), settings_.baud, letter_of(settings_.parity), 8, settings_.stop_bits);
  if (context_ == nullptr) return tl::unexpected(absent(errno));
  if (modbus_connect(context_) != 0) {
    const int error = errno;
    modbus_free(context_);
    context_ = nullptr;
    return tl::unexpected(absent(error));
  }
  fd_ = modbus_get_socket(context_);
  if (!settings_taken()) {
    shut();
    return tl::unexpected(absent(EINVAL));
  }
  ::ioctl(fd_, TIOCEXCL);  // a second master on the line would be a fault that is hard to find
  if (settings_.rs485) (void)modbus_rtu_set_serial_mode(context_, MODBUS_RTU_RS485);
  return {};
}

bool RtuLink::settings_taken() const {
  termios now{};
  if (::tcgetattr(fd_, &now) != 0) return false;
  const bool parity = (now.c_cflag & PARENB) != 0, odd = (now.c_cflag & PARODD) != 0;
  return parity == (settings_.parity != Parity::none) && (!parity || odd == (settings_.parity == Parity::odd)) &&
         ((now.c_cflag & CSTOPB) != 0) == (settings_.stop_bits == 2);
}

void RtuLink::shut() {
  if (context_ == nullptr) return;
  if (fd_ >= 0) ::ioctl(fd_, TIOCNXCL);
  modbus_close(context_);
  modbus_free(context_);
  context_ = nullptr;
  fd_ = -1;
}

Fault RtuLink::lost(const std::string& doing, int error) {
  shut();
  Fault fault = os_fault(fmt::format("{}: {}", settings_.device, doing), error);
  fault.cause = Cause::network;
  return fault;
}

bool RtuLink::found_closed() {
  pollfd wait{fd_, POLLIN, 0};
  if (::poll(&wait, 1, 0) <= 0 || (wait.revents & (POLLHUP | POLLERR | POLLNVAL)) == 0) return false;
  shut();
  return true;
}

bool RtuLink::wait_readable(milliseconds timeout) const {
  const Deadline deadline(timeout);
  pollfd wait{fd_, POLLIN, 0};
  int ready = 0;
  do {
    ready = ::poll(&wait, 1, static_cast<int>(deadline.left().count()));
  } while (ready < 0 && errno == EINTR && !deadline.passed());
  return ready > 0;
}

Result<bool> RtuLink::take(std::vector<std::uint8_t>& into) {
  std::array<std::uint8_t, 512> buffer;
  const auto got = ::read(fd_, buffer.data(), buffer.size());
  if (got > 0) {
    into.insert(into.end(), buffer.begin(), buffer.begin() + got);
    return true;
  }
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) return false;
  return tl::unexpected(lost("receiving", got == 0 ? EIO : errno));
}

Result<void> RtuLink::wait_for_silence() {
  // Each wait counts for its own length at most: if we run late, one byte is not chatter.
  std::chrono::steady_clock::duration chatter{};
  std::vector<std::uint8_t> unasked;
  for (auto before = std::chrono::steady_clock::now(); wait_readable(silence_);) {
    const auto taken = take(unasked);
    if (!taken) return tl::unexpected(taken.error());
    const auto now = std::chrono::steady_clock::now();
    chatter += std::min<std::chrono::steady_clock::duration>(now - before, silence_);
    before = now;
    if (chatter >= kLongestChatter) {
      return tl::unexpected(Fault{Cause::protocol, {}, "the line is never silent: look for a second master", {}});
    }
  }
  return {};
}

Result<std::vector<std::uint16_t>> RtuLink::exchange(const Request& request, milliseconds timeout) {
  LUXRIG_CHECK(connected(), "unit {}", request.unit);
  last_exception_ = 0;
  may_repeat_ = false;
  if (auto silent = wait_for_silence(); !silent) return tl::unexpected(silent.error());

  const std::vector<std::uint8_t> frame = encode_rtu(request);
  const auto sent = ::write(fd_, frame.data(), frame.size());
  if (sent != static_cast<ssize_t>(frame.size())) return tl::unexpected(lost("sending", sent < 0 ? errno : EAGAIN));

  const Deadline deadline(timeout + on_wire(frame.size() + rtu_answer_size(request)));
  std::vector<std::uint8_t> heard;
  RtuSearch search;
  while (true) {
    const milliseconds left = deadline.left();
    if (!wait_readable(search.spoiled ? std::min(left, kAdapterPause) : left)) break;
    const auto taken = take(heard);
    if (!taken) return tl::unexpected(taken.error());
    search = find_rtu_answer(request, heard);
    // Bytes that have arrived by the deadline are still read after it: perhaps only we are late.
    if (search.answer || heard.size() > kMaxBytesHeard) break;
  }
  if (!search.answer) {
    if (heard.empty()) {
      return tl::unexpected(Fault{Cause::timeout, {}, fmt::format("no answer within {} ms", timeout.count()), {}});
    }
    may_repeat_ = search.spoiled && !deadline.passed();
    return tl::unexpected(Fault{Cause::protocol, {}, "garbled answer: " + search.what, {}});
  }
  if (search.answer->verdict == Verdict::exception) {
    last_exception_ = search.answer->exception_code;
    return tl::unexpected(Fault{Cause::refused, {}, exception_name(last_exception_), {}});
  }
  if (search.answer->verdict != Verdict::good) {
    return tl::unexpected(Fault{Cause::protocol, {}, "garbled answer: " + search.answer->what, {}});
  }
  return std::move(search.answer->values);
}

}  // namespace luxrig::modbus
