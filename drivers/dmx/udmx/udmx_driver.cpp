#include "drivers/dmx/udmx/udmx_driver.h"

#include <fmt/format.h>

#include "drivers/dmx/send_rate.h"
#include "drivers/dmx/udmx/changed_range.h"
#include "drivers/dmx/udmx/lateness.h"
#include "drivers/dmx/usb/usb_dmx_driver.h"
#include "drivers/io/deadline.h"

namespace luxrig {
namespace {

using std::chrono::milliseconds;
using udmx::SlotRange;

constexpr OptionDoc kUdmxOptions[] = {kUsbSerialOption, kUsbPortOption, kUsbUniverseOption};

constexpr std::uint8_t kSetChannelRange = 2;  // anyma's uDMX_cmds.h; value: count, index: first slot, from 0
constexpr int kMaxFailures = 3;               // in a row
constexpr int kMaxStalls = 100;               // in a row, about 2 s: healthy units stall occasionally
constexpr milliseconds kLastWait(20);         // in real time, before a transfer counts as slow or hung

class UdmxDriver final : public UsbDmxDriver {
 public:
  UdmxDriver(std::unique_ptr<UsbChannel> channel, const Rig& rig, std::size_t bus)
      : UsbDmxDriver(std::move(channel), rig, bus) {}
  ~UdmxDriver() override { close(latest_); }

 private:
  // It has no identity request: the first range shows whether it answers.
  bool proves_itself_later() const override { return true; }
  Result<void> opened(Time now) override {
    latest_ = now;
    known_.reset();
    failures_ = stalls_ = 0;
    return {};
  }

  void ended(Time now, const UsbCompletion& completion) override {
    if (sending_ != completion.ticket) return;
    sending_.reset();
    switch (completion.status) {
      case UsbStatus::done:
        // A cancelled transfer may have delivered its last packet or not, so only a complete one counts.
        if (completion.transferred != range_.count) return failed(now, "ended early");
        known_ = on_its_way_;
        failures_ = stalls_ = 0;
        lateness_.arrived();
        life_.count_received(now);
        if (!lateness_.should_be_known()) well(now);
        return;
      case UsbStatus::stalled:
        life_.count_error();
        lateness_.went_wrong();
        known_.reset();  // part of it may have arrived
        if (++stalls_ < kMaxStalls) return;
        return lost(now, {Cause::refused, {}, fmt::format("{} requests in a row were refused: no uDMX?", stalls_), {}});
      case UsbStatus::gone:
        return lost(now, {Cause::network, {}, "the widget has been unplugged: plug it in again", {}});
      case UsbStatus::cancelled:
        return failed(now, "took longer than 500 ms");
      case UsbStatus::failed:
        return failed(now, "failed");
    }
  }

  void failed(Time now, std::string_view how) {
    life_.count_error();
    lateness_.went_wrong();
    known_.reset();
    if (++failures_ < kMaxFailures) return;
    lost(now, {Cause::timeout,
               {},
               fmt::format("{} transfers in a row went wrong, the last {}: unplug the widget and plug it in again",
                           failures_, how),
               {}});
  }

  void send_frame(Time now) override {
    latest_ = now;
    if (is_slow(now)) take_ended(now, kLastWait);
    if (!usb().is_open()) return;
    if (is_hung(now)) {
      usb().cancel(*sending_);
      take_ended(now, kLastWait);
      if (!usb().is_open()) return;
    }
    watch_lateness(now);
    if (sending_) return;
    if (const auto range = wanted_range(now); range && rate_.take(now)) send(now, *range);
  }

  [[nodiscard]] bool settled() const override { return known_ && *known_ == slots(); }

  /// The widget is there but the light follows too late or not at all: a fault like any other, until it ends.
  void watch_lateness(Time now) {
    const bool was_known = lateness_.should_be_known();
    lateness_.step(now, known_ && *known_ == slots());
    if (lateness_.should_be_known()) {
      const double window_s = to_seconds(udmx::kUdmxLateWindow);
      life_.faulted(now,
                    {Cause::timeout,
                     {},
                     fmt::format("{}: light follows late or not at all, for {:.1f} of the last {:g} s ({} of {} "
                                 "transfers went wrong): use another port, a shorter cable, no hub, or another widget",
                                 usb().where(), to_seconds(lateness_.late_for()), window_s, lateness_.failures(),
                                 lateness_.transfers()),
                     {}},
                    false);  // each failed transfer was counted
    } else if (was_known) {
      life_.active(now);
    }
  }

  /// The widget repeats its slots for ever, so they must be the newest.
  void leave(Time now) override {
    const Deadline deadline(kUsbLeaveBound);
    for (int transfers = 0; transfers < 2; ++transfers) {
      while (sending_ && usb().is_open() && !deadline.passed()) {
        if (const auto completion = usb().take(deadline.left())) ended(now, *completion);
      }
      if (!usb().is_open() || sending_) return;
      const auto range = known_ ? udmx::changed_range(*known_, slots()) : std::nullopt;
      if (!range) return;
      send(now, *range);
    }
  }

  void closed() override {
    sending_.reset();
    known_.reset();
    lateness_ = {};
  }

  bool is_slow(Time now) const { return sending_ && now - sent_at_ > udmx::kUdmxLateAfter / 2; }
  bool is_hung(Time now) const { return sending_ && now - sent_at_ > kUsbTransferTimeout; }

  std::optional<SlotRange> wanted_range(Time now) const {
    if (!known_ || now - whole_at_ >= kUsbRefreshEvery) return udmx::kAllSlots;
    return udmx::changed_range(*known_, slots());
  }

  void send(Time now, const SlotRange& range) {
    range_ = range;
    on_its_way_ = slots();
    const UsbSetup setup{kUsbVendorOut, kSetChannelRange, static_cast<std::uint16_t>(range.count),
                         static_cast<std::uint16_t>(range.first)};
    sending_ = usb().control_out(setup, std::span(on_its_way_).subspan(range.first, range.count));
    sent_at_ = now;
    if (range == udmx::kAllSlots) whole_at_ = now;
    life_.count_sent();
    lateness_.sent();
  }

  SendRate rate_;
  udmx::Lateness lateness_;
  std::optional<UsbTicket> sending_;
  SlotRange range_;
  std::optional<DmxSlots> known_;  ///< the widget's slots
  DmxSlots on_its_way_{};
  Time sent_at_{}, whole_at_{}, latest_{};
  int failures_ = 0, stalls_ = 0;
};

}  // namespace

std::span<const OptionDoc> udmx_options() { return kUdmxOptions; }

std::vector<Problem> check_udmx(const Rig& rig, std::size_t bus) { return check_usb_dmx(rig, bus, kUdmxOptions); }

std::unique_ptr<Driver> make_udmx_over(std::unique_ptr<UsbChannel> channel, const Rig& rig, std::size_t bus) {
  return std::make_unique<UdmxDriver>(std::move(channel), rig, bus);
}

std::unique_ptr<Driver> make_udmx(const Rig& rig, std::size_t bus, const std::optional<Redirect>& redirect) {
  // Every user of that USB stack may use the first id, so the names must match as well.
  UsbSearch search =
      usb_search(rig.buses[bus], kUdmxOptions, "uDMX", {{0x16c0, 0x05dc, "www.anyma.ch", "uDMX"}, {0x03eb, 0x8888}});
  return make_udmx_over(make_usb_channel(std::move(search), redirect), rig, bus);
}

WhenDataStops udmx_when_data_stops(const Rig&, std::size_t) {
  return {WithoutData::holds, std::nullopt, "the widget, which repeats its last packet while it has power"};
}

}  // namespace luxrig
