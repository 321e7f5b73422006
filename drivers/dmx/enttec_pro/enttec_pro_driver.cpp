#include "drivers/dmx/enttec_pro/enttec_pro_driver.h"

#include <fmt/format.h>

#include "drivers/dmx/enttec_pro/widget_session.h"
#include "drivers/dmx/usb/ftdi.h"
#include "drivers/dmx/usb/usb_dmx_driver.h"
#include "drivers/io/deadline.h"

namespace luxrig {
namespace {

using std::chrono::milliseconds;

constexpr OptionDoc kEnttecProOptions[] = {
    kUsbSerialOption,
    kUsbPortOption,
    kUsbUniverseOption,
    {"rate_hz", "whole number", "Hz", "40", "1 to 40",
     "how often the widget sends a packet at most; some fixtures fail above 30"},
    {"break_us", "whole number", "µs", "176", "96 to 1355", "length of the break, in steps of 10.67 µs"},
    {"mab_us", "whole number", "µs", "21", "11 to 1355", "length of the mark after it, in steps of 10.67 µs"},
};

constexpr int kSerialBaud = 57600;  // irrelevant for a chip on USB, but clones pass it on to a real UART
constexpr int kLatency_ms = 2;
constexpr std::size_t kBulkInBytes = 512;
/// Extra real time before a silent widget counts as lost: the controller's clock may run faster, and a busy machine may
/// have delayed the answer.
constexpr milliseconds kLastListen(20);

enttec::Parameters wanted_parameters(const Bus& bus) {
  enttec::Parameters wanted;
  wanted.break_units = enttec::units_of_us(static_cast<int>(integer_option(bus, kEnttecProOptions, "break_us")));
  wanted.mark_units = enttec::units_of_us(static_cast<int>(integer_option(bus, kEnttecProOptions, "mab_us")));
  wanted.rate_hz = static_cast<int>(integer_option(bus, kEnttecProOptions, "rate_hz"));
  return wanted;
}

class EnttecProDriver final : public UsbDmxDriver {
 public:
  EnttecProDriver(std::unique_ptr<UsbChannel> channel, const Rig& rig, std::size_t bus)
      : UsbDmxDriver(std::move(channel), rig, bus), session_(wanted_parameters(rig.buses[bus])) {}
  ~EnttecProDriver() override { close(latest_); }

 private:
  bool proves_itself_later() const override { return true; }

  Result<void> opened(Time now) override {
    latest_ = now;
    if (auto done = set_up({ftdi::reset(port_, ftdi::Purge::reset), ftdi::set_baud(port_, kSerialBaud),
                            ftdi::set_format(port_, ftdi::Format::eight_n_one), ftdi::no_flow_control(port_),
                            ftdi::set_latency(port_, kLatency_ms), ftdi::reset(port_, ftdi::Purge::receive)});
        !done) {
      return done;
    }
    session_.start(now);
    receiving_ = usb().bulk_in(port_.bulk_in(), kBulkInBytes);
    return {};
  }

  void ended(Time now, const UsbCompletion& completion) override {
    if (completion.status == UsbStatus::gone) {
      return lost(now, {Cause::network, {}, "the widget has been unplugged: plug it in again", {}});
    }
    if (sending_ == completion.ticket) {
      sending_.reset();
      if (completion.status != UsbStatus::done) transfer_failed(now, completion);
      return;
    }
    if (receiving_ != completion.ticket) return;
    receiving_.reset();
    if (completion.status != UsbStatus::done) return transfer_failed(now, completion);
    const std::uint64_t answers = session_.answers();
    session_.receive(now, ftdi::received_bytes(completion.data));
    if (session_.answers() != answers) {
      life_.count_received(now);
      well(now);
    }
    receiving_ = usb().bulk_in(port_.bulk_in(), kBulkInBytes);
  }

  void send_frame(Time now) override {
    latest_ = now;
    if (session_.is_overdue(now) || is_hung(now)) take_ended(now, kLastListen);
    if (!usb().is_open()) return;
    if (session_.is_overdue(now) || is_hung(now)) return silent(now);
    if (sending_) return;  // the widget is busy: the newest levels go out when it has caught up
    send(now, session_.due(now, slots()));
  }

  [[nodiscard]] bool settled() const override { return !sending_ && session_.is_sent(slots()); }

  bool is_hung(Time now) const { return sending_ && now - sent_at_ > kUsbTransferTimeout; }

  /// The widget repeats the last packet for ever, so that must be the newest.
  void leave(Time now) override {
    const Deadline deadline(kUsbLeaveBound);
    wait_for_sent(now, deadline);
    if (!usb().is_open() || sending_) return;
    send(now, session_.unsent(slots()));
    wait_for_sent(now, deadline);
  }

  void closed() override {
    sending_.reset();
    receiving_.reset();
  }

  void wait_for_sent(Time now, const Deadline& deadline) {
    while (sending_ && usb().is_open() && !deadline.passed()) {
      if (const auto completion = usb().take(deadline.left())) ended(now, *completion);
    }
  }

  void send(Time now, const std::vector<std::uint8_t>& bytes) {
    if (bytes.empty()) return;
    sending_ = usb().bulk_out(port_.bulk_out(), bytes);
    sent_at_ = now;
    life_.count_sent();
  }

  void transfer_failed(Time now, const UsbCompletion& completion) {
    lost(now, {Cause::network,
               {},
               fmt::format("a transfer {}: the cable or a hub is bad, or the widget needs its power back",
                           name_of(completion.status)),
               {}});
  }

  void silent(Time now) {
    if (session_.has_answered()) {
      return lost(now, {Cause::timeout, {}, "the widget has stopped answering: unplug it and plug it in again", {}});
    }
    lost(now, {Cause::timeout,
               {},
               "nothing there answers as an ENTTEC DMX USB Pro does: if it is a plain cable take driver = "
               "\"open_dmx\", else give the bus the widget's serial",
               {}});
  }

  ftdi::Port port_;
  enttec::WidgetSession session_;
  std::optional<UsbTicket> sending_, receiving_;
  Time sent_at_{}, latest_{};
};

}  // namespace

std::span<const OptionDoc> enttec_pro_options() { return kEnttecProOptions; }

std::vector<Problem> check_enttec_pro(const Rig& rig, std::size_t bus) {
  return check_usb_dmx(rig, bus, kEnttecProOptions);
}

std::unique_ptr<Driver> make_enttec_pro_over(std::unique_ptr<UsbChannel> channel, const Rig& rig, std::size_t bus) {
  return std::make_unique<EnttecProDriver>(std::move(channel), rig, bus);
}

std::unique_ptr<Driver> make_enttec_pro(const Rig& rig, std::size_t bus, const std::optional<Redirect>& redirect) {
  UsbSearch search =
      usb_search(rig.buses[bus], kEnttecProOptions, "ENTTEC DMX USB Pro", {{ftdi::kVendor, ftdi::kFt232}});
  return make_enttec_pro_over(make_usb_channel(std::move(search), redirect), rig, bus);
}

WhenDataStops enttec_pro_when_data_stops(const Rig&, std::size_t) {
  return {WithoutData::holds, std::nullopt, "the widget, which repeats its last packet while it has power"};
}

}  // namespace luxrig
