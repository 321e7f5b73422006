#include "drivers/dmx/usb/usb_dmx_driver.h"

#include <fmt/format.h>

#include "drivers/io/deadline.h"
#include "drivers/usb/libusb_channel.h"
#include "drivers/usb/usbip_channel.h"

namespace luxrig {
namespace {

using std::chrono::milliseconds;

constexpr Duration kUsbReopenEvery = std::chrono::seconds(1);
constexpr milliseconds kUsbCloseBound(50);
constexpr int kMaxEndedPerCycle = 64;  // a device that answers without end must not delay the output
constexpr int kHighestUsbUniverse = 63999;

}  // namespace

UsbDmxDriver::UsbDmxDriver(std::unique_ptr<UsbChannel> channel, const Rig& rig, std::size_t bus)
    : bay_(rig, bus), life_(rig.buses[bus].name), channel_(std::move(channel)) {}

const DmxSlots& UsbDmxDriver::slots() const {
  return bay_.universes().empty() ? dark_ : bay_.universes().front().slots;
}

std::vector<CarriedUniverse> UsbDmxDriver::carried() const {
  if (bay_.universes().empty()) return {};
  return {{bay_.universes().front().number, {slots().begin(), slots().end()}, false}};
}

Fault UsbDmxDriver::inactive() const {
  return {Cause::inactive, life_.health().device, "the driver is not active", {}};
}

DriverBounds UsbDmxDriver::bounds() const {
  DriverBounds bounds;
  // With a working widget a call takes kUsbFrameBound at most; the rest is for closing and reopening it.
  bounds.write = kUsbOpenBound + kUsbPrepareBound + kUsbCloseBound + kUsbFrameBound;
  bounds.write_period = kDmxWritePeriod;
  bounds.fault_after = kUsbRefreshEvery + 2 * kUsbTransferTimeout + kDmxWritePeriod;
  return bounds;
}

Result<void> UsbDmxDriver::activate(Time now) {
  if (life_.life() != Life::configured) return {};
  life_.active(now);
  open(now);
  return {};
}

void UsbDmxDriver::deactivate(Time now) {
  if (life_.life() == Life::configured) return;
  close(now);
  life_.configured(now);
}

Result<void> UsbDmxDriver::move(Time, std::span<const AimCommand> commands) {
  if (life_.life() == Life::configured) return tl::unexpected(inactive());
  return bay_.set_aims(commands);
}

Result<void> UsbDmxDriver::write(Time now, std::span<const LevelCommand> commands) {
  if (life_.life() == Life::configured) return tl::unexpected(inactive());
  if (auto set = bay_.set_levels(commands); !set) return set;
  if (!channel_->is_open() && now >= reopen_at_) open(now);
  if (channel_->is_open()) take_ended(now);
  if (channel_->is_open()) send_frame(now);
  if (life_.life() == Life::faulted) return tl::unexpected(life_.fault());
  return {};
}

void UsbDmxDriver::open(Time now) {
  reopen_at_ = now + kUsbReopenEvery;
  if (auto done = channel_->open(); !done) return life_.faulted(now, done.error());
  if (auto done = opened(now); !done) return lost(now, done.error());
  if (!proves_itself_later()) well(now);
}

void UsbDmxDriver::close(Time now) {
  if (!channel_->is_open()) return;
  leave(now);
  channel_->close();
  closed();
}

void UsbDmxDriver::lost(Time now, Fault fault) {
  if (const std::string where = channel_->where(); !where.empty()) fault.detail = where + ": " + fault.detail;
  fault.detail += fmt::format(" ({} errors, {} transfers)", life_.health().errors + 1, life_.health().sent);
  life_.faulted(now, fault);
  channel_->close();
  closed();
  reopen_at_ = now + kUsbReopenEvery;
}

void UsbDmxDriver::well(Time now) {
  life_.mark_ok(now);
  if (life_.life() == Life::faulted) life_.active(now);
}

Result<void> UsbDmxDriver::set_up(std::initializer_list<UsbSetup> requests) {
  std::vector<UsbTicket> tickets;
  for (const UsbSetup& request : requests) tickets.push_back(usb().control_out(request, {}));
  const Deadline deadline(kUsbPrepareBound);
  for (std::size_t done = 0; done < tickets.size(); ++done) {
    const auto completion = usb().take(deadline.left());
    if (!completion) {
      return tl::unexpected(
          Fault{Cause::timeout, {}, "no answer to a control request: unplug the widget and plug it in again", {}});
    }
    if (completion->status == UsbStatus::done) continue;
    const Cause cause = completion->status == UsbStatus::stalled ? Cause::refused : Cause::network;
    return tl::unexpected(
        Fault{cause,
              {},
              fmt::format("control request {} of {}: {}", done + 1, tickets.size(), name_of(completion->status)),
              {}});
  }
  return {};
}

std::optional<UsbCompletion> UsbDmxDriver::wait_for(Time now, UsbTicket ticket, milliseconds wait) {
  for (const Deadline deadline(wait);;) {
    auto completion = usb().take(deadline.left());
    if (!completion) return std::nullopt;
    if (completion->ticket == ticket) return completion;
    ended(now, *completion);
    if (!usb().is_open()) return std::nullopt;
  }
}

void UsbDmxDriver::take_ended(Time now, milliseconds wait) {
  for (int i = 0; i < kMaxEndedPerCycle && usb().is_open(); ++i) {
    const auto completion = usb().take(i == 0 ? wait : milliseconds(0));
    if (!completion) return;
    ended(now, *completion);
  }
}

UsbSearch usb_search(const Bus& bus, std::span<const OptionDoc> docs, std::string what, std::vector<UsbKind> kinds) {
  UsbSearch search;
  search.what = std::move(what);
  search.kinds = std::move(kinds);
  search.serial = string_option(bus, docs, kUsbSerialOption.key);
  search.port = string_option(bus, docs, kUsbPortOption.key);
  return search;
}

std::vector<Problem> check_usb_dmx(const Rig& rig, std::size_t bus, std::span<const OptionDoc> docs) {
  const Bus& entry = rig.buses[bus];
  std::vector<Problem> problems = check_options(rig, entry, docs);
  const std::vector<Problem> patch = check_dmx_patch(rig, bus, 1, kHighestUsbUniverse);
  if (problems.empty()) {
    const std::string port = string_option(entry, docs, kUsbPortOption.key);
    if (!port.empty() && !is_port_path(port)) {
      problems.push_back(problem_at(rig, entry, kUsbPortOption.key,
                                    fmt::format("usb_port = \"{}\" is no USB port", port),
                                    "write it as `ls /sys/bus/usb/devices` shows it, such as \"1-1.4\""));
    }
    auto wanted = static_cast<int>(integer_option(entry, docs, kUsbUniverseOption.key));
    for (const Fixture& fixture : rig.fixtures) {
      const auto* dmx = std::get_if<DmxPatch>(&fixture.patch);
      if (fixture.bus != bus || dmx == nullptr) continue;
      if (wanted == 0) wanted = dmx->universe;
      if (dmx->universe == wanted) continue;
      problems.push_back({rig.file.string(), fixture.in_file.line, fixture.in_file.column,
                          fmt::format("fixture \"{}\" is in universe {}, but bus \"{}\" is one {} widget, which puts "
                                      "out one universe, {}",
                                      fixture.name, dmx->universe, entry.name, entry.driver, wanted),
                          fmt::format("write universe = {}, or give the fixture a [[bus]] of its own", wanted)});
    }
  }
  problems.insert(problems.end(), patch.begin(), patch.end());
  return problems;
}

std::unique_ptr<UsbChannel> make_usb_channel(UsbSearch search, const std::optional<Redirect>& redirect) {
  if (redirect) return make_usbip_channel(*redirect);
  return make_libusb_channel(std::move(search));
}

}  // namespace luxrig
