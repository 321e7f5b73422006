#include "drivers/dmx/open_dmx/open_dmx_driver.h"

#include <fmt/format.h>

#include <algorithm>

#include "drivers/dmx/send_rate.h"
#include "drivers/dmx/usb/ftdi.h"
#include "drivers/dmx/usb/usb_dmx_driver.h"
#include "drivers/io/deadline.h"

namespace luxrig {
namespace {

using std::chrono::milliseconds;

constexpr OptionDoc kOpenDmxOptions[] = {
    kUsbSerialOption,
    kUsbPortOption,
    kUsbUniverseOption,
    {"rate_hz", "whole number", "Hz", "30", "1 to 40",
     "packets a second at most; each is made by three USB transfers, so above 35 some come late"},
    {"chip_port", "whole number", "", "0", "0 to 4",
     "which port of an FTDI chip that has several (0403:6010, 0403:6011); 0: the chip has one"},
};

constexpr int kDmxBaud = 250000;
constexpr int kQuietLatency_ms = 16;  // nothing is read
/// For one control transfer of a packet; normally 1 ms. A longer one (busy hub or host) costs that packet. The cable
/// counts as hung if no packet has come through for kUsbTransferTimeout.
constexpr milliseconds kControlWithin(10);
/// Longest wait of write() until the chip has sent the previous packet; after that, this packet is left out.
constexpr milliseconds kEmptyWithin(8);
/// Extra real time before data counts as hung: a packet needs 23 ms, and the controller's clock may run faster.
constexpr milliseconds kLastPatience(30);

class OpenDmxDriver final : public UsbDmxDriver {
 public:
  OpenDmxDriver(std::unique_ptr<UsbChannel> channel, const Rig& rig, std::size_t bus)
      : UsbDmxDriver(std::move(channel), rig, bus),
        port_{static_cast<std::uint16_t>(integer_option(rig.buses[bus], kOpenDmxOptions, "chip_port"))},
        rate_(std::chrono::nanoseconds(1'000'000'000 / integer_option(rig.buses[bus], kOpenDmxOptions, "rate_hz"))) {}
  ~OpenDmxDriver() override { close(latest_); }

 private:
  Result<void> opened(Time now) override {
    latest_ = now;
    late_since_.reset();
    // RTS low turns ENTTEC's line driver on.
    return set_up({ftdi::reset(port_, ftdi::Purge::reset), ftdi::set_baud(port_, kDmxBaud),
                   ftdi::set_format(port_, ftdi::Format::eight_n_two), ftdi::no_flow_control(port_),
                   ftdi::set_rts(port_, false), ftdi::set_latency(port_, kQuietLatency_ms),
                   ftdi::reset(port_, ftdi::Purge::transmit), ftdi::reset(port_, ftdi::Purge::receive)});
  }

  void ended(Time now, const UsbCompletion& completion) override {
    if (completion.status == UsbStatus::gone) {
      return lost(now, {Cause::network, {}, "the cable has been unplugged: plug it in again", {}});
    }
    if (sending_ != completion.ticket) return;  // a control transfer that write() no longer waits for
    sending_.reset();
    if (completion.status == UsbStatus::done) {
      late_since_.reset();
      return well(now);
    }
    failed(now, completion.status);
  }

  void send_frame(Time now) override {
    latest_ = now;
    if (sending_ && now - sent_at_ > kUsbTransferTimeout) take_ended(now, kLastPatience);
    if (!usb().is_open()) return;
    if (sending_) {
      if (now - sent_at_ > kUsbTransferTimeout) {
        lost(now, {Cause::timeout, {}, "the cable does not take data any more: unplug it and plug it in again", {}});
      }
      return;
    }
    if (!rate_.may_go(now) || !line_is_free(now)) return;
    (void)rate_.take(now);
    put_packet(now);
  }

  void leave(Time now) override {
    const Deadline deadline(kUsbLeaveBound);
    while (sending_ && usb().is_open() && !deadline.passed()) {
      if (const auto completion = usb().take(deadline.left())) ended(now, *completion);
    }
    // Send the newest look last; then the line rests at mark, not in the middle of a packet.
    if (usb().is_open() && !sending_ && last_ != slots() && line_is_free(now)) put_packet(now);
    while (sending_ && usb().is_open() && !deadline.passed()) {
      if (const auto completion = usb().take(deadline.left())) ended(now, *completion);
    }
  }

  void closed() override { sending_.reset(); }

  [[nodiscard]] bool settled() const override { return !sending_ && last_ == slots(); }

  /// A break while the chip still sends slots would cut the packet short. USB completion only means that the chip has
  /// them.
  bool line_is_free(Time now) {
    for (const Deadline deadline(kEmptyWithin);;) {
      const auto status = control(now, usb().control_in(ftdi::get_modem_status(port_), ftdi::kModemStatusBytes));
      if (!status) return false;
      if (ftdi::transmitter_is_empty(status->data)) return true;
      if (deadline.passed()) return false;
    }
  }

  /// Break, mark after break, data. Each begins after the one before has ended, as endpoints are not ordered.
  void put_packet(Time now) {
    const auto format = [&](bool breaks) { return ftdi::set_format(port_, ftdi::Format::eight_n_two, breaks); };
    if (!control(now, usb().control_out(format(true), {}))) return;
    if (!control(now, usb().control_out(format(false), {}))) return;
    std::array<std::uint8_t, 1 + kDmxSlots> packet{};  // start code 0
    std::copy(slots().begin(), slots().end(), packet.begin() + 1);
    sending_ = usb().bulk_out(port_.bulk_out(), packet);
    sent_at_ = now;
    last_ = slots();
    life_.count_sent();
  }

  std::optional<UsbCompletion> control(Time now, UsbTicket ticket) {
    auto completion = wait_for(now, ticket, kControlWithin);
    if (!usb().is_open()) return std::nullopt;
    if (!completion) {
      usb().cancel(ticket);
      late_since_ = std::min(now, late_since_.value_or(now));
      if (now - *late_since_ > kUsbTransferTimeout)
        lost(now,
             {Cause::timeout, {}, "it no longer answers control requests: unplug the cable and plug it in again", {}});
      return std::nullopt;
    }
    if (completion->status == UsbStatus::done) return completion;
    failed(now, completion->status);
    return std::nullopt;
  }

  void failed(Time now, UsbStatus status) {
    lost(now, {status == UsbStatus::stalled ? Cause::refused : Cause::network,
               {},
               fmt::format("a transfer {}: the cable or a hub is bad, or it is no FTDI chip", name_of(status)),
               {}});
  }

  ftdi::Port port_;
  SendRate rate_;
  std::optional<UsbTicket> sending_;
  Time sent_at_{}, latest_{};
  std::optional<Time> late_since_{};  ///< first late request since the last packet
  DmxSlots last_{};
};

}  // namespace

std::span<const OptionDoc> open_dmx_options() { return kOpenDmxOptions; }

std::vector<Problem> check_open_dmx(const Rig& rig, std::size_t bus) {
  return check_usb_dmx(rig, bus, kOpenDmxOptions);
}

std::unique_ptr<Driver> make_open_dmx_over(std::unique_ptr<UsbChannel> channel, const Rig& rig, std::size_t bus) {
  return std::make_unique<OpenDmxDriver>(std::move(channel), rig, bus);
}

std::unique_ptr<Driver> make_open_dmx(const Rig& rig, std::size_t bus, const std::optional<Redirect>& redirect) {
  const Bus& entry = rig.buses[bus];
  const ftdi::Port port{static_cast<std::uint16_t>(integer_option(entry, kOpenDmxOptions, "chip_port"))};
  std::vector<UsbKind> kinds{{ftdi::kVendor, ftdi::kFt232}};
  if (port.index > 0) kinds = {{ftdi::kVendor, ftdi::kFt2232}, {ftdi::kVendor, ftdi::kFt4232}};
  UsbSearch search = usb_search(entry, kOpenDmxOptions, "Open DMX cable (FTDI)", std::move(kinds));
  search.interface = port.interface();
  return make_open_dmx_over(make_usb_channel(std::move(search), redirect), rig, bus);
}

WhenDataStops open_dmx_when_data_stops(const Rig&, std::size_t) {
  return {WithoutData::makers_choice, 1, "E1.11: the line is silent, and data is lost after 1 s"};
}

}  // namespace luxrig
