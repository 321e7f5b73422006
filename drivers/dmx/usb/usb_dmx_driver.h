#pragma once
/// Common base of drivers of a USB widget: one bus is one widget with one universe. Life cycle, reopening a lost
/// device, options. A derived driver decides what to send when.

#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include "drivers/dmx/dmx_patch.h"
#include "drivers/driver.h"
#include "drivers/life.h"
#include "drivers/options.h"
#include "drivers/usb/usb_channel.h"
#include "drivers/usb/usb_search.h"

namespace luxrig {

// Rows for a driver's option table.
inline constexpr OptionDoc kUsbSerialOption = {
    "serial", "text", "", "\"\"", "as `lsusb -v` shows it", "serial number of the widget; empty: whichever is there"};
inline constexpr OptionDoc kUsbPortOption = {
    "usb_port",
    "text",
    "",
    "\"\"",
    "bus-port.port, such as 1-1.4",
    "where it is plugged in, for widgets without a serial number: as in /sys/bus/usb/devices; empty: anywhere"};
inline constexpr OptionDoc kUsbUniverseOption = {
    "universe",   "whole number",
    "",           "0",
    "0 to 63999", "the universe of the patch that this widget puts out; 0: the one that its fixtures are in"};

inline constexpr std::chrono::milliseconds kUsbPrepareBound(150), kUsbLeaveBound(100);
/// A transfer that takes longer than this counts as hung.
inline constexpr Duration kUsbTransferTimeout = std::chrono::milliseconds(500);
/// Unchanged levels are repeated this often, as a widget that lost power for an instant has forgotten them.
inline constexpr Duration kUsbRefreshEvery = std::chrono::milliseconds(900);

class UsbDmxDriver : public Driver, public LevelOutput, public Mover {
 public:
  UsbDmxDriver(const UsbDmxDriver&) = delete;
  UsbDmxDriver& operator=(const UsbDmxDriver&) = delete;

  Result<void> activate(Time now) final;
  void deactivate(Time now) final;
  [[nodiscard]] DriverBounds bounds() const final;
  [[nodiscard]] std::vector<Health> health(Time) const final { return {life_.health()}; }
  [[nodiscard]] std::vector<CarriedUniverse> carried() const final;
  LevelOutput* level_output() final { return this; }
  Mover* mover() final { return bay_.has_heads() ? this : nullptr; }
  Result<void> move(Time now, std::span<const AimCommand> commands) final;
  Result<void> write(Time now, std::span<const LevelCommand> commands) final;

 protected:
  UsbDmxDriver(std::unique_ptr<UsbChannel> channel, const Rig& rig, std::size_t bus);

  // Implemented by a derived driver. None blocks longer than stated.
  virtual Result<void> opened(Time now) = 0;                                ///< sets the device up; kUsbPrepareBound
  virtual void ended(Time now, const UsbCompletion& completion) = 0;        ///< a transfer has ended
  virtual void send_frame(Time now) = 0;                                    ///< starts due transfers; kUsbFrameBound
  virtual void leave(Time) {}                                               ///< about to close; kUsbLeaveBound
  virtual void closed() = 0;                                                ///< every ticket is invalid
  [[nodiscard]] virtual bool proves_itself_later() const { return false; }  ///< opened() proves nothing of the widget

  [[nodiscard]] UsbChannel& usb() { return *channel_; }
  [[nodiscard]] const DmxSlots& slots() const;
  /// Control transfers without data, one after another; returns the first failure or a timeout.
  Result<void> set_up(std::initializer_list<UsbSetup> requests);
  /// The completion of that ticket; others go to ended(). Empty if it takes longer than `wait`.
  std::optional<UsbCompletion> wait_for(Time now, UsbTicket ticket, std::chrono::milliseconds wait);
  /// Passes ended transfers to ended().
  void take_ended(Time now, std::chrono::milliseconds wait = std::chrono::milliseconds(0));
  /// Closes; reopens after a while.
  void lost(Time now, Fault fault);
  /// The device has shown that it works.
  void well(Time now);
  /// A derived destructor must call it: the base's is too late for overridden functions.
  void close(Time now);

  DmxPatchbay bay_;
  LifeRecord life_;

 private:
  [[nodiscard]] Fault inactive() const;
  void open(Time now);

  std::unique_ptr<UsbChannel> channel_;
  Time reopen_at_{};
  DmxSlots dark_{};
};

inline constexpr std::chrono::milliseconds kUsbFrameBound(50);

/// The device named by the bus's options. requires check_usb_dmx() to be empty.
[[nodiscard]] UsbSearch usb_search(const Bus& bus, std::span<const OptionDoc> docs, std::string what,
                                   std::vector<UsbKind> kinds);

/// Checks options, patch, and that all fixtures of the bus are in one universe.
[[nodiscard]] std::vector<Problem> check_usb_dmx(const Rig& rig, std::size_t bus, std::span<const OptionDoc> docs);

/// libusb, or the stand-in.
[[nodiscard]] std::unique_ptr<UsbChannel> make_usb_channel(UsbSearch search, const std::optional<Redirect>& redirect);

}  // namespace luxrig
