#pragma once
/// A switch on a discrete input of a unit, for a blackout without a computer. `now` in, requests out; no socket.

#include <optional>
#include <span>

#include "core/rig/rig.h"
#include "core/time.h"
#include "drivers/driver.h"
#include "drivers/modbus/modbus_codec.h"
#include "drivers/options.h"

namespace luxrig::modbus {

// Rows for a driver's option table.
inline constexpr OptionDoc kContactInputOption = {
    "blackout_input", "whole number", "", "-1", "-1 to 65535",
    "discrete input (function 2, counted from 0) of a switch that asks for blackout; -1: there is none"};
inline constexpr OptionDoc kContactUnitOption = {"blackout_unit", "whole number",          "", "1",
                                                 "0 to 255",      "the unit that has it"};
inline constexpr OptionDoc kContactWhenOption = {
    "blackout_when", "text", "", "\"open\"", "open or closed",
    "which state of its contact asks for blackout; `open`, with a contact that rests closed, finds a broken wire, too"};

struct ContactPatch {
  int unit = 1;
  int input = 0;
  bool when_open = true;
};

/// Empty if there is none. requires check_options() and check_contact() to be empty.
[[nodiscard]] std::optional<ContactPatch> contact_patch(const Bus& bus, std::span<const OptionDoc> docs);
[[nodiscard]] std::vector<Problem> check_contact(const Rig& rig, const Bus& bus, std::span<const OptionDoc> docs,
                                                 int first_unit, int last_unit);

class ContactWatch {
 public:
  /// Below the write period, so every call that writes levels also asks.
  static constexpr Duration kEvery = std::chrono::milliseconds(90);
  /// After this long without an answer the state is unknown.
  static constexpr Duration kKnownFor = std::chrono::seconds(1);

  explicit ContactWatch(const ContactPatch& patch) : patch_(patch) {}
  [[nodiscard]] int unit() const { return patch_.unit; }
  [[nodiscard]] std::optional<Request> due(Time now) const;
  void asked(Time now) { asked_ = now; }
  void answered(Time now, bool closed);
  [[nodiscard]] Contact contact(Time now) const;

 private:
  ContactPatch patch_;
  std::optional<Time> asked_, answered_;
  bool closed_ = false;
};

}  // namespace luxrig::modbus
