#include "drivers/usb/usbip_channel.h"

#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <deque>
#include <map>

#include "drivers/io/datagram.h"
#include "drivers/io/deadline.h"
#include "drivers/io/os_fault.h"
#include "drivers/usb/usbip_codec.h"

namespace luxrig {
namespace {

using std::chrono::milliseconds;

constexpr std::string_view kStandInBusId = "1-1";

class UsbipChannel final : public UsbChannel {
 public:
  explicit UsbipChannel(Redirect server) : server_(std::move(server)) {}
  ~UsbipChannel() override { close(); }
  UsbipChannel(const UsbipChannel&) = delete;
  UsbipChannel& operator=(const UsbipChannel&) = delete;

  Result<void> open() override {
    if (is_open()) return {};
    auto done = connect(Deadline(kUsbOpenBound));
    if (!done) close();
    return done;
  }

  void close() override {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
    imported_ = false;
    received_.clear();
    under_way_.clear();
    unlinks_.clear();
    ended_.clear();
  }

  [[nodiscard]] bool is_open() const override { return imported_; }
  [[nodiscard]] std::string where() const override {
    return imported_ ? fmt::format("USB/IP {}:{}", server_.host, server_.port) : "";
  }

  UsbTicket control_out(const UsbSetup& setup, std::span<const std::uint8_t> data) override {
    return start({0, 0, false, 0, setup, static_cast<std::uint32_t>(data.size())}, data);
  }
  UsbTicket control_in(const UsbSetup& setup, std::size_t length) override {
    return start({0, 0, true, 0, setup, static_cast<std::uint32_t>(length)}, {});
  }
  UsbTicket bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data) override {
    return start({0, 0, false, endpoint, {}, static_cast<std::uint32_t>(data.size())}, data);
  }
  UsbTicket bulk_in(std::uint8_t endpoint, std::size_t length) override {
    return start({0, 0, true, static_cast<std::uint8_t>(endpoint & 0x0f), {}, static_cast<std::uint32_t>(length)}, {});
  }

  void cancel(UsbTicket ticket) override {
    const auto found = under_way_.find(ticket);
    if (found == under_way_.end() || found->second.cancelled) return;
    found->second.cancelled = true;
    // The server may hang, so do not wait for its answer.
    ended_.push_back({ticket, UsbStatus::cancelled, 0, {}});
    unlinks_[++sequence_] = ticket;
    if (!send(usbip::unlink_header(sequence_, device_, ticket))) unplugged();
  }

  std::optional<UsbCompletion> take(milliseconds wait) override {
    receive(milliseconds(0));
    for (const Deadline until(wait); ended_.empty() && socket_ >= 0 && !until.passed();) receive(until.left());
    if (ended_.empty()) return std::nullopt;
    UsbCompletion completion = std::move(ended_.front());
    ended_.pop_front();
    return completion;
  }

 private:
  struct Transfer {
    bool in = false, cancelled = false;
  };

