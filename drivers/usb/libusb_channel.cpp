#include "drivers/usb/libusb_channel.h"

#include <fmt/format.h>
#include <libusb.h>

#include <algorithm>
#include <array>
#include <deque>
#include <memory>

#include "drivers/io/deadline.h"
#include "drivers/usb/tty_lock.h"
#include "drivers/usb/usb_strings.h"

namespace luxrig {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kStringTimeout(50), kCancelTimeout(200);
constexpr std::size_t kMaxHubs = 7;  // USB 2.0: deepest nesting

Fault usb_fault(const std::string& doing, int error) {
  switch (error) {
    case LIBUSB_ERROR_ACCESS:
      return {Cause::system,
              {},
              doing +
                  ": no permission: install drivers/dmx/usb/60-luxrig-usb.rules in /etc/udev/rules.d and plug the "
                  "device in again, or run as root",
              {}};
    case LIBUSB_ERROR_BUSY:
      return {Cause::system, {}, doing + ": another program has claimed it: stop that program (OLA, QLC+)", {}};
    case LIBUSB_ERROR_NO_DEVICE:
      return {Cause::network, {}, doing + ": the device has been unplugged: plug it in again", {}};
    case LIBUSB_ERROR_TIMEOUT:
      return {Cause::timeout, {}, doing + ": no answer: unplug the device and plug it in again", {}};
    default:
      return {Cause::system, {}, fmt::format("{}: {}", doing, libusb_error_name(error)), {}};
  }
}

UsbStatus status_of(libusb_transfer_status status) {
  switch (status) {
    case LIBUSB_TRANSFER_COMPLETED:
      return UsbStatus::done;
    case LIBUSB_TRANSFER_STALL:
      return UsbStatus::stalled;
    case LIBUSB_TRANSFER_CANCELLED:
      return UsbStatus::cancelled;
    case LIBUSB_TRANSFER_NO_DEVICE:
      return UsbStatus::gone;
    default:
      return UsbStatus::failed;
  }
}

/// Closes an open device unless it is taken.
struct DeviceCloser {
  void operator()(libusb_device_handle* handle) const { libusb_close(handle); }
};
using OpenDevice = std::unique_ptr<libusb_device_handle, DeviceCloser>;

std::string string_of(libusb_device_handle* handle, std::uint8_t index, const Deadline& deadline) {
  constexpr std::uint16_t kEnglish = 0x0409;  // also what devices with only one language report
  std::array<unsigned char, 255> bytes{};
  if (index == 0 || deadline.passed()) return {};
  const auto timeout = static_cast<unsigned>(std::min(kStringTimeout, deadline.left()).count());
  const int got = libusb_control_transfer(handle, LIBUSB_ENDPOINT_IN, LIBUSB_REQUEST_GET_DESCRIPTOR,
                                          static_cast<std::uint16_t>(LIBUSB_DT_STRING << 8 | index), kEnglish,
                                          bytes.data(), static_cast<std::uint16_t>(bytes.size()), timeout);
  if (got <= 0) return {};
  return text_of_string_descriptor({bytes.data(), static_cast<std::size_t>(got)});
}

class LibusbChannel final : public UsbChannel {
 public:
  explicit LibusbChannel(UsbSearch search) : search_(std::move(search)) {}
  ~LibusbChannel() override { close(); }
  LibusbChannel(const LibusbChannel&) = delete;
  LibusbChannel& operator=(const LibusbChannel&) = delete;

  Result<void> open() override {
    if (is_open()) return {};
    if (const int error = libusb_init(&context_); error != 0) {
      context_ = nullptr;
      return tl::unexpected(usb_fault("libusb_init", error));
    }
    auto opened = find_and_claim();
    if (!opened) close();
    return opened;
  }

  void close() override {
    if (handle_) {
      for (const auto& transfer : under_way_) libusb_cancel_transfer(transfer->libusb);
      for (const Deadline until(kCancelTimeout); !under_way_.empty() && !until.passed();) handle_events(until.left());
      if (claimed_) libusb_release_interface(handle_.get(), search_.interface);
      if (detached_) libusb_attach_kernel_driver(handle_.get(), search_.interface);
      handle_.reset();
    }
    // Transfers that could not be cancelled ended with the handle; their memory is ours to free.
    for (const auto& transfer : under_way_) libusb_free_transfer(transfer->libusb);
    under_way_.clear();
    ended_.clear();
    claimed_ = detached_ = false;
    where_.clear();
    if (context_ != nullptr) libusb_exit(context_);
    context_ = nullptr;
  }

