#include "drivers/can/can_socket.h"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "drivers/io/os_fault.h"

namespace luxrig::can {
namespace {

static_assert(sizeof(can_frame) == kFrameBytes);

CanFrame from_kernel(const can_frame& raw) {
  CanFrame frame;
  frame.error = (raw.can_id & CAN_ERR_FLAG) != 0;
  frame.remote = (raw.can_id & CAN_RTR_FLAG) != 0;
  frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.id = raw.can_id & (frame.error ? CAN_ERR_MASK : frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.size = raw.can_dlc > 8 ? std::uint8_t{8} : raw.can_dlc;
  std::memcpy(frame.data.data(), raw.data, frame.size);
  return frame;
}

class CanSocket final : public CanChannel {
 public:
  explicit CanSocket(CanSocketSettings settings) : settings_(std::move(settings)) {}
  ~CanSocket() override { close(); }
  CanSocket(const CanSocket&) = delete;
  CanSocket& operator=(const CanSocket&) = delete;

  Result<void> open() override {
    if (fd_ >= 0) return {};
    error_.reset();
    fd_ = ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    if (fd_ < 0) return failed("opening a CAN socket");
    std::vector<can_filter> filters;
    for (const std::uint32_t id : settings_.ids) filters.push_back({id, CAN_SFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG});
    const can_err_mask_t errors = CAN_ERR_BUSOFF | CAN_ERR_CRTL | CAN_ERR_RESTARTED;
    const int yes = 1;
    if (::setsockopt(fd_, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                     static_cast<socklen_t>(filters.size() * sizeof(can_filter))) != 0 ||
        ::setsockopt(fd_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) != 0 ||
        ::setsockopt(fd_, SOL_SOCKET, SO_TIMESTAMPNS, &yes, sizeof yes) != 0) {
      return failed("setting up a CAN socket");
    }
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(::if_nametoindex(settings_.interface_name.c_str()));
    if (address.can_ifindex == 0) return failed("looking for the interface " + settings_.interface_name);
    if (::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      return failed("using the interface " + settings_.interface_name);
    }
    // A socket can bind to an interface that is down; it shows only as a pending error.
    int pending = 0;
    socklen_t size = sizeof pending;
    if (::getsockopt(fd_, SOL_SOCKET, SO_ERROR, &pending, &size) == 0 && pending != 0) {
      errno = pending;
      return failed("using the interface " + settings_.interface_name);
    }
    return {};
  }

  void close() override {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }

  bool is_open() const override { return fd_ >= 0; }

  Result<Sent> send(const CanFrame& frame) override {
    can_frame raw{};
    raw.can_id = frame.id;
    raw.can_dlc = frame.size;
    std::memcpy(raw.data, frame.data.data(), frame.size);
    if (::write(fd_, &raw, sizeof raw) == sizeof raw) return Sent::yes;
    if (errno == ENOBUFS || errno == EAGAIN) return Sent::queue_full;
    const Fault fault = os_fault("sending on " + settings_.interface_name, errno);
    close();  // down or gone: reopening may help
    return tl::unexpected(fault);
  }

  std::optional<CanFrame> receive() override {
    if (fd_ < 0) return std::nullopt;
    can_frame raw{};
    iovec part{&raw, sizeof raw};
    alignas(cmsghdr) char control[128];
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    const auto got = ::recvmsg(fd_, &message, 0);
    if (got < 0) {
      if (errno == EAGAIN || errno == EINTR) return std::nullopt;
      error_ = os_fault("receiving on " + settings_.interface_name, errno);
      close();
      return std::nullopt;
    }
    if (got != sizeof raw) return std::nullopt;
    CanFrame frame = from_kernel(raw);
    for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
      if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SO_TIMESTAMPNS) continue;
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
      frame.received = std::chrono::seconds(stamp.tv_sec) + std::chrono::nanoseconds(stamp.tv_nsec);
    }
    return frame;
  }

  std::optional<Fault> take_error() override { return std::exchange(error_, std::nullopt); }

 private:
  tl::unexpected<Fault> failed(const std::string& doing) {
    const int error = errno;
    close();
    if (error == EAFNOSUPPORT) {
      return tl::unexpected(Fault{
          Cause::system, "", "this kernel has no CAN: load the modules can and can-raw, or use another kernel", {}});
    }
    return tl::unexpected(os_fault(doing, error));
  }

  CanSocketSettings settings_;
  int fd_ = -1;
  std::optional<Fault> error_;
};

}  // namespace

std::unique_ptr<CanChannel> make_can_socket(CanSocketSettings settings) {
  return std::make_unique<CanSocket>(std::move(settings));
}

}  // namespace luxrig::can
