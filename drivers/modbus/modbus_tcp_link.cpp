#include "drivers/modbus/modbus_tcp_link.h"

#include <fmt/format.h>
#include <modbus/modbus.h>
#include <poll.h>
#include <sys/select.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "core/check.h"
#include "drivers/io/deadline.h"
#include "drivers/io/os_fault.h"

namespace luxrig::modbus {
namespace {

constexpr std::size_t kRememberedUnanswered = 16;
constexpr int kMaxDrains = 16;
/// Extra time to read the rest of an answer that has begun, even if we come to it late.
constexpr std::chrono::milliseconds kRestOfAnswer(20);

void set_timeout(modbus_t* context, std::chrono::milliseconds timeout) {
  // Zero means "invalid" to libmodbus.
  const auto us = std::max<std::int64_t>(std::chrono::microseconds(timeout).count(), 1000);
  modbus_set_response_timeout(context, static_cast<std::uint32_t>(us / 1000000),
                              static_cast<std::uint32_t>(us % 1000000));
  // With a byte timeout, each byte of a trickling answer would start a new wait. Without one, the response timeout
  // bounds the whole answer.
  modbus_set_byte_timeout(context, 0, 0);
}

}  // namespace

Result<void> TcpLink::connect(std::chrono::milliseconds timeout) {
  shut();
  context_ = modbus_new_tcp(host_.c_str(), port_);
  if (context_ == nullptr) return tl::unexpected(os_fault("preparing a connection", errno));
  set_timeout(context_, timeout);
  if (modbus_connect(context_) != 0) {
    const int error = errno;
    shut();
    return tl::unexpected(os_fault(fmt::format("connecting to {}:{}", host_, port_), error));
  }
  fd_ = modbus_get_socket(context_);
  if (fd_ >= FD_SETSIZE) {  // libmodbus waits with select(), which cannot handle higher descriptors
    shut();
    return tl::unexpected(os_fault(fmt::format("connecting to {}:{}", host_, port_), EMFILE));
  }
  return {};
}

void TcpLink::shut() {
  if (context_ == nullptr) return;
  modbus_close(context_);
  modbus_free(context_);
  context_ = nullptr;
  fd_ = -1;
  unanswered_.clear();
}

Fault TcpLink::lost(Cause cause, std::string detail) {
  shut();
  return {cause, {}, std::move(detail), {}};
}

bool TcpLink::found_closed() {
  std::uint8_t byte = 0;
  const auto got = ::recv(fd_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  if (got > 0 || (got < 0 && (errno == EAGAIN || errno == EINTR))) return false;
  shut();
  return true;
}

Result<void> TcpLink::drop_unasked() {
  std::array<std::uint8_t, kLongestAdu> bin{};
  for (int i = 0; i < kMaxDrains; ++i) {
    const auto got = ::recv(fd_, bin.data(), bin.size(), MSG_DONTWAIT);
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) return {};
    if (got < 0) return tl::unexpected(lost(Cause::network, os_fault("the connection", errno).detail));
    if (got == 0) return tl::unexpected(lost(Cause::network, "the peer closed the connection"));
    if (unanswered_.empty()) {
      return tl::unexpected(lost(Cause::protocol, fmt::format("{} bytes that nobody asked for", got)));
    }
  }
  return tl::unexpected(lost(Cause::protocol, "a flood of bytes that nobody asked for"));
}

Result<std::vector<std::uint8_t>> TcpLink::receive(std::chrono::milliseconds timeout) {
  const Deadline deadline(timeout);
  pollfd wait{fd_, POLLIN, 0};
  int ready = 0;
  do {
    ready = ::poll(&wait, 1, static_cast<int>(deadline.left().count()));
  } while (ready < 0 && errno == EINTR && !deadline.passed());
  if (ready <= 0)
    return tl::unexpected(Fault{Cause::timeout, {}, fmt::format("no answer within {} ms", timeout.count()), {}});

  std::array<std::uint8_t, kLongestAdu> buffer{};
  set_timeout(context_, std::max(deadline.left(), kRestOfAnswer));
  const int size = modbus_receive_confirmation(context_, buffer.data());
  if (size >= 0) return std::vector<std::uint8_t>(buffer.begin(), buffer.begin() + size);
  const int error = errno;
  if (error == ETIMEDOUT) {
    return tl::unexpected(
        lost(Cause::timeout, fmt::format("an answer stopped half-way, {} ms passed", timeout.count())));
  }
  if (error == ECONNRESET) return tl::unexpected(lost(Cause::network, "the peer closed the connection"));
  if (error >= MODBUS_ENOBASE) {
    return tl::unexpected(lost(Cause::protocol, fmt::format("garbled answer: {}", modbus_strerror(error))));
  }
  return tl::unexpected(lost(Cause::network, os_fault("receiving", error).detail));
}

Result<std::vector<std::uint16_t>> TcpLink::exchange(const Request& request, std::chrono::milliseconds timeout) {
  LUXRIG_CHECK(connected(), "unit {}", request.unit);
  const Deadline deadline(timeout);
  last_exception_ = 0;
  if (auto dropped = drop_unasked(); !dropped) return tl::unexpected(dropped.error());

  ++transaction_;
  const std::vector<std::uint8_t> bytes = encode(request, transaction_);
  const auto sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent != static_cast<ssize_t>(bytes.size())) {
    const int error = sent < 0 ? errno : EAGAIN;
    return tl::unexpected(lost(Cause::network, os_fault("sending", error).detail));
  }

  while (true) {
    auto received = receive(deadline.left());
    if (!received) {
      if (connected()) {
        unanswered_.push_back(transaction_);
        if (unanswered_.size() > kRememberedUnanswered) unanswered_.pop_front();
        received.error().detail = fmt::format("no answer within {} ms", timeout.count());
      }
      return tl::unexpected(received.error());
    }
    Answer answer = decode(request, transaction_, *received);
    if (answer.verdict == Verdict::foreign) {
      const auto late = std::find(unanswered_.begin(), unanswered_.end(), answer.transaction);
      if (late != unanswered_.end()) {
        unanswered_.erase(late);
        continue;
      }
    }
    if (answer.verdict == Verdict::exception) {
      last_exception_ = answer.exception_code;
      return tl::unexpected(Fault{Cause::refused, {}, exception_name(answer.exception_code), {}});
    }
    if (answer.verdict != Verdict::good) {
      return tl::unexpected(lost(Cause::protocol, "garbled answer: " + answer.what));
    }
    std::uint8_t more = 0;
    if (unanswered_.empty() && ::recv(fd_, &more, 1, MSG_PEEK | MSG_DONTWAIT) > 0) {
      return tl::unexpected(lost(Cause::protocol, "bytes behind the end of an answer"));
    }
    return std::move(answer.values);
  }
}

}  // namespace luxrig::modbus