  [[nodiscard]] bool is_open() const override { return claimed_; }
  [[nodiscard]] std::string where() const override { return where_; }

  UsbTicket control_out(const UsbSetup& setup, std::span<const std::uint8_t> data) override {
    return start(0, setup, data, data.size());
  }
  UsbTicket control_in(const UsbSetup& setup, std::size_t length) override { return start(0, setup, {}, length); }
  UsbTicket bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data) override {
    return start(endpoint, std::nullopt, data, data.size());
  }
  UsbTicket bulk_in(std::uint8_t endpoint, std::size_t length) override {
    return start(endpoint, std::nullopt, {}, length);
  }

  void cancel(UsbTicket ticket) override {
    for (const auto& transfer : under_way_) {
      if (transfer->ticket == ticket) libusb_cancel_transfer(transfer->libusb);
    }
  }

  std::optional<UsbCompletion> take(milliseconds wait) override {
    if (context_ == nullptr) return std::nullopt;
    handle_events(milliseconds(0));
    for (const Deadline until(wait); ended_.empty() && !until.passed();) handle_events(until.left());
    if (ended_.empty()) return std::nullopt;
    UsbCompletion completion = std::move(ended_.front());
    ended_.pop_front();
    return completion;
  }

 private:
  struct Transfer {
    UsbTicket ticket = 0;
    LibusbChannel* channel = nullptr;
    libusb_transfer* libusb = nullptr;
    std::vector<std::uint8_t> buffer;
    bool control = false, in = false;
  };

  Result<void> find_and_claim() {
    const Deadline deadline(kUsbOpenBound);
    libusb_device** list = nullptr;
    const auto count = libusb_get_device_list(context_, &list);
    if (count < 0) return tl::unexpected(usb_fault("listing USB devices", static_cast<int>(count)));
    std::vector<UsbCandidate> matching;
    std::vector<libusb_device*> devices;
    std::optional<Fault> trouble;
    for (ssize_t i = 0; i < count; ++i) {
      UsbCandidate candidate;
      libusb_device_descriptor descriptor{};
      if (libusb_get_device_descriptor(list[i], &descriptor) != 0) continue;
      candidate.vendor = descriptor.idVendor;
      candidate.product = descriptor.idProduct;
      std::array<std::uint8_t, kMaxHubs> ports{};
      const int depth = libusb_get_port_numbers(list[i], ports.data(), static_cast<int>(ports.size()));
      candidate.port =
          port_path(libusb_get_bus_number(list[i]), {ports.data(), static_cast<std::size_t>(std::max(depth, 0))});
      if (!may_match(search_, candidate)) continue;
      if (needs_strings(search_, candidate)) {
        const auto read = read_strings(list[i], descriptor, candidate, deadline);
        if (!read) trouble = read.error();
      }
      if (!matches(search_, candidate)) continue;
      matching.push_back(std::move(candidate));
      devices.push_back(list[i]);
    }
    // A candidate device that cannot be queried explains more than "none is there".
    Result<void> result;
    if (matching.empty() && trouble) {
      result = tl::unexpected(*trouble);
    } else if (const auto chosen = choose(search_, matching); !chosen) {
      result = tl::unexpected(chosen.error());
    } else {
      result = claim(devices[*chosen], matching[*chosen], deadline);
    }
    libusb_free_device_list(list, 1);
    return result;
  }

  static Result<void> read_strings(libusb_device* device, const libusb_device_descriptor& descriptor,
                                   UsbCandidate& candidate, const Deadline& deadline) {
    libusb_device_handle* opened = nullptr;
    if (const int error = libusb_open(device, &opened); error != 0) {
      return tl::unexpected(usb_fault("opening " + text_of(candidate), error));
    }
    const OpenDevice handle(opened);
    candidate.serial = string_of(opened, descriptor.iSerialNumber, deadline);
    candidate.manufacturer = string_of(opened, descriptor.iManufacturer, deadline);
    candidate.product_name = string_of(opened, descriptor.iProduct, deadline);
    return {};
  }