  Result<void> connect(const Deadline& deadline) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(parse_ipv4(server_.host).value_or(INADDR_LOOPBACK));
    address.sin_port = htons(static_cast<std::uint16_t>(server_.port));
    const std::string doing = fmt::format("connecting to {}:{}", server_.host, server_.port);
    socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (socket_ < 0) return tl::unexpected(os_fault("socket", errno));
    const int yes = 1;
    ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      if (errno != EINPROGRESS) return tl::unexpected(os_fault(doing, errno));
      if (!wait_for(POLLOUT, deadline)) return tl::unexpected(os_fault(doing, ETIMEDOUT));
      int error = 0;
      socklen_t size = sizeof error;
      ::getsockopt(socket_, SOL_SOCKET, SO_ERROR, &error, &size);
      if (error != 0) return tl::unexpected(os_fault(doing, error));
    }
    if (!send(usbip::import_request(kStandInBusId))) return tl::unexpected(os_fault(doing, EPIPE));
    while (received_.size() < usbip::kImportReplyBytes) {
      if (!wait_for(POLLIN, deadline)) return tl::unexpected(os_fault(doing + ", asking for the device", ETIMEDOUT));
      if (!read_some()) return tl::unexpected(os_fault(doing + ", asking for the device", ECONNRESET));
    }
    const auto device = usbip::imported(received_);
    if (!device) {
      return tl::unexpected(
          Fault{Cause::refused, {}, doing + ": the server does not give the device: unplug it elsewhere", {}});
    }
    received_.erase(received_.begin(), received_.begin() + usbip::kImportReplyBytes);
    device_ = *device;
    imported_ = true;
    return {};
  }

  bool wait_for(short events, const Deadline& deadline) const {
    pollfd wait{socket_, events, 0};
    return ::poll(&wait, 1, static_cast<int>(deadline.left().count())) > 0;
  }

  UsbTicket start(usbip::Submit submit, std::span<const std::uint8_t> data) {
    submit.sequence = ++sequence_;
    submit.device = device_;
    std::vector<std::uint8_t> bytes = usbip::submit_header(submit);
    if (!submit.in) bytes.insert(bytes.end(), data.begin(), data.end());
    under_way_[submit.sequence] = {submit.in, false};
    if (!send(bytes)) unplugged();
    return submit.sequence;
  }

  bool send(std::span<const std::uint8_t> bytes) {
    // Half a message would corrupt the stream, so a peer that does not read its socket counts as unplugged.
    return socket_ >= 0 &&
           ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
  }

  /// False when the connection has ended.
  bool read_some() {
    std::array<std::uint8_t, 4096> bytes;
    const auto got = ::recv(socket_, bytes.data(), bytes.size(), 0);
    if (got < 0) return errno == EAGAIN || errno == EINTR;
    received_.insert(received_.end(), bytes.begin(), bytes.begin() + got);
    return got > 0;
  }

  void receive(milliseconds wait) {
    if (socket_ < 0) return;
    pollfd ready{socket_, POLLIN, 0};
    if (::poll(&ready, 1, static_cast<int>(wait.count())) <= 0) return;
    if (!read_some()) return unplugged();
    while (received_.size() >= usbip::kHeaderBytes) {
      const auto answer = usbip::decode_answer(
          std::span<const std::uint8_t, usbip::kHeaderBytes>(received_.data(), usbip::kHeaderBytes));
      if (!answer) return unplugged();
      std::size_t size = usbip::kHeaderBytes;
      const auto found = answer->unlink ? under_way_.end() : under_way_.find(answer->sequence);
      if (!answer->unlink && found == under_way_.end()) return unplugged();  // an answer to nothing
      const bool has_data = !answer->unlink && found->second.in;
      if (has_data) size += answer->length;
      if (received_.size() < size) return;
      if (const auto unlink = unlinks_.find(answer->sequence); answer->unlink && unlink != unlinks_.end()) {
        under_way_.erase(unlink->second);
        unlinks_.erase(unlink);
      }
      if (!answer->unlink) {
        if (!found->second.cancelled) {
          UsbCompletion completion{answer->sequence, usbip::status_of(answer->status), answer->length, {}};
          if (has_data) {
            completion.data.assign(received_.begin() + usbip::kHeaderBytes,
                                   received_.begin() + static_cast<std::ptrdiff_t>(size));
          }
          ended_.push_back(std::move(completion));
        }
        under_way_.erase(found);
      }
      received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(size));
    }
  }

  void unplugged() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
    received_.clear();
    for (const auto& [ticket, transfer] : under_way_) {
      if (!transfer.cancelled) ended_.push_back({ticket, UsbStatus::gone, 0, {}});
    }
    under_way_.clear();
    unlinks_.clear();
  }

  Redirect server_;
  int socket_ = -1;
  bool imported_ = false;
  std::uint32_t device_ = 0, sequence_ = 0;
  std::vector<std::uint8_t> received_;
  std::map<std::uint32_t, Transfer> under_way_;  ///< cancelled ones stay until nothing more can arrive
  std::map<std::uint32_t, UsbTicket> unlinks_;   ///< by the sequence number of the unlink
  std::deque<UsbCompletion> ended_;
};

}  // namespace

std::unique_ptr<UsbChannel> make_usbip_channel(Redirect server) {
  return std::make_unique<UsbipChannel>(std::move(server));
}

}  // namespace luxrig