  Result<void> claim(libusb_device* device, UsbCandidate& candidate, const Deadline& deadline) {
    libusb_device_handle* opened = nullptr;
    if (const int error = libusb_open(device, &opened); error != 0) {
      return tl::unexpected(usb_fault("opening " + text_of(candidate), error));
    }
    handle_.reset(opened);
    libusb_device_descriptor descriptor{};
    if (candidate.serial.empty() && libusb_get_device_descriptor(device, &descriptor) == 0) {
      candidate.serial = string_of(opened, descriptor.iSerialNumber, deadline);
    }
    if (libusb_kernel_driver_active(opened, search_.interface) == 1) {
      if (const auto user = tty_user(candidate.port, search_.interface)) {
        return tl::unexpected(Fault{Cause::system,
                                    {},
                                    fmt::format("{} is in use as {} by process {}: stop that program",
                                                text_of(candidate), user->tty, user->pid),
                                    {}});
      }
      if (const int error = libusb_detach_kernel_driver(opened, search_.interface); error != 0) {
        return tl::unexpected(usb_fault("taking " + text_of(candidate) + " from the kernel's driver", error));
      }
      detached_ = true;
    }
    if (const int error = libusb_claim_interface(opened, search_.interface); error != 0) {
      return tl::unexpected(usb_fault("claiming " + text_of(candidate), error));
    }
    claimed_ = true;
    where_ = text_of(candidate);
    return {};
  }

  UsbTicket start(std::uint8_t endpoint, const std::optional<UsbSetup>& setup, std::span<const std::uint8_t> data,
                  std::size_t length) {
    auto transfer = std::make_unique<Transfer>();
    transfer->ticket = ++last_ticket_;
    transfer->channel = this;
    transfer->control = setup.has_value();
    transfer->in = ((setup ? setup->request_type : endpoint) & LIBUSB_ENDPOINT_IN) != 0;
    transfer->libusb = libusb_alloc_transfer(0);
    if (transfer->libusb == nullptr || handle_ == nullptr) {
      libusb_free_transfer(transfer->libusb);
      ended_.push_back({last_ticket_, UsbStatus::failed, 0, {}});
      return last_ticket_;
    }
    if (setup) {
      transfer->buffer.resize(LIBUSB_CONTROL_SETUP_SIZE + length);
      libusb_fill_control_setup(transfer->buffer.data(), setup->request_type, setup->request, setup->value,
                                setup->index, static_cast<std::uint16_t>(length));
      std::copy(data.begin(), data.end(), transfer->buffer.begin() + LIBUSB_CONTROL_SETUP_SIZE);
      libusb_fill_control_transfer(transfer->libusb, handle_.get(), transfer->buffer.data(), ended, transfer.get(), 0);
    } else {
      transfer->buffer.assign(data.begin(), data.end());
      transfer->buffer.resize(length);
      libusb_fill_bulk_transfer(transfer->libusb, handle_.get(), endpoint, transfer->buffer.data(),
                                static_cast<int>(length), ended, transfer.get(), 0);
    }
    if (const int error = libusb_submit_transfer(transfer->libusb); error != 0) {
      libusb_free_transfer(transfer->libusb);
      const UsbStatus status = error == LIBUSB_ERROR_NO_DEVICE ? UsbStatus::gone : UsbStatus::failed;
      ended_.push_back({last_ticket_, status, 0, {}});
      return last_ticket_;
    }
    under_way_.push_back(std::move(transfer));
    return last_ticket_;
  }

  static void LIBUSB_CALL ended(libusb_transfer* done) {
    Transfer* transfer = static_cast<Transfer*>(done->user_data);
    LibusbChannel& channel = *transfer->channel;
    UsbCompletion completion{transfer->ticket, status_of(done->status), 0, {}};
    completion.transferred = static_cast<std::size_t>(std::max(done->actual_length, 0));
    if (transfer->in) {
      const auto from =
          transfer->buffer.begin() + (transfer->control ? static_cast<std::ptrdiff_t>(LIBUSB_CONTROL_SETUP_SIZE) : 0);
      completion.data.assign(from, from + done->actual_length);
    }
    channel.ended_.push_back(std::move(completion));
    libusb_free_transfer(done);
    std::erase_if(channel.under_way_, [&](const auto& t) { return t.get() == transfer; });
  }

  void handle_events(milliseconds wait) {
    timeval time{wait.count() / 1000, (wait.count() % 1000) * 1000};
    libusb_handle_events_timeout(context_, &time);
  }

  UsbSearch search_;
  libusb_context* context_ = nullptr;
  OpenDevice handle_;
  bool claimed_ = false, detached_ = false;
  std::string where_;
  UsbTicket last_ticket_ = 0;
  std::vector<std::unique_ptr<Transfer>> under_way_;
  std::deque<UsbCompletion> ended_;
};

}  // namespace

std::unique_ptr<UsbChannel> make_libusb_channel(UsbSearch search) {
  return std::make_unique<LibusbChannel>(std::move(search));
}

}  // namespace luxrig
